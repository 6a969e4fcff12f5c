"""Shortcutting of paths by free motions, for worlds other than an arm's, whose paths are smoothed in the kernel."""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad._time_limit import BudgetSpent, in_time, look_at_clock
from evenroad.points.reversed_halton import cube_points
from evenroad.roadmap.edges import EdgeCost
from evenroad.roadmap.search import confirmed
from evenroad.space import Space
from evenroad.space.path import motion_lengths
from evenroad.world import World

PAIRS = 32
"""Number of even pairs of positions on the path that a batch joins, beside the corners that it cuts."""
MAX_BATCHES = 32
PATIENCE = 3
"""Number of batches without a gain after which the path counts as short."""
WORTH_WHILE = 2e-3
"""Least share of shortening that counts as a gain of a batch."""
LEAST = 1e-4
"""Least gain of a single cut, as a share of the cost of the path: motions for less are not checked."""
SIZES = 4
"""Corners are cut at their neighbours, then at a half, a quarter and an eighth of the way to them."""
ROUNDING = 1e-9
"""Share of a motion within which a position counts as its end."""
ROUNDING_OF_COSTS = 1e-12
_TINY = np.finfo(np.float64).tiny


def shortcut(world: World, path: Floats, cost: EdgeCost | None = None) -> tuple[Floats, int]:
    """Return a path that does not cost more, with new motions that are free in the world.

    Each batch joins positions on the path by straight motions: even pairs, drawn once for all, then positions on both
    sides of each corner.  Of the free motions that do not overlap it takes those of the largest gain.  At the end,
    unnecessary waypoints are dropped.  It draws no random numbers.  If the world has a strict check (`ValidatesPaths`),
    each new motion of the path passes it, too.

    `path`, (p, dim), p >= 2, has free motions; costs are lengths by default.  When the time is over, the best path so
    far is the answer.  The second return value is the number of motions checked, without strict checks.
    """
    work = _Shortcut(path, world, world.space.distance if cost is None else cost)
    try:
        work.shorten()
        work.drop_needless()
    except BudgetSpent:
        pass
    return work.path, work.checked


@dataclass(frozen=True)
class _Cuts:
    """Motions that join two positions on a path.

    A position is the number of a motion, (m,), and the `share` of it that lies before, (m,) in [0, 1].
    """

    first: Ints
    first_share: Floats
    last: Ints
    last_share: Floats

    def __getitem__(self, which: Ints | Bools | list[int]) -> _Cuts:
        return _Cuts(self.first[which], self.first_share[which], self.last[which], self.last_share[which])

    @property
    def positions(self) -> tuple[Floats, Floats]:
        """Where cuts begin and end, (m,) each: the number of the motion plus the share."""
        return self.first + self.first_share, self.last + self.last_share


class _Shortcut:
    """A path that becomes shorter."""

    def __init__(self, path: Floats, world: World, cost: EdgeCost) -> None:
        self.path, self.world, self.cost = path, world, cost
        self.length = self._total(path)
        self.checked = 0

    def shorten(self) -> None:
        """Take cuts until they gain nothing more."""
        idle = 0
        for number in range(MAX_BATCHES):
            before = self.length
            corners = _corner_cuts(self.path, 0.5 ** (number % SIZES))
            self._take(_together(corners, _even_cuts(self.path, self.world.space, number)), LEAST * before)
            idle = 0 if before - self.length >= WORTH_WHILE * before else idle + 1
            if idle == PATIENCE or len(self.path) == 2:
                return

    def drop_needless(self) -> None:
        """Drop waypoints between neighbours that can be joined at no higher cost."""
        before = 0
        while len(self.path) != before:
            before = len(self.path)
            self._take(_corner_cuts(self.path, 1.0), -ROUNDING_OF_COSTS * self.length)

    def _take(self, cuts: _Cuts, least: float) -> None:
        """Take the best free cuts that gain more than `least`, if the path costs no more with them."""
        a, b = self._at(cuts.first, cuts.first_share), self._at(cuts.last, cuts.last_share)
        gains = self._cost_between(cuts, a, b) - self.cost(a, b)
        worth = np.flatnonzero(gains > least)
        free = worth[self._free(a[worth], b[worth])]
        best = free[np.argsort(-gains[free], kind="stable")]
        chosen = best[_apart(cuts[best])]
        while len(chosen) and not (passed := self._confirmed(cuts[chosen], a[chosen], b[chosen])).all():
            # Others that overlapped with these may pass.
            best = best[~np.isin(best, chosen[~passed])]
            chosen = best[_apart(cuts[best])]
        if len(chosen):
            _, path = self._with(cuts[chosen], a[chosen], b[chosen])
            length = self._total(path)
            if length <= self.length * (1.0 + ROUNDING_OF_COSTS):
                self.path, self.length = path, length

    def _confirmed(self, cuts: _Cuts, a: Floats, b: Floats) -> Bools:
        """Return which of these cuts pass the strict check, with the parts of motions that they leave, (m,)."""
        look_at_clock()
        positions, path = self._with(cuts, a, b)
        begins, finishes = cuts.positions
        failed = np.zeros(len(path) - 1, dtype=np.bool_)
        # A part of a motion is another motion, whose states are tested elsewhere.
        (parts,) = np.nonzero(np.isin(positions[:-1], finishes) | np.isin(positions[1:], begins))
        failed[parts] = ~self._free(path[parts], path[parts + 1])
        if not failed.any():
            # In one call, from the first cut to the last one.
            uncertain = (positions[:-1] >= begins.min()) & (positions[1:] <= finishes.max())
            uncertain[parts] = True
            failed = ~confirmed(self.world, path, uncertain)
        touched = np.concatenate([positions[:-1][failed], positions[1:][failed]])
        return ~(np.isin(begins, touched) | np.isin(finishes, touched))

    def _free(self, a: Floats, b: Floats) -> Bools:
        """Return which motions are free, (m,)."""
        free = np.zeros(len(a), dtype=np.bool_)
        for rows in in_time(np.arange(len(a))):
            free[rows] = self.world.motion_valid(a[rows], b[rows])
            self.checked += len(rows)
        return free

    def _at(self, motions: Ints, shares: Floats) -> Floats:
        """Return the states at positions, (m, dim)."""
        return self.world.space.interpolate(self.path[motions], self.path[motions + 1], shares)

    def _cost_between(self, cuts: _Cuts, a: Floats, b: Floats) -> Floats:
        """Return what the path costs between the two positions of each cut, (m,)."""
        before = np.concatenate([[0.0], np.cumsum(self.cost(self.path[:-1], self.path[1:]))])
        whole = before[cuts.last] - before[cuts.first + 1]
        between: Floats = self.cost(a, self.path[cuts.first + 1]) + whole + self.cost(self.path[cuts.last], b)
        return between

    def _with(self, cuts: _Cuts, a: Floats, b: Floats) -> tuple[Floats, Floats]:
        """Return the positions and waypoints of the path with these cuts."""
        own = np.arange(len(self.path), dtype=np.float64)
        begins, finishes = cuts.positions
        left = ~((own[:, np.newaxis] > begins) & (own[:, np.newaxis] < finishes)).any(axis=1)
        states = np.concatenate([self.path[left], a, b])
        # A cut that begins or ends at a waypoint has the same position: the waypoint comes first, and is kept.
        positions, rows = np.unique(np.concatenate([own[left], begins, finishes]), return_index=True)
        return positions, states[rows]

    def _total(self, path: Floats) -> float:
        return float(np.sum(self.cost(path[:-1], path[1:])))


def _corner_cuts(path: Floats, share: float) -> _Cuts:
    """Return cuts of all corners at a share of both motions there."""
    first = np.arange(len(path) - 2)
    return _Cuts(first, np.full(len(first), 1.0 - share), first + 1, np.full(len(first), share))


def _even_cuts(path: Floats, space: Space, number: int) -> _Cuts:
    """Return the cuts of batch `number` between evenly spread positions of different motions."""
    lengths = motion_lengths(path, space)
    travelled = np.concatenate([[0.0], np.cumsum(lengths)])
    at = np.sort(cube_points(2)[number * PAIRS : (number + 1) * PAIRS], axis=1) * travelled[-1]
    motion = np.clip(np.searchsorted(travelled, at, side="right") - 1, 0, len(lengths) - 1)
    share = (at - travelled[motion]) / np.maximum(lengths[motion], ROUNDING * travelled[-1] + _TINY)
    share = np.where(share < ROUNDING, 0.0, np.where(share > 1.0 - ROUNDING, 1.0, share))
    cuts = _Cuts(motion[:, 0], share[:, 0], motion[:, 1], share[:, 1])
    return cuts[motion[:, 0] < motion[:, 1]]


def _together(some: _Cuts, others: _Cuts) -> _Cuts:
    return _Cuts(
        np.concatenate([some.first, others.first]),
        np.concatenate([some.first_share, others.first_share]),
        np.concatenate([some.last, others.last]),
        np.concatenate([some.last_share, others.last_share]),
    )


def _apart(cuts: _Cuts) -> list[int]:
    """Return which cuts do not overlap an earlier one of these."""
    taken: list[tuple[float, float]] = []
    rows = []
    begins, finishes = (each.tolist() for each in cuts.positions)
    for row, cut in enumerate(zip(begins, finishes, strict=True)):
        at = bisect_left(taken, cut)
        if (at == 0 or taken[at - 1][1] <= cut[0]) and (at == len(taken) or cut[1] <= taken[at][0]):
            taken.insert(at, cut)
            rows.append(row)
    return rows
