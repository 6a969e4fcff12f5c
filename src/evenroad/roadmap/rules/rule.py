"""What a connection rule is.

The rule is part of every result: the same points give 15 % or 62 % success under two different rules.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from evenroad.space import Space


@dataclass(frozen=True)
class Reach:
    """How one more configuration is joined to milestones that are there already.

    Attributes
    ----------
    k : int or None
        To this many nearest ones.
    radius : float or None
        To those at most this far, in the units of the space.  With both None: to all.
    """

    k: int | None = None
    radius: float | None = None


class Rule(Protocol):
    """Chooses candidate edges among configurations, before anything is checked; ``str()`` is its name."""

    def edges(
        self, q: npt.NDArray[np.float64], space: Space | None = None, *, ends: int = 0
    ) -> npt.NDArray[np.int32]:
        """Return the pairs i < j to try, shape (m, 2), in ascending order, each once.

        Parameters
        ----------
        q : ndarray, shape (n, dim)
            Configurations: milestones, then `ends` starts and goals.
        space : Space, optional
            Whose metric counts; default: the Euclidean one.
        ends : int
            How many of the last rows are starts and goals.  Rules that depend on an order of insertion take
            them as the first; for all others they come last among ties.
        """
        ...

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return how a start or goal is joined to a finished roadmap of so many milestones."""
        ...


def ascending(pairs: npt.NDArray[np.integer], n: int) -> npt.NDArray[np.int32]:
    """Return the distinct unordered pairs of numbers below `n`, smaller first, sorted, as int32 (m, 2)."""
    if not len(pairs):
        return np.empty((0, 2), dtype=np.int32)
    keys = np.unique(pairs.min(axis=1).astype(np.int64) * n + pairs.max(axis=1))
    return np.stack([keys // n, keys % n], axis=1).astype(np.int32)


def plain(number: float) -> str:
    """Return a number in the fewest digits that read back as the same number."""
    short = f"{number:g}"
    return short if float(short) == number else repr(number)


def manifold_dimension(q: npt.NDArray[np.float64], space: Space | None) -> int:
    """Return the dimension d of the formulas: that of the space's cube, else the number of coordinates."""
    return q.shape[1] if space is None else space.cube_dim
