"""The latest map of a node: what a message says, what is refused, and updates of parts."""

import math

import numpy as np
import pytest

from evenroad.errors import InvalidValue, NotAvailable
from evenroad.ros2.map_state import MapRobot, MapState, grid_map
from tests.ros2.stand_ins import occupancy, update

CELLS = np.array([[-1, 0, 64], [70, 60, 100]])
"""The lower row comes first."""


def test_cells_of_65_percent_and_unknown_ones_are_obstacles():
    grid = grid_map(occupancy(CELLS))
    np.testing.assert_array_equal(grid.occupied, [[True, False, True], [True, False, False]])
    assert grid.resolution == 0.05


def test_unknown_cells_may_be_free_and_the_least_percentage_another_one():
    grid = grid_map(occupancy(CELLS), MapRobot(occupied_from=60, unknown_is_free=True))
    np.testing.assert_array_equal(grid.occupied, [[True, True, True], [False, False, True]])
    np.testing.assert_array_equal(grid.unknown[1], [True, False, False])


def _with(message, path, value):
    *inner, last = path.split(".")
    part = message
    for name in inner:
        part = getattr(part, name)
    setattr(part, last, value)
    return message


@pytest.mark.parametrize(
    ("path", "value", "said"),
    [
        ("info.origin.orientation.x", 0.1, "must lie flat"),
        ("info.origin.orientation.w", math.nan, "orientation of the map's origin must be 4 finite"),
        ("info.origin.orientation.w", 7.0, "length 1"),
        ("info.origin.position.x", math.inf, "position of the map's origin must be 3 finite"),
        ("info.resolution", math.nan, "resolution of the map must be a finite number > 0, got nan"),
        ("info.resolution", 0.0, "resolution of the map must be a finite number > 0"),
        ("info.width", 4, "2 x 4 = 8 cells, got 6"),
        ("info.height", 0, "height of the map must be an integer >= 1"),
        ("info.height", 2**31 - 1, "at most 400000000 cells"),
        ("data", [0, 0, 0, 0, 0, 101], "from -1 to 100, got 0 to 101"),
        ("data", [0, 0, 0, 0, 0, 1000], "from -1 to 100"),
        ("header.frame_id", "", "no frame_id"),
    ],
)
def test_a_malformed_map_is_refused_and_the_last_one_stays(path, value, said):
    state = MapState(MapRobot(0.02))
    state.take_map(occupancy(np.zeros((5, 5))))
    before = state.world().world
    with pytest.raises(InvalidValue, match=said):
        state.take_map(_with(occupancy(CELLS), path, value))
    assert state.world().world is before


def test_updates_change_their_cells_as_a_new_map_would():
    rng = np.random.default_rng(1)
    cells = rng.integers(-1, 101, (30, 40))
    state = MapState(MapRobot(0.02))
    state.take_map(occupancy(cells))
    for _ in range(20):
        height, width = rng.integers(1, 10, 2)
        x, y = rng.integers(0, 41 - width), rng.integers(0, 31 - height)
        part = rng.integers(-1, 101, (height, width))
        cells[y : y + height, x : x + width] = part
        state.take_update(update(x, y, part))
        np.testing.assert_array_equal(state.world().world.grid.occupied, grid_map(occupancy(cells)).occupied)


def test_a_world_that_a_query_has_does_not_change_with_the_map():
    state = MapState(MapRobot(0.02))
    state.take_map(occupancy(np.zeros((5, 5))))
    world = state.world()
    assert state.world() is world
    state.take_update(update(0, 0, np.full((5, 5), 100)))
    assert not world.world.grid.occupied.any()
    assert state.world().world.grid.occupied.all()


@pytest.mark.parametrize(
    ("message", "said"),
    [
        (update(3, 0, np.zeros((2, 3), int)), "not within the map of 5 x 5"),
        (update(-1, 0, np.zeros((2, 3), int)), "not within the map"),
        (update(0, 0, np.zeros((1, 1), int), frame="odom"), "in frame 'odom', the map in 'map'"),
        (update(0, 0, np.full((1, 1), 120)), "cells of the update must be from -1 to 100"),
        (update(0, 0, np.zeros((1, 1), int), seconds=2.0), "older than the map of 3"),
    ],
)
def test_an_update_that_does_not_fit_is_refused(message, said):
    state = MapState(MapRobot(0.02))
    state.take_map(occupancy(np.zeros((5, 5)), seconds=3.0))
    with pytest.raises(InvalidValue, match=said):
        state.take_update(message)


def test_a_map_that_is_older_than_the_present_one_is_refused():
    state = MapState(MapRobot(0.02))
    with pytest.raises(NotAvailable, match="before any map"):
        state.take_update(update(0, 0, np.zeros((1, 1), int)))
    state.take_map(occupancy(np.zeros((5, 5)), seconds=3.0))
    with pytest.raises(InvalidValue, match=r"2\.000 s is older than the present one of 3\.000 s"):
        state.take_map(occupancy(np.zeros((5, 5)), seconds=2.0))
