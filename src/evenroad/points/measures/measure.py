"""Measure: one L2 discrepancy, as a value or with its gradient, squared or rooted."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._checks import require_known
from evenroad.errors import InvalidValue, shown
from evenroad.points.measures import l2
from evenroad.points.measures.l2 import ProductTerms
from evenroad.points.pointset import as_unit_points


@dataclass(frozen=True)
class Measure:
    """One L2 discrepancy of points in the unit cube; small is even.  O(n^2 d) time, O(n d) memory.

    ``squared`` is the value of the closed form, ``rooted`` its square root: the discrepancy itself.

    Attributes
    ----------
    name : str
        Its name in expressions and tables.
    title : str
        What it is, and its source.
    terms : callable
        ``terms(columns, weights)``: the parts of the closed form at points of shape (d, n).
    weighted : bool
        Whether coordinate weights are defined: its factors are 1 + weight * something.
    periodic : bool
        Whether a shift modulo 1 leaves it as it is.
    reflectable : bool
        Whether reflecting a coordinate, x -> 1 - x, leaves it as it is.
    """

    name: str
    title: str
    terms: Callable[[Floats, Floats], ProductTerms]
    weighted: bool = True
    periodic: bool = False
    reflectable: bool = False

    def squared(self, points: object, weights: npt.ArrayLike | None = None) -> float:
        """Return the squared discrepancy.

        Parameters
        ----------
        points : array_like or PointSet, shape (n, d)
            Coordinates in [0, 1), n >= 1.
        weights : array_like, shape (d,), optional
            Weight >= 0 of every coordinate: it multiplies the part of the coordinate's factor that is not
            constant, so 0 ignores the coordinate and 1, the default, is the plain measure.

        Raises
        ------
        InvalidValue
            For no points, bad coordinates, bad weights, or weights of a measure that has none.
        """
        columns, gamma = self._checked(points, weights)
        return squared_of_columns(self, columns, gamma, want_gradient=False)[0]

    def rooted(self, points: object, weights: npt.ArrayLike | None = None) -> float:
        """Return the discrepancy, the square root of :meth:`squared`; same parameters and errors."""
        return math.sqrt(self.squared(points, weights))

    def squared_with_gradient(
        self, points: object, weights: npt.ArrayLike | None = None
    ) -> tuple[float, Floats]:
        """Return the squared discrepancy and its gradient, shape (n, d); parameters as :meth:`squared`.

        Where two points share a coordinate most measures have a kink: the gradient is a one-sided one there.
        """
        columns, gamma = self._checked(points, weights)
        value, gradient = squared_of_columns(self, columns, gamma, want_gradient=True)
        return value, np.ascontiguousarray(gradient.T)

    def rooted_with_gradient(
        self, points: object, weights: npt.ArrayLike | None = None
    ) -> tuple[float, Floats]:
        """Return the discrepancy and its gradient, shape (n, d); parameters as :meth:`squared`."""
        columns, gamma = self._checked(points, weights)
        value, gradient = rooted_of_columns(self, columns, gamma)
        return value, np.ascontiguousarray(gradient.T)

    def __str__(self) -> str:
        return self.name

    def _checked(self, points: object, weights: npt.ArrayLike | None) -> tuple[Floats, Floats]:
        coordinates = as_unit_points(points)
        n, d = coordinates.shape
        if n == 0:
            raise InvalidValue(f"{self.name} needs at least one point, got an array of shape (0, {d})")
        return np.ascontiguousarray(coordinates.T), self._checked_weights(weights, d)

    def _checked_weights(self, weights: npt.ArrayLike | None, d: int) -> Floats:
        if weights is None:
            return np.ones(d)
        if not self.weighted:
            raise InvalidValue(
                f"{self.name} takes no coordinate weights: its factors have no constant part that a weight"
                " could leave alone"
            )
        try:
            gamma = np.asarray(weights, dtype=np.float64)
        except (TypeError, ValueError):
            gamma = np.array(np.nan)
        if gamma.shape != (d,) or not np.isfinite(gamma).all() or (gamma < 0).any():
            raise InvalidValue(
                f"weights must be {d} finite numbers >= 0, one a coordinate, got {shown(weights)}"
            )
        return gamma


def squared_of_columns(
    measure: Measure, columns: Floats, weights: Floats, want_gradient: bool
) -> tuple[float, Floats]:
    """Return the squared measure and its gradient at checked points of shape (d, n): for inner loops.

    The gradient has shape (d, n), and is zero where it is not wanted.  Rounding below zero is cut off.
    """
    n = columns.shape[1]
    terms = measure.terms(columns, weights)
    products = terms.linear.prod(axis=0)
    sums, gradient = l2.pair_sums(columns, terms.pairs, want_gradient)
    # The parts nearly cancel: taken point by point the differences are small before they are added up, which
    # keeps digits that the textbook order of the sum loses for large n.
    value = float(np.mean((sums / n - products) - (products - terms.constant)))
    if want_gradient:
        gradient /= n * n
        gradient -= (2.0 / n) * (products / terms.linear) * terms.linear_slope
    return max(value, 0.0), gradient


def rooted_of_columns(measure: Measure, columns: Floats, weights: Floats) -> tuple[float, Floats]:
    """Return the rooted measure and its gradient at checked points of shape (d, n): for inner loops.

    Where the measure is 0 the root has no gradient; zeros are returned.
    """
    squared, gradient = squared_of_columns(measure, columns, weights, want_gradient=True)
    root = math.sqrt(squared)
    if root == 0.0:
        return 0.0, np.zeros_like(gradient)
    gradient *= 0.5 / root
    return root, gradient


MEASURES: dict[str, Measure] = {
    measure.name: measure
    for measure in (
        Measure("star", "L2 star discrepancy (Warnock 1972)", l2.star, weighted=False),
        Measure(
            "hickernell",
            "Hickernell L2 discrepancy, all projections (Hickernell 1998; Joe 1997)",
            l2.hickernell,
        ),
        Measure("centred", "centred L2 discrepancy (Hickernell 1998)", l2.centred, reflectable=True),
        Measure(
            "wrap_around",
            "wrap-around L2 discrepancy (Hickernell 1998)",
            l2.wrap_around,
            periodic=True,
            reflectable=True,
        ),
        Measure("mixture", "mixture L2 discrepancy (Zhou, Fang and Ning 2013)", l2.mixture, reflectable=True),
        Measure("symmetric", "symmetric L2 discrepancy (Hickernell 1998)", l2.symmetric, reflectable=True),
        Measure(
            "average_squared",
            "average-squared L2 discrepancy over all corners",
            l2.average_squared,
            weighted=False,
            reflectable=True,
        ),
    )
}
"""The L2 discrepancies by name."""


def measure_named(name: str) -> Measure:
    """Return the measure of this name, or raise UnknownName with the known ones."""
    require_known("measure", name, MEASURES)
    return MEASURES[name]
