"""What is known of a map is made tile by tile, when it is asked for: it is the same as if it were made at once."""

from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
import pytest
from scipy import ndimage

from evenroad.planning.connectors import CELLS
from evenroad.world import GridMap
from tests.world.gridmap_oracle import points_to_obstacles


def blocks(rng, rows, cols, count):
    occupied = np.zeros((rows, cols), dtype=bool)
    for _ in range(count):
        row, col = rng.integers(0, (rows, cols))
        occupied[row : row + rng.integers(1, 30), col : col + rng.integers(1, 30)] = True
    return occupied


@pytest.mark.parametrize("radius", [0.4, 1.0, 3.7, 20.0, 66.0, 150.0])
def test_states_of_cells_are_those_of_distances_over_the_whole_map(radius):
    occupied = blocks(np.random.default_rng(5), 301, 457, 12)
    padded = np.pad(occupied, 1, constant_values=True)
    to_centre = ndimage.distance_transform_edt(~padded)
    to_grown = ndimage.distance_transform_edt(~ndimage.binary_dilation(padded, np.ones((3, 3))))
    states = np.where(to_grown >= radius, 2 + np.clip(np.floor(to_grown - radius), 0, 32), 1)
    states[(to_centre < radius) | padded] = 0
    np.testing.assert_array_equal(GridMap(occupied).world(radius).disk.cells(), states)


@pytest.mark.parametrize("radius", [0.4, 3.7, 40.0])
def test_verdicts_across_tiles_are_those_of_the_distance(radius):
    rng = np.random.default_rng(7)
    occupied = blocks(rng, 400, 300, 6)
    world = GridMap(occupied).world(radius)
    # Around the borders of tiles, which are multiples of 128 less the ring.
    q = rng.choice([127.0, 255.0], (3000, 2)) + rng.normal(size=(3000, 2)) * [1.0, 40.0]
    q = q[(q > 1.0).all(axis=1) & (q < [299.0, 399.0]).all(axis=1)]
    away = points_to_obstacles(q, occupied)
    np.testing.assert_array_equal(world.valid(q), away >= radius)
    np.testing.assert_allclose(world.distance(q) + radius, away, atol=1e-9)


def test_threads_that_ask_a_new_world_at_once_get_the_answers_of_one_thread():
    rng = np.random.default_rng(3)
    grid = GridMap(blocks(rng, 700, 700, 90))
    places = grid.space.from_cube(rng.random((400, 2)))
    places = places[grid.world(2.0).valid(places)][:80]

    def answers(world, order):
        found = {k: CELLS.connect(world, places[k], places[k + 1][np.newaxis]).path for k in order}
        return [found[k].tolist() for k in range(len(places) - 1)]

    orders = [rng.permutation(len(places) - 1) for _ in range(8)]
    expected = answers(grid.world(2.0), range(len(places) - 1))
    with ThreadPoolExecutor(8) as pool:
        for found in pool.map(partial(answers, grid.world(2.0)), orders):
            assert found == expected


def test_a_thread_that_searched_very_often_finds_the_same_path():
    """What a search knows bears its number, and numbers repeat after 65 535."""
    grid = GridMap(blocks(np.random.default_rng(1), 40, 40, 2))
    disk = grid.world(1.0).disk
    a, b = np.array([5.0, 30.0]), np.array([[9.0, 33.0]])
    first = disk.find_path(a, b, 1000)
    for _ in range(65_536):
        disk.find_path(a, b, 1000)
    last = disk.find_path(a, b, 1000)
    np.testing.assert_array_equal(first.points, last.points)
    assert (first.goal, first.expanded, first.motions) == (last.goal, last.expanded, last.motions)
