"""A kept roadmap whose start or goal is cut off: the world joins them itself where it can."""

import numpy as np
import pytest

from evenroad.planning.connectors import CELLS, Cells
from evenroad.points import draw
from evenroad.roadmap import KNearest
from evenroad.roadmap.build import roadmap_of_points
from evenroad.world import GridMap


def walled(gap):
    """Two rooms of 30 x 40 with a slit in the wall between them."""
    occupied = np.zeros((40, 60), dtype=bool)
    occupied[:, 29:31] = True
    occupied[20 : 20 + gap, 29:31] = False
    return GridMap(occupied).world(2.0)


START, GOAL = (5.0, 5.0), (55.0, 35.0)


def known(world, n=32, **options):
    return roadmap_of_points(world.space, draw("sobol", n, 2, rng=0), KNearest(6)).within(world, **options)


def test_trees_join_what_the_roadmap_does_not():
    world = walled(gap=5)
    roadmap = known(world)
    alone = roadmap.plan(START, GOAL)
    assert alone.status == "not_connected"
    joined = roadmap.plan(START, GOAL, smooth=False, connector=CELLS)
    assert joined.solved
    assert joined.planner == "prm lazy, then cells"
    assert world.motion_valid(joined.path[:-1], joined.path[1:]).all()
    shorter = roadmap.plan(START, GOAL, connector=CELLS)
    assert shorter.cost < joined.cost


def test_what_the_search_learned_stays():
    roadmap = known(walled(gap=5))
    first = roadmap.plan(START, GOAL, connector=CELLS)
    before = roadmap.evaluated
    again = roadmap.plan(START, GOAL, connector=CELLS)
    assert np.array_equal(first.path, again.path)
    assert again.counts["edges_checked"] < first.counts["edges_checked"]
    assert roadmap.evaluated == before


def test_a_path_along_the_roadmap_needs_no_trees():
    result = known(walled(gap=5)).plan(START, (20.0, 30.0), connector=CELLS)
    assert result.solved
    assert result.planner == "prm lazy"


class Unasked(Cells):
    def connect(self, *_, **__):
        pytest.fail("was asked")


def test_where_it_is_proved_that_there_is_no_path_nobody_looks_for_one():
    result = known(walled(gap=3)).plan(START, GOAL, connector=Unasked())
    assert result.status == "not_connected"
    assert result.counts["start_component"] > 0


def test_paths_by_another_cost_come_from_the_roadmap_alone():
    def twice(a, b):
        return 2.0 * np.hypot(*(a - b).T)

    assert known(walled(gap=5), edge_cost=twice).plan(START, GOAL, connector=CELLS).status == "not_connected"
