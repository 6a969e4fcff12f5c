"""The closed forms of the L2 discrepancies, and the sum over all pairs of points that they share.

A squared L2 discrepancy with a product kernel K(x, y) = prod_k K_k(x_k, y_k) is (Hickernell 1998)

    constant - (2/n) sum_i prod_k linear_k(x_ik) + (1/n^2) sum_ij prod_k K_k(x_ik, x_jk).

Each formula is a function of the points, (d, n), and of a weight g of every coordinate, (d,), where its factors are
1 + g * something; it writes x for x_ik, y for x_jk, z for x - 1/2.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from evenroad._arrays import Floats
from evenroad._native.points import PairSums, distance_pair_sums, maximum_pair_sums


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


def pair_sums(columns: Floats, pairs: Pairs, want_gradient: bool) -> PairSums:
    """Sum the pair products of every point with all points, itself included, (n,), and the derivative of the total.

    It takes O(n^2 d) time and O(n d) memory.  A gradient, (d, n), that is not wanted is zero and saves half the time.
    If two points share a coordinate, the kernels have a kink, and the gradient is one of the one-sided ones.
    """
    if isinstance(pairs, MaximumPairs):
        return maximum_pair_sums(columns, *pairs, want_gradient)
    return distance_pair_sums(columns, *pairs, want_gradient)


def pair_row(columns: Floats, pairs: Pairs, i: int, others: slice = slice(None)) -> Floats:
    """Return the pair products of point i with some of all points, by default all."""
    row = np.ones(columns[0, others].shape)
    for axis, x in enumerate(columns):
        y = x[others]
        if isinstance(pairs, MaximumPairs):
            row *= pairs.ceiling[axis] - pairs.slope[axis] * np.maximum(y, x[i])
        else:
            gap, own = np.abs(y - x[i]), pairs.own[axis]
            factor = pairs.level[axis] + own[i] + own[others]
            row *= factor - gap * (pairs.slope[axis] - pairs.curvature[axis] * gap)
    return row
