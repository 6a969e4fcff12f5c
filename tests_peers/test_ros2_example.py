"""The nodes of examples/ros2 without ROS: rosbags' messages in, and messages out that are compared byte for byte.

What goes out is compared with bytes that this file writes itself by the rules of CDR.
"""

import importlib
import math
import struct
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue
from evenroad.robot import ArmWorld, Obstacle, Scene, load_robot
from evenroad.trajectory import Limits, make_trajectory
from evenroad.trajectory.files import joint_trajectory

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
    return lambda kind, **fields: store.types[kind](**fields)


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
    return make(
        "std_msgs/msg/Header", stamp=make("builtin_interfaces/msg/Time", sec=0, nanosec=0), frame_id=frame
    )


def _occupancy(make, cells, origin=(1.0, -2.0), yaw=0.0):
    info = make(
        "nav_msgs/msg/MapMetaData",
        map_load_time=make("builtin_interfaces/msg/Time", sec=0, nanosec=0),
        resolution=0.05,
        width=cells.shape[1],
        height=cells.shape[0],
        origin=_pose(make, (*origin, 0.0), (0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw))),
    )
    data = cells.astype(np.int8).ravel()
    return make("nav_msgs/msg/OccupancyGrid", header=_header(make, "map"), info=info, data=data)


def test_a_map_is_the_one_that_its_file_is(store, make, tmp_path):
    """The message of a map server and the file that it serves are one map."""
    from PIL import Image

    cells = np.zeros((40, 60), dtype=np.int8)
    cells[10:14, :40] = 100
    cells[30:35, 10:20] = -1
    pixels = np.where(cells == 100, 0, np.where(cells < 0, 205, 254))[::-1].astype(np.uint8)
    Image.fromarray(pixels).save(tmp_path / "map.pgm")
    (tmp_path / "map.yaml").write_text(
        "image: map.pgm\nresolution: 0.05\norigin: [1.0, -2.0, 0.3]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    given = _module("messages").grid_map(_sent(store, _occupancy(make, cells, yaw=0.3)))
    read = er.load_map(tmp_path / "map.yaml")
    np.testing.assert_array_equal(given.occupied, read.occupied)
    np.testing.assert_array_equal(given.unknown, read.unknown)
    assert given.frame.resolution == 0.05
    assert given.frame.origin == read.frame.origin
    assert given.frame.yaw == pytest.approx(0.3, abs=1e-12)


def test_unknown_cells_may_be_free(make):
    cells = np.array([[-1, 0], [70, 60]])
    messages = _module("messages")
    free = messages.grid_map(_occupancy(make, cells), unknown_is_free=True)
    np.testing.assert_array_equal(free.occupied, [[True, False], [False, False]])
    np.testing.assert_array_equal(messages.grid_map(_occupancy(make, cells)).occupied[1], [True, False])


def test_a_map_that_does_not_lie_flat_is_refused(make):
    message = _occupancy(make, np.zeros((2, 2)))
    message.info.origin.orientation.x = 0.1
    with pytest.raises(InvalidValue, match="flat"):
        _module("messages").grid_map(message)


def test_a_path_is_written_byte_for_byte(store, make):
    path = np.array([[0.5, 0.25], [1.5, 0.25], [1.5, 3.0]])
    message = _module("messages").path_message(make, path, "map", (12, 34), -2.0)
    cdr = Cdr().header(12, 34, "map").put("I", 3)
    for (x, y), angle in zip(path.tolist(), (0.0, 0.5 * math.pi, -2.0), strict=True):
        cdr.header(12, 34, "map").put("d", x, y, 0.0, 0.0, 0.0, math.sin(0.5 * angle), math.cos(0.5 * angle))
    assert _written(store, message) == cdr.message()


def test_the_map_planner_answers_with_a_free_path(store, make):
    cells = np.zeros((60, 60))
    cells[30, :45] = 100
    grid = _sent(store, _occupancy(make, cells))
    start, goal = _pose(make, (1.4, -1.4, 0.0)), _pose(make, (1.4, 0.4, 0.0), (0.0, 0.0, 1.0, 0.0))
    path, why = _module("map_planner").answer(make, grid, start, goal, 0.2, (1, 2))
    assert "path" in why
    path = _sent(store, path)
    assert path.header.frame_id == "map"
    places = np.array([[each.pose.position.x, each.pose.position.y] for each in path.poses])
    np.testing.assert_allclose(places[[0, -1]], [[1.4, -1.4], [1.4, 0.4]])
    world = _module("messages").grid_map(grid).world(0.2)
    assert world.motion_valid(places[:-1], places[1:]).all()
    assert path.poses[-1].pose.orientation.z == pytest.approx(1.0)
    shut, why = _module("map_planner").answer(make, grid, start, goal, 0.6, (1, 2))
    assert shut is None
    assert why


@pytest.fixture
def node(monkeypatch):
    """The map's node as it runs: its subscriptions by topic, what it says, and what it publishes."""
    node = SimpleNamespace(takes={}, said=[], published=[])
    log = SimpleNamespace(**dict.fromkeys(("info", "warning", "error"), node.said.append))
    clock = SimpleNamespace(now=lambda: SimpleNamespace(to_msg=lambda: SimpleNamespace(sec=1, nanosec=2)))
    wired = SimpleNamespace(
        declare_parameter=lambda name, value: SimpleNamespace(value=value),
        create_publisher=lambda *_: SimpleNamespace(publish=node.published.append),
        create_subscription=lambda kind, topic, callback, quality: node.takes.update({topic: callback}),
        get_logger=lambda: log,
        get_clock=lambda: clock,
    )
    quality = SimpleNamespace(
        DurabilityPolicy=SimpleNamespace(TRANSIENT_LOCAL=1), QoSProfile=lambda **_: None
    )
    kinds = SimpleNamespace(PoseStamped=0, PoseWithCovarianceStamped=0, OccupancyGrid=0, Path=0)
    ros = SimpleNamespace(init=lambda: None, create_node=lambda _: wired, spin=lambda _: None)
    for name, module in {
        "rclpy": ros,
        "rclpy.qos": quality,
        "geometry_msgs.msg": kinds,
        "nav_msgs.msg": kinds,
    }.items():
        monkeypatch.setitem(sys.modules, name, module)
    for name in ("geometry_msgs", "nav_msgs"):
        monkeypatch.setitem(sys.modules, name, SimpleNamespace(msg=kinds))
    module = _module("map_planner")
    monkeypatch.setattr(module, "answer", lambda make, *given: ("a path", "found"))
    module.main()
    node.answers = lambda answer: monkeypatch.setattr(module, "answer", answer)
    return node


def _in_frame(frame, pose=None):
    return SimpleNamespace(header=SimpleNamespace(frame_id=frame), pose=SimpleNamespace(pose=pose))


def test_the_map_node_plans_within_one_frame_only(node):
    node.takes["map"](_in_frame("map"))
    node.takes["goal_pose"](_in_frame("map"))
    assert (node.said, node.published) == (["no start yet"], [])
    node.takes["initialpose"](_in_frame("map"))
    node.takes["goal_pose"](_in_frame("odom"))
    assert node.said[1:] == ["map, start and goal are in different frames: map, odom"]
    assert node.published == []
    node.takes["goal_pose"](_in_frame("map"))
    assert node.published == ["a path"]


def test_the_map_node_outlives_what_it_refuses(node):
    def refuse(*_):
        raise InvalidValue("the map must lie flat")

    node.answers(refuse)
    node.takes["map"](_in_frame("map"))
    node.takes["initialpose"](_in_frame("map"))
    node.takes["goal_pose"](_in_frame("map"))
    assert (node.said, node.published) == (["the map must lie flat"], [])


def test_a_trajectory_is_written_byte_for_byte(store, make):
    path = np.array([[0.0, 0.0], [1.0, 0.5], [0.5, 1.0]])
    trajectory = make_trajectory(path, Limits((1.0, 1.0), (2.0, 2.0)), names=("a", "bc"), held={"d": 0.25})
    message = joint_trajectory(trajectory, make, ("bc", "d", "a"))
    cdr = Cdr().header(0, 0, "").put("I", 3).text("bc").text("d").text("a").put("I", len(trajectory.times))
    for i, time in enumerate(trajectory.times):
        for table, held in (
            (trajectory.positions, 0.25),
            (trajectory.velocities, 0.0),
            (trajectory.accelerations, 0.0),
        ):
            cdr.row([table[i, 1], held, table[i, 0]])
        cdr.row([]).put("i", int(time // 1)).put("I", round((time % 1) * 1e9))
    assert _written(store, message) == cdr.message()


def _solid(make, kind, dimensions):
    polygon = make("geometry_msgs/msg/Polygon", points=[])
    return make(
        "shape_msgs/msg/SolidPrimitive", type=kind, dimensions=np.array(dimensions, float), polygon=polygon
    )


def _collision_object(make, name, solids, poses, pose=None, frame="", meshes=(), mesh_poses=(), planes=()):
    return make(
        "moveit_msgs/msg/CollisionObject",
        header=_header(make, frame),
        pose=pose or _pose(make, (0, 0, 0)),
        id=name,
        type=make("object_recognition_msgs/msg/ObjectType", key="", db=""),
        primitives=list(solids),
        primitive_poses=list(poses),
        meshes=list(meshes),
        mesh_poses=list(mesh_poses),
        planes=list(planes),
        plane_poses=[_pose(make, (0, 0, 0)) for _ in planes],
        subframe_names=[],
        subframe_poses=[],
        operation=0,
    )


def _planning_scene(make, joints, objects, attached=(), allowed=(), octomap=(), **changes):
    state = make(
        "moveit_msgs/msg/RobotState",
        joint_state=make(
            "sensor_msgs/msg/JointState",
            header=_header(make),
            name=list(joints),
            position=np.array([*joints.values()], float),
            velocity=np.zeros(0),
            effort=np.zeros(0),
        ),
        multi_dof_joint_state=make(
            "sensor_msgs/msg/MultiDOFJointState",
            header=_header(make),
            joint_names=[],
            transforms=[],
            twist=[],
            wrench=[],
        ),
        attached_collision_objects=[
            make(
                "moveit_msgs/msg/AttachedCollisionObject",
                link_name=link,
                object=thing,
                touch_links=list(touches),
                detach_posture=make(
                    "trajectory_msgs/msg/JointTrajectory", header=_header(make), joint_names=[], points=[]
                ),
                weight=0.0,
            )
            for link, thing, touches in attached
        ],
        is_diff=False,
    )
    names = sorted({name for pair in allowed for name in pair})
    rows = [
        make(
            "moveit_msgs/msg/AllowedCollisionEntry",
            enabled=np.array([(one, other) in allowed or (other, one) in allowed for other in names]),
        )
        for one in names
    ]
    map_message = make(
        "octomap_msgs/msg/OctomapWithPose",
        header=_header(make),
        origin=_pose(make, (0, 0, 0)),
        octomap=make(
            "octomap_msgs/msg/Octomap",
            header=_header(make),
            binary=True,
            id="",
            resolution=0.0,
            data=np.array(octomap, dtype=np.int8),
        ),
    )
    fields = dict(
        name="today",
        robot_state=state,
        robot_model_name="",
        fixed_frame_transforms=[],
        allowed_collision_matrix=make(
            "moveit_msgs/msg/AllowedCollisionMatrix",
            entry_names=names,
            entry_values=rows,
            default_entry_names=[],
            default_entry_values=np.zeros(0, dtype=bool),
        ),
        link_padding=[],
        link_scale=[],
        object_colors=[],
        world=make(
            "moveit_msgs/msg/PlanningSceneWorld", collision_objects=list(objects), octomap=map_message
        ),
        is_diff=False,
    )
    return make("moveit_msgs/msg/PlanningScene", **{**fields, **changes})


START = dict(
    zip(
        (
            "shoulder_pan_joint",
            "shoulder_lift_joint",
            "elbow_joint",
            "wrist_1_joint",
            "wrist_2_joint",
            "wrist_3_joint",
        ),
        (0.0, -1.9, 1.6, -1.3, -1.57, 0.0),
        strict=True,
    )
)
TURNED = (0.0, 0.0, math.sin(0.25), math.cos(0.25))


def _triangle(make, a, b, c):
    return make("shape_msgs/msg/MeshTriangle", vertex_indices=np.array([a, b, c], dtype=np.uint32))


def _things(make):
    corners = [(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)]
    mesh = make(
        "shape_msgs/msg/Mesh",
        triangles=[_triangle(make, *row) for row in ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))],
        vertices=[make("geometry_msgs/msg/Point", x=float(x), y=float(y), z=float(z)) for x, y, z in corners],
    )
    return [
        _collision_object(
            make, "table", [_solid(make, 1, (1.0, 2.0, 0.04))], [_pose(make, (0.3, 0.0, -0.03))]
        ),
        _collision_object(
            make,
            "posts",
            [_solid(make, 3, (0.5, 0.05)), _solid(make, 2, (0.06,))],
            [_pose(make, (0.0, 0.0, 0.25)), _pose(make, (0.1, 0.2, 0.3))],
            pose=_pose(make, (0.45, 0.3, 0.0), TURNED),
            frame="base_link",
        ),
        _collision_object(
            make,
            "wedge",
            [],
            [],
            meshes=[mesh],
            mesh_poses=[_pose(make, (0.6, -0.4, 0.1), (0.0, 0.0, 0.0, 0.0))],
        ),
    ]


def test_a_planning_scene_is_the_scene_that_it_says(store, make):
    robot = load_robot("ur5")
    message = _planning_scene(
        make, START, _things(make), allowed={("base_link", "table"), ("table", "wedge")}
    )
    scene = _module("messages").planning_scene(_sent(store, message), robot)
    assert scene.name == "today"
    assert [each.name for each in scene.obstacles] == ["table", "posts/0", "posts/1", "wedge"]
    assert scene.allowed == {("base_link", "table")}
    table, post, ball, wedge = scene.obstacles
    assert (table.shape, table.size, table.xyz) == ("box", (1.0, 2.0, 0.04), (0.3, 0.0, -0.03))
    # A message has height and radius, we radius and length; poses are relative to the object's.
    assert (post.shape, post.size) == ("cylinder", (0.05, 0.5))
    np.testing.assert_allclose(post.xyz, (0.45, 0.3, 0.25))
    c, s = math.cos(0.5), math.sin(0.5)
    np.testing.assert_allclose(ball.xyz, (0.45 + 0.1 * c - 0.2 * s, 0.3 + 0.1 * s + 0.2 * c, 0.3))
    assert ball.size == (0.06,)
    np.testing.assert_allclose(wedge.body.triangles.vertices.max(axis=0), 0.1)
    np.testing.assert_allclose(wedge.xyz, (0.6, -0.4, 0.1))


def test_what_the_robot_holds_is_held(store, make):
    robot = load_robot("ur5")
    box = _collision_object(
        make, "box", [_solid(make, 1, (0.1, 0.1, 0.2))], [_pose(make, (0.0, 0.0, 0.1))], frame="tool0"
    )
    message = _planning_scene(make, START, _things(make), attached=[("tool0", box, ["wrist_3_link"])])
    scene = _module("messages").planning_scene(_sent(store, message), robot)
    [held] = scene.attached
    assert (held.name, held.link, held.touches) == ("box", "tool0", ("wrist_3_link",))
    assert held.body.pose.xyz == (0.0, 0.0, 0.1)


def test_the_arm_planner_answers_with_a_trajectory_that_is_free(store, make):
    robot = load_robot("ur5")
    goal = (1.2, -1.5, 1.7, -1.3, -1.57, 0.3)
    message = _sent(store, _planning_scene(make, START, _things(make), allowed={("base_link", "table")}))
    sent, why = _module("arm_planner").answer(make, message, robot, ",".join(map(str, goal)), speed=0.5)
    assert "path" in why
    trajectory = _sent(store, sent)
    assert trajectory.joint_names[: len(START)] == list(START)
    q = np.array([point.positions for point in trajectory.points])[:, : len(START)]
    np.testing.assert_allclose(q[[0, -1]], [[*START.values()], goal], atol=1e-6)
    # The scene once more, written down by hand.
    c, s = math.cos(0.5), math.sin(0.5)
    scene = Scene(
        "by hand",
        (
            Obstacle.of("table", "box", (1.0, 2.0, 0.04), (0.3, 0.0, -0.03)),
            Obstacle.of("post", "cylinder", (0.05, 0.5), (0.45, 0.3, 0.25)),
            Obstacle.of("ball", "sphere", (0.06,), (0.45 + 0.1 * c - 0.2 * s, 0.3 + 0.1 * s + 0.2 * c, 0.3)),
            Obstacle.of("wedge", "box", (0.1, 0.1, 0.1), (0.65, -0.35, 0.15)),
        ),
        frozenset({("base_link", "table")}),
    )
    assert ArmWorld(robot, scene).recheck(q[::4]).all()


def test_no_path_is_an_answer(store, make):
    robot = load_robot("ur5")
    message = _planning_scene(make, START, _things(make))
    sent, why = _module("arm_planner").answer(make, message, robot, "0,-1.9,1.6,-1.3,-1.57,0")
    assert sent is None
    assert "table" in why


def _far(make):
    return _collision_object(make, "far", [], [], frame="camera")


def _floor(make):
    return _collision_object(make, "floor", [], [], planes=[make("shape_msgs/msg/Plane", coef=np.zeros(4))])


def _padded(make):
    return make("moveit_msgs/msg/LinkPadding", link_name="tool0", padding=0.01)


def _scaled(make):
    return make("moveit_msgs/msg/LinkScale", link_name="tool0", scale=1.1)


@pytest.mark.parametrize(
    ("said", "objects", "changes"),
    [
        ("difference", [], {"is_diff": lambda make: True}),
        ("octomap", [], {"octomap": lambda make: (1, 2)}),
        ("padded", [], {"link_padding": lambda make: [_padded(make)]}),
        ("scaled", [], {"link_scale": lambda make: [_scaled(make)]}),
        ("camera", [_far], {}),
        ("plane", [_floor], {}),
    ],
)
def test_what_would_be_left_out_is_refused(make, said, objects, changes):
    fields = {name: value(make) for name, value in changes.items()}
    message = _planning_scene(make, START, [each(make) for each in objects], **fields)
    with pytest.raises(InvalidValue, match=said):
        _module("messages").planning_scene(message, load_robot("ur5"))


def test_messages_of_ros_get_lists(monkeypatch):
    """Setters of ROS refuse arrays."""
    point = SimpleNamespace(JointTrajectoryPoint=lambda **fields: fields)
    monkeypatch.setitem(sys.modules, "trajectory_msgs", SimpleNamespace(msg=point))
    monkeypatch.setitem(sys.modules, "trajectory_msgs.msg", point)
    kind = "trajectory_msgs/msg/JointTrajectoryPoint"
    made = _module("messages").ros_message(kind, positions=np.array([1.0, 2.0]), effort=np.zeros(0))
    assert made == {"positions": [1.0, 2.0], "effort": []}
    assert type(made["positions"]) is list


def test_a_state_that_says_too_little_is_refused(make):
    message = _planning_scene(make, {"elbow_joint": 1.0}, [])
    with pytest.raises(InvalidValue, match="shoulder_pan_joint"):
        _module("messages").standing(message, load_robot("ur5"))


def test_nothing_of_ros_is_needed_until_a_node_runs():
    code = (
        "import sys, map_planner, arm_planner, messages;"
        " print([m for m in ('rclpy', 'nav_msgs', 'moveit_msgs', 'rosbags') if m in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=FOLDER, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"
