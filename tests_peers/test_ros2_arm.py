"""The arm node of examples/ros2 without ROS: rosbags' messages in, and what goes out compared byte for byte."""

import math
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.robot import ArmWorld, Obstacle, Scene, load_robot
from evenroad.trajectory import Limits, make_trajectory
from evenroad.trajectory.files import joint_trajectory
from tests_peers.ros2_messages import FOLDER, Cdr, _header, _module, _pose, _sent, _written
from tests_peers.ros2_messages import _folder as _folder
from tests_peers.ros2_messages import make as make
from tests_peers.ros2_messages import store as store


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
        (
            Obstacle.of("table", "box", (1.0, 2.0, 0.04), (0.3, 0.0, -0.03)),
            Obstacle.of("post", "cylinder", (0.05, 0.5), (0.45, 0.3, 0.25)),
            Obstacle.of("ball", "sphere", (0.06,), (0.45 + 0.1 * c - 0.2 * s, 0.3 + 0.1 * s + 0.2 * c, 0.3)),
            Obstacle.of("wedge", "box", (0.1, 0.1, 0.1), (0.65, -0.35, 0.15)),
        ),
        name="by hand",
        allowed=frozenset({("base_link", "table")}),
    )
    assert ArmWorld(robot, scene).validate(q[::4]).all()


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
