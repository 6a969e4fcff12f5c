"""More time buys better paths, never worse ones."""

from itertools import pairwise

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.planning import Problem, plan
from evenroad.planning.trees import default_planner, solve_by
from evenroad.roadmap import Budget
from evenroad.roadmap.attempt import NO_LIMIT
from evenroad.roadmap.connector import Connection, Search
from evenroad.space import BoxSpace
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

    def connect(self, world, start, goals, *, variant, most_motions, seconds):
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
