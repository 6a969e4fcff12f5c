"""Plans of flight: proved, quick, the same every time, and refused in words."""

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue
from evenroad.planning import FlightSearch
from tests.flight.oracle import distances, flown


def forest(seed=0, n=120):
    """Upright cylinders between x = 0 and x = 18."""
    rng, trees = np.random.default_rng(seed), []
    while len(trees) < n:
        x, y = rng.uniform(0.3, 17.7), rng.uniform(-9, 9)
        if np.hypot(x, y) > 1.3 and np.hypot(x - 18, y) > 1.3:
            trees.append(er.Cylinder(rng.uniform(0.2, 0.3), 6.0, xyz=(x, y, 2)))
    return er.FlightWorld(er.Scene(trees), speed=6.0, acceleration=8.0, bounds=[(-1, 19), (-9, 9), (0.5, 3.5)])


START, GOAL = er.State((0, 0, 2)), er.State((18, 0, 2))


@pytest.mark.parametrize("seed", range(3))
def test_a_flight_through_a_forest_is_free_at_every_instant_and_within_limits(seed):
    world = forest(seed)
    result = er.plan(world, START, GOAL)
    assert result, result.message
    assert result.cost <= result.milestone_cost
    assert result.gap >= 0.0
    assert world.validate(result.path).all()
    along, _ = flown(result.start, result.trajectory().pieces, 100)
    assert distances(world.scene, along[:, :3]).min() > world.radius
    assert np.abs(along[:, 3:]).max() <= 6.0 + 1e-9
    np.testing.assert_allclose(along[-1], result.goal, atol=1e-8)
    assert er.plan(world, START, GOAL).path.tolist() == result.path.tolist()


def test_the_quickest_motion_is_the_answer_where_it_is_free():
    world = er.FlightWorld(er.Scene(), speed=6.0, acceleration=8.0)
    result = er.plan(world, START, GOAL)
    assert (len(result.path), result.cost, result.gap) == (2, 3.75, 0.0)


def test_a_start_and_goal_in_motion_are_kept():
    world = forest(1)
    start, goal = er.State((0, 0, 2), (5, 1, 0)), er.State((18, 0, 2), (4, 0, 0))
    result = er.plan(world, start, goal)
    assert result, result.message
    assert result.path[[0, -1]].tolist() == [np.array(start).tolist(), np.array(goal).tolist()]


def test_several_goals_are_tried_and_only_free_ones_reached():
    world = forest(2)
    trunk = world.scene.obstacles[0].xyz
    result = er.plan(world, START, [er.State((trunk[0], trunk[1], 2)), GOAL])
    assert result.goal_index == 1


@pytest.mark.parametrize(
    ("start", "goal", "says"),
    [
        (er.State((5, 0, 2)), GOAL, "the start is in collision: the ball touches 'tree'"),
        (START, er.State((18, 0, 2), (0, 9, 0)), "the speed along y must be from -6 to 6, got 9"),
        (START, er.State((18, 0, 999)), "the goal is outside the limits: z must be"),
    ],
)
def test_a_state_that_is_not_free_is_refused_in_words(start, goal, says):
    tree = er.Scene([er.Cylinder(0.3, 4, xyz=(5, 0, 2), name="tree")])
    result = er.plan(er.FlightWorld(tree, speed=6.0, acceleration=8.0), start, goal)
    assert not result
    assert says in result.message


def test_without_a_path_the_budget_is_spent():
    walls = [er.Box(size, xyz=xyz) for size, xyz in (((2, 2, 0.1), (5, 0, 1)), ((2, 2, 0.1), (5, 0, 3)))]
    walls += [er.Box((0.1, 2, 2), xyz=(5 + side, 0, 2)) for side in (-1, 1)]
    walls += [er.Box((2, 0.1, 2), xyz=(5, side, 2)) for side in (-1, 1)]
    world = er.FlightWorld(er.Scene(walls), speed=6.0, acceleration=8.0)
    result = er.plan(world, START, er.State((5, 0, 2)), seconds=0.05)
    assert result.status is er.Status.BUDGET_SPENT
    assert "nodes were grown" in result.message


def test_other_planners_and_worlds_are_refused():
    with pytest.raises(InvalidValue, match="only FlightSearch"):
        er.plan(forest(), START, GOAL, er.PRM(64))
    with pytest.raises(InvalidValue, match="FlightSearch plans for what flies"):
        er.plan(er.GridMap(np.zeros((20, 30), dtype=bool)).world(2), (3, 3), (27, 17), FlightSearch())
    with pytest.raises(InvalidValue, match="start must be 6 finite numbers"):
        er.plan(forest(), (0, 0, 2), GOAL)
