"""Straight lines of a tip: on the line, with its rotation, free, or a reason."""

import math
from itertools import pairwise

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue
from evenroad.geometry import Pose
from evenroad.poses.cartesian_line import line_from
from evenroad.poses.chain import chain_of
from evenroad.robot import ArmWorld, CartesianLine, Obstacle, Scene, link_poses, load_robot
from tests.refused import refused

UR5, ARM7 = load_robot("ur5"), load_robot("arm7")
BENT = {"ur5": [0.3, -1.2, 1.4, -0.8, 0.9, 0.2], "arm7": [0.3, 0.6, 0.1, 1.2, 0.3, 0.7, -0.4]}
EMPTY = Scene(name="empty")
START = [0.5, -1.9, 1.2, -0.8, -1.57, 0.0]
"""Above the box of ``box-reach``."""


def tips(robot, path, tip):
    """Poses of the tip at 40 states of every motion."""
    dense = np.concatenate([np.linspace(a, b, 40) for a, b in pairwise(path)])
    return link_poses(robot, dense)[:, robot.links.index(tip)]


@pytest.mark.parametrize(("robot", "tip"), [(UR5, "tool0"), (ARM7, "flange")], ids=["ur5", "arm7"])
@pytest.mark.parametrize("away", ["-z", "x", "up", (0.6, 0.0, -0.8)])
def test_a_line_is_straight_keeps_the_rotation_and_is_proved_free(robot, tip, away):
    world, q = ArmWorld(robot, EMPTY), np.array(BENT[robot.name])
    line = line_from(world, chain_of(robot, tip), CartesianLine(0.05, away=away), q, 0.05)
    assert line.why == ""
    assert (line.path[0] == q).all()
    assert world.validate(line.path).all()
    at = tips(robot, line.path, tip)
    first = at[0]
    direction = {"up": np.array([0, 0, 1.0]), "-z": -first[:3, 2], "x": first[:3, 0]}.get(
        away if isinstance(away, str) else "", first[:3, :3] @ [0.6, 0.0, -0.8]
    )
    gap = at[:, :3, 3] - first[:3, 3]
    along = gap @ direction
    off = np.linalg.norm(gap - np.outer(along, direction), axis=1)
    assert along[-1] == pytest.approx(0.05, abs=1e-6)
    assert (np.diff(along) > -1e-9).all()
    assert off.max() <= line.off_m < 1e-4
    assert np.abs(at[:, :3, :3] - first[:3, :3]).max() < 1e-3


def test_a_line_that_is_blocked_says_where_and_by_what():
    q = np.array(BENT["ur5"])
    at = link_poses(UR5, q[None])[0, UR5.links.index("tool0")]
    wall = Obstacle.of("wall", "sphere", (0.05,), tuple(at[:3, 3] + 0.2 * at[:3, 2]))
    world = ArmWorld(UR5, Scene((wall,), name="s"))
    assert world.valid(q[None])[0]
    line = line_from(world, chain_of(UR5, "tool0"), CartesianLine(0.15, away="z"), q, 0.15)
    assert len(line.path) == 1
    assert "'wrist_3_link' touches 'wall'" in line.why
    after = float(line.why.split()[1])
    assert 0.0 < after < 0.15


def test_a_line_out_of_reach_says_how_far_it_goes():
    line = line_from(
        ArmWorld(UR5, EMPTY), chain_of(UR5, "tool0"), CartesianLine(2.0, away="up"), np.array(BENT["ur5"]), 2.0
    )
    assert "no joint angles go on" in line.why
    assert 0.05 < float(line.why.split()[1]) < 1.0


@pytest.mark.parametrize("length", [3.0, 1e6, 1e300])
def test_a_line_longer_than_the_arm_reaches_is_refused_before_it_is_laid_out(length):
    q = np.array(BENT["ur5"])
    line = line_from(ArmWorld(UR5, EMPTY), chain_of(UR5, "tool0"), CartesianLine(length), q, length)
    assert line.path.tolist() == [q.tolist()]
    assert "'tool0' moves no farther than 2.4" in line.why


def test_a_line_that_is_missed_by_more_than_its_tolerance_is_refused():
    straight = CartesianLine(0.05, line_tolerance=1e-9)
    line = line_from(ArmWorld(UR5, EMPTY), chain_of(UR5, "tool0"), straight, np.array(BENT["ur5"]), 0.05)
    assert "the tip misses its curve by" in line.why


def test_a_plan_goes_straight_from_its_start_and_to_its_goal():
    pose = Pose.from_rpy((0.62, 0.0, 0.2), (0.0, math.pi / 2, 0.0))
    start = START
    result = er.plan("box-reach", start, pose, robot="ur5", constraints=CartesianLine(0.1, 0.05))
    assert result.solved
    assert result.path[0].tolist() == start
    assert result.cost == pytest.approx(np.linalg.norm(np.diff(result.path, axis=0), axis=1).sum())
    at = tips(UR5, result.path, "tool0")
    near = np.linalg.norm(at[:, :3, 3] - pose.xyz, axis=1)
    last = at[np.flatnonzero(near > 0.1)[-1] :]
    assert np.abs(last[:, 1:3, 3] - [0.0, 0.2]).max() < 1e-3
    assert np.abs(last[:, :3, :3] - pose.rotation_matrix).max() < 1e-2
    first = at[: np.flatnonzero(np.linalg.norm(at[:, :3, 3] - at[0, :3, 3], axis=1) > 0.049)[0]]
    gap = first[:, :3, 3] - at[0, :3, 3]
    assert np.linalg.norm(gap - np.outer(gap @ at[0, :3, 2], at[0, :3, 2]), axis=1).max() < 1e-3
    assert 0.0 < result.deviation["line_m"] < 1e-3
    assert result.path[-1].tolist() == result.goals[result.goal_index].tolist()
    assert "(tool0 at (0.62, 0, 0.2))" in result.message


def test_points_plan_between_lines_too():
    pose = Pose.from_rpy((0.62, 0.0, 0.2), (0.0, math.pi / 2, 0.0))
    result = er.plan("box-reach", START, pose, er.PRM(1024), robot="ur5", seconds=60, constraints=CartesianLine(0.05))
    assert result.solved
    assert result.planner == "prm lazy"
    assert "line_m" in result.deviation


def test_where_there_is_no_straight_way_the_answer_says_so():
    stretched = er.plan("box-reach", "home", "inside", robot="ur5", constraints=CartesianLine(retreat=0.2, away="up"))
    assert stretched.status is er.Status.NOT_CONNECTED
    assert "no straight line from the start: after" in stretched.message
    sideways = er.plan("box-reach", "home", "inside", robot="ur5", constraints=CartesianLine(0.3, away="x"))
    assert sideways.status is er.Status.NOT_CONNECTED
    assert "no straight line to the goal: after" in sideways.message


def test_a_line_that_is_none_is_refused():
    refused(InvalidValue, "must have a length", CartesianLine)
    refused(InvalidValue, "approach must be a finite number >= 0, got nan", CartesianLine, math.nan)
    refused(InvalidValue, "away must be a direction, got zeros", CartesianLine, 0.1, away=(0, 0, 0))
    refused(InvalidValue, "away must be x, -x, .* or 3 finite numbers, got 'down'", CartesianLine, 0.1, away="down")
