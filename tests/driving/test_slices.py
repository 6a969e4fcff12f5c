"""Proofs that a footprint cannot get from one pose to another, by slices of the angle."""

import math

import numpy as np
import pytest

import evenroad as er
from evenroad._native.drive import CarQuery
from tests.driving.oracle import BOX

HAMMER = [(0.2, -0.1), (1.0, -0.1), (1.0, -0.4), (1.3, -0.4), (1.3, 0.4), (1.0, 0.4), (1.0, 0.1), (0.2, 0.1)]
"""A concave footprint that does not hold its reference point."""


def corner(width, cell=0.05):
    """Two corridors that meet in a corner, and poses in both, as a box drives around it forwards."""
    count = round(width / cell)
    cells = np.ones((80, 80), dtype=bool)
    cells[10 : 10 + count, 10:] = cells[10:, 10 : 10 + count] = False
    middle = 10 * cell + 0.5 * width
    return er.GridMap(cells[::-1], resolution=cell), (middle, 3.0, -math.pi / 2), (3.0, middle, 0.0)


def test_a_corner_that_is_too_narrow_for_a_box_is_proved_and_a_wide_one_is_driven():
    """Turned by 45 degrees the box needs (0.45 + 0.62) / sqrt(2) = 0.757; the disk inside needs 0.62."""
    for width in (0.65, 0.7):
        grid, start, goal = corner(width)
        result = er.plan(grid.world(footprint=BOX), start, goal, seconds=20)
        assert result.status == "not_connected", result.message
        assert result.message.startswith("proved: there is no path; in none of")
    grid, start, goal = corner(0.9)
    assert er.plan(grid.world(footprint=BOX), start, goal, seconds=20).solved


@pytest.mark.parametrize("footprint", [BOX, HAMMER])
def test_nothing_is_proved_where_there_is_a_path(footprint):
    """A wall with a gap of 0.3 to 1.4: narrow ones are proved, wide ones are driven, and none is both."""
    proofs = paths = 0
    for gap in range(3, 15):
        cells = np.zeros((40, 60), dtype=bool)
        cells[:, 29 : 30 + gap % 3] = True
        cells[20 - gap // 2 : 20 + gap - gap // 2, 29:32] = False
        world = er.GridMap(cells, resolution=0.1).world(footprint=footprint)
        start, goal = np.array([1.2, 2.0, 0.5]), np.array([4.6, 2.0, 2.0])
        is_apart = world.vehicle.are_apart(start, goal, 72, 10**7)
        found = is_apart or er.plan(world, start, goal, er.planning.CarSearch(), seconds=0.4).solved
        if is_apart:
            query = CarQuery(world.vehicle, world.space.steering, start, goal, 0)
            assert not query.search(2)
        proofs, paths = proofs + is_apart, paths + (found and not is_apart)
    assert proofs >= 2
    assert paths >= 4


def test_a_proof_that_takes_too_many_boxes_says_nothing():
    grid, start, goal = corner(0.7)
    vehicle = grid.world(footprint=BOX).vehicle
    assert vehicle.are_apart(np.array(start), np.array(goal), 144, 10**7)
    assert not vehicle.are_apart(np.array(start), np.array(goal), 144, 100)
