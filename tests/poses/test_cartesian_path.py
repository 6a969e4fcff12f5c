"""A tip on its curve: its bounds hold at sampled states, and where it goes no farther the cause is the true one."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

import evenroad as er
from evenroad.geometry.curve import polyline
from evenroad.poses.cartesian_path import OFF_M, OFF_RAD, Follower, condition_of, deviations
from evenroad.poses.chain import chain_of
from evenroad.poses.posture_layers import follow
from tests.robots import oracle

UR5, ARM7 = er.load_robot("ur5"), er.load_robot("arm7")
BENT = {"ur5": [0.3, -1.2, 1.4, -0.8, 0.9, 0.2], "arm7": [0.3, 0.6, 0.1, 1.2, 0.3, 0.7, -0.4]}
TIPS = {"ur5": "tool0", "arm7": "flange"}


def tips(robot, q):
    """Rotations and origins of the tip by the oracle."""
    return oracle.link_poses(robot, q)[TIPS[robot.name]]


def pose_at(robot, q, xyz=(0.0, 0.0, 0.0), rpy=(0.0, 0.0, 0.0)):
    """The tip's pose at a configuration, moved and turned in the root's frame."""
    turn, origin = (each[0] for each in tips(robot, np.array([q])))
    return er.Pose(origin + xyz, er.Pose(rpy=rpy).rotation_matrix @ turn)


@pytest.mark.parametrize("robot", [UR5, ARM7], ids=["ur5", "arm7"])
def test_a_polyline_is_followed_within_its_bounds_and_reaches_each_pose(robot):
    q = np.array(BENT[robot.name])
    moves = [((0.0, 0.1, 0.0), (0.0, 0.0, 0.4)), ((-0.05, 0.1, -0.1), (0.3, 0.0, 0.4))]
    poses = [pose_at(robot, q), *(pose_at(robot, q, *move) for move in moves)]
    world = er.ArmWorld(robot)
    done = follow(Follower(world, chain_of(robot, TIPS[robot.name]), polyline(poses)), q)
    assert done.why == ""
    assert done.off_m <= OFF_M
    assert done.off_rad <= OFF_RAD
    assert world.validate(done.path).all()
    turns, origins = tips(robot, done.path[list(done.via)])
    np.testing.assert_allclose(origins, [pose.xyz for pose in poses], atol=1e-9)
    np.testing.assert_allclose(turns, [pose.rotation_matrix for pose in poses], atol=1e-9)
    for (first, last), (a, b) in zip(pairwise(done.via), pairwise(poses), strict=True):
        states = np.linspace(done.path[first:last], done.path[first + 1 : last + 1], 21)
        at = tips(robot, states.reshape(-1, len(q)))[1] - a.xyz
        along = np.subtract(b.xyz, a.xyz) / np.linalg.norm(np.subtract(b.xyz, a.xyz))
        assert np.linalg.norm(at - np.outer(at @ along, along), axis=1).max() <= done.off_m


@pytest.mark.parametrize("robot", [UR5, ARM7], ids=["ur5", "arm7"])
def test_no_state_between_two_configurations_is_farther_off_than_the_bound(robot):
    rng, chain = np.random.default_rng(0), chain_of(robot, TIPS[robot.name])
    share, tightest = np.linspace(0.0, 1.0, 41), np.inf
    for size in (0.01, 0.05, 0.3):
        a = rng.uniform(*chain.bounds, size=(60, len(robot.group)))
        for first, last in zip(a, a + rng.uniform(-size, size, a.shape), strict=True):
            off_m, off_rad = deviations(chain, np.array([first, last]))
            turns, at = tips(robot, first + np.outer(share, last - first))
            worst = np.linalg.norm(at - at[0] - np.outer(share, at[-1] - at[0]), axis=1).max()
            steady = Slerp([0.0, 1.0], Rotation.from_matrix(turns[[0, -1]]))(share)
            assert worst <= off_m[0]
            assert (steady.inv() * Rotation.from_matrix(turns)).magnitude().max() <= off_rad[0] + 1e-12
            tightest = min(tightest, off_m[0] / worst)
    assert tightest < 1.3, "the bound is far from the truth: this tests little"


def test_of_a_line_beyond_reach_the_share_and_the_condition_are_said():
    q = np.array(BENT["ur5"])
    curve = polyline([pose_at(UR5, q), pose_at(UR5, q, (0.0, 0.0, 2.0))])
    done = follow(Follower(er.ArmWorld(UR5), chain_of(UR5, "tool0"), curve), q)
    assert "no joint angles go on: the posture has the condition number" in done.why
    height = tips(UR5, done.path[-1:])[1][0, 2] - tips(UR5, q[np.newaxis])[1][0, 2]
    assert done.share == pytest.approx(0.5 * height, abs=1e-9)


def test_a_limit_is_named():
    q = np.array(BENT["ur5"])
    turned = er.Pose(pose_at(UR5, q).xyz, pose_at(UR5, q).rotation_matrix @ er.Pose(rpy=(0, 0, 1.0)).rotation_matrix)
    world = er.ArmWorld(UR5, er.Scene(limits={"wrist_3_joint": (-0.5, 0.5)}))
    done = follow(Follower(world, chain_of(world.robot, "tool0"), polyline([pose_at(UR5, q), turned])), q)
    assert done.why == "joint 'wrist_3_joint' is at its limit there, of [-0.5, 0.5]"
    assert done.share == pytest.approx(0.3, abs=0.05)


def test_an_obstacle_is_named_with_the_share_that_is_free():
    q = np.array(BENT["ur5"])
    goal = pose_at(UR5, q, (0.0, 0.2, 0.0))
    wall = er.Box((1.0, 0.02, 1.0), xyz=tuple(np.add(goal.xyz, (0.0, 0.02, 0.0))), name="wall")
    done = follow(
        Follower(er.ArmWorld(UR5, er.Scene([wall])), chain_of(UR5, "tool0"), polyline([pose_at(UR5, q), goal])), q
    )
    assert "touches 'wall'" in done.why
    assert 0.1 < done.share < 0.9


def test_the_condition_number_is_that_of_the_derivative():
    q = np.array(BENT["ur5"])
    step = 1e-6 * np.eye(6)
    turns, at = tips(UR5, np.concatenate([q + step, q - step]))
    columns = []
    for k in range(6):
        skew = turns[k] @ turns[k + 6].T
        columns.append([*(at[k] - at[k + 6]), skew[2, 1], skew[0, 2], skew[1, 0]])
    assert condition_of(chain_of(UR5, "tool0"), q) == pytest.approx(np.linalg.cond(np.array(columns)), rel=1e-4)


def test_layers_find_a_way_on_which_going_to_the_nearest_posture_fails():
    """Seven joints leave a choice: greedily the arm ends at a limit, and layers avoid it."""
    rng, robot = np.random.default_rng(0), ARM7
    world, chain = er.ArmWorld(robot), chain_of(robot, "flange")
    better = 0
    for _ in range(60):
        q = rng.uniform(*chain.bounds)
        if not world.valid(q):
            continue
        curve = polyline([pose_at(robot, q), pose_at(robot, q, rng.uniform(-0.4, 0.4, 3))])
        follower = Follower(world, chain, curve)
        greedy, layered = follower.from_posture(q), follow(follower, q)
        assert layered.share >= greedy.share or not layered.why
        if greedy.why and not layered.why:
            better += 1
            assert (layered.path[0] == q).all()
            assert world.validate(layered.path).all()
            np.testing.assert_allclose(chain.tip_poses(layered.path[-1:])[0], curve.poses[-1], atol=1e-9)
    assert better > 0
