"""The smallest k whose symmetrised k-nearest graph joins start and goal: one pass answers for every k at once.

An edge of the graph of k nearest neighbours is one of every larger k, so success can only rise with k.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.roadmap.neighbours import nearest
from evenroad.roadmap.search import join
from evenroad_studies.bench.task import Problem

NEVER = 10**6
"""Stands for: not with any k that was tried."""


def smallest_k(problem: Problem, cube: npt.NDArray[np.float64], largest: int) -> int:
    """Return the least k <= `largest` with which start and goal are joined over the points (n, d), else `NEVER`.

    The same graph as :class:`evenroad.roadmap.KNearest`: milestones that are not free are left out, start and goal
    come last among ties.
    """
    world = problem.world
    milestones = world.space.from_cube(cube)
    milestones = milestones[world.valid(milestones)]
    q = np.concatenate([milestones, problem.start[np.newaxis], problem.goal[np.newaxis]])
    neighbours = nearest(q, largest, world.space)
    label = np.arange(len(q), dtype=np.int32)
    own = np.arange(len(q), dtype=np.int32)
    for rank in range(neighbours.shape[1]):
        other = neighbours[:, rank]
        # Motions inside one piece change nothing.
        open_arcs = np.flatnonzero(label[own] != label[other])
        if len(open_arcs):
            free = world.motion_valid(q[open_arcs], q[other[open_arcs]])
            joined = open_arcs[free]
            join(label, np.stack([own[joined], other[joined]], axis=1))
        if label[-2] == label[-1]:
            return rank + 1
    return NEVER
