"""Far goals are found over a coarse level of the map: no path is lost, and what is said to be apart is so."""

import numpy as np
import pytest
from scipy import ndimage

from evenroad.planning import plan
from evenroad.world import GridMap


def blocks(rng, rows, cols, count):
    occupied = np.zeros((rows, cols), dtype=bool)
    for _ in range(count):
        row, col = rng.integers(0, (rows, cols))
        occupied[row : row + rng.integers(1, 30), col : col + rng.integers(1, 30)] = True
    return occupied


@pytest.mark.parametrize("radius", [0.4, 2.0, 3.3, 20.0, 59.0])
def test_the_coarse_level_joins_what_cells_that_are_not_blocked_join(radius):
    """SciPy labels the cells whose middle is far enough away; tiles of any place in the map must say the same."""
    rng = np.random.default_rng(11)
    joined = apart = 0
    for _ in range(6):
        occupied = blocks(rng, 301, 457, 10)
        for wall in rng.integers(20, 440, 3):
            occupied[:, wall] = True
            occupied[100 : 100 + int(2 * radius * rng.choice([0.7, 1.0, 1.4])), wall] = False
        padded = np.pad(occupied, 1, constant_values=True)
        label = ndimage.label(ndimage.distance_transform_edt(~padded) >= radius)[0][1:-1, 1:-1]
        disk = GridMap(occupied).world(radius).disk
        cells = np.argwhere(label > 0)
        for (r, c), (row, col) in rng.choice(cells, (100, 2)) if len(cells) else ():
            is_joined = label[r, c] == label[row, col]
            assert disk.may_reach(np.array([c + 0.5, r + 0.5]), np.array([[col + 0.5, row + 0.5]])) == is_joined
            joined, apart = joined + is_joined, apart + (not is_joined)
    assert joined > 50
    assert apart > 50


def wall_with_doors(*doors):
    """A long room with a wall in the middle, and doors in it."""
    occupied = np.zeros((400, 1600), dtype=bool)
    occupied[:, 800] = True
    for top, wide in doors:
        occupied[top : top + wide, 800] = False
    return occupied


def test_a_far_path_leads_through_a_door_just_as_wide_as_the_disk():
    a, b = np.array([100.0, 50.0]), np.array([1500.0, 60.0])
    world = GridMap(wall_with_doors((297, 6))).world(3.0)
    result = plan(world, a, b)
    post = np.array([800.5, 300.0])
    shortest = np.hypot(*(post - a)) + np.hypot(*(post - b))
    assert world.motion_valid(result.path[:-1], result.path[1:]).all()
    assert shortest - 1e-6 < result.cost < 1.002 * shortest


def test_a_door_that_is_a_bit_too_narrow_is_not_taken_and_another_one_is():
    a, b = np.array([100.0, 50.0]), np.array([1500.0, 60.0])
    world = GridMap(wall_with_doors((40, 5), (350, 12))).world(3.0)
    result = plan(world, a, b)
    assert result.solved
    assert result.path[:, 1].max() > 350
    assert world.motion_valid(result.path[:-1], result.path[1:]).all()
    shut = plan(GridMap(wall_with_doors((40, 5))).world(3.0), a, b)
    assert not shut.solved
    assert shut.status == "not_connected"


def test_of_far_goals_one_that_can_be_reached_is():
    occupied = wall_with_doors()
    occupied[350:360, 800] = False
    occupied[180:220, 1400:1402] = occupied[180:220, 1440:1442] = True
    occupied[180:182, 1400:1442] = occupied[218:220, 1400:1442] = True
    world = GridMap(occupied).world(3.0)
    result = plan(world, (50.0, 50.0), [(1420.0, 200.0), (1500.0, 60.0)])
    assert result.solved
    assert result.path[-1].tolist() == [1500.0, 60.0]


def test_far_paths_are_as_short_as_those_of_all_cells():
    """Legs of less than 1000 pixels search all cells: their sum around a far place is no shorter by much."""
    rng = np.random.default_rng(5)
    occupied = blocks(rng, 500, 1500, 250)
    world = GridMap(occupied).world(3.0)
    start, goal = (world.nearest_free(np.array(at)) for at in ((20.0, 250.0), (1480.0, 260.0)))
    far = plan(world, start, goal)
    assert far.solved
    assert world.motion_valid(far.path[:-1], far.path[1:]).all()
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(far.path, axis=0).T))])
    middle = far.path[np.abs(along - along[-1] / 2).argmin()]
    by_halves = plan(world, start, middle).cost + plan(world, middle, goal).cost
    assert far.cost < 1.02 * by_halves
