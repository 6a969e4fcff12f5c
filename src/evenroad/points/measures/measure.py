"""Measure: one L2 discrepancy, squared, or rooted and with its gradient."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._checks import require_positive
from evenroad._native.points import star_discrepancy as largest_deviation
from evenroad.errors import InvalidValue, NotAvailable, shown
from evenroad.points.measures import l2
from evenroad.points.pointset import as_unit_points


@dataclass(frozen=True)
class Measure:
    """One L2 discrepancy of points in the unit cube; small is even.  O(n^2 d) time, O(n d) memory.

    ``squared`` is the closed form, ``rooted`` its square root, the discrepancy itself.  If two points share a
    coordinate, most gradients are one-sided.  `terms` returns the parts of the closed form.  `weighted` says whether
    it takes coordinate weights.  `periodic` says whether a shift modulo 1 changes nothing, and `reflectable` whether
    x -> 1 - x in a coordinate does.
    """

    name: str
    terms: Callable[[Floats, Floats], l2.ProductTerms]
    weighted: bool = True
    periodic: bool = False
    reflectable: bool = False
    least_points = 1

    def squared(self, points: object, weights: npt.ArrayLike | None = None) -> float:
        """Return the squared discrepancy of points, (n, d) in [0, 1), n >= 1, else InvalidValue.

        `weights`, (d,) >= 0, weight the coordinates: 0 ignores one.
        """
        return self._squared(*self._checked(points, weights), want_gradient=False)[0]

    def rooted(self, points: object, weights: npt.ArrayLike | None = None) -> float:
        """Return the discrepancy, the square root of :meth:`squared`; same parameters and errors."""
        return math.sqrt(self.squared(points, weights))

    def terms_of(self, points: object) -> tuple[Floats, l2.ProductTerms]:
        """Return the points as columns, (d, n), and the parts of the closed form there; errors as :meth:`squared`."""
        columns, weights = self._checked(points, None)
        return columns, self.terms(columns, weights)

    def of_columns(self, columns: Floats, weights: Floats | None = None) -> tuple[float, Floats]:
        """Return the rooted measure and its gradient, (d, n), at checked points of shape (d, n): for inner loops.

        Where the measure is 0 the root has no gradient; zeros are returned.
        """
        gamma = np.ones(len(columns)) if weights is None else weights
        squared, gradient = self._squared(columns, gamma, want_gradient=True)
        root = math.sqrt(squared)
        if root == 0.0:
            return 0.0, np.zeros_like(gradient)
        gradient *= 0.5 / root
        return root, gradient

    def _squared(self, columns: Floats, weights: Floats, want_gradient: bool) -> tuple[float, Floats]:
        """Return the squared measure, at least 0, and its gradient, (d, n), or zeros if it is not wanted."""
        n = columns.shape[1]
        terms = self.terms(columns, weights)
        products = terms.linear.prod(axis=0)
        found = l2.pair_sums(columns, terms.pairs, want_gradient)
        sums, gradient = found.sums, found.gradient
        # The parts nearly cancel.  Differences per point keep digits that the textbook order loses for large n.
        value = float(np.mean((sums / n - products) - (products - terms.constant)))
        if want_gradient:
            gradient /= n * n
            gradient -= (2.0 / n) * (products / terms.linear) * terms.linear_slope
        return max(value, 0.0), gradient

    def _checked(self, points: object, weights: npt.ArrayLike | None) -> tuple[Floats, Floats]:
        coordinates = as_unit_points(points)
        n, d = coordinates.shape
        if n == 0:
            raise InvalidValue(f"{self.name} needs at least one point, got an array of shape (0, {d})")
        columns = np.ascontiguousarray(coordinates.T)
        if weights is None:
            return columns, np.ones(d)
        if not self.weighted:
            raise InvalidValue(f"{self.name} takes no coordinate weights: its factors have no constant part")
        try:
            gamma = np.asarray(weights, dtype=np.float64)
        except (TypeError, ValueError):
            gamma = np.array(np.nan)
        if gamma.shape != (d,) or not np.isfinite(gamma).all() or (gamma < 0).any():
            raise InvalidValue(f"weights must be {d} finite numbers >= 0, got {shown(weights)}")
        return columns, gamma

    def __str__(self) -> str:
        return self.name


MEASURES: dict[str, Measure] = {
    measure.name: measure
    for measure in (
        Measure("star", l2.star, weighted=False),
        Measure("hickernell", l2.hickernell),
        Measure("centred", l2.centred, reflectable=True),
        Measure("wrap_around", l2.wrap_around, periodic=True, reflectable=True),
        Measure("mixture", l2.mixture, reflectable=True),
        Measure("symmetric", l2.symmetric, reflectable=True),
        Measure("average_squared", l2.average_squared, weighted=False, reflectable=True),
    )
}
"""The L2 discrepancies by name."""


STAR_BUDGET = 1e10
"""Default limit on the estimated work: about a minute."""


def star_discrepancy(points: object, budget: float = STAR_BUDGET) -> float:
    """Return the exact star discrepancy of points, (n, d) in [0, 1), n >= 1.

    The maximum is at a box [0, y) whose upper sides pass through points or are 1, with or without the points on those
    sides (Niederreiter 1972; Gnewuch, Srivastav and Winzen 2009).  Branch and bound enumerates them by coordinate.
    Raises NotAvailable if the estimated work, n^d / d!, exceeds `budget`.  The default allows n = 140000, 3900, 700,
    260 and 139 for d = 2 .. 6.
    """
    coordinates = as_unit_points(points)
    n, d = coordinates.shape
    if n == 0:
        raise InvalidValue(f"star_discrepancy needs at least one point, got an array of shape (0, {d})")
    limit = require_positive("budget", budget)
    log_work = d * math.log(n) - math.lgamma(d + 1)
    if log_work > math.log(limit):
        raise NotAvailable(
            f"the exact star discrepancy of n={n} points in d={d} takes about 10^{log_work / math.log(10):.0f}"
            f" steps, the budget is {limit:.0e}: use fewer points, a larger budget, or the L2 star discrepancy"
        )
    by_last = np.argsort(coordinates[:, -1], kind="stable")
    return largest_deviation(np.ascontiguousarray(coordinates[by_last].T))
