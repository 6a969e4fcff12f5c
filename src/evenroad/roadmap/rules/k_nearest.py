"""Rules by number of neighbours: symmetrised, mutual, earlier.

Candidates are all configurations but itself; ties go to the lower index, and start and goal come last, except for
`KEarlier`, where they are the first.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_count
from evenroad.roadmap.neighbours import nearest
from evenroad.roadmap.rules.rule import Reach, ascending
from evenroad.space import Space


@dataclass(frozen=True)
class KNearest:
    """``k symmetrised``: edge i-j iff i is among the k nearest of j, or j among those of i."""

    k: int = 10

    def __post_init__(self) -> None:
        require_count("k", self.k)

    def __str__(self) -> str:
        return f"k={self.k} symmetrised"

    def edges(
        self, q: npt.NDArray[np.float64], space: Space | None = None, *, ends: int = 0
    ) -> npt.NDArray[np.int32]:
        """Return the symmetrised k-nearest pairs; see :class:`Rule`."""
        return ascending(_arcs(nearest(q, self.k, space)), len(q))

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return that an end is joined to its k nearest; see :class:`Rule`."""
        return Reach(k=self.k)


@dataclass(frozen=True)
class KMutual:
    """``k mutual``: edge i-j iff i is among the k nearest of j, and j among those of i."""

    k: int = 10

    def __post_init__(self) -> None:
        require_count("k", self.k)

    def __str__(self) -> str:
        return f"k={self.k} mutual"

    def edges(
        self, q: npt.NDArray[np.float64], space: Space | None = None, *, ends: int = 0
    ) -> npt.NDArray[np.int32]:
        """Return the pairs that are near each other both ways; see :class:`Rule`."""
        n = len(q)
        arcs = _arcs(nearest(q, self.k, space)).astype(np.int64)
        there = arcs[:, 0] * n + arcs[:, 1]
        back = arcs[:, 1] * n + arcs[:, 0]
        return ascending(arcs[np.isin(there, back)], n)

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return that an end is joined to its k nearest; see :class:`Rule`."""
        return Reach(k=self.k)


@dataclass(frozen=True)
class KEarlier:
    """``k earlier``: each configuration is joined to its k nearest among those inserted before it.

    Start and goal are inserted first, then the milestones by their index: the order of OMPL's PRM, whose
    default strategy this is (k = 10).
    """

    k: int = 10

    def __post_init__(self) -> None:
        require_count("k", self.k)

    def __str__(self) -> str:
        return f"k={self.k} earlier"

    def edges(
        self, q: npt.NDArray[np.float64], space: Space | None = None, *, ends: int = 0
    ) -> npt.NDArray[np.int32]:
        """Return the pairs of each configuration with its k nearest earlier ones; see :class:`Rule`."""
        n = len(q)
        inserted = np.concatenate([np.arange(n - ends, n), np.arange(n - ends)])
        arcs = _arcs(nearest(q[inserted], self.k, space, earlier=True))
        return ascending(inserted[arcs], n)

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return that an end that comes late is joined to its k nearest; see :class:`Rule`."""
        return Reach(k=self.k)


def _arcs(neighbours: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
    """Return (row, neighbour) for every entry that is not -1, shape (m, 2)."""
    n, k = neighbours.shape
    arcs = np.stack([np.repeat(np.arange(n, dtype=np.int32), k), neighbours.ravel()], axis=1)
    return arcs[arcs[:, 1] >= 0]
