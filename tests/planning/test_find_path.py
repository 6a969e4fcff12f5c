"""Planning without a number of points."""

import numpy as np

from evenroad.planning import plan
from evenroad.roadmap import Budget
from evenroad.space import BoxSpace
from evenroad.world import FunctionWorld, GridMap


def two_rooms(gap):
    occupied = np.zeros((40, 60), dtype=bool)
    occupied[:, 30] = True
    occupied[10 : 10 + gap, 30] = False
    return GridMap(occupied).world(2.0)


def test_a_world_that_plans_by_itself_is_asked():
    world = two_rooms(gap=5)
    result = plan(world, (10, 30), (50, 30))
    assert result.solved
    assert result.planner == "cells"
    assert world.motion_valid(result.path[:-1], result.path[1:]).all()
    assert result.cost <= result.milestone_cost
    assert len(plan(world, (10, 30), (50, 30), smooth=False).path) > len(result.path)


def test_for_any_other_world_points_grow():
    world = FunctionWorld(BoxSpace((0, 0), (1, 1)), lambda q: (np.abs(q[:, 0] - 0.5) > 0.1) | (q[:, 1] > 0.9), 0.01)
    # Time enough also where code is compiled first.
    result = plan(world, (0.1, 0.1), (0.9, 0.1), seconds=60.0)
    assert result.solved
    assert result.planner == "prm anytime"
    closed = FunctionWorld(BoxSpace((0, 0), (1, 1)), lambda q: np.abs(q[:, 0] - 0.5) > 0.1, 0.01)
    assert plan(closed, (0.1, 0.1), (0.9, 0.1), limits=Budget(samples=128)).status == "budget_spent"
