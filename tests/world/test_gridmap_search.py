"""The disk world's own planner: what it finds is free, what it proves is so, and it finds what there is."""

from itertools import pairwise

import numpy as np
import pytest
from scipy import ndimage

from evenroad.planning import plan
from evenroad.planning.connectors import CELLS
from evenroad.world import GridMap, MapFrame

FINE = 12
"""Points a pixel of the picture that decides what hangs together."""


def cluttered(rng, rows=24, cols=30):
    occupied = rng.random((rows, cols)) < rng.choice([0.02, 0.05, 0.1])
    for _ in range(int(rng.integers(0, 3))):
        wall = int(rng.integers(4, cols - 4))
        occupied[:, wall] = True
        door = int(rng.integers(2, rows - 8))
        occupied[door : door + int(rng.integers(2, 8)), wall] = False
    return occupied


def free_places(world, rng, count):
    places = world.space.from_cube(rng.random((40 * count, 2)))
    return places[world.valid(places)][:count]


def fine_components(world):
    """Label the free points of a fine grid; what hangs together there does so in the world."""
    rows, cols = world.grid.occupied.shape
    y, x = (np.indices((rows * FINE, cols * FINE)) + 0.5) / FINE
    free = world.valid(np.column_stack([x.ravel(), y.ravel()])).reshape(x.shape)
    return ndimage.label(free)[0]


def test_what_is_known_of_narrow_passages_is_in_proportion_to_the_pixels():
    """Every cell of a passage of one pixel is at a gate; a million of them took 2 GB, at 2 kB each."""
    world = GridMap(np.zeros((1, 20_000), dtype=bool)).world(0.3)
    a, b = np.array([0.4, 0.5]), np.array([19_999.6, 0.5])
    assert world.may_connect(a, b)
    assert world.disk.gates().sum() == 20_000
    assert world._components.nbytes < 70 * 20_000
    assert world.cells_of(world.component(a)).all()


@pytest.mark.parametrize("radius", [0.5, 1.0, 1.37, 2.0, 2.5])
def test_what_hangs_together_is_found_and_what_is_proved_apart_does_not(radius):
    rng = np.random.default_rng(17)
    found = apart = 0
    for _ in range(40):
        world = GridMap(cluttered(rng)).world(radius)
        label = fine_components(world)
        places = free_places(world, rng, 8)
        for a, b in pairwise(places):
            in_fine = [label[int(y * FINE), int(x * FINE)] for x, y in (a, b)]
            together = in_fine[0] == in_fine[1] != 0
            connection = CELLS.connect(world, a, b[np.newaxis])
            if connection.goal < 0:
                assert not together
                assert connection.path.shape == (0, 2)
            else:
                assert connection.goal == 0
                assert world.may_connect(a, b)
                path = connection.path
                assert (path[0] == a).all()
                assert (path[-1] == b).all()
                assert world.motion_valid(path[:-1], path[1:]).all()
                found += 1
            if not world.may_connect(a, b):
                assert not together
                assert connection.goal < 0
                apart += 1
    assert found > 50
    assert apart > 3


FRAMES = [None, MapFrame(rows=40, cols=60, resolution=0.05, origin=(-3.0, 7.0), yaw=0.7, y_up=True)]


@pytest.mark.parametrize("frame", FRAMES)
def test_a_door_is_passed_by_a_disk_that_fits_and_a_larger_one_is_proved_to_fail(frame):
    occupied = np.zeros((40, 60), dtype=bool)
    occupied[:, 30:32] = True
    occupied[14:20, 30:32] = False
    grid = GridMap(occupied, frame)
    pixel = grid.frame.resolution
    a, b = grid.frame.to_map(np.array([[8.0, 30.0], [52.0, 8.0]]))
    exact = 3.0 * pixel
    # A turned frame rounds: there the disk that fits exactly may do so or not.
    for radius in (exact if frame is None else exact * (1 - 1e-9), 2.9 * pixel):
        world = grid.world(radius)
        path = CELLS.connect(world, a, b[np.newaxis]).path
        assert len(path) > 2
        assert world.motion_valid(path[:-1], path[1:]).all()
    for radius in (3.05 * pixel, 4.0 * pixel):
        world = grid.world(radius)
        assert not world.may_connect(a, b)
        assert CELLS.connect(world, a, b[np.newaxis]).goal == -1


def test_of_several_goals_the_one_reached_first_is_named_and_a_bound_on_motions_kept():
    occupied = np.zeros((40, 60), dtype=bool)
    occupied[:, 30] = True
    world = GridMap(occupied).world(2.0)
    connection = CELLS.connect(world, np.array([5.0, 5.0]), np.array([[50.0, 5.0], [25.0, 30.0], [6.0, 20.0]]))
    assert connection.goal == 2
    rng = np.random.default_rng(0)
    world = GridMap(cluttered(rng)).world(1.3)
    a, b = free_places(world, rng, 2)
    assert CELLS.connect(world, a, b[np.newaxis], most_motions=1).goal == -1


@pytest.mark.parametrize("frame", FRAMES)
def test_a_shortened_path_is_free_and_not_longer(frame):
    rng = np.random.default_rng(5)
    shorter = 0
    for _ in range(20):
        world = GridMap(cluttered(rng, 40, 60), frame).world(1.2 * (frame.resolution if frame else 1.0))
        a, b = free_places(world, rng, 2)
        path = CELLS.connect(world, a, b[np.newaxis]).path
        if not len(path):
            continue
        short, motions = CELLS.smooth(world, path)
        before, after = (np.hypot(*np.diff(each, axis=0).T).sum() for each in (path, short))
        assert world.motion_valid(short[:-1], short[1:]).all()
        assert (short[[0, -1]] == path[[0, -1]]).all()
        assert after <= before
        assert motions > 0
        shorter += after < 0.99 * before
    assert shorter > 5


@pytest.mark.parametrize("wide", [0, 25])
def test_a_path_around_corners_is_pulled_as_taut_as_a_string(wide):
    """The shortest path of a disk is a string around discs: two lines, an arc at each corner, and the wall between."""
    occupied = np.zeros((200, 400), dtype=bool)
    occupied[100:, 150 : 151 + wide] = True
    a, b, radius = np.array([20.0, 150.0]), np.array([281.0 + wide, 150.0]), 12.0
    result = plan(GridMap(occupied).world(radius), a, b)
    away = np.array([130.0, 50.0])
    length = np.sqrt(away @ away - radius**2)
    # How far the string has turned from one tangent to level.
    turn = np.arctan2(50.0, 130.0) + np.arcsin(radius / np.hypot(*away))
    shortest = 2 * (length + radius * turn) + 1 + wide
    assert shortest < result.cost < 1.004 * shortest
    assert len(result.path) <= 7


def test_a_disk_drives_through_a_door_just_as_wide():
    """Motions touch both posts to the last bit, wherever on the middle line they begin and end."""
    occupied = np.zeros((60, 80), dtype=bool)
    occupied[30:32] = True
    occupied[30:32, 40:46] = False
    world = GridMap(occupied).world(3.0)
    rows = np.random.default_rng(2).uniform(20.0, 42.0, (2000, 2))
    a, b = (np.column_stack([np.full(2000, 43.0), row]) for row in rows.T)
    assert world.motion_valid(a, b).all()
    beside = [0.0, 1e-9]
    through = (rows.min(axis=1) < 27.0) & (rows.max(axis=1) > 35.0)
    assert not world.motion_valid((a + beside[::-1])[through], (b + beside[::-1])[through]).any()
    result = plan(world, (10.0, 10.0), (70.0, 55.0))
    assert result.trajectory(speed=1.0).proof == "exact"


def test_the_nearest_free_place_is_free_and_none_is_much_nearer():
    rng = np.random.default_rng(3)
    for _ in range(30):
        world = GridMap(cluttered(rng)).world(1.6)
        places = world.space.from_cube(rng.random((20000, 2)))
        free = places[world.valid(places)]
        for q in places[~world.valid(places)][:10]:
            nearest = world.nearest_free(q)
            if not len(free):
                continue
            assert world.valid(nearest[np.newaxis])[0]
            assert np.hypot(*(nearest - q)) < np.hypot(*(free - q).T).min() + 0.6
    assert GridMap(np.ones((5, 5), dtype=bool)).world(1.0).nearest_free(np.array([1.0, 1.0])) is None


def test_an_invalid_place_is_explained_with_the_nearest_free_one():
    occupied = np.zeros((20, 20), dtype=bool)
    occupied[:, 10:] = True
    world = GridMap(occupied).world(2.0)
    assert world.explain(np.array([9.0, 10.0])).endswith("; the nearest free position is (8, 10)")
    assert "no position on the map is free" in GridMap(occupied).world(30.0).explain(np.array([9.0, 10.0]))


@pytest.mark.parametrize("frame", FRAMES)
def test_a_cropped_map_is_the_same_world(frame):
    occupied = np.ones((40, 60), dtype=bool)
    occupied[10:25, 20:50] = np.random.default_rng(2).random((15, 30)) < 0.05
    grid = GridMap(occupied, frame, unknown=occupied)
    small = grid.cropped()
    assert small.occupied.shape == (15, 30)
    assert small.unknown.sum() == small.occupied.sum()
    q = grid.space.from_cube(np.random.default_rng(0).random((4000, 2)))
    radius = 1.1 * grid.frame.resolution
    whole, part = grid.world(radius), small.world(radius)
    np.testing.assert_array_equal(whole.valid(q), part.valid(q))
    np.testing.assert_array_equal(whole.motion_valid(q[:-1], q[1:]), part.motion_valid(q[:-1], q[1:]))
    nothing = GridMap(np.ones((3, 3), dtype=bool))
    assert nothing.cropped() is nothing
