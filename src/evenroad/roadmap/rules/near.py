"""The protocol of connection rules, and rules by a number of neighbours or a distance.

The rule is part of every result: the same points give 15 % or 62 % success under two rules.  Candidates are all other
configurations; ties go to the lower index, and start and goals come last, except for `KEarlier`, where they come first.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints32
from evenroad._checks import require_count, require_positive
from evenroad.roadmap.neighbours import nearest, within
from evenroad.space import Space


@dataclass(frozen=True)
class Reach:
    """How a start or goal is joined to milestones: to its `k` nearest ones, or to those within `radius`.

    If both are None: to all.
    """

    k: int | None = None
    radius: float | None = None


class Rule(Protocol):
    """Chooses candidate edges among configurations, before anything is checked; ``str()`` is its name."""

    def edges(self, q: Floats, space: Space | None = None, *, terminals: int = 0) -> Ints32:
        """Return the pairs i < j of configurations `q`, (n, dim), to try, (m, 2), in ascending order, each once.

        Distances are those of the space, by default Euclidean.  The last `terminals` rows are starts and goals.  Rules
        that depend on an order of insertion take them as the first; in all others they come last among ties.
        """

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return how a start or goal is joined to a finished roadmap of this number of milestones."""


def ascending(pairs: npt.NDArray[np.integer], n: int) -> Ints32:
    """Return the distinct unordered pairs of numbers below `n`, smaller first, sorted, as int32 (m, 2)."""
    if not len(pairs):
        return np.empty((0, 2), dtype=np.int32)
    keys = np.unique(pairs.min(axis=1).astype(np.int64) * n + pairs.max(axis=1))
    return np.stack([keys // n, keys % n], axis=1).astype(np.int32)


def plain(number: float) -> str:
    """Return a number in the fewest digits that read back as the same number."""
    short = f"{number:g}"
    return short if float(short) == number else repr(number)


@dataclass(frozen=True)
class Complete(Rule):
    """``complete``: every pair is an edge; O(n^2) of them."""

    def __str__(self) -> str:
        return "complete"

    def edges(self, q: Floats, space: Space | None = None, *, terminals: int = 0) -> Ints32:
        """Return all pairs; see :class:`Rule`."""
        return np.stack(np.triu_indices(len(q), k=1), axis=1).astype(np.int32)

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return that a terminal is joined to all milestones; see :class:`Rule`."""
        return Reach()


@dataclass(frozen=True)
class _ByNumber(Rule):
    """A rule with a number of neighbours."""

    k: int = 10
    which: ClassVar[str]

    def __post_init__(self) -> None:
        require_count("k", self.k)

    def __str__(self) -> str:
        return f"k={self.k} {self.which}"

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return that a terminal is joined to its k nearest; see :class:`Rule`."""
        return Reach(k=self.k)


@dataclass(frozen=True)
class KNearest(_ByNumber):
    """``k symmetrised``: edge i-j iff i is among the k nearest of j, or j among those of i."""

    which = "symmetrised"

    def edges(self, q: Floats, space: Space | None = None, *, terminals: int = 0) -> Ints32:
        """Return the pairs of each with its k nearest; see :class:`Rule`."""
        return ascending(_arcs(nearest(q, self.k, space)), len(q))


@dataclass(frozen=True)
class KMutual(_ByNumber):
    """``k mutual``: edge i-j iff i is among the k nearest of j, and j among those of i."""

    which = "mutual"

    def edges(self, q: Floats, space: Space | None = None, *, terminals: int = 0) -> Ints32:
        """Return the pairs that are near each other both ways; see :class:`Rule`."""
        n = len(q)
        arcs = _arcs(nearest(q, self.k, space)).astype(np.int64)
        there = arcs[:, 0] * n + arcs[:, 1]
        back = arcs[:, 1] * n + arcs[:, 0]
        return ascending(arcs[np.isin(there, back)], n)


@dataclass(frozen=True)
class KEarlier(_ByNumber):
    """``k earlier``: each configuration is joined to its k nearest among those inserted before it.

    Start and goal are inserted first, then the milestones by their index: the order of OMPL's PRM, whose
    default strategy this is (k = 10).
    """

    which = "earlier"

    def edges(self, q: Floats, space: Space | None = None, *, terminals: int = 0) -> Ints32:
        """Return the pairs of each with its k nearest earlier ones; see :class:`Rule`."""
        n = len(q)
        inserted = np.concatenate([np.arange(n - terminals, n), np.arange(n - terminals)])
        arcs = _arcs(nearest(q[inserted], self.k, space, earlier=True))
        return ascending(inserted[arcs], n)


def _arcs(neighbours: Ints32) -> Ints32:
    """Return (row, neighbour) for every entry that is not -1, shape (m, 2)."""
    n, k = neighbours.shape
    arcs = np.stack([np.repeat(np.arange(n, dtype=np.int32), k), neighbours.ravel()], axis=1)
    return arcs[arcs[:, 1] >= 0]


@dataclass(frozen=True)
class Radius(Rule):
    """``radius``: edge i-j iff the distance is at most r, in the units of the space (Algorithm 1's r_N)."""

    r: float

    def __post_init__(self) -> None:
        require_positive("connection radius", self.r)

    def __str__(self) -> str:
        return f"radius={plain(self.r)}"

    def edges(self, q: Floats, space: Space | None = None, *, terminals: int = 0) -> Ints32:
        """Return the pairs within the radius; see :class:`Rule`."""
        return ascending(within(q, self.r, space), len(q))

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return that a terminal is joined to all within the radius; see :class:`Rule`."""
        return Reach(radius=self.r)
