"""Connection rules: which pairs of milestones a roadmap tries to join.

The rule is part of every result: the same points give 15 % or 62 % success under two different rules.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_count, require_positive
from evenroad.roadmap.kdtree import k_nearest, pairs_within


class Rule(Protocol):
    """Chooses candidate edges among configurations, before anything is checked."""

    def edges(self, milestones: npt.NDArray[np.float64]) -> npt.NDArray[np.int32]:
        """Return the pairs i < j to try, shape (m, 2), in ascending order, each once."""
        ...


@dataclass(frozen=True)
class KNearest:
    """``k symmetrised``: edge i-j iff i is among the k nearest of j, or j among those of i.

    Candidates are all other milestones; ties go to the lower index, and start and goal come last.
    """

    k: int = 10

    def __post_init__(self) -> None:
        require_count("k", self.k)

    def __str__(self) -> str:
        return f"k={self.k} symmetrised"

    def edges(self, milestones: npt.NDArray[np.float64]) -> npt.NDArray[np.int32]:
        """Return the symmetrised k-nearest pairs; see :class:`Rule`."""
        nearest = k_nearest(milestones, self.k)
        n, k = nearest.shape
        own = np.repeat(np.arange(n, dtype=np.int32), k)
        return _ascending(np.stack([own, nearest.ravel()], axis=1), n)


@dataclass(frozen=True)
class Radius:
    """``radius``: edge i-j iff the distance is at most r, in the units of the space (Algorithm 1's r_N)."""

    r: float

    def __post_init__(self) -> None:
        require_positive("connection radius", self.r)

    def __str__(self) -> str:
        return f"radius={self.r:g}"

    def edges(self, milestones: npt.NDArray[np.float64]) -> npt.NDArray[np.int32]:
        """Return the pairs within the radius; see :class:`Rule`."""
        return _ascending(pairs_within(milestones, self.r), len(milestones))


def _ascending(pairs: npt.NDArray[np.int32], n: int) -> npt.NDArray[np.int32]:
    """Return the distinct unordered pairs, smaller index first, sorted."""
    keys = (
        np.unique(pairs.min(axis=1).astype(np.int64) * n + pairs.max(axis=1)) if len(pairs) else pairs[:, 0]
    )
    return np.stack([keys // n, keys % n], axis=1).astype(np.int32) if n else np.empty((0, 2), dtype=np.int32)
