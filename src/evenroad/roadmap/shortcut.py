"""Shortcutting: straighten a path with motions that the world itself calls free."""

from __future__ import annotations

import math
import time
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from evenroad.roadmap.cost import EdgeCost
from evenroad.roadmap.proof import confirmed
from evenroad.roadmap.search import BudgetSpent, shortest_path
from evenroad.roadmap.search.edge_states import in_time
from evenroad.space import Space
from evenroad.space.path import motion_lengths, subdivide
from evenroad.world import World

SPREADS = (32, 96)
"""Waypoints offered to a round, first of the coarse rounds, then of the fine ones; all pairs of them are checked.

A coarse round asks for a tenth of the motions and finds most of what there is to gain.
"""
MAX_ROUNDS = 8
WORTH_WHILE = 1e-2
"""A round that shortens the path by less than this share is the last one with so many waypoints."""


def shortcut(
    path: npt.NDArray[np.float64],
    world: World,
    cost: EdgeCost | None = None,
    deadline: float = math.inf,
) -> tuple[npt.NDArray[np.float64], int]:
    """Return a path that does not cost more, and whose every new motion was reported free by `world`.

    Each round puts waypoints evenly along the path, few at first, joins every pair that `world` says can be joined,
    and takes the shortest way through them; its own waypoints are always among those offered, so a round never makes
    the path longer.  At the end, waypoints that can be passed by are dropped.  It draws no random numbers.

    Where the world has a strict check (`Rechecks`), the motions of a round's way have to pass it, too; those that
    fail are taken away and the next shortest way is tried.

    Parameters
    ----------
    path : ndarray, shape (p, dim), p >= 2
        A path whose motions are free.
    world : World
        Whose ``motion_valid`` decides, and its ``recheck`` if there is one.
    cost : callable, optional
        What a motion costs; default: its length in the metric of the space.
    deadline : float
        When to stop with what was reached, on the clock of ``time.perf_counter``.

    Returns
    -------
    path : ndarray, shape (q, dim)
        From the same start to the same goal.
    motions : int
        How many motions were checked, rechecks apart.
    """
    work = _Shortcut(path, world, world.space.distance if cost is None else cost, deadline)
    try:
        for most in SPREADS:
            for _ in range(MAX_ROUNDS):
                before = work.length
                work.round(most)
                gain = before - work.length
                if not gain > 0.0 or gain < WORTH_WHILE * work.length:
                    break
        work.drop_needless()
    except BudgetSpent:
        pass
    return work.path, work.checked


class _Shortcut:
    """A path that becomes shorter, and what was asked for it."""

    def __init__(self, path: npt.NDArray[np.float64], world: World, cost: EdgeCost, deadline: float) -> None:
        self.path, self.world, self.cost, self.deadline = path, world, cost, deadline
        self.length = self._total(path)
        self.checked = 0

    def round(self, most: int) -> None:
        """Take the shortest way through so many waypoints along the path, if it is shorter."""
        space = self.world.space
        waypoints, own = _spread(self.path, space, most)
        first, second, free = self._pairs(waypoints)
        edges = np.stack([first[free], second[free]], axis=1).astype(np.int32)
        steps = np.stack([own[:-1], own[1:]], axis=1).astype(np.int32)
        # The path's own motions are known to be free; with them there always is a way.
        edges = np.concatenate([edges, steps])
        lengths = self.cost(waypoints[edges[:, 0]], waypoints[edges[:, 1]])
        goal = len(waypoints) - 1
        to_goal = space.distance(waypoints, np.broadcast_to(waypoints[-1], waypoints.shape))
        trusted = {tuple(step) for step in steps.tolist()}
        while True:
            way, _ = shortest_path(len(waypoints), edges, lengths, to_goal, 0, goal)
            shorter = self._total(waypoints[way])
            if not shorter < self.length:
                return
            failed = self._failed(waypoints, way.tolist(), trusted)
            if not failed:
                self.path, self.length = waypoints[way], shorter
                return
            kept = np.array([tuple(edge) not in failed for edge in edges.tolist()])
            edges, lengths = edges[kept], lengths[kept]

    def drop_needless(self) -> None:
        """From each waypoint go straight to the last one that can be reached, and drop those between."""
        path = self.path
        first, second, free = self._pairs(path)
        trusted = {(i, i + 1) for i in range(len(path) - 1)}
        open_pairs = set(zip(first[free].tolist(), second[free].tolist(), strict=True)) | trusted
        while True:
            reach = list(range(len(path)))
            for i, j in open_pairs:
                reach[i] = max(reach[i], j)
            way = [0]
            while way[-1] < len(path) - 1:
                way.append(reach[way[-1]])
            failed = self._failed(path, way, trusted)
            if not failed:
                break
            open_pairs -= failed
        # In a metric this never is longer; other costs may well prefer the waypoint.
        if self._total(path[way]) <= self.length * (1.0 + 1e-12):
            self.path = path[way]

    def _total(self, path: npt.NDArray[np.float64]) -> float:
        return float(np.sum(self.cost(path[:-1], path[1:])))

    def _pairs(
        self, waypoints: npt.NDArray[np.float64]
    ) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp], npt.NDArray[np.bool_]]:
        """Return all pairs of waypoints, as two arrays, and which of them can be joined."""
        first, second = np.triu_indices(len(waypoints), k=1)
        free = np.zeros(len(first), dtype=np.bool_)
        for rows in in_time(np.arange(len(first)), self.deadline):
            free[rows] = self.world.motion_valid(waypoints[first[rows]], waypoints[second[rows]])
            self.checked += len(rows)
        return first, second, free

    def _failed(
        self, waypoints: npt.NDArray[np.float64], way: list[int], trusted: set[tuple[int, int]]
    ) -> set[tuple[int, int]]:
        """Return which steps of a way the world does not confirm; those that pass are trusted from now on."""
        if time.perf_counter() >= self.deadline:
            raise BudgetSpent
        steps = [(min(step), max(step)) for step in pairwise(way)]
        doubtful = np.array([step not in trusted for step in steps], dtype=np.bool_)
        passed = confirmed(self.world, waypoints[way], doubtful)
        failed = {step for step, good in zip(steps, passed.tolist(), strict=True) if not good}
        trusted |= set(steps) - failed
        return failed


def _spread(
    path: npt.NDArray[np.float64], space: Space, most: int
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
    """Return the path's waypoints with evenly spread ones between them, `most` in all, and the rows of its own."""
    lengths = motion_lengths(path, space)
    spare = max(0, most - len(path))
    total = lengths.sum()
    extra = np.floor(spare * lengths / total).astype(int) if total > 0 else np.zeros(len(lengths), dtype=int)
    return subdivide(path, space, extra + 1)
