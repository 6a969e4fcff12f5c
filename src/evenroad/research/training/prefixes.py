"""The discrepancies of all prefixes of a set at once, and the slope of their mean logarithm.

With D^2(n) = constant - (2/n) sum_{i <= n} l_i + (1/n^2) sum_{i, j <= n} K_ij, sums of rows give all D(n) in one pass
over the pairs, and a pair's slope is one sum over the prefixes that hold it: two passes, however many prefixes.
"""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats
from evenroad._njit import njit
from evenroad.points.measures import MEASURES
from evenroad.points.measures.l2 import MaximumPairs

PREFIXED = ("hickernell", "star")
"""Measures whose prefixes can be looked at: those with a kernel of the maximum of two coordinates."""

SHORTEST = 8
"""Points of the shortest prefix that counts, unless there are fewer."""

SMALLEST = 1e-300


def of_prefixes(name: str, columns: Floats) -> tuple[float, Floats]:
    """Return the mean of log D(n) over the prefixes and its gradient, (d, n), at points of shape (d, n).

    A prefix of n points weighs 1 / n: equal ratios of lengths count alike.
    """
    n = columns.shape[1]
    terms = MEASURES[name].terms(columns, np.ones(len(columns)))
    assert isinstance(terms.pairs, MaximumPairs)
    products = terms.linear.prod(axis=0)
    lengths = np.arange(1, n + 1)
    rows = _row_sums(columns, *terms.pairs)
    squared = terms.constant - 2.0 * np.cumsum(products) / lengths + np.cumsum(rows) / lengths**2
    squared = np.maximum(squared, SMALLEST)
    shares = np.where(lengths >= min(SHORTEST, n), 1.0 / lengths, 0.0)
    shares /= shares.sum()
    # Sums over all prefixes that hold point i: from its end backwards.
    of_pairs = np.cumsum((shares / (2.0 * squared * lengths**2))[::-1])[::-1].copy()
    of_points = np.cumsum((shares / (squared * lengths))[::-1])[::-1]
    gradient = _weighted_slopes(columns, *terms.pairs, of_pairs)
    gradient -= of_points * (products / terms.linear) * terms.linear_slope
    return float(shares @ np.log(squared)) / 2.0, gradient


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
def _weighted_slopes(columns, ceiling, slope, weights):  # type: ignore[no-untyped-def]
    """Return the slope, (d, n), of the sum of weights[max(i, j)] K_ij over all pairs."""
    d, n = columns.shape
    gradient, product = np.empty((d, n)), np.empty(n)
    for i in range(n):
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
