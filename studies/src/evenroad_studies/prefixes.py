"""The discrepancies of all prefixes of a sequence at once, and the slope of the worst of them.

With D^2(n) = constant - (2/n) sum_{i <= n} l_i + (1/n^2) sum_{i, j <= n} K_ij, sums of rows give all D(n) in one pass
over the pairs, and a pair's slope is one sum over the prefixes that hold it: two passes, however many prefixes.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue, shown
from evenroad.points.measures.l2 import MaximumPairs, ProductTerms, hickernell, star
from evenroad.points.pointset import as_unit_points

PREFIXED = {"hickernell": hickernell, "star": star}
"""Measures whose prefixes can be looked at: those with a kernel of the maximum of two coordinates."""

SHORTEST = 8
"""Points of the shortest prefix that counts, unless there are fewer."""

SHARPNESS = 60.0
"""How much the worst prefix counts more than others: a prefix 5 % above another one weighs e^3 times as much."""

SMALLEST = 1e-300


def rooted_prefixes(points: object, name: str = "hickernell") -> Floats:
    """Return the rooted discrepancies, (n,), of the first 1 .. n points; `name` is one of :data:`PREFIXED`.

    One pass over the pairs, O(n^2 d).  Other names, or bad points, are an InvalidValue.
    """
    if name not in PREFIXED:
        raise InvalidValue(f"prefixes(...) takes {' or '.join(PREFIXED)}, got {shown(name)}")
    columns = np.ascontiguousarray(as_unit_points(points).T)
    return np.sqrt(_squared(columns, _terms(name, columns)))


def worst_prefix(name: str, columns: Floats, level: Floats, fixed: int = 0) -> tuple[float, Floats]:
    """Return how far the prefixes are above a level, and the gradient, (d, n), at points of shape (d, n).

    The value is log(sum_n w_n exp(s r_n)) / s with r_n = log D(n) - `level`_n, s = :data:`SHARPNESS` and weights w_n in
    proportion to 1/n, since equal ratios of lengths count alike: the mean of r_n if all are equal, else nearly their
    largest.  The first `fixed` points have no gradient, and prefixes that end among them do not count.
    """
    n = columns.shape[1]
    terms, lengths = _terms(name, columns), np.arange(1, n + 1)
    squared = _squared(columns, terms)
    counts = lengths >= max(min(SHORTEST, n), fixed + 1)
    above = np.where(counts, 0.5 * np.log(squared) - level, -np.inf)
    shares = np.where(counts, 1.0 / lengths, 0.0)
    top, total = above.max(), shares.sum()
    shares *= np.exp(SHARPNESS * (above - top))
    value = top + np.log(shares.sum() / total) / SHARPNESS
    shares /= shares.sum()
    # Sums over all prefixes that hold point i: from its end backwards.
    of_pairs = np.cumsum((shares / (2.0 * squared * lengths**2))[::-1])[::-1].copy()
    of_points = np.cumsum((shares / (squared * lengths))[::-1])[::-1]
    assert isinstance(terms.pairs, MaximumPairs)
    gradient = _weighted_slopes(columns, *terms.pairs, of_pairs, fixed)
    gradient -= of_points * (terms.linear.prod(axis=0) / terms.linear) * terms.linear_slope
    gradient[:, :fixed] = 0.0
    return float(value), gradient


def _terms(name: str, columns: Floats) -> ProductTerms:
    return PREFIXED[name](columns, np.ones(len(columns)))


def _squared(columns: Floats, terms: ProductTerms) -> Floats:
    """Return the squared discrepancies of all prefixes, above 0."""
    assert isinstance(terms.pairs, MaximumPairs)
    lengths = np.arange(1, columns.shape[1] + 1)
    linear = np.cumsum(terms.linear.prod(axis=0)) / lengths
    rows = np.cumsum(_row_sums(columns, *terms.pairs)) / lengths**2
    return np.maximum((rows - linear) - (linear - terms.constant), SMALLEST)


@njit(cache=True, fastmath=True)
def _row_sums(columns, ceiling, slope):  # type: ignore[no-untyped-def]
    """Return what each point adds to the pair sum of those before it: twice its pairs with them, and its own."""
    d, n = columns.shape
    sums, product = np.empty(n), np.empty(n)
    for i in range(n):
        product[: i + 1] = 2.0
        product[i] = 1.0
        for k in range(d):
            at, top, fall, others = columns[k, i], ceiling[k], slope[k], columns[k]
            for j in range(i + 1):
                product[j] *= top - fall * max(at, others[j])
        total = 0.0
        for j in range(i + 1):
            total += product[j]
        sums[i] = total
    return sums


@njit(cache=True, fastmath=True)
def _weighted_slopes(columns, ceiling, slope, weights, fixed):  # type: ignore[no-untyped-def]
    """Return the slope, (d, n), of the sum of weights[max(i, j)] K_ij over all pairs; 0 for the first `fixed`."""
    d, n = columns.shape
    gradient, product = np.zeros((d, n)), np.empty(n)
    for i in range(fixed, n):
        for j in range(n):
            product[j] = 2.0 * weights[max(i, j)]
        product[i] = weights[i]
        for k in range(d):
            at, top, fall, others = columns[k, i], ceiling[k], slope[k], columns[k]
            for j in range(n):
                product[j] *= top - fall * max(at, others[j])
        for k in range(d):
            at, others, below = columns[k, i], columns[k], 0.0
            for j in range(n):
                below += product[j] if others[j] < at else 0.0
            gradient[k, i] = -slope[k] * (below + product[i]) / (ceiling[k] - slope[k] * at)
    return gradient
