"""Messages of ROS 2 without ROS: types that rosbags does not know, and bytes written by the rules of CDR."""

import importlib
import struct
import sys
from pathlib import Path

import numpy as np
import pytest

typesys = pytest.importorskip("rosbags.typesys")
FOLDER = Path(__file__).parents[1] / "examples" / "ros2"

MOVEIT = {
    "object_recognition_msgs/msg/ObjectType": "string key\nstring db",
    "octomap_msgs/msg/Octomap": "std_msgs/Header header\nbool binary\nstring id\nfloat64 resolution\nint8[] data",
    "octomap_msgs/msg/OctomapWithPose": (
        "std_msgs/Header header\ngeometry_msgs/Pose origin\noctomap_msgs/Octomap octomap"
    ),
    "moveit_msgs/msg/CollisionObject": (
        "std_msgs/Header header\ngeometry_msgs/Pose pose\nstring id\nobject_recognition_msgs/ObjectType type\n"
        "shape_msgs/SolidPrimitive[] primitives\ngeometry_msgs/Pose[] primitive_poses\n"
        "shape_msgs/Mesh[] meshes\ngeometry_msgs/Pose[] mesh_poses\n"
        "shape_msgs/Plane[] planes\ngeometry_msgs/Pose[] plane_poses\n"
        "string[] subframe_names\ngeometry_msgs/Pose[] subframe_poses\nbyte operation"
    ),
    "moveit_msgs/msg/AttachedCollisionObject": (
        "string link_name\nmoveit_msgs/CollisionObject object\nstring[] touch_links\n"
        "trajectory_msgs/JointTrajectory detach_posture\nfloat64 weight"
    ),
    "moveit_msgs/msg/RobotState": (
        "sensor_msgs/JointState joint_state\nsensor_msgs/MultiDOFJointState multi_dof_joint_state\n"
        "moveit_msgs/AttachedCollisionObject[] attached_collision_objects\nbool is_diff"
    ),
    "moveit_msgs/msg/AllowedCollisionEntry": "bool[] enabled",
    "moveit_msgs/msg/AllowedCollisionMatrix": (
        "string[] entry_names\nmoveit_msgs/AllowedCollisionEntry[] entry_values\n"
        "string[] default_entry_names\nbool[] default_entry_values"
    ),
    "moveit_msgs/msg/LinkPadding": "string link_name\nfloat64 padding",
    "moveit_msgs/msg/LinkScale": "string link_name\nfloat64 scale",
    "moveit_msgs/msg/ObjectColor": "string id\nstd_msgs/ColorRGBA color",
    "moveit_msgs/msg/PlanningSceneWorld": (
        "moveit_msgs/CollisionObject[] collision_objects\noctomap_msgs/OctomapWithPose octomap"
    ),
    "moveit_msgs/msg/PlanningScene": (
        "string name\nmoveit_msgs/RobotState robot_state\nstring robot_model_name\n"
        "geometry_msgs/TransformStamped[] fixed_frame_transforms\n"
        "moveit_msgs/AllowedCollisionMatrix allowed_collision_matrix\n"
        "moveit_msgs/LinkPadding[] link_padding\nmoveit_msgs/LinkScale[] link_scale\n"
        "moveit_msgs/ObjectColor[] object_colors\nmoveit_msgs/PlanningSceneWorld world\nbool is_diff"
    ),
}
"""The fields of what rosbags does not know, as MoveIt 2 has them."""


@pytest.fixture(scope="module")
def store():
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    types = {}
    for name, fields in MOVEIT.items():
        types |= typesys.get_types_from_msg(fields, name)
    store.register(types)
    return store


@pytest.fixture(scope="module")
def make(store):
    """Make a message: fields that are not given are zeros, empty, or messages of such."""

    def make(kind, **fields):
        unknown = fields.keys() - {name for name, _ in store.fielddefs[kind][1]}
        assert not unknown, f"{kind} has no {unknown}"
        return store.types[kind](**{name: _nothing(make, *of) for name, of in store.fielddefs[kind][1]} | fields)

    return make


def _nothing(make, node, of):
    """Return the value of a field that nobody gave."""
    if node == typesys.base.Nodetype.BASE:
        kind = of[0]
        return "" if kind == "string" else False if kind == "bool" else 0.0 if "float" in kind else 0
    if node == typesys.base.Nodetype.NAME:
        return make(of)
    kind, count = of
    if kind[0] == typesys.base.Nodetype.BASE and kind[1][0] != "string":
        return np.zeros(count, dtype={"byte": "uint8"}.get(kind[1][0], kind[1][0]))
    return [_nothing(make, *kind) for _ in range(count)]


@pytest.fixture(scope="module", autouse=True)
def _folder():
    sys.path.insert(0, str(FOLDER))
    yield
    sys.path.remove(str(FOLDER))


def _module(name):
    return importlib.import_module(name)


class Cdr:
    """Bytes by the rules of CDR, little-endian: numbers stand at multiples of their size behind four bytes."""

    def __init__(self):
        self.bytes = b""

    def put(self, kind, *values):
        size = struct.calcsize(kind)
        for value in values:
            self.bytes += b"\0" * (-len(self.bytes) % size) + struct.pack("<" + kind, value)
        return self

    def text(self, text):
        data = text.encode() + b"\0"
        self.put("I", len(data)).bytes += data
        return self

    def row(self, values):
        return self.put("I", len(values)).put("d", *values)

    def header(self, sec, nanosec, frame):
        return self.put("i", sec).put("I", nanosec).text(frame)

    def message(self):
        return b"\0\1\0\0" + self.bytes


def _written(store, message):
    """Return the bytes of a message without what rosbags may leave at its end."""
    return bytes(store.serialize_cdr(message, message.__msgtype__))


def _sent(store, message):
    """Return a message as a node gets it: through bytes."""
    return store.deserialize_cdr(store.serialize_cdr(message, message.__msgtype__), message.__msgtype__)


def _pose(make, xyz, quaternion=(0.0, 0.0, 0.0, 1.0)):
    place = make("geometry_msgs/msg/Point", **dict(zip("xyz", map(float, xyz), strict=True)))
    turn = make("geometry_msgs/msg/Quaternion", **dict(zip("xyzw", map(float, quaternion), strict=True)))
    return make("geometry_msgs/msg/Pose", position=place, orientation=turn)


def _header(make, frame=""):
    return make("std_msgs/msg/Header", frame_id=frame)
