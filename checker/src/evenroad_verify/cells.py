"""Cells: boxes of the ranges of some joints, which answers of a certificate halve, block or leave open."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad_verify.errors import Bools, Floats, Ints, demand

WHOLE = 1 << 24
"""A range in units of the smallest side that a cell may have."""
OPEN = 0
"""Answer of a cell of which nothing is claimed."""
MOST_PAIRS, MOST_NEIGHBOURS = 1 << 25, 1 << 22
"""Pairs of cells that are looked at, and of neighbours among them, at most."""
_NEAR = 1e-3
"""How near a cell is to a state that counts as in it, in units."""
_AT_ONCE = 1 << 20


@dataclass(frozen=True)
class Ranges:
    """Ranges of some columns of a configuration [rad or m]; endless ones are one turn, whose ends meet."""

    columns: Ints
    low: Floats
    high: Floats
    endless: Bools

    def units(self, q: Floats) -> Floats:
        """Return where configurations, (n, dim), are in the ranges: (n, columns)."""
        at = (q[:, self.columns] - self.low) / (self.high - self.low) * WHOLE
        return np.where(self.endless, np.mod(at, WHOLE), at)


@dataclass(frozen=True)
class Cells:
    """Leaves of a tree: lower corners and sides, (n, columns), in units, and the answer of each."""

    ranges: Ranges
    low: Ints
    side: Ints
    answer: Ints

    def middles(self) -> tuple[Floats, Floats]:
        """Return middles and half sides [rad or m]."""
        scale = (self.ranges.high - self.ranges.low) / WHOLE
        return self.ranges.low + (self.low + 0.5 * self.side) * scale, 0.5 * self.side * scale

    def holding(self, q: Floats) -> Bools:
        """Return which cells hold a configuration, (dim,), their sides included."""
        at = self.ranges.units(q[None])
        # A turn ends where it begins.
        turns = np.where(self.ranges.endless, WHOLE, 0) * np.array([-1, 0, 1])[:, None]
        places = (at + turns)[:, None]
        inside = (places >= self.low - _NEAR) & (places <= self.low + self.side + _NEAR)
        return np.asarray(inside.any(axis=0).all(axis=1))


def cells_of(ranges: Ranges, answers: Ints) -> Cells:
    """Return the leaves of a tree that answers make: 1 to K halve a cell along a column, others end it."""
    axes = len(ranges.columns)
    low, side = np.zeros((1, axes), np.int64), np.full((1, axes), WHOLE)
    taken, found = 0, []
    while len(low):
        demand(taken + len(low) <= len(answers), "a cell has no answer")
        answer = answers[taken : taken + len(low)]
        taken += len(low)
        halved = (answer > OPEN) & (answer <= axes)
        found.append((low[~halved], side[~halved], answer[~halved]))
        rows, along = np.arange(int(halved.sum())), answer[halved] - 1
        low, side = low[halved], side[halved]
        side[rows, along] //= 2
        demand((side > 0).all(), "a cell is halved too often")
        low, side = np.repeat(low, 2, axis=0), np.repeat(side, 2, axis=0)
        low[2 * rows + 1, along] += side[2 * rows, along]
    demand(taken == len(answers), "there are answers without a cell")
    return Cells(ranges, *(np.concatenate(each) for each in zip(*found, strict=True)))


def reached(cells: Cells, start: Bools) -> Bools:
    """Return which open cells are joined to some by faces: a path that meets no blocked cell stays in them."""
    is_open = cells.answer == OPEN
    rows, budget = np.flatnonzero(is_open), [MOST_PAIRS, MOST_NEIGHBOURS]
    pairs = [_faces(cells, rows, axis, budget) for axis in range(cells.low.shape[1])]
    one, two = (np.concatenate([each[i] for each in pairs] + [each[1 - i] for each in pairs]) for i in (0, 1))
    order = np.argsort(one, kind="stable")
    two, first = two[order], np.searchsorted(one[order], np.arange(len(is_open) + 1))
    seen = start & is_open
    frontier = np.flatnonzero(seen)
    while len(frontier):
        count = first[frontier + 1] - first[frontier]
        beside = two[np.repeat(first[frontier] - np.cumsum(count) + count, count) + np.arange(count.sum())]
        frontier = np.unique(beside[~seen[beside]])
        seen[frontier] = True
    return np.asarray(seen)


def _faces(cells: Cells, rows: Ints, axis: int, budget: list[int]) -> tuple[Ints, Ints]:
    """Return pairs of cells of some rows, of which the first one ends along an axis where the second one begins."""
    low, high = cells.low[rows], cells.low[rows] + cells.side[rows]
    begins = rows[np.argsort(low[:, axis], kind="stable")]
    ends = high[:, axis] % WHOLE if cells.ranges.endless[axis] else high[:, axis]
    first, last = (np.searchsorted(cells.low[begins, axis], ends, side=side) for side in ("left", "right"))
    count, found = last - first, [(rows[:0], rows[:0])]
    budget[0] -= int(count.sum())
    demand(budget[0] >= 0, "too many cells lie side by side")
    others = [each for each in range(cells.low.shape[1]) if each != axis]
    for some in np.array_split(np.arange(len(rows)), 1 + int(count.sum()) // _AT_ONCE):
        one = np.repeat(rows[some], count[some])
        within = np.arange(len(one)) - np.repeat(np.cumsum(count[some]) - count[some], count[some])
        two = begins[np.repeat(first[some], count[some]) + within]
        begin = np.maximum(cells.low[one], cells.low[two])
        end = np.minimum(cells.low[one] + cells.side[one], cells.low[two] + cells.side[two])
        meet = (begin < end)[:, others].all(axis=1)
        budget[1] -= int(meet.sum())
        demand(budget[1] >= 0, "too many cells are neighbours")
        found.append((one[meet], two[meet]))
    return np.concatenate([each[0] for each in found]), np.concatenate([each[1] for each in found])
