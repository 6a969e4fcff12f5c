import numpy as np
import pytest

from evenroad.errors import InvalidValue, UnknownName
from evenroad.geometry import Box, Capsule, PointCloud, Pose
from evenroad.robot import (
    ArmWorld,
    Obstacle,
    Scene,
    at_states,
    configuration,
    in_scene,
    link_poses,
    load_robot,
    named_states,
    with_group,
    with_limits,
)
from tests.refused import refused
from tests.robots.urdf_texts import joint, link, urdf, write

UR5 = load_robot("ur5")
GRIPPER = urdf(
    link("base"),
    link("left"),
    link("right"),
    joint("grip", "base", "left", "prismatic", "<limit lower='0.02' upper='0.04'/>", "0 0.2 0.2"),
    joint(
        "mirror",
        "base",
        "right",
        "prismatic",
        "<limit lower='0.02' upper='0.04'/><mimic joint='grip'/>",
        "0 -0.2 0.2",
        "0 -1 0",
    ),
    name="gripper",
)


@pytest.fixture
def gripper(tmp_path):
    return load_robot(write(tmp_path, GRIPPER, "gripper.urdf"))


def test_a_gripper_is_carried_by_its_link_and_its_joints_are_held(gripper):
    pose = Pose.from_rpy((0, 0, 0.05), (0, 0, 0.3))
    arm = UR5.with_tool(gripper, at="tool0", pose=pose)
    assert arm.name == "ur5 with gripper"
    assert arm.group == UR5.group
    assert arm.states == UR5.states
    q = np.random.default_rng(1).uniform(-3, 3, (5, 6))
    ours, theirs = link_poses(arm, q), link_poses(gripper, [[0.02]])[0]
    tip = link_poses(UR5, q)[:, UR5.links.index("tool0")] @ pose.matrix
    np.testing.assert_array_equal(ours[:, : len(UR5.links)], link_poses(UR5, q))
    for i, name in enumerate(gripper.links):
        np.testing.assert_allclose(ours[:, arm.links.index(name)], tip @ theirs[i], atol=1e-14)


def test_pairs_between_arm_and_tool_are_worked_out_anew_and_the_others_stay(gripper):
    arm = UR5.with_tool(gripper, at="tool0", prefix="g_")
    assert set(UR5.pairs) < set(arm.pairs)
    assert ("g_left", "g_right") in arm.pairs
    assert ("forearm_link", "g_left") in arm.pairs
    assert ("wrist_3_link", "g_base") not in arm.pairs, "they are fixed to each other"
    assert len(set(arm.pairs)) == len(arm.pairs)


def test_a_tool_of_shapes_collides_where_the_bare_arm_does_not():
    arm = UR5.with_tool([Box((0.02, 0.02, 0.3), pose=Pose((0, 0, 0.15)))], at="tool0")
    q = np.array([[0.0, -1.5, 1.0, 0.0, 0.5, 0.0]])
    place = (link_poses(UR5, q)[0, UR5.links.index("tool0")] @ (0, 0, 0.25, 1))[:3]
    scene = Scene((Obstacle.of("ball", "sphere", (0.02,), place),), name="ball")
    assert ArmWorld(UR5, scene).valid(q)[0]
    assert not ArmWorld(arm, scene).valid(q)[0]
    assert ArmWorld(arm, scene).explain(q[0]) == "'tool' touches 'ball'"


@pytest.mark.parametrize(("make", "error", "says"), [
    (lambda: UR5.with_tool([Box((1, 1, 1))], at="hand"), UnknownName, "link of 'ur5': 'hand'; known: .*tool0"),
    (lambda: UR5.with_tool([], at="tool0"), InvalidValue, "must have a body"),
    (lambda: UR5.with_tool(UR5, at="tool0"), InvalidValue, "names of their links, both have .*prefix="),
    (lambda: UR5.with_tool([PointCloud(np.zeros((1, 3)))], at="tool0"), InvalidValue, "cloud of 1 points"),
])  # fmt: skip
def test_a_tool_that_cannot_be_joined_is_refused(make, error, says):
    refused(error, says, make)


def test_two_arms_of_one_kind_are_joined_with_a_prefix():
    both = UR5.with_tool(UR5, at="tool0", pose=Pose((0, 0, 0.5)), prefix="second_")
    assert len(both.links) == 2 * len(UR5.links)
    assert len(both.joints) == 2 * len(UR5.joints) + 1
    assert both.group == UR5.group


def test_a_rigid_tool_is_loaded_like_a_robot_or_capsules_as_they_are(tmp_path):
    tool = load_robot(write(tmp_path, urdf(link("rod"), name="rod")))
    assert tool.group == ()
    assert UR5.with_tool(tool, at="tool0").capsules[-1] == tool.capsules[0]
    refused(InvalidValue, "one joint or more", ArmWorld, tool, Scene(name="empty"))
    rod = Capsule((0, 0, 0), (0, 0, 0.2), 0.01)
    assert UR5.with_tool([rod], at="tool0").capsules[-1] == Capsule(rod.a, rod.b, 0.01, link="tool")


@pytest.mark.parametrize("called", [
    lambda robot: in_scene(robot, Scene(name="nothing")),
    lambda robot: with_limits(robot, {}),
    lambda robot: with_group(robot, ()),
    lambda robot: named_states(robot),
    lambda robot: at_states(robot, ["home"]),
    lambda robot: configuration(robot, "home"),
])  # fmt: skip
def test_a_name_in_place_of_a_robot_is_refused(called):
    refused(InvalidValue, r"robot must be a Robot, as load_robot.* gives it, got 'ur5'", called, "ur5")
