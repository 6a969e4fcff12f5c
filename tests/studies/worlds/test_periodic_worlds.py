"""Periodic balls and boxes against slow oracles, and the contract of every world."""

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.testing import WorldContract
from evenroad_studies.worlds import PeriodicBalls, PeriodicBoxes
from tests.refused import refused


def some_balls(d, n, radius, seed=0):
    return PeriodicBalls(np.random.default_rng(seed).random((n, d)), radius)


def some_boxes(d, n, m, half, seed=0):
    random = np.random.default_rng(seed)
    axes = np.stack([random.permutation(d)[:m] for _ in range(n)])
    return PeriodicBoxes(d, axes, random.random((n, m)), half * (0.5 + random.random((n, m))))


def copies(d):
    """All shifts by -1, 0 or 1 along every axis."""
    return np.stack(np.meshgrid(*[[-1, 0, 1]] * d, indexing="ij"), axis=-1).reshape(-1, d)


def depth_in_ball(world, a, b):
    """How deep the motion goes into the deepest ball: every copy of every ball, in closed form."""
    depth = -np.inf
    for centre in world.centres:
        for copy in centre + copies(world.d):
            squared = float((b - a) @ (b - a))
            t = 0.0 if squared == 0 else min(max(float((copy - a) @ (b - a)) / squared, 0.0), 1.0)
            depth = max(depth, world.radius - float(np.linalg.norm(a + t * (b - a) - copy)))
    return depth


def depth_in_box(world, a, b, states=4001):
    """How deep the motion goes into the deepest box, at many states of it."""
    q = a + np.linspace(0, 1, states)[:, None] * (b - a)
    depth = -np.inf
    for axes, centre, half in zip(world.axes, world.centres, world.half_extents, strict=True):
        offset = np.abs(q[:, axes] - centre)
        inside = half - np.minimum(offset, 1 - offset)
        depth = max(depth, float(inside.min(axis=1).max()))
    return depth


class TestBallsKeepTheContract(WorldContract):
    world = some_balls(3, 8, 0.25)


class TestLargeBallsKeepTheContract(WorldContract):
    world = some_balls(10, 12, 0.75)


class TestBoxesKeepTheContract(WorldContract):
    world = some_boxes(4, 12, 3, 0.25)


@pytest.mark.parametrize(("d", "n", "radius"), [(1, 2, 0.1), (2, 5, 0.2), (3, 6, 0.3), (4, 2, 0.6)])
def test_a_motion_is_free_iff_it_misses_every_copy_of_every_ball(d, n, radius):
    world = some_balls(d, n, radius, seed=d)
    random = np.random.default_rng(1)
    a, b = random.random((150, d)), random.random((150, d))
    near = random.random(150) < 0.5
    b[near] = np.clip(a[near] + 0.1 * random.standard_normal((near.sum(), d)), 0, 1)
    depth = np.array([depth_in_ball(world, *ends) for ends in zip(a, b, strict=True)])
    sure = np.abs(depth) > 1e-9
    free = world.motion_valid(a, b)
    assert sure.all()
    assert 0 < free.sum() < 150
    np.testing.assert_array_equal(free, depth < 0)
    ends = np.array([depth_in_ball(world, each, each) for each in a])
    np.testing.assert_array_equal(world.valid(a), ends < 0)


@pytest.mark.parametrize(("d", "n", "m", "half"), [(1, 2, 1, 0.1), (2, 4, 2, 0.2), (5, 8, 3, 0.15)])
def test_a_motion_is_free_iff_it_misses_every_copy_of_every_box(d, n, m, half):
    world = some_boxes(d, n, m, half, seed=d)
    random = np.random.default_rng(2)
    a, b = random.random((300, d)), random.random((300, d))
    a[::7, 0] = b[::7, 0]
    depth = np.array([depth_in_box(world, *ends) for ends in zip(a, b, strict=True)])
    # A state is at most 2 / 4000 from one that the oracle looks at.
    free = world.motion_valid(a, b)
    assert 0 < free.sum() < 300
    assert not free[depth > 0].any()
    assert free[depth < -5e-4].all()
    assert ((depth > 0) | (depth < -5e-4)).mean() > 0.95
    ends = np.array([depth_in_box(world, each, each, states=1) for each in a])
    np.testing.assert_array_equal(world.valid(a), ends < 0)


def test_a_ball_at_a_face_is_met_at_its_copies_and_motions_do_not_wrap():
    world = PeriodicBalls([[0.0, 1.0]], 0.1)
    corners = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]])
    assert not world.valid(corners).any()
    assert world.valid(np.array([[0.5, 0.5], [0.5, 0.0]])).all()
    world = PeriodicBalls([[0.0, 0.5]], 0.1)
    assert world.motion_valid([[0.0, 0.3]], [[1.0, 0.3]])[0]
    assert not world.motion_valid([[0.0, 0.3]], [[1.0, 0.45]])[0]
    assert not world.motion_valid([[1.0, 0.3]], [[0.0, 0.45]])[0]
    world = PeriodicBalls([[0.5, 0.5]], 0.2)
    assert not world.motion_valid([[0.05, 0.5]], [[0.95, 0.5]])[0]


def test_touching_a_ball_or_a_box_is_free():
    ball, box = PeriodicBalls([[0.5, 0.5]], 0.25), PeriodicBoxes(2, [[0, 1]], [[0.5, 0.5]], [[0.25, 0.25]])
    for world in (ball, box):
        assert world.valid([[0.25, 0.5]])[0]
        assert world.motion_valid([[0.25, 0.0]], [[0.25, 1.0]])[0]
        assert not world.motion_valid([[0.26, 0.0]], [[0.26, 1.0]])[0]


def test_a_box_leaves_its_other_coordinates_free():
    world = PeriodicBoxes(3, [[2]], [[0.5]], [[0.1]])
    q = np.random.default_rng(3).random((200, 3))
    np.testing.assert_array_equal(world.valid(q), np.abs(q[:, 2] - 0.5) >= 0.1)


def test_outside_of_the_cube_nothing_is_free_and_without_balls_all_of_it():
    outside = np.array([[1.01, 0.5], [0.5, -0.01]])
    for world in (PeriodicBalls(np.empty((0, 2)), 0.1), some_boxes(2, 1, 2, 0.01)):
        assert not world.valid(outside).any()
        assert not world.motion_valid(outside, outside).any()
    assert PeriodicBalls(np.empty((0, 3)), 0.1).motion_valid(np.zeros((1, 3)), np.ones((1, 3)))[0]


@pytest.mark.parametrize(("centres", "radius", "match"), [
    (np.zeros(3), 0.1, "centres"), (np.zeros((2, 0)), 0.1, "centres"), ([[0.5, np.nan]], 0.1, "finite"),
    ([[0.5, 1.5]], 0.1, "1.5"), ([[0.5, 0.5]], 0.0, "radius"),
])  # fmt: skip
def test_balls_that_cannot_be_are_refused(centres, radius, match):
    refused(InvalidValue, match, PeriodicBalls, centres, radius)


@pytest.mark.parametrize(("d", "axes", "centres", "half", "match"), [
    (0, [[0]], [[0.5]], [[0.1]], "d must"), (2, [0], [[0.5]], [[0.1]], "axes"), (2, [[0.5]], [[0.5]], [[0.1]], "axes"),
    (2, [[2]], [[0.5]], [[0.1]], "0 .. 1, got 2"), (2, [[1, 1]], [[0.5, 0.5]], [[0.1, 0.1]], "different"),
    (2, [[0, 1]], [[0.5]], [[0.1, 0.1]], "centres"), (2, [[0, 1]], [[0.5, 0.5]], [[0.1, 0.6]], "0.6"),
    (2, [[0, 1]], [[0.5, 0.5]], [[0.1, 0.0]], "0.0"),
])  # fmt: skip
def test_boxes_that_cannot_be_are_refused(d, axes, centres, half, match):
    refused(InvalidValue, match, PeriodicBoxes, d, axes, centres, half)
