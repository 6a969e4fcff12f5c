"""The closed forms of the L2 discrepancies, and the sum over all pairs of points that they share.

A squared L2 discrepancy with a product kernel K(x, y) = prod_k K_k(x_k, y_k) is (Hickernell 1998)

    constant - (2/n) sum_i prod_k linear_k(x_ik) + (1/n^2) sum_ij prod_k K_k(x_ik, x_jk).

Each formula is a function of the points, (d, n), and of a weight g of every coordinate, (d,), where its factors are
1 + g * something; it writes x for x_ik, y for x_jk, z for x - 1/2.
"""

from __future__ import annotations

import math
from typing import NamedTuple, TypeAlias

import numpy as np

from evenroad._arrays import Floats
from evenroad._njit import njit

TILE = 512
"""Number of points in a tile: small enough for the first cache, large enough to keep the vector units busy."""


class MaximumPairs(NamedTuple):
    """Pair factors ``ceiling_k - slope_k * max(x, y)``, positive on the cube; both of shape (d,)."""

    ceiling: Floats
    slope: Floats


class DistancePairs(NamedTuple):
    """Pair factors ``level_k + own_k(x) + own_k(y) - slope_k * |x - y| + curvature_k * (x - y)^2``.

    The part of one point, `own`, and its derivative have shape (d, n), the others (d,).
    """

    level: Floats
    slope: Floats
    curvature: Floats
    own: Floats
    own_slope: Floats


Pairs: TypeAlias = MaximumPairs | DistancePairs


class ProductTerms(NamedTuple):
    """The parts of a squared discrepancy at given points.

    `constant` is the double integral of the kernel; `linear` its integral over one argument, a factor a coordinate,
    (d, n), and `linear_slope` the derivative of that; `pairs` is the kernel at pairs of points.
    """

    constant: float
    linear: Floats
    linear_slope: Floats
    pairs: Pairs


def star(points: Floats, weights: Floats) -> ProductTerms:
    """3^-d - (2/n) sum_i prod_k (1 - x^2)/2 + (1/n^2) sum_ij prod_k (1 - max(x, y)); Warnock (1972)."""
    one = np.ones(len(points))
    return ProductTerms(3.0 ** -len(points), (1.0 - points * points) / 2.0, -points, MaximumPairs(one, one))


def hickernell(points: Floats, weights: Floats) -> ProductTerms:
    """(4/3)^d - (2/n) sum_i prod_k (3 - x^2)/2 + (1/n^2) sum_ij prod_k (2 - max(x, y)); Joe (1997).

    The sum of the squared L2 star discrepancies of all 2^d - 1 projections, each weighted by the product of the
    weights of its coordinates.
    """
    g = weights[:, np.newaxis]
    linear = 1.0 + g * (1.0 - points * points) / 2.0
    pairs = MaximumPairs(1.0 + weights, weights)
    return ProductTerms(float(np.prod(1.0 + weights / 3.0)), linear, -g * points, pairs)


def centred(points: Floats, weights: Floats) -> ProductTerms:
    """(13/12)^d - (2/n) sum_i prod_k (1 + |z|/2 - z^2/2) + (1/n^2) sum_ij prod_k (1 + (|z_i| + |z_j| - |x - y|)/2).

    Hickernell (1998).
    """
    z, g = points - 0.5, weights[:, np.newaxis]
    side, flat = np.sign(z), np.zeros_like(weights)
    return ProductTerms(
        float(np.prod(1.0 + weights / 12.0)),
        1.0 + g * (np.abs(z) - z * z) / 2.0,
        g * (side / 2.0 - z),
        DistancePairs(np.ones_like(weights), weights / 2.0, flat, g * np.abs(z) / 2.0, g * side / 2.0),
    )


def wrap_around(points: Floats, weights: Floats) -> ProductTerms:
    """-(4/3)^d + (1/n^2) sum_ij prod_k (3/2 - t(1 - t)), t = |x - y|; Hickernell (1998).

    The kernel's integral over one argument is 4/3 everywhere, so the linear term is a constant.
    """
    level = 1.0 + weights / 3.0
    linear, still = np.broadcast_to(level[:, np.newaxis], points.shape), np.zeros_like(points)
    pairs = DistancePairs(1.0 + weights / 2.0, weights, weights, still, still)
    return ProductTerms(float(np.prod(level)), linear, still, pairs)


def mixture(points: Floats, weights: Floats) -> ProductTerms:
    """(19/12)^d - (2/n) sum_i prod_k (5/3 - |z|/4 - z^2/4) + (1/n^2) sum_ij prod_k K_k.

    K_k = 15/8 - |z_i|/4 - |z_j|/4 - 3 |x - y|/4 + (x - y)^2/2; Zhou, Fang and Ning (2013).
    """
    z, g = points - 0.5, weights[:, np.newaxis]
    side, level = np.sign(z), 1.0 + weights * 7.0 / 8.0
    own, own_slope = -g * np.abs(z) / 4.0, -g * side / 4.0
    return ProductTerms(
        float(np.prod(1.0 + weights * 7.0 / 12.0)),
        1.0 + g * (2.0 / 3.0 - (np.abs(z) + z * z) / 4.0),
        -g * (side / 4.0 + z / 2.0),
        DistancePairs(level, weights * 3.0 / 4.0, weights / 2.0, own, own_slope),
    )


def symmetric(points: Floats, weights: Floats) -> ProductTerms:
    """(4/3)^d - (2/n) sum_i prod_k (1 + 2x - 2x^2) + (2^d/n^2) sum_ij prod_k (1 - |x - y|); Hickernell (1998).

    Without weights it is 4^d times the average-squared one.
    """
    g, still = weights[:, np.newaxis], np.zeros_like(points)
    linear, slope = 1.0 + g * 2.0 * points * (1.0 - points), g * (2.0 - 4.0 * points)
    pairs = DistancePairs(1.0 + weights, 2.0 * weights, np.zeros_like(weights), still, still)
    return ProductTerms(float(np.prod(1.0 + weights / 3.0)), linear, slope, pairs)


def average_squared(points: Floats, weights: Floats) -> ProductTerms:
    """3^-d - (2/n) sum_i prod_k (1 + 2x - 2x^2)/4 + (1/n^2) sum_ij prod_k (1 - |x - y|)/2.

    The mean of the squared L2 star discrepancy over all 2^d corners taken as the origin: Warnock's formula averaged
    over x and 1 - x in every coordinate (Clement, Kirk, Owen and Rusch 2025).
    """
    half, still = np.full(len(points), 0.5), np.zeros_like(points)
    linear = (1.0 + 2.0 * points * (1.0 - points)) / 4.0
    pairs = DistancePairs(half, half, np.zeros_like(half), still, still)
    return ProductTerms(3.0 ** -len(points), linear, 0.5 - points, pairs)


def pair_sums(columns: Floats, pairs: Pairs, want_gradient: bool) -> tuple[Floats, Floats]:
    """Sum the pair products of every point with all points, itself included, (n,), and the derivative of the total.

    O(n^2 d) time, O(n d) memory.  The gradient, (d, n), is zero where it is not wanted, in about half the time.  Where
    two points share a coordinate the kernels have a kink; the gradient is then one of the one-sided ones.  Points come
    in tiles that stay in the first caches, and fastmath lets the inner loops run as vectors: input is finite because
    ``as_unit_points`` refused everything else.
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
