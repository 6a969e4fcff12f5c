"""A clearance that is preferred: kept where there is room, given up where there is not, and no path that touches."""

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue
from tests.driving.oracle import BOX, Oracle, driven

PREFERRED = 0.3
CAR = {"footprint": BOX, "turning_radius": 0.5}
ROBOTS = pytest.mark.parametrize("robot", [{"radius": 0.3}, CAR], ids=["disk", "car"])


def hall(**robot):
    """A hall of 10 by 5 with blocks to pass, and a door of 1.0 in a wall behind them."""
    cells = np.zeros((50, 100), dtype=bool)
    cells[28:36, 20:28] = cells[14:22, 34:42] = True
    cells[:, 60:62] = True
    cells[20:30, 60:62] = False
    return er.GridMap(cells, resolution=0.1).world(**robot)


def terminals(world):
    return np.array([1.0, 2.4, 0.0])[: world.dim], np.array([9.0, 2.6, 0.0])[: world.dim]


def cost(result):
    """The length, where that at an obstacle counts three times: by distances close together."""
    distance = result.world.distance(result.resample(0.02))
    return result.cost * (1.0 + 2.0 * np.mean(1.0 - np.clip(distance, 0.0, PREFERRED) / PREFERRED))


@ROBOTS
def test_a_path_keeps_its_distance_where_there_is_room_and_passes_the_door(robot):
    world = hall(**robot)
    plain = er.plan(world, *terminals(world))
    roomy = er.plan(world, *terminals(world), prefer_clearance=PREFERRED)
    assert roomy.solved
    assert roomy.proof == "exact"
    # The door is narrower than the robot with all of the clearance; the blocks before it leave room.
    with_room, without = (each.resample(0.02) for each in (roomy, plain))
    at_blocks = world.distance(with_room[with_room[:, 0] < 4.8]).min()
    assert at_blocks > world.distance(without[without[:, 0] < 4.8]).min() + 0.05
    assert 0.0 < world.distance(with_room).min() < PREFERRED
    assert cost(roomy) < 0.95 * cost(plain)
    assert plain.cost < roomy.cost < 1.3 * plain.cost
    again = er.plan(world, *terminals(world), prefer_clearance=PREFERRED)
    np.testing.assert_array_equal(roomy.path, again.path)


def test_pieces_of_a_car_with_room_lead_to_the_goal_and_touch_nothing():
    world = hall(**CAR)
    start, goal = terminals(world)
    result = er.plan(world, start, goal, prefer_clearance=PREFERRED)
    at, length = driven(start, result.pieces)
    oracle = Oracle(world.grid, world.footprint.parts)
    assert length == pytest.approx(result.cost)
    np.testing.assert_allclose(at(1.0), result.path[-1], atol=1e-6)
    assert min(oracle.gap(at(t)) for t in np.linspace(0.0, 1.0, 120)) > -1e-8


@ROBOTS
def test_where_there_is_no_room_at_all_the_path_is_the_plain_one(robot):
    cells = np.ones((9, 80), dtype=bool)
    cells[1:8, 1:-1] = False
    world = er.GridMap(cells, resolution=0.1).world(**robot)
    ends = np.array([1.0, 0.45, 0.0])[: world.dim], np.array([7.0, 0.45, 0.0])[: world.dim]
    assert er.plan(world, *ends, prefer_clearance=1.0).cost == pytest.approx(er.plan(world, *ends).cost)


@pytest.mark.parametrize(
    ("world", "ends", "prefer", "said"),
    [
        (hall(radius=0.3), ((1, 2.4), (9, 2.6)), -1.0, "prefer_clearance"),
        (hall(radius=0.3), ((1, 2.4), (9, 2.6)), np.nan, "prefer_clearance"),
        (hall(footprint=BOX, holonomic=True), ((1, 2.4, 0), (9, 2.6, 0)), 0.1, "is of disks and cars"),
    ],
)
def test_it_is_refused_where_it_means_nothing(world, ends, prefer, said):
    with pytest.raises(InvalidValue, match=said):
        er.plan(world, *ends, prefer_clearance=prefer)
