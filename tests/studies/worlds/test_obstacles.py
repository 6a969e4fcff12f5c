"""Boxes, rods and caves against states sampled on motions, and against distances found by search."""

import numpy as np
import pytest
from scipy.optimize import minimize

from evenroad.errors import InvalidValue
from evenroad_studies.worlds.obstacles import Boxes, Cave, Rods


def boxes(d):
    rng = np.random.default_rng(d)
    low = rng.random((12, d))
    low[:, 2:] = -np.inf
    return Boxes(low, np.where(np.isinf(low), np.inf, low + 0.25))


def rods(d):
    rng = np.random.default_rng(d)
    axes = np.argsort(rng.random((12, d)), axis=1)[:, :2]
    first = rng.random((12, 2))
    last = first + 0.3 * rng.standard_normal((12, 2)) * (np.arange(12)[:, np.newaxis] % 3 > 0)
    return Rods(d, axes, first, last, 0.07)


def cave(d):
    rng = np.random.default_rng(d)
    return Cave(rng.random((12, d)), np.full(12, 0.2 * d**0.5))


def slowly_free(world, q):
    """Return which states of the cube are free, from the definition of each world."""
    if isinstance(world, Boxes):
        return ~((world.low < q[:, None]) & (q[:, None] < world.high)).all(axis=2).any(axis=1)
    if isinstance(world, Cave):
        return (np.linalg.norm(q[:, None] - world.centres, axis=2) <= world.radii).any(axis=1)
    gaps = []
    for axes, first, last in zip(world.axes, world.first, world.last, strict=True):
        along = np.linspace(first, last, 2001)
        gaps.append(np.linalg.norm(q[:, None, axes] - along, axis=2).min(axis=1))
    return (np.array(gaps) >= world.radius).all(axis=0)


@pytest.mark.parametrize("d", [2, 3, 5])
@pytest.mark.parametrize("make", [boxes, rods, cave])
def test_a_motion_is_free_if_all_its_states_are(make, d):
    world, rng = make(d), np.random.default_rng(5)
    a = rng.random((150, d))
    b = np.clip(a + 0.15 * rng.standard_normal((150, d)), 0.0, 1.0)
    states = np.linspace(a, b, 33)
    sampled = np.array([slowly_free(world, q) for q in states])
    np.testing.assert_array_equal(world.valid(a), sampled[0])
    free = world.motion_valid(a, b)
    np.testing.assert_array_equal(free, world.motion_valid(b, a))
    assert not (free & ~sampled.all(axis=0)).any()
    # Refused although no sampled state is blocked: it only touches between two of them.
    assert (~free & sampled.all(axis=0)).sum() <= 5
    assert 10 < free.sum() < 145


def test_segments_are_as_near_as_a_search_finds():
    rng = np.random.default_rng(6)
    world = Rods(3, [[0, 1, 2]], [[0.2, 0.3, 0.4]], [[0.7, 0.4, 0.5]], 0.1)
    for a, b in zip(rng.random((40, 3)), rng.random((40, 3)), strict=True):

        def gap(t, a=a, b=b):
            return np.linalg.norm(a + t[0] * (b - a) - world.first[0] - t[1] * (world.last[0] - world.first[0]))

        nearest = min(minimize(gap, at, bounds=[(0, 1)] * 2).fun for at in ((0.1, 0.1), (0.9, 0.5)))
        if abs(nearest - 0.1) > 1e-4:
            assert world.motion_valid(a[None], b[None])[0] == (nearest > 0.1)


def test_outside_of_the_cube_nothing_is_free():
    for world in (boxes(2), rods(2), cave(2)):
        assert not world.valid(np.array([[1.1, 0.5], [-0.1, 0.5]])).any()


def test_arrays_of_different_shapes_are_refused():
    with pytest.raises(InvalidValue, match="one shape"):
        Boxes(np.zeros((2, 3)), np.ones((3, 3)))
