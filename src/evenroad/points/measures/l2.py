"""The closed forms of the L2 discrepancies, and the sum over all pairs of points that they share.

A squared L2 discrepancy with a product kernel K(x, y) = prod_k K_k(x_k, y_k) is (Hickernell 1998)

    constant - (2/n) sum_i prod_k linear_k(x_ik) + (1/n^2) sum_ij prod_k K_k(x_ik, x_jk).

Each formula gives its three parts at given points, as a function ``formula(columns, weights)`` of the points, shape
(d, n): one coordinate of all points is contiguous, as the compiled sums read it; and of a weight of every coordinate,
shape (d,), where its factors are 1 + weight * something.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from evenroad._arrays import Floats

TILE = 512
"""Points in a tile: small enough for the first cache, large enough to keep the vector units busy."""


class MaximumPairs(NamedTuple):
    """Pair factors ``ceiling_k - slope_k * max(x, y)``, positive on the cube; all of shape (d,)."""

    ceiling: Floats
    slope: Floats


class DistancePairs(NamedTuple):
    """Pair factors ``level_k + own_k(x) + own_k(y) - slope_k * |x - y| + curvature_k * (x - y)^2``.

    `level`, `slope` and `curvature` have shape (d,); `own`, the part of one point, and its derivative (d, n).
    """

    level: Floats
    slope: Floats
    curvature: Floats
    own: Floats
    own_slope: Floats


class ProductTerms(NamedTuple):
    """The three parts of a squared discrepancy at given points.

    `constant` is the double integral of the kernel; `linear` its integral over one argument, a factor a coordinate,
    (d, n), and `linear_slope` the derivative of that; `pairs` is the kernel at pairs of points.
    """

    constant: float
    linear: Floats
    linear_slope: Floats
    pairs: MaximumPairs | DistancePairs


def star(columns: Floats, weights: Floats) -> ProductTerms:
    """3^-d - (2/n) sum_i prod_k (1 - x_ik^2)/2 + (1/n^2) sum_ij prod_k (1 - max(x_ik, x_jk)).

    Warnock (1972).
    """
    d = columns.shape[0]
    return ProductTerms(
        constant=3.0**-d,
        linear=(1.0 - columns * columns) / 2.0,
        linear_slope=-columns,
        pairs=MaximumPairs(ceiling=np.ones(d), slope=np.ones(d)),
    )


def hickernell(columns: Floats, weights: Floats) -> ProductTerms:
    """Sum the squared L2 star discrepancies of all 2^d - 1 projections in closed form (Joe 1997).

    (4/3)^d - (2/n) sum_i prod_k (3 - x_ik^2)/2 + (1/n^2) sum_ij prod_k (2 - max(x_ik, x_jk)); a projection
    onto some coordinates is weighted by the product of their weights.
    """
    gamma = weights[:, np.newaxis]
    return ProductTerms(
        constant=float(np.prod(1.0 + weights / 3.0)),
        linear=1.0 + gamma * (1.0 - columns * columns) / 2.0,
        linear_slope=-gamma * columns,
        pairs=MaximumPairs(ceiling=1.0 + weights, slope=weights),
    )


def centred(columns: Floats, weights: Floats) -> ProductTerms:
    """Hickernell (1998), with z = x - 1/2.

    (13/12)^d - (2/n) sum_i prod_k (1 + |z_ik|/2 - z_ik^2/2)
    + (1/n^2) sum_ij prod_k (1 + |z_ik|/2 + |z_jk|/2 - |x_ik - x_jk|/2).
    """
    z, gamma = columns - 0.5, weights[:, np.newaxis]
    side = np.sign(z)
    return ProductTerms(
        constant=float(np.prod(1.0 + weights / 12.0)),
        linear=1.0 + gamma * (np.abs(z) - z * z) / 2.0,
        linear_slope=gamma * (side / 2.0 - z),
        pairs=DistancePairs(
            level=np.ones_like(weights),
            slope=weights / 2.0,
            curvature=np.zeros_like(weights),
            own=gamma * np.abs(z) / 2.0,
            own_slope=gamma * side / 2.0,
        ),
    )


def wrap_around(columns: Floats, weights: Floats) -> ProductTerms:
    """-(4/3)^d + (1/n^2) sum_ij prod_k (3/2 - t(1 - t)), t = |x_ik - x_jk| (Hickernell 1998, wrap-around).

    The kernel's integral over one argument is 4/3 everywhere, so the linear term is a constant.
    """
    level = 1.0 + weights / 3.0
    return ProductTerms(
        constant=float(np.prod(level)),
        linear=np.broadcast_to(level[:, np.newaxis], columns.shape),
        linear_slope=np.zeros_like(columns),
        pairs=_distances_alone(columns, 1.0 + weights / 2.0, weights, weights),
    )


def mixture(columns: Floats, weights: Floats) -> ProductTerms:
    """Zhou, Fang and Ning (2013), with z = x - 1/2.

    (19/12)^d - (2/n) sum_i prod_k (5/3 - |z_ik|/4 - z_ik^2/4)
    + (1/n^2) sum_ij prod_k (15/8 - |z_ik|/4 - |z_jk|/4 - 3 |x_ik - x_jk|/4 + (x_ik - x_jk)^2/2).
    """
    z, gamma = columns - 0.5, weights[:, np.newaxis]
    side = np.sign(z)
    return ProductTerms(
        constant=float(np.prod(1.0 + weights * 7.0 / 12.0)),
        linear=1.0 + gamma * (2.0 / 3.0 - (np.abs(z) + z * z) / 4.0),
        linear_slope=-gamma * (side / 4.0 + z / 2.0),
        pairs=DistancePairs(
            level=1.0 + weights * 7.0 / 8.0,
            slope=weights * 3.0 / 4.0,
            curvature=weights / 2.0,
            own=-gamma * np.abs(z) / 4.0,
            own_slope=-gamma * side / 4.0,
        ),
    )


def symmetric(columns: Floats, weights: Floats) -> ProductTerms:
    """(4/3)^d - (2/n) sum_i prod_k (1 + 2x - 2x^2) + (2^d/n^2) sum_ij prod_k (1 - |x_ik - x_jk|).

    Hickernell (1998), symmetric discrepancy; without weights it is 4^d times the average-squared one.
    """
    gamma = weights[:, np.newaxis]
    return ProductTerms(
        constant=float(np.prod(1.0 + weights / 3.0)),
        linear=1.0 + gamma * 2.0 * columns * (1.0 - columns),
        linear_slope=gamma * (2.0 - 4.0 * columns),
        pairs=_distances_alone(columns, 1.0 + weights, 2.0 * weights, np.zeros_like(weights)),
    )


def average_squared(columns: Floats, weights: Floats) -> ProductTerms:
    """Mean of the squared L2 star discrepancy over all 2^d corners taken as the origin, in closed form.

    3^-d - (2/n) sum_i prod_k (1 + 2 x_ik - 2 x_ik^2)/4 + (1/n^2) sum_ij prod_k (1 - |x_ik - x_jk|)/2:
    Warnock's formula averaged over x and 1 - x in every coordinate (Clement, Kirk, Owen and Rusch 2025).
    """
    d = columns.shape[0]
    return ProductTerms(
        constant=3.0**-d,
        linear=(1.0 + 2.0 * columns * (1.0 - columns)) / 4.0,
        linear_slope=0.5 - columns,
        pairs=_distances_alone(columns, np.full(d, 0.5), np.full(d, 0.5), np.zeros(d)),
    )


def _distances_alone(columns: Floats, level: Floats, slope: Floats, curvature: Floats) -> DistancePairs:
    """Return pair factors without a part of one point."""
    nothing = np.zeros_like(columns)
    return DistancePairs(level, slope, curvature, nothing, nothing)


def pair_sums(
    columns: Floats, pairs: MaximumPairs | DistancePairs, want_gradient: bool
) -> tuple[Floats, Floats]:
    """Sum the pair products of every point with all points, itself included: O(n^2 d) time, O(n d) memory.

    One compiled loop is for factors in max(x, y), where the gradient needs no division, and one for factors in
    |x - y|.  Points come in tiles that stay in the first caches, and fastmath lets the inner loops run as vectors;
    input is finite because ``as_unit_points`` refused everything else.

    Returns
    -------
    sums : ndarray, shape (n,)
        ``sum_j prod_k K_k(x_ik, x_jk)`` of every i.
    gradient : ndarray, shape (d, n)
        Derivative of ``sums.sum()`` by every coordinate; zero, in about half the time, where it is not wanted.  Where
        two points share a coordinate the kernels have a kink; the gradient is then one of the one-sided ones.
    """
    if isinstance(pairs, MaximumPairs):
        return _maximum_pair_sums(columns, *pairs, want_gradient)
    return _distance_pair_sums(columns, *pairs, want_gradient)


@njit(cache=True, fastmath=True)
def _maximum_pair_sums(columns, ceiling, slope, want_gradient):  # type: ignore[no-untyped-def]
    d, n = columns.shape
    sums = np.zeros(n)
    gradient = np.zeros((d, n))
    product = np.empty(TILE)
    for first in range(0, n, TILE):
        size = min(TILE, n - first)
        for i in range(n):
            for j in range(size):
                product[j] = 1.0
            for k in range(d):
                at, top, fall = columns[k, i], ceiling[k], slope[k]
                others = columns[k, first : first + size]
                for j in range(size):
                    product[j] *= top - fall * max(at, others[j])
            row = 0.0
            for j in range(size):
                row += product[j]
            sums[i] += row
            if want_gradient:
                for k in range(d):
                    at = columns[k, i]
                    others = columns[k, first : first + size]
                    below = 0.0
                    for j in range(size):
                        below += product[j] if others[j] < at else 0.0
                    gradient[k, i] += below
    if want_gradient:
        # Where the other point is below, the factor is ceiling - slope * x_ik: the same for all of them, so
        # one division a coordinate is enough.  Such a pair counts twice, a point with itself once.
        for i in range(n):
            itself = 1.0
            for k in range(d):
                itself *= ceiling[k] - slope[k] * columns[k, i]
            for k in range(d):
                factor = ceiling[k] - slope[k] * columns[k, i]
                gradient[k, i] = -slope[k] * (2.0 * gradient[k, i] + itself) / factor
    return sums, gradient


@njit(cache=True, fastmath=True)
def _distance_pair_sums(columns, level, slope, curvature, own, own_slope, want_gradient):  # type: ignore[no-untyped-def]
    d, n = columns.shape
    sums = np.zeros(n)
    gradient = np.zeros((d, n))
    # Products of the factors before and after a coordinate replace the division of the whole product by the
    # coordinate's factor: three times faster.
    before = np.ones((d + 1, TILE))
    after = np.empty(TILE)
    factors = np.empty((d, TILE))
    for first in range(0, n, TILE):
        size = min(TILE, n - first)
        for i in range(n):
            for k in range(d):
                at, base, fall, bend = columns[k, i], level[k] + own[k, i], slope[k], curvature[k]
                others = columns[k, first : first + size]
                theirs = own[k, first : first + size]
                factor, product, longer_product = factors[k], before[k], before[k + 1]
                for j in range(size):
                    gap = abs(at - others[j])
                    factor[j] = base + theirs[j] - gap * (fall - bend * gap)
                    longer_product[j] = product[j] * factor[j]
            row = 0.0
            for j in range(size):
                row += before[d, j]
                after[j] = 1.0
            sums[i] += row
            if want_gradient:
                for k in range(d - 1, -1, -1):
                    at, fall, twice_bend = columns[k, i], slope[k], 2.0 * curvature[k]
                    others = columns[k, first : first + size]
                    factor, product = factors[k], before[k]
                    rest_sum, slope_sum = 0.0, 0.0
                    for j in range(size):
                        step = at - others[j]
                        rest = product[j] * after[j]
                        rest_sum += rest
                        # copysign instead of a branch: a branch stops the loop from running as vectors.  Of
                        # 1, not of rest: that is negative where a weight makes factors negative.
                        slope_sum += rest * math.copysign(1.0, step) * (fall - twice_bend * abs(step))
                        after[j] *= factor[j]
                    gradient[k, i] += 2.0 * (own_slope[k, i] * rest_sum - slope_sum)
    if want_gradient:
        # copysign takes the step of a point to itself, +0, for a rise; that pair has no slope in the gap.
        for i in range(n):
            itself = 1.0
            for k in range(d):
                itself *= level[k] + 2.0 * own[k, i]
            for k in range(d):
                gradient[k, i] += 2.0 * slope[k] * itself / (level[k] + 2.0 * own[k, i])
    return sums, gradient
