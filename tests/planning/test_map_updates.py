"""A path on a map that changes: what is free of it is known to a tenth of a cell, and it is kept or planned anew."""

import math

import numpy as np
import pytest

import evenroad as er
from evenroad.driving import GoalRegion
from evenroad.errors import InvalidValue
from tests.driving.oracle import BOX, driven

SHAPE = 60, 120
CAR = {"footprint": BOX, "turning_radius": 0.6}
ROBOTS = pytest.mark.parametrize("robot", [CAR, {"radius": 0.35}], ids=["car", "disk"])


def hall(cells=None, **robot):
    return er.GridMap(np.zeros(SHAPE, dtype=bool) if cells is None else cells, resolution=0.1).world(**robot)


def wall(column, first=20, last=40):
    """A wall across the middle of the hall, of one column."""
    cells = np.zeros(SHAPE, dtype=bool)
    cells[first:last, column] = True
    return cells


def terminals(world):
    return np.array([1.0, 3.0, 0.2])[: world.dim], np.array([11.0, 3.2, -0.1])[: world.dim]


@ROBOTS
def test_what_is_free_ahead_ends_where_the_first_pose_touches(robot):
    start, goal = terminals(hall(**robot))
    live = er.Replanner(hall(**robot), goal)
    first = live.update(start)
    assert live.ahead(start).is_free
    assert live.ahead(start).length == pytest.approx(first.cost)
    ahead = live.ahead(start, wall(70))
    assert not ahead.is_free
    # A slow walk along the path finds the same.
    step, world = 0.002, live.world
    walked = np.arange(0.0, first.cost, step)
    if "radius" in robot:
        poses = first.path[0] + walked[:, np.newaxis] / first.cost * (first.path[-1] - first.path[0])
    else:
        at, _ = driven(start, first.pieces)
        poses = np.array([at(s / first.cost) for s in walked])
    touched = walked[np.argmin(world.valid(poses))]
    assert touched - 0.01 - 2.0 * step < ahead.free_until < touched + step


@ROBOTS
def test_a_path_is_kept_along_the_way_and_planned_anew_where_it_is_blocked(robot):
    start, goal = terminals(hall(**robot))
    live = er.Replanner(hall(**robot), goal)
    first = live.update(start)
    on = first.resample(0.1)[30]
    kept = live.update(on, np.zeros(SHAPE, dtype=bool))
    assert kept.planner == "kept"
    np.testing.assert_array_equal(kept.path[0], on)
    assert kept.cost < first.cost
    beside = on + np.array([0.0, 0.02, 0.01])[: len(on)]
    assert live.update(beside).planner == "kept"
    anew = live.update(beside, wall(80))
    assert anew.solved
    assert anew.planner != "kept"
    assert anew.cost > kept.cost
    np.testing.assert_array_equal(live.path, anew.path)
    assert np.asarray(live.world.valid(anew.path)).all()


def test_a_path_that_is_blocked_for_a_while_is_kept_when_it_is_free_again():
    live = er.Replanner(hall(radius=0.35), (11.0, 3.0))
    live.update((1.0, 3.0))
    closed = wall(80, 0, 60)
    assert live.update((2.0, 3.0), closed).status == "not_connected"
    assert live.path is None
    assert live.update((2.0, 3.0), np.zeros(SHAPE, dtype=bool)).planner == "kept"


def test_polygons_may_change_too_and_a_goal_may_be_a_region():
    def yard(x):
        return er.PolygonMap([[(x, 2), (x + 0.5, 2), (x, 4)]], bounds=((0, 0), (12, 6)))

    live = er.Replanner(yard(9).world(**CAR), GoalRegion((11, 3), radius=0.3))
    live.update((1, 3, 0))
    assert live.ahead((1, 3, 0), yard(0.5).world(**CAR).polygons).free_until == 0.0
    anew = live.update((2.2, 3, 0), yard(5))
    assert anew.solved
    assert math.dist(anew.path[-1][:2], (11, 3)) < 0.31


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda live: live.update((1, 3, 0), np.zeros((3, 3), dtype=bool)), "must have the shape of the map"),
        (lambda live: live.update((1, 3, 0), np.zeros(SHAPE)), "boolean array"),
        (lambda live: live.update((1, 3, 0), "office.yaml"), "occupied cells, or a new map"),
        (lambda live: live.update((1, 3, 0), er.GridMap(np.zeros((3, 3), dtype=bool))), "the frame of the first"),
        (lambda live: live.update((1, 3, 0), removed="box"), "an arm's; a map has new cells"),
        (lambda live: live.update("home"), "q must be 3 finite numbers"),
        (lambda live: live.ahead((1, 3, 0)), "there is no path yet"),
        (lambda live: er.Replanner(live.world, (1, 2)), "goal must be 3 finite numbers"),
        (lambda live: er.Replanner(live.world.space, (1, 2, 3)), "world must be an ArmWorld"),
        (lambda live: er.Replanner(hall(footprint=BOX, holonomic=True), (1, 2, 3)), "world must be an ArmWorld"),
        (lambda live: er.Replanner(er.ArmWorld("ur5"), "home").ahead("home"), "ahead is of cars and disks"),
    ],
)
def test_what_does_not_fit_is_refused_in_one_line(call, said):
    with pytest.raises(InvalidValue, match=said):
        call(er.Replanner(hall(**CAR), (11.0, 3.0, 0.0)))
