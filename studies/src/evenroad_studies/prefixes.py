"""The discrepancies of all prefixes of a sequence at once, and the slope of the worst of them.

With D^2(n) = constant - (2/n) sum_{i <= n} l_i + (1/n^2) sum_{i, j <= n} K_ij, sums of rows give all D(n) in one pass
over the pairs, and a pair's slope is one sum over the prefixes that hold it: two passes, however many prefixes.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

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
IN_CACHE = 10_000
"""Number of values that are worked on at once."""


def rooted_prefixes(points: object, name: str = "hickernell") -> Floats:
    """Return the rooted discrepancies, (n,), of the first 1 .. n points; `name` is one of :data:`PREFIXED`.

    One pass over the pairs, O(n^2 d).  Other names, or bad points, are an InvalidValue.
    """
    if name not in PREFIXED:
        raise InvalidValue(f"prefixes(...) takes {' or '.join(PREFIXED)}, got {shown(name)}")
    columns = np.ascontiguousarray(as_unit_points(points).T)
    terms = _terms(name, columns)
    return np.sqrt(_squared(terms, _pairs(columns, terms)))


def worst_prefix(name: str, columns: Floats, level: Floats, fixed: int = 0) -> tuple[float, Floats]:
    """Return how far the prefixes are above a level, and the gradient, (d, n), at points of shape (d, n).

    The value is log(sum_n w_n exp(s r_n)) / s with r_n = log D(n) - `level`_n, s = :data:`SHARPNESS` and weights w_n in
    proportion to 1/n, since equal ratios of lengths count alike: the mean of r_n if all are equal, else nearly their
    largest.  The first `fixed` points have no gradient, and prefixes that end among them do not count.
    """
    n = columns.shape[1]
    terms, lengths = _terms(name, columns), np.arange(1, n + 1)
    pairs = _pairs(columns, terms)
    squared = _squared(terms, pairs)
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
    gradient = _weighted_slopes(columns, terms, pairs, of_pairs)
    gradient -= of_points * (terms.linear.prod(axis=0) / terms.linear) * terms.linear_slope
    gradient[:, :fixed] = 0.0
    return float(value), gradient


def _terms(name: str, columns: Floats) -> ProductTerms:
    return PREFIXED[name](columns, np.ones(len(columns)))


def _pairs(columns: Floats, terms: ProductTerms) -> Floats:
    """Return the kernel K_ij of all pairs, (n, n)."""
    assert isinstance(terms.pairs, MaximumPairs)
    factors = terms.pairs.ceiling[:, np.newaxis] - terms.pairs.slope[:, np.newaxis] * columns
    pairs = np.ones((columns.shape[1],) * 2)
    for rows in _blocks(len(pairs)):
        for factor in factors:
            pairs[rows] *= np.minimum(factor[rows, np.newaxis], factor)
    return pairs


def _blocks(n: int) -> Iterator[slice]:
    """Yield parts of n rows that stay, n numbers each, in the processor's memory."""
    step = max(1, IN_CACHE // n)
    return (slice(at, at + step) for at in range(0, n, step))


def _squared(terms: ProductTerms, pairs: Floats) -> Floats:
    """Return the squared discrepancies of all prefixes, above 0."""
    lengths = np.arange(1, len(pairs) + 1)
    linear = np.cumsum(terms.linear.prod(axis=0)) / lengths
    # What each point adds to the pair sum of those before it: twice its pairs with them, and its own.
    rows = np.diagonal(pairs) + 2.0 * np.array([row[:i].sum() for i, row in enumerate(pairs)])
    return np.maximum((np.cumsum(rows) / lengths**2 - linear) - (linear - terms.constant), SMALLEST)


def _weighted_slopes(columns: Floats, terms: ProductTerms, pairs: Floats, weights: Floats) -> Floats:
    """Return the slope, (d, n), of the sum of weights[max(i, j)] K_ij over all pairs; the weights fall."""
    assert isinstance(terms.pairs, MaximumPairs)
    ceiling, slope = (each[:, np.newaxis] for each in terms.pairs)
    # Of a pair, the one with the larger coordinate has the slope; of a point and itself, half of it.
    sums = np.tile(weights * np.diagonal(pairs), (len(columns), 1))
    for rows in _blocks(len(pairs)):
        product = np.minimum(weights, weights[rows, np.newaxis]) * pairs[rows]
        for x, total in zip(columns, sums, strict=True):
            total[rows] += 2.0 * (product * (x < x[rows, np.newaxis])).sum(axis=1)
    return -slope * sums / (ceiling - slope * columns)
