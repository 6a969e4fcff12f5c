"""Better paths of arms for more time: the cost never rises, all is proved, and the same effort gives the same bits."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import evenroad as er
from evenroad.geometry.shapes import Capsule
from evenroad.planning import arm_trees
from evenroad.planning.connectors import ARM_TREES
from evenroad.roadmap import Budget
from evenroad.robots.joint import Joint
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Obstacle
from evenroad.space.path import path_length
from tests.robots.kernel_arms import STRAIGHT, X, Y
from tests.robots.oracle import clearance
from tests.robots.paths import GOAL, START, box_world, dense_states, proved

TERMINALS = np.stack([START, GOAL])


@pytest.fixture(scope="module")
def world():
    return box_world()


@pytest.fixture(scope="module")
def first(world):
    found = arm_trees.connect(world, START, [GOAL])
    return found.path, 0, found.motions


def improved(world, first, rounds, batches, is_smoothing=True, variant=0):
    """The length after each call until so many rounds are done, and the last improver."""
    improver = ARM_TREES.improver(world, TERMINALS, first, variant=variant, is_smoothing=is_smoothing)
    lengths = [improver.length]
    while improver.improve(rounds, 10**9, batches) == "paused":
        lengths.append(improver.length)
    return [*lengths, improver.length], improver


@pytest.mark.parametrize("is_smoothing", [True, False])
def test_the_path_only_becomes_shorter_and_is_proved_and_leads_from_start_to_goal(world, first, is_smoothing):
    lengths, improver = improved(world, first, 40, 50, is_smoothing)
    assert lengths == sorted(lengths, reverse=True)
    assert lengths[-1] < 0.9 * lengths[0]
    assert lengths[-1] == pytest.approx(path_length(improver.path, world.space), rel=1e-12)
    for path in (improver.path, improver.along_trees):
        np.testing.assert_array_equal(path[[0, -1]], TERMINALS)
        assert proved(world, path)
        assert clearance(world.robot, world.scene, dense_states(world, path)).min() > 0.0
    assert improver.goal == 0


def test_pauses_and_threads_change_nothing_and_another_variant_does(world, first):
    paths = [improved(world, first, 12, batches)[1].path.tobytes() for batches in (1, 37, 10**9)]
    with ThreadPoolExecutor(4) as pool:
        paths += [each[1].path.tobytes() for each in pool.map(lambda _: improved(world, first, 12, 100), range(4))]
    assert len(set(paths)) == 1
    assert improved(world, first, 12, 100, variant=5)[1].path.tobytes() != paths[0]


def test_rounds_and_motions_are_kept_to_the_last(world, first):
    improver = improved(world, first, 3, 10**9)[1]
    assert improver.rounds == 3
    for most in (1, 100, 1234):
        improver = ARM_TREES.improver(world, TERMINALS, first, variant=0, is_smoothing=True)
        assert improver.improve(10**9, most, 10**9) == "spent"
        assert improver.motions == most


def test_long_rounds_come_near_the_shortest_way_around_a_plate():
    """A point-like arm of two sliding joints: the way around the end of a wall is known."""
    world, least = sliding_world()
    start, goal = np.array([-0.5, 0.0]), np.array([0.5, 0.0])
    result = er.plan(world, start, goal, er.RRTConnect(improve=True), limits=Budget(seconds=None, rounds=100))
    assert least < result.cost < 1.02 * least
    assert result.gap == pytest.approx(result.cost - 1.0)


def sliding_world():
    """A ball of 1 cm on two slides, a wall at x = 0 up to y = 0.3, and how long a way around it is at least."""
    joints = tuple(
        Joint(name, "prismatic", parent, name, (0.0, 0.0, 0.0), STRAIGHT, axis, -1.0, 1.0, 1.0)
        for name, parent, axis in (("x", "base", X), ("y", "x", Y))
    )
    ball = Capsule((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.01, link="y")
    robot = Robot("slides", ("base", "x", "y"), joints, (ball,), (), ("x", "y"))
    wall = Obstacle.of("wall", "box", (0.02, 1.3, 1.0), (0.0, -0.35, 0.0))
    return er.ArmWorld(robot, er.Scene((wall,), name="wall")), 2.0 * np.hypot(0.49, 0.3) + 0.02


def test_a_straight_way_is_the_shortest_and_takes_no_round(world):
    near = START + 0.05
    result = er.plan(world, START, near, er.RRTConnect(improve=True))
    assert result.gap == pytest.approx(0.0, abs=1e-9)
    assert result.counts["rounds"] == 0
    assert "the best of" not in result.message
