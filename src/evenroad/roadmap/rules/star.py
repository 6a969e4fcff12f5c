"""The rules of PRM* (Karaman and Frazzoli 2011): radius and k as functions of the number of milestones.

The number n counts all configurations that are joined, start and goal included; d is the dimension of the space.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_count, require_positive
from evenroad.roadmap.rules.k_nearest import KNearest
from evenroad.roadmap.rules.radius import Radius
from evenroad.roadmap.rules.rule import Reach, manifold_dimension, plain
from evenroad.space import Space


@dataclass(frozen=True)
class RadiusStar:
    """``radius*``: all pairs at most ``r = gamma (log n / n)^(1/d)`` apart.

    Parameters
    ----------
    gamma : float
        In the units of the space, > 0; asymptotically optimal above :func:`prm_star_gamma`.
    """

    gamma: float

    def __post_init__(self) -> None:
        require_positive("gamma", self.gamma)

    def __str__(self) -> str:
        return f"radius* gamma={plain(self.gamma)}"

    def radius(self, n: int, d: int) -> float:
        """Return r for n >= 2 configurations in d dimensions; 1 configuration has no log to speak of."""
        n = max(n, 2)
        return self.gamma * (math.log(n) / n) ** (1 / d)

    def edges(
        self, q: npt.NDArray[np.float64], space: Space | None = None, *, ends: int = 0
    ) -> npt.NDArray[np.int32]:
        """Return the pairs within the radius of this many; see :class:`Rule`."""
        return Radius(self.radius(len(q), manifold_dimension(q, space))).edges(q, space)

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return that an end is joined to all within the radius; see :class:`Rule`."""
        return Reach(radius=self.radius(milestones, space.cube_dim))


@dataclass(frozen=True)
class KStar:
    """``k*``: the ``k = ceil(e (1 + 1/d) log n)`` nearest, symmetrised."""

    def __str__(self) -> str:
        return "k*"

    def k(self, n: int, d: int) -> int:
        """Return k for n >= 2 configurations in d dimensions."""
        return math.ceil(math.e * (1 + 1 / d) * math.log(max(n, 2)))

    def edges(
        self, q: npt.NDArray[np.float64], space: Space | None = None, *, ends: int = 0
    ) -> npt.NDArray[np.int32]:
        """Return the symmetrised pairs for the k of this many; see :class:`Rule`."""
        return KNearest(self.k(len(q), manifold_dimension(q, space))).edges(q, space)

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return that an end is joined to its k nearest; see :class:`Rule`."""
        return Reach(k=self.k(milestones, space.cube_dim))


def prm_star_gamma(d: int, free_measure: float) -> float:
    """Return the gamma above which PRM* is asymptotically optimal (Karaman and Frazzoli 2011, Algorithm 4).

    It is ``2 (1 + 1/d)^(1/d) (free_measure / unit_ball)^(1/d)``, with the measure of the free space in the
    units of the metric to the power d, and that of the unit ball of d dimensions.
    """
    d = require_count("d", d)
    measure = require_positive("free measure", free_measure)
    unit_ball = math.pi ** (d / 2) / math.gamma(d / 2 + 1)
    return 2 * ((1 + 1 / d) * measure / unit_ball) ** (1 / d)
