"""The rule that tries every pair."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad.roadmap.rules.rule import Reach
from evenroad.space import Space


@dataclass(frozen=True)
class Complete:
    """``complete``: every pair is an edge; O(n^2) of them."""

    def __str__(self) -> str:
        return "complete"

    def edges(
        self, q: npt.NDArray[np.float64], space: Space | None = None, *, ends: int = 0
    ) -> npt.NDArray[np.int32]:
        """Return all pairs; see :class:`Rule`."""
        return np.stack(np.triu_indices(len(q), k=1), axis=1).astype(np.int32)

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return that an end is joined to all milestones; see :class:`Rule`."""
        return Reach()
