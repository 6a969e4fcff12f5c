"""Planning on points, with what is told of planner and search side by side: for tests that try many of both.

Planners solve problems here: ``er.plan`` would ask the world why there is no path, which some tests count.
"""

from functools import partial

import numpy as np

from evenroad.planning import FMT, PRM, GrowingPRM, Problem
from evenroad.planning.planners.trees import default_planner
from evenroad.planning.terminals import as_start_and_goals
from evenroad.roadmap import Budget


def solve(planner, world, start, goal, *, rng=0, smooth=True, budget=None):
    """Let a planner find a path."""
    first, goals = as_start_and_goals(start, goal, world.space)
    budget = Budget(seconds=planner.seconds) if budget is None else budget
    return planner.solve(Problem(world, first, goals, budget=budget, smooth=smooth, rng=rng))


def plan_on(world, start, goal, points, *, by=PRM, smooth=True, budget=None, **options):
    """Plan with all edges checked, unless told otherwise."""
    if by is PRM:
        options = {"search": "full"} | options
    return solve(by(points, **options), world, start, goal, smooth=smooth, budget=budget)


fmt_on = partial(plan_on, by=FMT)


def plan_growing(world, start, goal, sampler=None, *, rng=0, smooth=True, budget=None, **options):
    """Plan with more and more points."""
    return solve(GrowingPRM(sampler, **options), world, start, goal, rng=rng, smooth=smooth, budget=budget)


def find_path(world, start, goal, *, budget=None, smooth=True):
    """Plan without a number of points."""
    return solve(default_planner(world), world, start, goal, smooth=smooth, budget=budget)


def may_connect(world, a, b):
    """Return False where the world proves that no path leads from one place to another."""
    found = world.apart(np.asarray(a, dtype=float), np.atleast_2d(b))
    return found is None or not found.proved
