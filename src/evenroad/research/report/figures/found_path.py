"""A path to draw: the problem planned with more and more edges until there is one."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.points import draw
from evenroad.research.bench.problem import Problem
from evenroad.roadmap import KNearest, PlanResult, plan
from evenroad.space import Space

TRIES = ((1024, 10), (2048, 10), (4096, 10), (2048, 40), (8192, 40))
"""Points and neighbours: more points, where they do not help (a goal deep in a box) more neighbours."""


def find_path(problem: Problem) -> PlanResult:
    """Return the first plan with a path, on scrambled Halton points; the last one if none has."""
    for n, k in TRIES:
        points = draw("halton", n, problem.world.space.cube_dim)
        result = plan(problem.world, problem.start, problem.goal, points, rule=KNearest(k), search="lazy", links=None)
        if result.solved:
            break
    return result


def poses_along(space: Space, path: npt.NDArray[np.float64], count: int) -> npt.NDArray[np.float64]:
    """Return configurations at even distances along a path, its ends included, (count, dim).

    Parameters
    ----------
    space : Space
    path : ndarray, shape (p, dim), p >= 2
    count : int
        At least 2.
    """
    lengths = space.distance(path[:-1], path[1:])
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    along = np.linspace(0.0, ends[-1], count)
    leg = np.clip(np.searchsorted(ends, along, side="right") - 1, 0, len(lengths) - 1)
    shares = (along - ends[leg]) / np.where(lengths[leg] > 0, lengths[leg], 1.0)
    return space.interpolate(path[leg], path[leg + 1], np.clip(shares, 0.0, 1.0))
