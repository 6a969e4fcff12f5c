"""The arm's node without ROS: rosbags' messages in, and what goes out compared byte for byte."""

import math

import numpy as np
import pytest

from evenroad.errors import EvenroadError, InvalidValue
from evenroad.robot import ArmWorld, Obstacle, Scene, link_poses, load_robot
from evenroad.ros2.arm_query import ArmQuery, plan_for_arm
from evenroad.ros2.scene_state import joint_values, planning_scene, standing_at_values
from evenroad.trajectory import Limits, make_trajectory
from evenroad.trajectory.formats import joint_trajectory
from tests_peers.ros2_messages import Cdr, _header, _pose, _sent, _written
from tests_peers.ros2_messages import make as make
from tests_peers.ros2_messages import store as store


def test_a_trajectory_is_written_byte_for_byte(store, make):
    path = np.array([[0.0, 0.0], [1.0, 0.5], [0.5, 1.0]])
    trajectory = make_trajectory(path, Limits((1.0, 1.0), (2.0, 2.0)), names=("a", "bc"), held={"d": 0.25})
    message = joint_trajectory(trajectory, make, ("bc", "d", "a"))
    cdr = Cdr().header(0, 0, "").put("I", 3).text("bc").text("d").text("a").put("I", len(trajectory.times))
    for i, time in enumerate(trajectory.times):
        cdr.row([trajectory.positions[i, 1], 0.25, trajectory.positions[i, 0]])
        for table in (trajectory.velocities, trajectory.accelerations):
            cdr.row([table[i, 1], 0.0, table[i, 0]])
        cdr.row([]).put("i", int(time // 1)).put("I", round((time % 1) * 1e9))
    assert _written(store, message) == cdr.message()


def _solid(make, kind, dimensions):
    return make("shape_msgs/msg/SolidPrimitive", type=kind, dimensions=np.array(dimensions, float))


def _collision_object(make, name, solids=(), poses=(), frame="", **more):
    lists = {key: list(value) for key, value in (("primitives", solids), ("primitive_poses", poses))}
    more = {"pose": _pose(make, (0, 0, 0))} | more
    return make("moveit_msgs/msg/CollisionObject", header=_header(make, frame), id=name, **lists, **more)


def _planning_scene(make, joints, objects, attached=(), allowed=(), octomap=(), **changes):
    values = np.array([*joints.values()], float)
    state = make(
        "moveit_msgs/msg/RobotState",
        joint_state=make("sensor_msgs/msg/JointState", name=list(joints), position=values),
        attached_collision_objects=[
            make("moveit_msgs/msg/AttachedCollisionObject", link_name=link, object=thing, touch_links=touches)
            for link, thing, touches in attached
        ],
    )
    names = sorted({name for pair in allowed for name in pair})
    rows = [np.array([(a, b) in allowed or (b, a) in allowed for b in names]) for a in names]
    entries = [make("moveit_msgs/msg/AllowedCollisionEntry", enabled=row) for row in rows]
    cells = make("octomap_msgs/msg/Octomap", binary=True, data=np.array(octomap, dtype=np.int8))
    fields = dict(
        name="today",
        robot_state=state,
        allowed_collision_matrix=make(
            "moveit_msgs/msg/AllowedCollisionMatrix", entry_names=names, entry_values=entries
        ),
        world=make(
            "moveit_msgs/msg/PlanningSceneWorld",
            collision_objects=list(objects),
            octomap=make("octomap_msgs/msg/OctomapWithPose", octomap=cells),
        ),
    )
    return make("moveit_msgs/msg/PlanningScene", **{**fields, **changes})


NAMES = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
VALUES = (0.0, -1.9, 1.6, -1.3, -1.57, 0.0)
START = {f"{name}_joint": value for name, value in zip(NAMES, VALUES, strict=True)}
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
    solids = [_solid(make, 3, (0.5, 0.05)), _solid(make, 2, (0.06,))]
    poses = [_pose(make, (0.0, 0.0, 0.25)), _pose(make, (0.1, 0.2, 0.3))]
    at, wedge = _pose(make, (0.45, 0.3, 0.0), TURNED), _pose(make, (0.6, -0.4, 0.1), (0.0, 0.0, 0.0, 0.0))
    table = _solid(make, 1, (1.0, 2.0, 0.04))
    return [
        _collision_object(make, "table", [table], [_pose(make, (0.3, 0.0, -0.03))]),
        _collision_object(make, "posts", solids, poses, frame="base_link", pose=at),
        _collision_object(make, "wedge", meshes=[mesh], mesh_poses=[wedge]),
    ]


def test_a_planning_scene_is_the_scene_that_it_says(store, make):
    robot = load_robot("ur5")
    allowed = {("base_link", "table"), ("table", "wedge")}
    message = _planning_scene(make, START, _things(make), allowed=allowed)
    scene = planning_scene(_sent(store, message), robot)
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
    solid, pose = _solid(make, 1, (0.1, 0.1, 0.2)), _pose(make, (0.0, 0.0, 0.1))
    box = _collision_object(make, "box", [solid], [pose], frame="tool0")
    message = _planning_scene(make, START, _things(make), attached=[("tool0", box, ["wrist_3_link"])])
    scene = planning_scene(_sent(store, message), robot)
    [held] = scene.attached
    assert (held.name, held.link, held.touches) == ("box", "tool0", ("wrist_3_link",))
    assert held.body.pose.xyz == (0.0, 0.0, 0.1)


def test_the_arm_planner_answers_with_a_trajectory_that_is_free(store, make):
    robot = load_robot("ur5")
    goal = (1.2, -1.5, 1.7, -1.3, -1.57, 0.3)
    message = _sent(store, _planning_scene(make, START, _things(make), allowed={("base_link", "table")}))
    there = planning_scene(message, robot)
    standing, start = standing_at_values(joint_values(message.robot_state.joint_state, robot, "it"), robot, "it")
    answer = plan_for_arm(ArmQuery(standing, there, start, [goal], speed=0.5))
    assert answer.outcome == "SUCCESS"
    trajectory = _sent(store, joint_trajectory(answer.trajectory, make))
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
    scene = planning_scene(_planning_scene(make, START, _things(make)), robot)
    answer = plan_for_arm(ArmQuery(robot, scene, [*START.values()], ["0,-1.9,1.6,-1.3,-1.57,0"]))
    assert answer.trajectory is None
    assert answer.outcome == "START_STATE_IN_COLLISION"
    assert "table" in answer.message


def _far(make):
    return _collision_object(make, "far", [_solid(make, 2, (0.1,))], [_pose(make, (0, 0, 0))], frame="camera")


def _floor(make):
    return _collision_object(make, "floor", planes=[make("shape_msgs/msg/Plane")], plane_poses=[_pose(make, (0, 0, 0))])


def test_padded_links_and_objects_in_the_frames_of_links_are_honoured(store, make):
    robot = load_robot("ur5")
    padding = make("moveit_msgs/msg/LinkPadding", link_name="tool0", padding=0.01)
    solid, pose = _solid(make, 1, (0.1, 0.1, 0.2)), _pose(make, (0.0, 0.0, 0.3))
    box = _collision_object(make, "box", [solid], [pose], frame="tool0")
    message = _planning_scene(make, START, [box], link_padding=[padding])
    scene = planning_scene(_sent(store, message), robot)
    assert scene.padding == {"tool0": 0.01}
    tip = link_poses(robot, [[*START.values()]])[0, robot.links.index("tool0")]
    np.testing.assert_allclose(scene.obstacles[0].xyz, (tip @ (0.0, 0.0, 0.3, 1.0))[:3])


def _scaled(make):
    return make("moveit_msgs/msg/LinkScale", link_name="tool0", scale=1.1)


@pytest.mark.parametrize(
    ("said", "objects", "changes"),
    [
        ("difference", [], {"is_diff": lambda make: True}),
        ("octomap", [], {"octomap": lambda make: (1, 2)}),
        ("link_scale", [], {"link_scale": lambda make: [_scaled(make)]}),
        ("camera", [_far], {}),
        ("plane", [_floor], {}),
    ],
)
def test_what_would_be_left_out_is_refused(make, said, objects, changes):
    fields = {name: value(make) for name, value in changes.items()}
    message = _planning_scene(make, START, [each(make) for each in objects], **fields)
    with pytest.raises(EvenroadError, match=said):
        planning_scene(message, load_robot("ur5"))


def test_a_state_that_says_too_little_is_refused(make):
    message = _planning_scene(make, {"elbow_joint": 1.0}, [])
    values = joint_values(message.robot_state.joint_state, load_robot("ur5"), "the scene")
    with pytest.raises(InvalidValue, match="the scene does not say where shoulder_pan_joint"):
        standing_at_values(values, load_robot("ur5"), "the scene")
