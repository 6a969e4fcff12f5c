"""Plans of cars: what is handed out leads from start to goal, and no pose on it touches."""

import math

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue
from evenroad.planning import CarSearch
from evenroad.planning.planners.car import SHORTCUTS
from tests.driving.oracle import BOX, Oracle, driven

ELBOW = [(-0.4, -0.2), (0.5, -0.2), (0.5, 0.2), (0.0, 0.2), (0.0, 0.5), (-0.4, 0.5)]


def rooms(seed=5):
    """Two rooms with a door of 1.2 between them, and some cells in both; 48 by 32 cells of 0.25."""
    cells = np.random.default_rng(seed).random((32, 48)) < 0.015
    cells[:, 24] = True
    cells[14:19, 24] = False
    cells[13:20, 21:28] &= False
    cells[:14, 24] = cells[19:, 24] = True
    return er.GridMap(cells, resolution=0.25)


CARS = {
    "reverses": {"footprint": BOX, "turning_radius": 0.9},
    "forwards": {"footprint": BOX, "turning_radius": 0.6, "reverse": False},
    "on the spot": {"footprint": ELBOW},
    "two parts with clearance": {"footprint": ELBOW, "turning_radius": 0.5, "clearance": 0.05},
}


def queries(world, n, seed=3):
    """Free poses, the starts to the left and the goals to the right of the door."""
    q = world.space.from_cube(np.random.default_rng(seed).random((4000, 3)))
    q = q[world.valid(q)]
    return zip(q[q[:, 0] < 5][:n], q[q[:, 0] > 7][:n], strict=True)


@pytest.mark.parametrize("car", CARS)
def test_the_path_leads_from_start_to_goal_and_touches_nothing(car):
    world = rooms().world(**CARS[car])
    oracle = Oracle(world.grid, world.footprint.parts)
    for start, goal in queries(world, 2):
        result = er.plan(world, start, goal)
        assert result.solved, result.message
        assert result.proof == "exact"
        at, length = driven(start, result.pieces)
        np.testing.assert_allclose(at(1.0)[:2], goal[:2], atol=1e-6)
        assert math.cos(at(1.0)[2] - goal[2]) == pytest.approx(1.0, abs=1e-9)
        np.testing.assert_array_equal(result.path[0], start)
        np.testing.assert_allclose(result.path[-1][:2], goal[:2])
        for t in np.linspace(0.0, 1.0, math.ceil(length / 0.1)):
            assert oracle.gap(at(t)) >= max(world.clearance - 1e-6, -1e-8)
        assert world.validate(result.path).all()
        if not world.reverse:
            assert (result.pieces[:, 1] > 0.0).all()
            assert result.cusps == 0
        if world.turning_radius > 0.0:
            assert set(np.abs(result.pieces[:, 0]).round(9)) <= {0.0, round(1.0 / world.turning_radius, 9)}
            assert result.length == pytest.approx(result.cost, rel=1e-6)


def test_a_car_gets_out_of_a_parking_space_that_is_hardly_longer():
    """It is 2.4 long, the space 2.9: it goes back and forth."""
    cells = np.zeros((60, 100), dtype=bool)
    cells[40:, :36] = cells[40:, 65:] = cells[52:, :] = True
    grid = er.GridMap(cells, resolution=0.1)
    footprint = [(-0.5, -0.5), (1.9, -0.5), (1.9, 0.5), (-0.5, 0.5)]
    world = grid.world(footprint=footprint, turning_radius=2.0)
    start, goal = (4.3, 1.4, 0.0), (6.0, 3.5, 0.0)
    result = er.plan(world, start, goal, seconds=20)
    assert result.solved, result.message
    assert result.cusps >= 2
    oracle, (at, length) = Oracle(grid, world.footprint.parts), driven(start, result.pieces)
    assert min(oracle.gap(at(t)) for t in np.linspace(0.0, 1.0, math.ceil(length / 0.1))) >= -1e-8


def test_the_same_call_gives_the_same_path_and_another_seed_another_one():
    world = rooms().world(**CARS["reverses"])
    ((start, goal),) = queries(world, 1, 8)
    first, again, other = (er.plan(world, start, goal, rng=seed) for seed in (0, 0, 4))
    np.testing.assert_array_equal(first.pieces, again.pieces)
    assert first.pieces.shape != other.pieces.shape or (first.pieces != other.pieces).any()


def test_shortcuts_make_paths_shorter():
    world = rooms().world(footprint=BOX, turning_radius=1.5)
    totals = np.zeros(3)
    for start, goal in queries(world, 5, 9):
        raw, quick, full = (er.plan(world, start, goal, smooth=smooth) for smooth in (False, "quick", True))
        totals += [raw.cost, quick.cost, full.cost]
        assert full.milestone_cost == pytest.approx(raw.cost)
    assert totals[0] > totals[1] >= totals[2]


def test_shortcuts_are_not_tried_where_the_path_is_the_shortest_curve_and_end_where_they_gain_nothing():
    world = rooms().world(**CARS["reverses"])
    free = er.GridMap(np.zeros((40, 40), dtype=bool), resolution=0.25).world(**CARS["reverses"])
    assert er.plan(free, (5, 5, 0), (6, 6, 1)).counts["shortcut_motions"] == 0
    tries = [er.plan(world, start, goal).counts["shortcut_motions"] for start, goal in queries(world, 4, 9)]
    assert 0 < sum(tries) < 4 * SHORTCUTS


def test_few_paths_have_pieces_that_are_too_short_to_follow():
    """Where only random intervals are replaced, 16 of these 30 paths have a piece of less than 2 cm; now 8 do."""
    world = er.load_map("office.yaml").world(footprint=BOX, turning_radius=0.5)
    q = world.space.from_cube(np.random.default_rng(1).random((800, 3)))
    q = q[world.valid(q)][:60]
    paths = [er.plan(world, start, goal) for start, goal in zip(q[:30], q[30:], strict=True)]
    assert all(path.solved for path in paths)
    assert sum(np.abs(path.pieces[:, 1]).min() < 0.02 for path in paths) <= 11


def test_a_car_does_not_turn_round_to_drive_backwards_all_the_way():
    boxes = [[(0, 0), (1, 0), (1, 1), (0, 1)], [(3, 0), (4, 0), (4, 2), (3, 2)]]
    yard = er.PolygonMap(boxes, bounds=((-5, -5), (8, 8)))
    car = yard.world(footprint=[(-0.4, -0.2), (0.4, -0.2), (0.4, 0.2), (-0.4, 0.2)], turning_radius=0.8)
    result = er.plan(car, (-2, 0, 0), (6, 0.5, 0))
    # Straight past both boxes it is 8.15 m.  The trees' first path is driven backwards for 6.5 m.
    assert result.milestone_cost > 12
    assert result.cost < 8.3
    assert result.cusps == 0


def test_where_cusps_cost_more_there_are_fewer():
    world = er.GridMap(np.zeros((80, 80), dtype=bool), resolution=0.25).world(footprint=BOX, turning_radius=1.5)
    cheap, expensive = (er.plan(world, (10, 10, 0), (10, 11, 0), CarSearch(cusp_cost=cost)) for cost in (0.0, 50.0))
    assert cheap.cusps > expensive.cusps
    assert cheap.cost < expensive.cost


def test_of_several_goals_the_path_ends_at_one_that_is_free():
    world = rooms().world(**CARS["reverses"])
    ((start, goal),) = queries(world, 1)
    result = er.plan(world, start, [(0.0, 0.0, 0.0), goal, goal + np.array([0.0, 0.0, 0.1])])
    assert result.solved
    assert result.goal_index in (1, 2)
    np.testing.assert_allclose(result.path[-1][:2], result.goal[:2])


def test_no_path_is_proved_where_the_door_is_narrower_than_the_disk_inside():
    cells = np.zeros((40, 80), dtype=bool)
    cells[:, 40] = True
    cells[17:23, 40] = False  # a door of 0.6
    world = er.GridMap(cells, resolution=0.1).world(footprint=BOX, turning_radius=0.9)
    result = er.plan(world, (2, 2, 0), (6, 2, 0))
    assert result.status == "not_connected"
    assert result.message.startswith("proved: there is no path; the largest disk inside")


def test_the_time_is_kept_where_there_is_no_path_and_no_proof():
    cells = np.zeros((40, 80), dtype=bool)
    cells[:, 40] = True
    cells[17:24, 40] = False
    grid = er.GridMap(cells, resolution=0.1)  # a door of 0.7, and a robot that is 0.62 wide and 2 long
    footprint = [(-0.2, -1.0), (0.2, -1.0), (0.2, 1.0), (-0.2, 1.0)]
    result = er.plan(grid.world(footprint=footprint, turning_radius=3.0), (2, 2, 0), (6, 2, 0), seconds=0.3)
    assert result.status == "budget_spent"
    assert "0.3 s" in result.message
    assert result.seconds < 2.0


def test_a_start_that_touches_is_refused_with_the_corner_and_the_cell():
    world = rooms().world(**CARS["reverses"])
    result = er.plan(world, (5.7, 1.0, 0.0), (9.0, 2.0, 0.0))
    assert result.status == "start_invalid"
    assert (
        result.message == "the start is in collision: its front right corner touches the cell at (6.125, 0.875) by 0.15"
    )


def test_angles_in_degrees_other_worlds_and_planners_are_refused_in_one_line():
    grid = rooms()
    world = grid.world(**CARS["forwards"])
    with pytest.raises(InvalidValue, match=r"start .* radians, got 90; .* 1\.5708"):
        er.plan(world, (2, 2, 90), (9, 2, 0))
    with pytest.raises(InvalidValue, match="only CarSearch"):
        er.plan(world, (2, 2, 0), (9, 2, 0), er.PRM(64))
    with pytest.raises(InvalidValue, match="a car on a map"):
        er.plan(grid.world(radius=0.3), (2, 2), (9, 2), CarSearch())
    with pytest.raises(InvalidValue, match="cusp_cost"):
        CarSearch(cusp_cost=-1.0)


def test_a_holonomic_robot_is_planned_by_the_planners_of_all_worlds():
    world = rooms().world(footprint=BOX, holonomic=True)
    result = er.plan(world, (3.0, 4.0, 0.0), (4.0, 4.5, 1.0), er.PRM(128), seconds=20)
    assert result.solved, result.message
    assert result.proof == "certified"
    assert world.validate(result.path).all()


def test_a_map_goes_with_a_footprint():
    result = er.plan("office.yaml", (1.0, 2.0, 1.5), (8.5, 3.0, 0.0), footprint=BOX, turning_radius=0.4)
    assert result.solved, result.message
    assert result.proof == "exact"


def test_a_plan_on_disk_has_its_pieces(tmp_path):
    for car in ("reverses", "on the spot"):
        world = rooms().world(**CARS[car])
        ((start, goal),) = queries(world, 1)
        result = er.plan(world, start, goal)
        result.save(tmp_path / "plan.json")
        read = er.PlanResult.load(tmp_path / "plan.json")
        np.testing.assert_array_equal(read.pieces, result.pieces)
        assert read.cusps == result.cusps
        result.save(tmp_path / "plan.csv")
        assert (tmp_path / "plan.csv").read_text().startswith("x,y,angle\n")
