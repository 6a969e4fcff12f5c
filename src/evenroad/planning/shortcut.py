"""Shortcutting of paths by free motions, for worlds other than an arm's, whose paths are smoothed in the kernel."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats, Ints
from evenroad._time_limit import BudgetSpent, in_time, look_at_clock
from evenroad.roadmap.edges import EdgeCost
from evenroad.roadmap.search import confirmed, shortest_path
from evenroad.space import Space
from evenroad.space.path import motion_lengths, subdivide
from evenroad.world import World

Indices: TypeAlias = npt.NDArray[np.integer]
SPREADS = (32, 96)
"""Numbers of waypoints in a coarse and in a fine round; all pairs of them are checked.

A coarse round needs a tenth of the motions and finds most of the gain."""
MAX_ROUNDS = 8
PATIENCE = 4
"""Number of failed strict checks in a round after which neighbours one step further away are dropped, too."""
WORTH_WHILE = 1e-2
"""Least share of shortening in a round for another round with the same number of waypoints."""


def shortcut(world: World, path: Floats, cost: EdgeCost | None = None) -> tuple[Floats, int]:
    """Return a path that does not cost more, with new motions that are free in the world.

    Each round puts waypoints evenly along the path, few at first, joins every pair with a free motion between, and
    takes the shortest path through them.  The path's own waypoints are always among them, so a round never makes it
    longer.  At the end, unnecessary waypoints are dropped.  It draws no random numbers.  If the world has a strict
    check (`ValidatesPaths`), the motions of a round's path must also pass it.  Motions that fail are removed, later
    with their neighbours, and the next shortest path is tried.

    `path`, (p, dim), p >= 2, has free motions; costs are lengths by default.  When the time is over, the best path so
    far is the answer.  The second return value is the number of motions checked, without strict checks.
    """
    work = _Shortcut(path, world, world.space.distance if cost is None else cost)
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
    """A path that becomes shorter, and the number of checks for it."""

    def __init__(self, path: Floats, world: World, cost: EdgeCost) -> None:
        self.path, self.world, self.cost = path, world, cost
        self.length = self._total(path)
        self.checked = 0

    def round(self, most: int) -> None:
        """Take the shortest path through this number of waypoints, if it is shorter."""
        space = self.world.space
        waypoints, own = _spread(self.path, space, most)
        # The path's own motions are known to be free, so a path always exists.
        pairs = _Pairs(self._free_pairs(waypoints), own)
        lengths = self.cost(waypoints[pairs.edges[:, 0]], waypoints[pairs.edges[:, 1]])
        goal = len(waypoints) - 1
        to_goal = space.distance(waypoints, np.broadcast_to(waypoints[-1], waypoints.shape))
        while True:
            edges = pairs.edges[pairs.usable]
            kept, _ = shortest_path(len(waypoints), edges, lengths[pairs.usable], to_goal, 0, goal)
            shorter = self._total(waypoints[kept])
            if not shorter < self.length:
                return
            if self._holds(waypoints, kept, pairs):
                self.path, self.length = waypoints[kept], shorter
                return

    def drop_needless(self) -> None:
        """Join each waypoint to the last one that can be reached straight, and drop those between."""
        path = self.path
        pairs = _Pairs(self._free_pairs(path), np.arange(len(path)))
        while True:
            reach = np.arange(len(path))
            first, second = pairs.edges[pairs.usable].T
            np.maximum.at(reach, first, second)
            kept = [0]
            while kept[-1] < len(path) - 1:
                kept.append(int(reach[kept[-1]]))
            if self._holds(path, np.array(kept), pairs):
                break
        # This is never longer in a metric, but other costs may prefer the waypoint.
        if self._total(path[kept]) <= self.length * (1.0 + 1e-12):
            self.path = path[kept]

    def _holds(self, waypoints: Floats, kept: Indices, pairs: _Pairs) -> bool:
        """Return whether the world confirms a path; if not, some of its pairs become unusable."""
        look_at_clock()
        along = pairs.along(kept)
        passed = confirmed(self.world, waypoints[kept], ~pairs.trusted[along])
        pairs.trusted[along[passed]] = True
        if not passed.all():
            pairs.give_up(along[~passed])
        return bool(passed.all())

    def _total(self, path: Floats) -> float:
        return float(np.sum(self.cost(path[:-1], path[1:])))

    def _free_pairs(self, waypoints: Floats) -> Bools:
        """Return which pairs of waypoints i < j can be joined, (w, w)."""
        first, second = np.triu_indices(len(waypoints), k=1)
        free = np.zeros((len(waypoints), len(waypoints)), dtype=np.bool_)
        for rows in in_time(np.arange(len(first))):
            i, j = first[rows], second[rows]
            free[i, j] = self.world.motion_valid(waypoints[i], waypoints[j])
            self.checked += len(rows)
        return free


class _Pairs:
    """Pairs of waypoints that can be joined, which include the steps between a path's `own` ones.

    `edges`, (m, 2), have the smaller row first.  `trusted` ones have passed the strict check, and `usable` ones have
    not failed it, (m,) each.
    """

    def __init__(self, free: Bools, own: Indices) -> None:
        free = free.copy()
        free[own[:-1], own[1:]] = True
        self.edges = np.argwhere(free).astype(np.int32)
        self._number = np.zeros(free.shape, dtype=np.intp)
        self._number[free] = np.arange(len(self.edges))
        self.usable = np.ones(len(self.edges), dtype=np.bool_)
        self.trusted = np.zeros(len(self.edges), dtype=np.bool_)
        self.trusted[self._number[own[:-1], own[1:]]] = True
        self._failures = 0

    def along(self, kept: Indices) -> Indices:
        """Return the numbers of the pairs along a path."""
        return self._number[np.minimum(kept[:-1], kept[1:]), np.maximum(kept[:-1], kept[1:])]

    def give_up(self, failed: Indices) -> None:
        """Drop these pairs and unchecked neighbours, more of them the more pairs have failed.

        An obstacle that blocks one motion mostly blocks its neighbours, too.  Singly, thousands would be tried.
        """
        for pair in self.edges[failed]:
            beside = (np.abs(self.edges - pair) <= self._failures // PATIENCE).all(axis=1)
            self.usable &= ~beside | self.trusted
            self._failures += 1


def _spread(path: Floats, space: Space, most: int) -> tuple[Floats, Ints]:
    """Return the path's waypoints with evenly spread ones between them, `most` in all, and the rows of its own."""
    lengths = motion_lengths(path, space)
    spare = max(0, most - len(path))
    total = lengths.sum()
    extra = np.floor(spare * lengths / total).astype(int) if total > 0 else np.zeros(len(lengths), dtype=int)
    return subdivide(path, space, extra + 1)
