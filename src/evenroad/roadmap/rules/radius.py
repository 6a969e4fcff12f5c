"""The rule by a fixed distance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_positive
from evenroad.roadmap.neighbours import within
from evenroad.roadmap.rules.rule import Reach, ascending, plain
from evenroad.space import Space


@dataclass(frozen=True)
class Radius:
    """``radius``: edge i-j iff the distance is at most r, in the units of the space (Algorithm 1's r_N)."""

    r: float

    def __post_init__(self) -> None:
        require_positive("connection radius", self.r)

    def __str__(self) -> str:
        return f"radius={plain(self.r)}"

    def edges(
        self, q: npt.NDArray[np.float64], space: Space | None = None, *, ends: int = 0
    ) -> npt.NDArray[np.int32]:
        """Return the pairs within the radius; see :class:`Rule`."""
        return ascending(within(q, self.r, space), len(q))

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return that an end is joined to all within the radius; see :class:`Rule`."""
        return Reach(radius=self.r)
