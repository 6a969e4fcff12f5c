"""Whether a roadmap joins start and goal, for several numbers of neighbours at once, in a few milliseconds.

The graphs of k nearest neighbours of growing k contain one another, and a motion within one connected part changes
nothing.  So all k together need hardly more checks than a tree has edges; a test compares with plans.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from evenroad._arrays import Bools, Floats, Ints, Ints32
from evenroad.roadmap.edges import LINKS, links_among
from evenroad.roadmap.neighbours import nearest
from evenroad.roadmap.search import components
from evenroad.world import World
from evenroad_studies.bench.task import Problem


def connected(problem: Problem, points: Floats, ks: Sequence[int]) -> Bools:
    """Return whether start and goal are joined in a box space, (2, len(ks)), for ascending numbers of neighbours.

    `points` are (n, d) of the unit cube.  The graph is that of ``k symmetrised`` over the free points, start and goal.
    Row 0 joins start and goal by the rule alone; row 1 also to as many milestones as a plan links them to.
    """
    world, found = problem.world, np.zeros((2, len(ks)), dtype=np.bool_)
    milestones = world.space.from_cube(points)
    milestones = milestones[world.valid(milestones)]
    n = len(milestones)
    q = np.concatenate([milestones, problem.start[np.newaxis], problem.goal[np.newaxis]])
    near = nearest(q, min(ks[-1], n + 1))
    own = np.repeat(np.arange(n + 2), near.shape[1])
    rank, other = np.tile(np.arange(near.shape[1]), n + 2), near.ravel()
    order = np.argsort(rank, kind="stable")
    key = np.minimum(own, other)[order] * (n + 2) + np.maximum(own, other)[order]
    pairs, first = np.unique(key, return_index=True)
    rank = rank[order][first]
    pairs = np.stack([pairs // (n + 2), pairs % (n + 2)], axis=1).astype(np.int32)
    most = links_among(n, LINKS)
    linked = [_free_links(world, q, end, most) for end in (n, n + 1)]
    free = np.empty((0, 2), dtype=np.int32)
    label: Ints32 = np.arange(n + 2, dtype=np.int32)
    least = 0
    # Two neighbours first: what they join needs no further check.
    for k in (2, *ks):
        new = pairs[(rank >= least) & (rank < k)]
        new = new[label[new[:, 0]] != label[new[:, 1]]]
        free = np.concatenate([free, new[world.motion_valid(q[new[:, 0]], q[new[:, 1]])]])
        label, least = components(n + 2, free), k
        if k not in ks:
            continue
        at = ks.index(k)
        starts, goals = (np.append(label[links], label[n + i]) for i, links in enumerate(linked))
        found[0, at:] |= label[n] == label[n + 1]
        found[1, at:] |= bool(np.isin(starts, goals).any())
        if found[:, at].all():
            break
    return found


def _free_links(world: World, q: Floats, end: int, most: int) -> Ints:
    """Return which of so many nearest milestones an end is joined to by a free motion."""
    milestones = q[:-2]
    near = np.argsort(((milestones - q[end]) ** 2).sum(axis=1), kind="stable")[:most]
    return np.asarray(near[world.motion_valid(np.tile(q[end], (len(near), 1)), milestones[near])])
