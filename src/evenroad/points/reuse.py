"""Sets from larger ones: the projection on fewer axes, and an order whose beginnings are all even.

Chahine, Rusch, Patterson and Rus (2025) propose both for large trained sets: one set serves many dimensions and many
numbers of points.  ``studies/docs/reuse.md`` has the cost.
"""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad._call import explains_calls
from evenroad._checks import require_count, require_known
from evenroad.errors import InvalidValue
from evenroad.points.measures.l2 import pair_row
from evenroad.points.measures.measure import MEASURES, Measure
from evenroad.points.pointset import PointSet

MOST_CHOICES = 300
"""Number of choices of axes up to which all are measured. Beyond it, axes are added and exchanged one by one."""


@explains_calls
def project(points: PointSet, d: int, *, measure: str = "hickernell") -> PointSet:
    """Return the projection of a set on the `d` axes on which it is the most even.

    Parameters
    ----------
    points : PointSet
        Points in at least `d` dimensions.
    d : int
        Number of axes to keep, >= 1; they keep their order.
    measure : str
        The L2 discrepancy to minimise, a name in :data:`evenroad.points.measures.MEASURES`.  Up to 300 choices of axes
        are all measured.  Else the best axis is added ``d`` times, then exchanged while that lowers the discrepancy.

    Returns
    -------
    PointSet
        All points, shape (n, d); ``origin.method`` names the axes.

    Raises
    ------
    InvalidValue
        If the set has fewer than `d` dimensions, or no points.
    UnknownName
        For an unknown measure.

    Examples
    --------
    >>> import evenroad as er
    >>> from evenroad.points import project
    >>> project(er.draw("hickernell", 128, 10), 5).shape
    (128, 5)
    """
    d, judge = require_count("d", d), _measure(measure)
    if d > points.d:
        raise InvalidValue(f"d must be at most the set's {points.d} dimensions, got {d}")
    axes = _all_measured if math.comb(points.d, d) <= MOST_CHOICES else _exchanged
    kept = axes(points.points, d, judge)
    how = f"{points.origin.method}, axes {' '.join(map(str, kept))}"
    return PointSet(points.points[:, kept], points.origin).with_origin(method=how)


def _all_measured(points: Floats, d: int, judge: Measure) -> list[int]:
    choices = [list(each) for each in combinations(range(points.shape[1]), d)]
    return min(choices, key=lambda kept: judge.squared(points[:, kept]))


def _exchanged(points: Floats, d: int, judge: Measure) -> list[int]:
    kept: list[int] = []
    others = list(range(points.shape[1]))
    for _ in range(d):
        best = min(others, key=lambda axis: judge.squared(points[:, [*kept, axis]]))
        kept.append(best)
        others.remove(best)
    value = judge.squared(points[:, kept])
    while True:
        swaps = [(at, axis) for at in range(d) for axis in others]
        trials = [[*kept[:at], axis, *kept[at + 1 :]] for at, axis in swaps]
        values = [judge.squared(points[:, trial]) for trial in trials]
        least = int(np.argmin(values))
        if values[least] >= value:
            return sorted(kept)
        kept, value = trials[least], values[least]
        others = [axis for axis in range(points.shape[1]) if axis not in kept]


@explains_calls
def greedy_order(points: PointSet, *, measure: str = "hickernell") -> PointSet:
    """Return the same points in a greedy order: each next point minimises the discrepancy of all so far.

    Each beginning is then an even set.  It takes O(n^2 d) time: 0.5 s for 2048 points in ten dimensions.

    Parameters
    ----------
    points : PointSet
        At least one point.
    measure : str
        The L2 discrepancy, a name in :data:`evenroad.points.measures.MEASURES`.

    Returns
    -------
    PointSet
        All points, shape (n, d); among equally good ones, the first in the given order comes first.

    Raises
    ------
    InvalidValue
        If the set has no points.
    UnknownName
        For an unknown measure.

    Examples
    --------
    >>> import evenroad as er
    >>> from evenroad.points import greedy_order, prefix_discrepancies
    >>> ordered = greedy_order(er.draw("hickernell", 256, 3))
    >>> bool(prefix_discrepancies(ordered)[49] < prefix_discrepancies(er.draw("hickernell", 256, 3))[49])
    True
    """
    order = _greedy(points, _measure(measure))
    method = f"{points.origin.method}, in greedy order"
    return PointSet(points.points[order], points.origin).with_origin(method=method)


def _greedy(points: PointSet, judge: Measure) -> Ints:
    columns, terms = judge.terms_of(points.points)
    linear, n = terms.linear.prod(axis=0), columns.shape[1]
    own = np.array([pair_row(columns, terms.pairs, i, slice(i, i + 1))[0] for i in range(n)])
    with_chosen, left = np.zeros(n), np.ones(n, dtype=np.bool_)
    order = np.empty(n, dtype=np.int64)
    for m in range(1, n + 1):
        # Increase of the squared discrepancy of m points by each candidate, up to a common constant.
        gains = (2.0 * with_chosen + own) / m - 2.0 * linear
        order[m - 1] = chosen = int(np.where(left, gains, np.inf).argmin())
        left[chosen] = False
        with_chosen += pair_row(columns, terms.pairs, chosen)
    return order


@explains_calls
def prefix_discrepancies(points: PointSet, *, measure: str = "hickernell") -> Floats:
    """Return the discrepancies of the first 1, 2, ... n points of a set.

    Parameters
    ----------
    points : PointSet
        At least one point.
    measure : str
        The L2 discrepancy, a name in :data:`evenroad.points.measures.MEASURES`.

    Returns
    -------
    ndarray, shape (n,)
        Rooted discrepancies, >= 0.

    Raises
    ------
    InvalidValue
        If the set has no points.
    UnknownName
        For an unknown measure.

    Examples
    --------
    >>> import evenroad as er
    >>> from evenroad.points import prefix_discrepancies
    >>> prefix_discrepancies(er.draw("sobol", 64, 2)).shape
    (64,)
    """
    columns, terms = _measure(measure).terms_of(points.points)
    n = columns.shape[1]
    # The share of point i in the sum over all pairs of the first i.
    added = np.empty(n)
    for i in range(n):
        row = pair_row(columns, terms.pairs, i, slice(0, i + 1))
        added[i] = 2.0 * row.sum() - row[i]
    lengths = np.arange(1, n + 1)
    linear = np.cumsum(terms.linear.prod(axis=0))
    squared = terms.constant - 2.0 * linear / lengths + np.cumsum(added) / lengths**2
    distances: Floats = np.sqrt(np.maximum(squared, 0.0))
    return distances


def _measure(name: str) -> Measure:
    require_known("measure", name, MEASURES)
    return MEASURES[name]
