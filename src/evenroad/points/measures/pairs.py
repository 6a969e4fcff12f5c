"""Sums over all pairs of points of a product kernel, with the gradient: O(n^2 d) time, O(n d) memory.

The only compiled code of the L2 discrepancies: one kernel for factors in max(x, y), where the gradient needs
no division, and one for factors in |x - y|.  Points come in tiles that stay in the first caches, and fastmath
lets the inner loops run as vectors; input is finite because ``as_unit_points`` refused everything else.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from evenroad.points.measures.terms import Array, DistancePairs, MaximumPairs

TILE = 512
"""Points in a tile: small enough for the first cache, large enough to keep the vector units busy."""


def pair_sums(
    columns: Array, pairs: MaximumPairs | DistancePairs, want_gradient: bool
) -> tuple[Array, Array]:
    """Sum the pair products of every point with all points, itself included.

    Parameters
    ----------
    columns : ndarray, shape (d, n)
        The points, coordinate by coordinate, finite.
    pairs : MaximumPairs or DistancePairs
        The factors.
    want_gradient : bool
        False leaves the second result zero, in about half the time.

    Returns
    -------
    sums : ndarray, shape (n,)
        ``sum_j prod_k K_k(x_ik, x_jk)`` of every i.
    gradient : ndarray, shape (d, n)
        Derivative of ``sums.sum()`` by every coordinate.  Where two points share a coordinate the kernels
        have a kink; the gradient is then one of the one-sided ones.
    """
    if isinstance(pairs, MaximumPairs):
        return _maximum_pair_sums(columns, pairs.ceiling, pairs.slope, want_gradient)
    return _distance_pair_sums(
        columns, pairs.level, pairs.slope, pairs.curvature, pairs.own, pairs.own_slope, want_gradient
    )


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
