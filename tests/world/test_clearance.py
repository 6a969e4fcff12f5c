"""How near a path comes to an obstacle: never told larger than it is, and hardly smaller."""

from itertools import pairwise

import numpy as np
import pytest

from evenroad.planning import plan
from evenroad.world import GridMap
from evenroad.world.clearance import largest_kept, least_distance
from tests.world.gridmap_oracle import points_to_obstacles


def _rooms(seed):
    rng = np.random.default_rng(seed)
    return GridMap(rng.random((40, 60)) < 0.04)


@pytest.mark.parametrize("seed", range(12))
def test_the_clearance_of_a_disks_path_is_the_least_distance_along_it(seed):
    grid = _rooms(seed)
    world = grid.world(0.7)
    free = world.space.from_cube(np.random.default_rng(seed).random((200, 2)))
    free = free[world.valid(free)]
    result = plan(world, free[0], free[-1])
    if not result.solved:
        pytest.skip("no path to measure")
    along = np.concatenate([a + np.linspace(0.0, 1.0, 2001)[:, np.newaxis] * (b - a) for a, b in pairwise(result.path)])
    truth = points_to_obstacles(along, grid.occupied).min() - 0.7
    # The oracle looks at states, so it may be a little too large.
    assert truth - 0.02 <= result.clearance <= truth + 1e-9


def test_clearance_has_what_was_asked_for_and_of_a_path_without_motions_that_of_its_place():
    grid = _rooms(3)
    near, far = grid.world(0.7), grid.world(0.7, clearance=0.4)
    path = np.array([[20.2, 11.1], [20.3, 11.2]])
    assert near.path_clearance(path) == pytest.approx(far.path_clearance(path))
    world = GridMap(np.zeros((10, 10), dtype=bool)).world(1.0)
    assert world.path_clearance(np.array([[5.0, 5.0]])) == pytest.approx(4.0)


def test_a_distance_that_changes_as_fast_as_it_may_is_followed_to_its_least():
    path = np.array([[0.0, 0.0], [10.0, 0.0]])
    for place in (0.0, 3.3, 10.0, 7.0001):
        least = least_distance(path, lambda q, place=place: np.abs(q[:, 0] - place) + 0.25, 1e-6)
        assert 0.25 - 1e-6 <= least <= 0.25


@pytest.mark.parametrize("truth", [0.0, 0.0001, 0.0137, 0.5, 2.0])
def test_the_largest_clearance_that_is_kept_is_found_from_below(truth):
    found = largest_kept(lambda room: room <= truth, 0.0, 1.0, 1e-4)
    assert min(truth, 1.0) - 1e-4 <= found <= truth


def test_a_path_that_does_not_keep_what_was_asked_for_has_none():
    assert largest_kept(lambda room: False, 0.01, 1.0, 1e-4) is None
