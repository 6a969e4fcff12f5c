"""Lower bounds on the paths of a disk: exact on cells, by a graph of corners as the oracle, and below every plan."""

import itertools

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

import evenroad as er

TINY = 1e-6
"""Radius of a disk that is hardly more than a point: exactly the occupied cells are blocked."""


def random_map(rng, shape, share):
    """A map at random without two blocked cells that only share a corner: whether a way leads between is open."""
    occupied = rng.random(shape) < share
    while True:
        at, right, below, across = occupied[:-1, :-1], occupied[:-1, 1:], occupied[1:, :-1], occupied[1:, 1:]
        falling, rising = at & across & ~right & ~below, right & below & ~at & ~across
        if not (falling | rising).any():
            return occupied
        right |= falling
        at |= rising


def crosses(a, b, block):
    """Whether a segment passes through the inside of a rectangle: its upper left corner, then its sides."""
    low, high = 0.0, 1.0
    for k in range(2):
        begin, end, way = block[k], block[k] + block[k + 2], b[k] - a[k]
        if abs(way) < 1e-12:
            if not begin + 1e-9 < a[k] < end - 1e-9:
                return False
            continue
        ends = sorted(((begin - a[k]) / way, (end - a[k]) / way))
        low, high = max(low, ends[0]), min(high, ends[1])
    return high - low > 1e-9


def shortest(occupied, start, goal):
    """The shortest way of a point around occupied cells, over all corners of cells; infinite if there is none."""
    # Two blocked cells side by side leave no way between them.
    blocks = [(x, y, 1, 1) for y, x in np.argwhere(occupied)]
    blocks += [(x, y, 2, 1) for y, x in np.argwhere(occupied[:, :-1] & occupied[:, 1:])]
    blocks += [(x, y, 1, 2) for y, x in np.argwhere(occupied[:-1] & occupied[1:])]
    rows, columns = occupied.shape
    corners = {(x + i, y + j) for x, y, *_ in blocks for i in (0, 1) for j in (0, 1)}
    # Outside of the map all is blocked.
    blocks += [(-1, -1, columns + 2, 1), (-1, rows, columns + 2, 1), (-1, -1, 1, rows + 2), (columns, -1, 1, rows + 2)]
    blocks += [(x, -1, 1, 2) for x in np.flatnonzero(occupied[0])]
    blocks += [(x, rows - 1, 1, 2) for x in np.flatnonzero(occupied[-1])]
    blocks += [(-1, y, 2, 1) for y in np.flatnonzero(occupied[:, 0])]
    blocks += [(columns - 1, y, 2, 1) for y in np.flatnonzero(occupied[:, -1])]
    places = np.array([start, goal, *corners], dtype=float)
    pairs = np.array(
        [
            pair
            for pair in itertools.combinations(range(len(places)), 2)
            if not any(crosses(*places[list(pair)], block) for block in blocks)
        ],
        dtype=int,
    ).reshape(-1, 2)
    lengths = np.hypot(*(places[pairs[:, 0]] - places[pairs[:, 1]]).T)
    graph = coo_matrix((lengths, pairs.T), shape=(len(places),) * 2)
    return dijkstra(graph, directed=False, indices=0)[1]


@pytest.mark.parametrize("seed", range(30))
def test_on_cells_the_bound_is_the_shortest_way_over_corners(seed):
    rng = np.random.default_rng(seed)
    occupied = random_map(rng, (7, 9), (0.15, 0.3, 0.45)[seed % 3])
    free = np.argwhere(~occupied)
    if len(free) < 2:
        return
    ends = free[rng.choice(len(free), 2, replace=False)][:, ::-1] + rng.random((2, 2)) * 0.98 + 0.01
    world = er.GridMap(occupied).world(TINY)
    bound = world.least_length(ends[0], ends[1:])
    np.testing.assert_allclose(bound, shortest(occupied, *ends), rtol=1e-8)


def test_no_plan_is_shorter_than_the_bound_and_the_result_says_both():
    rng, gaps = np.random.default_rng(1), []
    for radius in (0.8, 1.0, 2.3):
        world = er.GridMap(rng.random((60, 80)) < 0.02).world(radius)
        places = rng.random((200, 2)) * (80, 60)
        places = places[world.valid(places)]
        for start, goal in zip(places[:16:2], places[1:16:2], strict=True):
            result = er.plan(world, start, goal)
            bound = world.least_length(start, goal[np.newaxis])
            assert result.lower_bound == bound >= np.hypot(*(goal - start))
            if result.solved:
                assert bound <= result.cost
                assert result.gap == result.cost / bound - 1.0
                gaps.append(result.gap)
    assert len(gaps) > 12
    assert np.median(gaps) < 0.02


def test_the_bound_of_several_goals_is_that_of_the_nearest_and_without_cells_between_there_is_none():
    occupied = np.zeros((20, 20), dtype=bool)
    occupied[:, 10] = True
    world = er.GridMap(occupied).world(1.0)
    start, near, far = np.array([3.0, 3.0]), np.array([3.0, 8.0]), np.array([17.0, 3.0])
    assert world.least_length(start, np.stack([far, near])) == pytest.approx(5.0)
    assert world.least_length(start, far[np.newaxis]) == np.inf
    assert er.plan(world, start, far).gap is None


def test_an_effort_that_is_spent_leaves_a_smaller_bound():
    rng = np.random.default_rng(3)
    world = er.GridMap(rng.random((200, 200)) < 0.05).world(1.0)
    start, goal = (world.nearest_free(np.array(place)) for place in ([5.0, 5.0], [195.0, 190.0]))
    bounds = [world.disk.least_length(start, goal, most) for most in (0, 10, 1000, 10**6)]
    assert bounds == sorted(bounds)
    assert bounds[0] == pytest.approx(np.hypot(*(goal - start)), rel=1e-6)
    assert bounds[-1] > bounds[0]


def test_no_way_leads_to_a_place_outside_however_far_out_it_is():
    disk, inside = er.GridMap(np.zeros((8, 8), dtype=bool)).world(0.5).disk, np.array([4.0, 4.0])
    for outside in ([-3.0, 4.0], [1e300, 4.0], [4.0, -1e300], [4.0, 1e300]):
        for ends in ((inside, np.array(outside)), (np.array(outside), inside)):
            assert disk.least_length(*ends, 1000) == np.inf
    assert disk.least_length(inside, inside + 1.0, 1000) < np.inf
