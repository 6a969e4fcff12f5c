"""An axis that stays upright: along the whole path, on a grid of its own, or there is no path."""

import math
from itertools import pairwise

import numpy as np
import pytest

import evenroad as er
from evenroad.constraints import KeepUpright
from evenroad.constraints.constrained_world import kept_world
from evenroad.errors import InvalidValue
from evenroad.geometry import Pose
from evenroad.poses.inverse_kinematics import reach
from evenroad.poses.pose_goal import PoseGoal
from evenroad.robot import ArmWorld, CartesianLine, Scene, link_poses, load_robot
from tests.refused import refused
from tests.robots import oracle
from tests.robots.kernel_arms import random_scene

ARM7 = load_robot("arm7")
DOWN = (math.pi, 0.0, 0.0)


def tilt_along(robot, path, tip):
    """Largest angle between the tip's z axis and straight down, at 50 states of every motion."""
    dense = np.concatenate([np.linspace(a, b, 50) for a, b in pairwise(path)])
    axis = link_poses(robot, dense)[:, robot.links.index(tip), :3, 2]
    return np.arctan2(np.hypot(axis[:, 0], axis[:, 1]), -axis[:, 2]).max()


def problem(seed):
    """A scene, and two poses that point down: a configuration of the one, a goal at the other."""
    scene, rng = random_scene(seed, count=6, spread=0.8, clear=0.35), np.random.default_rng(seed)
    world, found = ArmWorld(ARM7, scene), []
    while len(found) < 2:
        xyz = (*rng.uniform([-0.5, -0.5], [0.5, 0.5]), rng.uniform(0.2, 0.7))
        goal = PoseGoal(Pose.from_rpy(xyz, DOWN), free_axis="z")
        if len(rows := reach(world, goal, np.zeros(7)).configurations):
            found.append((rows[0], goal))
    return scene, found[0][0], found[1][1]


@pytest.mark.parametrize("tolerance", [0.3, 0.03])
def test_a_path_keeps_the_axis_upright_where_one_that_is_not_told_to_does_not(tolerance):
    plain = []
    for seed in (1, 2, 5, 6):
        scene, start, goal = problem(seed)
        result = er.plan(scene, start, goal, robot=ARM7, constraints=KeepUpright(tolerance))
        assert result.solved
        tilt = tilt_along(ARM7, result.path, "flange")
        assert tilt <= tolerance
        assert result.deviation["tilt_rad"] <= tolerance
        assert tilt <= result.deviation["tilt_rad"] + 0.1 * tolerance
        world = ArmWorld(ARM7, scene)
        assert world.validate(result.path).all()
        assert result.proof == "certified"
        assert result.path[0].tolist() == start.tolist()
        plain.append(tilt_along(ARM7, er.plan(scene, start, goal, robot=ARM7).path, "flange"))
    assert max(plain) > 0.3


@pytest.fixture(scope="module")
def world():
    arm = ArmWorld(ARM7, Scene(name="empty"))
    start = reach(arm, PoseGoal(Pose.from_rpy((0.4, 0.1, 0.4), DOWN)), np.zeros(7)).configurations[0]
    return kept_world(arm, (KeepUpright(0.1),), start, "flange")


def test_milestones_are_projected(world):
    q = world.space.from_cube(np.random.default_rng(0).random((300, 7)))
    axis = link_poses(ARM7, q)[:, ARM7.links.index("flange"), :3, 2]
    tilt = np.arctan2(np.hypot(axis[:, 0], axis[:, 1]), -axis[:, 2])
    assert np.abs(tilt - world.keeps[0].off(world.shares(q)[:, 0] * world.keeps[0].limit)).max() < 1e-7
    assert (tilt <= 0.1).mean() > 0.8
    assert not world.valid(q)[tilt > 0.1].any()


def test_a_motion_ends_on_the_branch_of_its_end_and_never_jumps(world):
    q = world.space.from_cube(np.random.default_rng(1).random((400, 7)))
    q = q[world.valid(q)]
    a, b = q[0:200:2], q[1:200:2]
    free = world.motion_valid(a, b)
    assert 5 < free.sum() < len(free) - 5
    for first, last, ok in zip(a, b, free, strict=True):
        way = world.along(first, last)
        assert (way is not None) == ok
        if ok:
            assert (way[0] == first).all()
            assert (way[-1] == last).all()
            assert np.linalg.norm(np.diff(way, axis=0), axis=1).max() < 0.3
            assert tilt_along(ARM7, way, "flange") <= 0.1
    assert (world.motion_valid(b, a) == free).all()


def test_a_start_or_goals_that_are_tilted_are_refused():
    _, start, _ = problem(1)
    tilted = start.copy()
    tilted[5] += 0.4
    result = er.plan(Scene(name="empty"), tilted, start, robot=ARM7, constraints=KeepUpright(0.1, axis="z"))
    assert result.status is er.Status.START_INVALID
    assert "at the start axis z of 'flange' is tilted by" in result.message
    result = er.plan(Scene(name="empty"), start, tilted, robot=ARM7, constraints=KeepUpright(0.1))
    assert result.status is er.Status.GOAL_INVALID
    assert "more than 0.1" in result.message


def test_straight_and_upright_go_together():
    scene, start, goal = problem(6)
    result = er.plan(scene, start, goal, robot=ARM7, constraints=KeepUpright(0.1) & CartesianLine(0.05, away="up"))
    assert result.solved
    assert set(result.deviation) == {"tilt_rad", "line_m", "line_rad"}
    assert tilt_along(ARM7, result.path, "flange") <= 0.1


def test_lines_keep_another_link_upright_too():
    # The line of the tool tilts the forearm by .236 rad on its way, and by .03 at its end.
    robot, start = load_robot("ur5"), np.array([0.06, -2.17, 0.75, -0.26, 0.87, 0.06])
    goal = start + np.array([0.6, 0, 0, 0.2, 0.2, 0.2])
    forearm = robot.links.index("forearm_link")
    axis = tuple(link_poses(robot, start[np.newaxis])[0, forearm, 2, :3].tolist())

    def plan(tolerance):
        line = CartesianLine(retreat=0.4, away=(1.6, -1.3, -0.6), tip="tool0")
        upright = KeepUpright(tolerance, axis, tip="forearm_link")
        return er.plan(Scene(name="empty"), start, goal, robot=robot, constraints=line & upright)

    refused = plan(0.1)
    assert "from the start: along it axis (" in refused.message
    assert refused.status is er.Status.NOT_CONNECTED
    assert "of 'forearm_link' is tilted by 0.23" in refused.message
    allowed = plan(0.3)
    assert allowed.solved
    dense = np.concatenate([np.linspace(a, b, 50) for a, b in pairwise(allowed.path)])
    up = link_poses(robot, dense)[:, forearm, 2, :3] @ np.array(axis)
    assert allowed.deviation["tilt_rad"] == pytest.approx(np.arccos(up.min()), rel=1e-3)
    assert allowed.deviation["tilt_rad"] > 0.23


def test_a_tolerance_that_is_none_is_refused():
    refused(InvalidValue, "tolerance of upright must be a finite number > 0, got 0", KeepUpright, 0.0)
    refused(InvalidValue, "at most", KeepUpright, 4.0)
    refused(InvalidValue, "axis of upright must be", KeepUpright, 0.1, axis="up")


def test_a_motion_walks_along_a_line_where_projected_straight_ones_jump():
    world, ends = ArmWorld("ur5"), []
    for y in (-0.5, 0.5):
        goal = PoseGoal(Pose.from_rpy((0.3036, y, 0.475), (math.pi / 2, 0.0, math.pi / 2)))
        ends.append(reach(world, goal, np.zeros(6)).configurations[:12])
    keeps = er.constraints.KeepOnLine("y"), er.constraints.KeepOrientation(1e-3)
    jumped = 0
    for first in ends[0]:
        line = kept_world(world, keeps, first, "tool0")
        for last in ends[1]:
            way = line.along(first, last)
            if way is None:
                continue
            assert (way == line.along(last, first)[::-1]).all()
            assert (way[[0, -1]] == [first, last]).all()
            assert np.linalg.norm(np.diff(way, axis=0), axis=1).max() < 0.04
            at = oracle.link_poses(world.robot, np.linspace(way[:-1], way[1:], 10).reshape(-1, 6))["tool0"][1]
            assert np.abs(at[:, [0, 2]] - [0.3036, 0.475]).max() <= 1e-4
            states, kept = line.projected(np.linspace(first, last, 300), steps=8)
            jumped += not kept.all() or np.linalg.norm(np.diff(states, axis=0), axis=1).max() > 0.1
    assert jumped > 0
