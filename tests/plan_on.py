"""Planning on points, with what is told of planner and search side by side: for tests that try many of both."""

from functools import partial

import numpy as np

from evenroad.planning import FMT, PRM, GrowingPRM, plan


def plan_on(world, start, goal, points, *, by=PRM, shorten=True, budget=None, **options):
    """Plan with all edges checked, unless told otherwise."""
    if by is PRM:
        options = {"search": "full"} | options
    return plan(world, start, goal, by(points, **options), smooth=shorten, limits=budget)


fmt_on = partial(plan_on, by=FMT)


def plan_growing(world, start, goal, sampler=None, *, rng=0, shorten=True, budget=None, **options):
    """Plan with more and more points."""
    grown = GrowingPRM(sampler, **options)
    return plan(world, start, goal, grown, rng=rng, smooth=shorten, limits=budget)


def find_path(world, start, goal, *, budget=None, shorten=True):
    """Plan without a number of points."""
    return plan(world, start, goal, smooth=shorten, limits=budget)


def may_connect(world, a, b):
    """Return False where the world proves that no path leads from one place to another."""
    found = world.apart(np.asarray(a, dtype=float), np.atleast_2d(b))
    return found is None or not found.proved
