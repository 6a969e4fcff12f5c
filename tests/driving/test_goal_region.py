"""Goals in regions: the path ends in one, and a proof that there is none is about all of it."""

import math

import numpy as np
import pytest

import evenroad as er
from evenroad.driving import GoalRegion
from evenroad.errors import InvalidValue
from tests.driving.oracle import BOX


def hall(door=True):
    """Two rooms of 4.8 by 5, with a door of 1.5 between them or none."""
    cells = np.zeros((50, 100), dtype=bool)
    cells[:, 49:51] = True
    if door:
        cells[17:32, 49:51] = False
    return er.GridMap(cells, resolution=0.1)


CAR = {"footprint": BOX, "turning_radius": 0.6}


def is_within(region, pose):
    off = np.abs(pose[:2] - region.middle)
    near = (off <= region.half + 1e-9).all() and (region.size is not None or math.hypot(*off) <= region.radius + 1e-9)
    middle, within = region.angles
    return near and (len(pose) == 2 or abs((pose[2] - middle + math.pi) % (2.0 * math.pi) - math.pi) <= within + 1e-9)


@pytest.mark.parametrize(
    "region",
    [
        GoalRegion((8.0, 2.5), radius=0.6),
        GoalRegion((8.0, 2.5)),
        GoalRegion((8.0, 2.5), size=(0.4, 2.0), angle=1.5, within=0.2),
        GoalRegion((9.4, 2.5), size=(1.0, 1.0), angle=math.pi),
    ],
)
def test_the_path_of_a_car_ends_in_the_region(region):
    result = er.plan(hall().world(**CAR), (2.0, 2.5, 0.0), region)
    assert result.solved, result.message
    assert is_within(region, result.path[-1])
    assert result.world.validate(result.path).all()


def test_the_path_of_a_disk_ends_in_the_nearer_of_two_regions():
    regions = [GoalRegion((8.0, 2.5), radius=0.6), GoalRegion((3.0, 2.5), radius=0.2)]
    result = er.plan(hall().world(0.3), (2.0, 2.5), regions)
    assert result.solved
    assert is_within(regions[1], result.path[-1])


@pytest.mark.parametrize("robot", [CAR, {"radius": 0.3}])
def test_no_path_into_a_region_is_proved_about_all_of_it(robot):
    world = hall(door=False).world(**robot)
    start = (2.0, 2.5, 0.0)[: world.dim]
    apart = er.plan(world, start, GoalRegion((8.0, 2.5), radius=1.0))
    assert apart.status == "not_connected"
    assert "goal region" in apart.message
    # One that begins behind the wall and ends before it is reached.
    assert er.plan(world, start, GoalRegion((5.0, 2.5), size=(4.0, 2.0))).solved


def test_a_region_and_a_pose_may_be_goals_of_one_query():
    result = er.plan(hall().world(**CAR), (2.0, 2.5, 0.0), [GoalRegion((8.0, 2.5), radius=0.5), (3.0, 2.5, 0.0)])
    np.testing.assert_allclose(result.path[-1], (3.0, 2.5, 0.0))


def test_many_queries_of_cars_are_answered_as_one_by_one():
    world = hall().world(**CAR)
    starts, goals = np.array([(2, 2.5, 0), (2, 1, 1), (4.9, 1.0, 1.5)]), np.array([(8, 2.5, 0), (8, 4, 2), (8, 1, 0)])
    many = er.plan_many(world, starts, goals)
    for row in range(3):
        one = er.plan(world, starts[row], goals[row])
        assert many.status[row] == one.status
        if one.solved:
            np.testing.assert_array_equal(many.path(row), one.path)
            np.testing.assert_array_equal(many.pieces[row], one.pieces)
    assert many.solved.tolist() == [True, True, False]


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (lambda: GoalRegion((1, 2, 3)), "centre must be 2 finite"),
        (lambda: GoalRegion((1, 2), radius=-1), "radius"),
        (lambda: GoalRegion((1, 2), radius=1, size=(1, 1)), "give one of the two"),
        (lambda: GoalRegion((1, 2), size=(1, -1)), "size must be two lengths"),
        (lambda: GoalRegion((1, 2), angle=90.0), "4 pi in radians"),
        (lambda: GoalRegion((1, 2), within=0.5), "goes with angle="),
        (lambda: er.plan(hall().world(0.3), (2, 2.5), GoalRegion((3, 2.5), angle=1.0)), "a disk has no angle"),
        (lambda: er.plan(er.ArmWorld("ur5"), "home", GoalRegion((3, 2.5))), "none of an arm"),
    ],
)
def test_what_is_no_region_is_refused(made, said):
    with pytest.raises(InvalidValue, match=said):
        made()
