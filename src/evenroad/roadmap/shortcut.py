"""Shortcutting: straighten a path with motions that the world itself calls free."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.roadmap.cost import EdgeCost
from evenroad.roadmap.search import shortest_path
from evenroad.space import Space
from evenroad.world import World

SPREADS = (32, 96)
"""Waypoints offered to a round, first of the coarse rounds, then of the fine ones; all pairs of them are checked.

A coarse round asks for a tenth of the motions and finds most of what there is to gain.
"""
MAX_ROUNDS = 8
WORTH_WHILE = 1e-2
"""A round that shortens the path by less than this share is the last one with so many waypoints."""


def shortcut(
    path: npt.NDArray[np.float64], world: World, cost: EdgeCost | None = None
) -> tuple[npt.NDArray[np.float64], int]:
    """Return a path that does not cost more, and whose every motion was reported free by `world`.

    Each round puts waypoints evenly along the path, few at first, joins every pair that `world` says can be joined,
    and takes the shortest way through them; its own waypoints are always among those offered, so a round never makes
    the path longer.  At the end, waypoints that can be passed by are dropped.  It draws no random numbers.

    Parameters
    ----------
    path : ndarray, shape (p, dim), p >= 2
        A path whose motions are free.
    world : World
        Whose ``motion_valid`` decides.
    cost : callable, optional
        What a motion costs; default: its length in the metric of the space.

    Returns
    -------
    path : ndarray, shape (q, dim)
        From the same start to the same goal.
    motions : int
        How many motions were checked.
    """
    cost = world.space.distance if cost is None else cost
    length = _total(path, cost)
    checked = 0
    for most in SPREADS:
        for _ in range(MAX_ROUNDS):
            candidate, motions = _round(path, world, cost, most)
            checked += motions
            shorter = _total(candidate, cost)
            if not shorter < length:
                break
            gain = length - shorter
            path, length = candidate, shorter
            if gain < WORTH_WHILE * length:
                break
    straighter, motions = _drop_needless(path, world)
    # In a metric this never is longer; other costs may well prefer the waypoint.
    if _total(straighter, cost) <= length * (1.0 + 1e-12):
        path = straighter
    return path, checked + motions


def path_length(path: npt.NDArray[np.float64], space: Space) -> float:
    """Return the length of a path of waypoints, shape (p, dim), in the metric of the space."""
    return _total(path, space.distance)


def _total(path: npt.NDArray[np.float64], cost: EdgeCost) -> float:
    return float(np.sum(cost(path[:-1], path[1:])))


def _round(
    path: npt.NDArray[np.float64], world: World, cost: EdgeCost, most: int
) -> tuple[npt.NDArray[np.float64], int]:
    waypoints, own = _spread(path, world.space, most)
    first, second = np.triu_indices(len(waypoints), k=1)
    free = world.motion_valid(waypoints[first], waypoints[second])
    edges = np.stack([first[free], second[free]], axis=1).astype(np.int32)
    steps = np.stack([own[:-1], own[1:]], axis=1).astype(np.int32)
    # The path's own motions are known to be free; with them there always is a way.
    edges = np.concatenate([edges, steps])
    lengths = cost(waypoints[edges[:, 0]], waypoints[edges[:, 1]])
    goal = len(waypoints) - 1
    to_goal = world.space.distance(waypoints, np.broadcast_to(waypoints[-1], waypoints.shape))
    way, _ = shortest_path(len(waypoints), edges, lengths, to_goal, 0, goal)
    return waypoints[way], len(first)


def _drop_needless(path: npt.NDArray[np.float64], world: World) -> tuple[npt.NDArray[np.float64], int]:
    """From each waypoint go straight to the last one that can be reached, and drop those between."""
    first, second = np.triu_indices(len(path), k=1)
    free = world.motion_valid(path[first], path[second]) | (second == first + 1)
    reach = np.arange(len(path))
    np.maximum.at(reach, first[free], second[free])
    kept = [0]
    while kept[-1] < len(path) - 1:
        kept.append(int(reach[kept[-1]]))
    return path[kept], len(first)


def _spread(
    path: npt.NDArray[np.float64], space: Space, most: int
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.intp]]:
    """Return the path's waypoints with evenly spread ones between them, `most` in all, and the rows of its own."""
    lengths = space.distance(path[:-1], path[1:])
    spare = max(0, most - len(path))
    total = lengths.sum()
    extra = np.floor(spare * lengths / total).astype(int) if total > 0 else np.zeros(len(lengths), dtype=int)
    pieces = []
    for a, b, count in zip(path[:-1], path[1:], extra, strict=True):
        t = np.arange(count + 1) / (count + 1)
        start, end = np.broadcast_to(a, (len(t), len(a))), np.broadcast_to(b, (len(t), len(b)))
        pieces.append(space.interpolate(start, end, t))
    own = np.concatenate([[0], np.cumsum(extra + 1)])
    return np.concatenate([*pieces, path[-1:]]), own
