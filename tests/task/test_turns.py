"""Joints that turn endlessly: every motion of a task goes on from the numbers where the one before ended."""

import math

import numpy as np
import pytest

import evenroad as er
from evenroad.robot import Joint, Robot
from evenroad.task import Attach, Detach, MoveLinear, MoveTo, Task
from evenroad.trajectory import Limits
from tests.robots.kernel_arms import STRAIGHT, Z

LIMITS = Limits((1.0, 1.0, 1.0), (2.0, 2.0, 2.0))


def turning_arm():
    """A planar arm of three joints, of which the first and the last have no limits."""
    links = ("base", "upper", "lower", "hand")
    places = (0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (0.4, 0.0, 0.0)
    joints = tuple(
        Joint(f"j{k + 1}", kind, links[k], links[k + 1], places[k], STRAIGHT, Z, -most, most)
        for k, (kind, most) in enumerate((("continuous", math.inf), ("revolute", 2.9), ("continuous", math.inf)))
    )
    bodies = tuple(er.Capsule((0.05, 0, 0), (0.3, 0, 0), 0.03, link=link) for link in links[1:])
    return Robot("planar", links, joints, bodies, (), ("j1", "j2", "j3"))


@pytest.fixture(scope="module")
def world():
    post = er.Box((0.1, 0.1, 0.5), xyz=(0.1, -0.8, 0.0), name="post")
    part = er.Box((0.04, 0.04, 0.04), xyz=(0.1, 0.0, 0.3), name="part")
    return er.ArmWorld(turning_arm(), er.Scene([post, part]))


def jumps(rows):
    return np.abs(np.diff(rows[:, [0, 2]], axis=0)).max()


STARTS = [(0.4, 0.5, 0.2), (9.0, 0.5, -20.0), (-50.3, -0.5, 3.1)]


@pytest.mark.parametrize("start", STARTS)
def test_a_task_goes_on_where_the_arm_stands(start, world):
    steps = [MoveTo([3.0, 0.3, 0.5]), Attach("part", reach=3.0), MoveTo([-2.6, 0.4, -3.0]),
             MoveTo([2.8, -0.4, 3.0]), Detach("part"), MoveTo([0.1, 0.2, 0.3])]  # fmt: skip
    done = Task(steps).plan(world, list(start))
    assert done.solved, done.message
    assert done.path[0].tolist() == list(start)
    assert jumps(done.path) <= math.pi
    for part, after in zip(done.parts[:-1], done.parts[1:], strict=True):
        assert part.path[-1].tolist() == after.path[0].tolist()
    for part in done.parts:
        assert part.world.validate(part.path).all()
    driven = done.trajectory(limits=LIMITS)
    assert driven.positions[0].tolist() == list(start)
    assert jumps(driven.positions) <= 1.0 * 0.008 + 1e-9


@pytest.mark.parametrize("start", STARTS)
def test_and_so_do_lines_after_motions(start, world):
    tip = er.robot.link_poses(world.robot, np.array([[3.0, 0.9, 0.2], [-2.9, 0.9, 0.2]]))[:, -1]
    done = Task([MoveTo([3.0, 0.9, 0.2]), MoveLinear(er.Pose.from_matrix(tip[1])), MoveTo([0.0, 0.5, 0.0])]).plan(
        world, start
    )
    assert done.solved, done.message
    assert done.path[0].tolist() == list(start)
    assert jumps(done.path) <= math.pi
