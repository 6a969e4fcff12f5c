"""Measure: one L2 discrepancy, squared, or rooted and with its gradient."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue, shown
from evenroad.points.measures import l2
from evenroad.points.pointset import as_unit_points


@dataclass(frozen=True)
class Measure:
    """One L2 discrepancy of points in the unit cube; small is even.  O(n^2 d) time, O(n d) memory.

    ``squared`` is the value of the closed form, ``rooted`` its square root: the discrepancy itself.  Where two points
    share a coordinate most measures have a kink, and the gradient is a one-sided one.

    `terms` gives the parts of the closed form (:mod:`evenroad.points.measures.l2`, with the sources); `weighted` says
    whether coordinate weights are defined, `periodic` and `reflectable` whether a shift modulo 1 of all points, or
    x -> 1 - x in a coordinate, leaves it as it is.
    """

    name: str
    terms: Callable[[Floats, Floats], l2.ProductTerms]
    weighted: bool = True
    periodic: bool = False
    reflectable: bool = False
    least_points = 1

    def squared(self, points: object, weights: npt.ArrayLike | None = None) -> float:
        """Return the squared discrepancy of points, (n, d) in [0, 1), n >= 1.

        `weights`, (d,) >= 0, are those of the parts of the coordinates' factors that are not constant: 0 ignores a
        coordinate.  Bad points or weights, or weights of a measure without, are an InvalidValue.
        """
        return self._squared(*self._checked(points, weights), want_gradient=False)[0]

    def rooted(self, points: object, weights: npt.ArrayLike | None = None) -> float:
        """Return the discrepancy, the square root of :meth:`squared`; same parameters and errors."""
        return math.sqrt(self.squared(points, weights))

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
        """Return the squared measure, at least 0, and its gradient, (d, n), or zeros where it is not wanted."""
        n = columns.shape[1]
        terms = self.terms(columns, weights)
        products = terms.linear.prod(axis=0)
        sums, gradient = l2.pair_sums(columns, terms.pairs, want_gradient)
        # The parts nearly cancel: taken point by point the differences are small before they are added up, which
        # keeps digits that the textbook order of the sum loses for large n.
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
