"""The common shape of every L2 discrepancy here: a constant, a mean of products, a mean of pair products.

A squared L2 discrepancy with a product kernel K(x, y) = prod_k K_k(x_k, y_k) is (Hickernell 1998)

    constant - (2/n) sum_i prod_k linear_k(x_ik) + (1/n^2) sum_ij prod_k K_k(x_ik, x_jk).

A measure says what its three parts are for given points; :mod:`~evenroad.points.measures.pairs` sums them.
Arrays here are *columns*, shape (d, n): one coordinate of all points is contiguous, as the kernels read it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class MaximumPairs:
    """Pair factors ``ceiling_k - slope_k * max(x, y)``, positive on the cube.

    Attributes
    ----------
    ceiling, slope : ndarray, shape (d,)
    """

    ceiling: Array
    slope: Array


@dataclass(frozen=True, eq=False)
class DistancePairs:
    """Pair factors ``level_k + own_k(x) + own_k(y) - slope_k * |x - y| + curvature_k * (x - y)^2``.

    Attributes
    ----------
    level, slope, curvature : ndarray, shape (d,)
    own, own_slope : ndarray, shape (d, n)
        The part of one point, and its derivative.
    """

    level: Array
    slope: Array
    curvature: Array
    own: Array
    own_slope: Array


@dataclass(frozen=True, eq=False)
class ProductTerms:
    """The three parts of a squared discrepancy at given points.

    Attributes
    ----------
    constant : float
        Double integral of the kernel.
    linear, linear_slope : ndarray, shape (d, n)
        Integral of the kernel over one argument, a factor a coordinate, and its derivative.
    pairs : MaximumPairs or DistancePairs
        The kernel at pairs of points.
    """

    constant: float
    linear: Array
    linear_slope: Array
    pairs: MaximumPairs | DistancePairs
