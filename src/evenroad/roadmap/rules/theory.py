"""The radius with a guarantee on the path's length (Chahine et al. 2025, section 3; Janson, Ichter and Pavone 2018)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_positive
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.roadmap.neighbours.find import flat_metric
from evenroad.roadmap.rules.radius import Radius
from evenroad.roadmap.rules.rule import Reach, plain
from evenroad.space import Space


@dataclass(frozen=True, kw_only=True)
class TheoryRadius:
    """``theory radius``: all pairs at most ``r = 2 alpha sqrt(d) D`` apart, D a bound of the l-infinity dispersion.

    With a path of enough clearance, the shortest one of the roadmap is then within a factor
    ``1 + 1 / (alpha - 1)`` of it.  The bound D is either the `dispersion` itself or ``2 star_discrepancy^(1/d)``: the
    dispersion is at most the d-th root of the discrepancy over *all* boxes (Niederreiter 1992), which is at most
    ``2^d`` times that over boxes at the origin.  Without the 2, as the paper could be read, it is false: the points
    (0, .375) and (.55, .975) leave a hole of .975 with a star discrepancy of .5.  In a space whose sides are not 1,
    ``sqrt(d)`` becomes the length of the diagonal.

    Parameters
    ----------
    alpha : float
        Above 1.
    star_discrepancy, dispersion : float
        Exactly one of the two, of the points in the unit cube, in (0, 1].

    Raises
    ------
    InvalidValue
        For other values; and from `edges`, where the radius is no less than the diameter of the space, so that it
        says nothing: in ten dimensions that is so for every set of a feasible size.
    """

    alpha: float
    star_discrepancy: float | None = None
    dispersion: float | None = None

    def __post_init__(self) -> None:
        if require_positive("alpha", self.alpha) <= 1:
            raise InvalidValue(f"alpha must be above 1, got {self.alpha!r}")
        if (self.star_discrepancy is None) == (self.dispersion is None):
            raise InvalidValue("give either star_discrepancy or dispersion")
        name, value = self._bound()
        if require_positive(name, value) > 1:
            raise InvalidValue(f"{name} must be at most 1, got {value!r}")

    def __str__(self) -> str:
        name, value = self._bound()
        return f"theory radius alpha={plain(self.alpha)} {name}={plain(value)}"

    def radius(self, space: Space) -> float:
        """Return r in the units of the space, or raise; see the class."""
        metric = flat_metric(space)
        if metric is None:
            raise NotAvailable(
                f"the theory radius needs a space whose metric is flat, not {type(space).__name__}"
            )
        d = space.cube_dim
        name, value = self._bound()
        bound = value if name == "dispersion" else 2 * value ** (1 / d)
        # The map from the cube is affine here; twice the way to the middle is a side, also where it wraps.
        middle = 0.5 * np.eye(d)
        sides = 2 * space.distance(space.from_cube(np.zeros((d, d))), space.from_cube(middle))
        radius = 2 * self.alpha * bound * float(np.sqrt(np.sum(sides**2)))
        diameter = float(np.sqrt(np.sum(np.where(metric.wrapping, sides / 2, sides) ** 2)))
        if radius >= diameter:
            raise InvalidValue(
                f"the {self} is {radius:.4g} here, no less than the diameter {diameter:.4g} of the space: it says"
                " nothing for so few points; take KNearest, or Complete() if every pair is meant"
            )
        return radius

    def edges(
        self, q: npt.NDArray[np.float64], space: Space | None = None, *, ends: int = 0
    ) -> npt.NDArray[np.int32]:
        """Return the pairs within the radius; see :class:`Rule`."""
        if space is None:
            raise InvalidValue("the theory radius depends on the space: give one")
        return Radius(self.radius(space)).edges(q, space)

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return that an end is joined to all within the radius; see :class:`Rule`."""
        return Reach(radius=self.radius(space))

    def _bound(self) -> tuple[str, float]:
        if self.dispersion is not None:
            return "dispersion", self.dispersion
        return "star_discrepancy", self.star_discrepancy  # type: ignore[return-value]
