"""More time buys better paths, never worse ones."""

from itertools import pairwise

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.planning import GrowingPRM, Problem, RRTConnect, plan
from evenroad.planning.attempt import NO_LIMIT
from evenroad.planning.connector import Connection, Search
from evenroad.planning.planners.trees import default_planner, solve_by
from evenroad.roadmap import Budget
from evenroad.space import SE2, SE3, BoxSpace
from evenroad.world import FunctionWorld, GridMap

HEIGHTS = (0.9, 0.7, 0.8, 0.3, 0.6)
"""Over which height each variant of the planner goes."""


class Detours:
    """Goes over a point above the middle of the unit square, and does not smooth."""

    planner, varies = "detours", True

    def __init__(self):
        self.asked, self.most = [], []

    def searches(self, dim):
        yield Search(NO_LIMIT, "none")

    def connect(self, world, start, goals, *, variant, most_motions):
        self.asked.append(variant)
        self.most.append(most_motions)
        if variant == 2:
            return Connection(np.empty((0, 2)), -1, 3, 1, 2)
        path = np.stack([start, [0.5, HEIGHTS[variant % len(HEIGHTS)]], goals[0]])
        return Connection(path, 0, 3, 1, 2)

    def smooth(self, world, path, *, quick=False):
        return path, 1


OPEN = FunctionWorld(BoxSpace((0, 0), (1, 1)), lambda q: np.ones(len(q), dtype=bool), 0.1)


def improved(start=(0.1, 0.1), goal=(0.9, 0.1), improve=True, **limits):
    detours = Detours()
    problem = Problem(OPEN, np.array(start), np.array([goal]), budget=Budget(seconds=None, **limits))
    return detours, solve_by(problem, detours, improve=improve)


def over(height):
    return 2 * np.hypot(0.4, height - 0.1)


@pytest.mark.parametrize(("rounds", "best"), [(1, 0.7), (2, 0.7), (3, 0.3), (4, 0.3)])
def test_the_best_of_so_many_rounds_is_kept(rounds, best):
    world, result = improved(rounds=rounds)
    assert world.asked == list(range(rounds + 1))
    assert result.cost == pytest.approx(over(best))
    assert result.counts["rounds"] == rounds
    assert result.counts["nodes"] == 3 * (rounds + 1)
    assert result.counts["edges_checked"] == 2 * (rounds + 1)
    assert f"the best of {rounds + 1}" in result.message


def test_stages_hold_the_cost_over_time_of_what_was_better():
    stages = improved(rounds=9)[1].stages
    assert [stage.cost for stage in stages] == pytest.approx([over(0.9), over(0.7), over(0.3)])
    assert [stage.points for stage in stages] == [3, 6, 12]
    assert all(a.seconds <= b.seconds for a, b in pairwise(stages))


def test_motions_bound_the_rounds_and_a_round_gives_up_sooner_than_the_first_path():
    assert improved(motions=5)[0].asked == [0, 1, 2]
    most = improved(rounds=3)[0].most
    assert most[0] > 10**9
    assert most[1:] == [1000] * 3


def test_a_straight_path_is_not_improved_on_and_none_is_unless_that_is_asked_for():
    detours, result = improved((0.3, 0.9), (0.7, 0.9), rounds=50)
    assert detours.asked == [0]
    assert result.cost == pytest.approx(0.4)
    assert "the best of" not in result.message
    detours, result = improved(improve=False)
    assert detours.asked == [0]
    assert result.stages == ()


@pytest.mark.parametrize("rounds", [0, -1, 1.5, True])
def test_rounds_are_a_number_of_times(rounds):
    with pytest.raises(InvalidValue, match="rounds must be an integer >= 1"):
        Budget(rounds=rounds)


def test_on_a_map_a_roadmap_grows_beside_the_first_path():
    occupied = np.zeros((60, 60), dtype=bool)
    occupied[10:50, 30] = True
    world = GridMap(occupied).world(1.0)
    first = plan(world, (5, 30), (55, 33))
    planner, limits = default_planner(world, improve=True), Budget(seconds=None, samples=512)
    best = plan(world, (5, 30), (55, 33), planner, limits=limits)
    assert best.cost <= first.cost
    assert world.motion_valid(best.path[:-1], best.path[1:]).all()
    assert best.stages[0].cost == first.cost
    assert [stage.points for stage in best.stages[1:]] == [64, 128, 256, 512]


SPACES = [BoxSpace([0] * 2, [1] * 2), BoxSpace([0] * 5, [1] * 5), SE2([0] * 2, [1] * 2), SE3([0] * 3, [1] * 3)]


def below_a_wall(q):
    """Whether places are free, by their first two coordinates: a wall reaches up to 0.8."""
    return ~((np.abs(q[:, 0] - 0.5) < 0.1) & (q[:, 1] < 0.8))


@pytest.mark.parametrize("planner", [RRTConnect(improve=True), GrowingPRM(until="budget")], ids=repr)
@pytest.mark.parametrize("space", SPACES, ids=lambda space: f"{space.dim} coordinates")
def test_in_each_space_more_effort_never_hurts_and_the_result_says_how_far_the_path_is_from_the_shortest(
    space, planner
):
    world = FunctionWorld(space, below_a_wall, 0.02)
    ends = np.tile(space.from_cube(np.full((1, space.cube_dim), 0.5)), (2, 1))
    ends[:, :2] = (0.1, 0.3), (0.9, 0.3)
    budgets = [Budget(seconds=None, rounds=1, samples=64), Budget(seconds=None, rounds=3, samples=256)]
    once, often = (plan(world, *ends, planner, limits=each) for each in budgets)
    assert often.lower_bound == pytest.approx(0.8)
    # Over both upper corners of the wall.
    shortest = 0.2 + 2 * np.hypot(0.3, 0.5)
    assert 0.999 * shortest <= often.cost
    # A roadmap that grows keeps what is shortest along it, and smooths that in the end.
    costs = [each.cost if isinstance(planner, RRTConnect) else each.milestone_cost for each in (once, often)]
    assert costs[0] is None or costs[1] <= costs[0]
    assert often.gap == pytest.approx(often.cost / 0.8 - 1)


@pytest.mark.parametrize("space", SPACES, ids=lambda space: f"{space.dim} coordinates")
def test_an_informed_roadmap_leaves_out_what_no_shorter_path_passes(space):
    world = FunctionWorld(space, below_a_wall, 0.02)
    ends = np.tile(space.from_cube(np.full((1, space.cube_dim), 0.5)), (2, 1))
    ends[:, :2] = (0.1, 0.3), (0.9, 0.3)
    all_of, informed = (
        plan(world, *ends, GrowingPRM(until="budget", informed=each), limits=Budget(seconds=None, samples=2048))
        for each in (False, True)
    )
    assert informed.counts["configurations_checked"] < 0.9 * all_of.counts["configurations_checked"]
    assert informed.milestone_cost <= 1.02 * all_of.milestone_cost


def test_an_informed_roadmap_has_no_costs_of_its_own():
    with pytest.raises(InvalidValue, match="informed must be False where edge_cost is given"):
        GrowingPRM(informed=True, edge_cost=lambda a, b: np.zeros(len(a)))
