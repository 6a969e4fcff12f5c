"""The reduced tree of moving frames puts every link where the joints put it; and bounds on how fast."""

import math
from dataclasses import replace

import numpy as np
import pytest

from evenroad.errors import InvalidValue, UnknownName
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.joint import Joint, Mimic
from evenroad.robot.kernel.moving_tree import moving_tree, rotation_from_z
from evenroad.robot.kernel.placed_capsules import farthest, joint_arms
from evenroad.robot.kernel.robot_tables import robot_tables
from evenroad.robot.scene import Scene
from tests.robot.kernel_arms import STRAIGHT, Y, Z, random_tree, seven_joint_arm, ur5
from tests.robot.oracle import link_poses

EMPTY = Scene((), name="empty")
ROBOTS = {"ur5": ur5(), "seven": seven_joint_arm()} | {
    f"tree {seed}": random_tree(seed) for seed in range(12)
}


def poses_by_frames(robot, q):
    """Rotation and origin of every link at one configuration, by way of the moving tree."""
    tree = moving_tree(robot)
    frames = [(np.eye(3), np.zeros(3))]
    for frame in tree.frames:
        rotation, origin = frames[frame.parent]
        value = frame.multiplier * q[frame.coordinate] + frame.offset
        origin = origin + rotation @ frame.translation
        rotation = rotation @ frame.rotation
        if frame.slides:
            origin = origin + rotation[:, 2] * value
        else:
            cosine, sine = math.cos(value), math.sin(value)
            rotation = rotation @ np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
        frames.append((rotation, origin))
    return {
        name: (
            frames[place.frame][0] @ place.rotation,
            frames[place.frame][1] + frames[place.frame][0] @ place.translation,
        )
        for name, place in tree.links.items()
    }


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_links_are_where_the_joints_put_them(robot):
    q = np.random.default_rng(1).uniform(-1.0, 1.0, (5, len(robot.group)))
    expected = link_poses(robot, q)
    for row in range(len(q)):
        for name, (rotation, origin) in poses_by_frames(robot, q[row]).items():
            np.testing.assert_allclose(rotation, expected[name][0][row], atol=1e-12)
            np.testing.assert_allclose(origin, expected[name][1][row], atol=1e-12)


def test_what_no_planned_joint_moves_becomes_no_frame():
    robot = ur5(joints=3)
    assert len(moving_tree(robot).frames) == 3
    assert len(moving_tree(ur5()).frames) == 6


def test_a_held_joint_stays_where_it_is_held():
    robot = replace(ur5(joints=5), held={"wrist_3_joint": 0.7})
    whole = np.array([[0.1, -0.2, 0.3, -0.4, 0.5, 0.7]])
    expected = link_poses(ur5(), whole)["wrist3"]
    rotation, origin = poses_by_frames(robot, whole[0, :5])["wrist3"]
    np.testing.assert_allclose(rotation, expected[0][0], atol=1e-12)
    np.testing.assert_allclose(origin, expected[1][0], atol=1e-12)


def test_a_held_joint_without_a_value_is_at_zero_or_the_limit_next_to_it():
    robot = ur5(joints=5)
    joints = (*robot.joints[:5], replace(robot.joints[5], lower=0.4, upper=1.0))
    rotation, _ = poses_by_frames(replace(robot, joints=joints), np.zeros(5))["wrist3"]
    held, _ = poses_by_frames(replace(robot, held={"wrist_3_joint": 0.4}), np.zeros(5))["wrist3"]
    np.testing.assert_allclose(rotation, held, atol=1e-12)


def test_a_mimic_of_itself_is_refused():
    robot = ur5(joints=4)
    a = replace(robot.joints[4], mimic=Mimic("wrist_3_joint"))
    b = replace(robot.joints[5], mimic=Mimic("wrist_2_joint"))
    with pytest.raises(InvalidValue, match="mimics itself"):
        moving_tree(replace(robot, joints=(*robot.joints[:4], a, b)))


def test_a_mimic_of_a_joint_that_is_not_there_is_refused():
    robot = ur5(joints=5)
    last = replace(robot.joints[5], mimic=Mimic("thumb"))
    with pytest.raises(UnknownName, match="unknown joint 'thumb'"):
        moving_tree(replace(robot, joints=(*robot.joints[:5], last)))


@pytest.mark.parametrize(
    "axis", [Z, Y, (0.0, 0.0, -1.0), (0.6, 0.0, 0.8), (1e-9, 0.0, 1.0), (3.0, -4.0, 12.0)]
)
def test_the_z_axis_is_turned_to_the_axis(axis):
    turn = rotation_from_z(axis)
    np.testing.assert_allclose(turn[:, 2], np.array(axis) / np.linalg.norm(axis), atol=1e-15)
    np.testing.assert_allclose(turn.T @ turn, np.eye(3), atol=1e-15)
    assert np.linalg.det(turn) > 0.0


# ---- bounds


def points_of(robot, tables, q):
    """Ends of every placed capsule's segment, (capsules, n, 2, 3); and the frames' numbers."""
    poses = link_poses(robot, q)
    places = moving_tree(robot).links
    ends = []
    for capsule in tables.capsules:
        rotation, origin = poses[capsule.link]
        back = places[capsule.link]
        local = [
            back.rotation.T @ (capsule.centre + s * capsule.half - back.translation) for s in (-1.0, 1.0)
        ]
        ends.append(np.stack([origin + rotation @ point for point in local], axis=1))
    return np.array(ends)


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_no_joint_moves_a_capsule_faster_than_its_arm(robot):
    tables, space = robot_tables(robot), ArmWorld(robot, EMPTY).space
    frames = moving_tree(robot).frames
    arms = joint_arms(tables.tree, tables.capsules, robot)
    q = space.from_cube(np.random.default_rng(2).random((300, space.dim)))
    for coordinate in range(space.dim):
        step = np.zeros(space.dim)
        step[coordinate] = 1e-6
        moved = (
            np.linalg.norm(points_of(robot, tables, q + step) - points_of(robot, tables, q), axis=-1) / 1e-6
        )
        allowed = sum(arms[:, f] for f, frame in enumerate(frames) if frame.coordinate == coordinate)
        assert (moved.max(axis=(1, 2)) <= allowed + 1e-6).all()


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_nothing_is_farther_than_the_reach(robot):
    tables, space = robot_tables(robot), ArmWorld(robot, EMPTY).space
    q = space.from_cube(np.random.default_rng(3).random((300, space.dim)))
    radii = np.array([capsule.cover.radius for capsule in tables.capsules])
    farthest_seen = (np.linalg.norm(points_of(robot, tables, q), axis=-1).max(axis=(1, 2)) + radii).max()
    assert farthest_seen <= farthest(tables.tree, tables.capsules, robot)


def test_the_reach_of_a_stretched_arm_is_not_far_off():
    assert model_reach(ur5()) < 1.4
    assert model_reach(ur5()) > 0.9


def model_reach(robot):
    return robot_tables(robot).reach


def test_a_slide_counts_in_the_reach_by_its_farther_end():
    robot = random_tree(8)
    slide = Joint("extra", "prismatic", robot.links[-1], "tip", (0.0, 0.0, 0.0), STRAIGHT, Z, -3.0, 1.0)
    longer = replace(
        robot,
        links=(*robot.links, "tip"),
        joints=(*robot.joints, slide),
        group=(*robot.group, "extra"),
        capsules=(*robot.capsules, replace(robot.capsules[-1], link="tip")),
    )
    assert model_reach(longer) >= 3.0
