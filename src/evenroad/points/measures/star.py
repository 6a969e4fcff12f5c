"""The exact star discrepancy: the largest difference between a share of points and a volume, over all boxes."""

from __future__ import annotations

import math

import numpy as np

from evenroad._checks import require_positive
from evenroad._njit import njit
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.points.pointset import as_unit_points

STAR_BUDGET = 1e10
"""Default limit on the estimated work: about a minute."""


def star_discrepancy(points: object, budget: float = STAR_BUDGET) -> float:
    """Return the exact star discrepancy: the largest gap between the share of points in a box [0, y) and its volume.

    The supremum is reached at boxes whose upper sides pass through points (or are 1), counted once without and
    once with the points on those sides (Niederreiter 1972; Gnewuch, Srivastav and Winzen 2009).  They are
    enumerated coordinate by coordinate, only through points that are still inside, and a branch is left where
    neither its volume nor its share of points exceeds the best found.

    `points`, (n, d), have coordinates in [0, 1), n >= 1, else InvalidValue.  NotAvailable if the estimated work,
    n^d / d!, exceeds `budget`: at the default n is 140000, 3900, 700, 260 and 139 at most for d = 2 .. 6.
    """
    coordinates = as_unit_points(points)
    n, d = coordinates.shape
    if n == 0:
        raise InvalidValue(f"star_discrepancy needs at least one point, got an array of shape (0, {d})")
    limit = require_positive("budget", budget)
    log_work = d * math.log(n) - math.lgamma(d + 1)
    if log_work > math.log(limit):
        raise NotAvailable(
            f"the exact star discrepancy of n={n} points in d={d} takes about 10^{log_work / math.log(10):.0f}"
            f" steps, the budget is {limit:.0e}: use fewer points, a larger budget, or the L2 star discrepancy"
        )
    by_last = np.argsort(coordinates[:, -1], kind="stable")
    columns = np.ascontiguousarray(coordinates[by_last].T)
    return float(_largest_deviation(columns, np.arange(n), np.ones(n, np.bool_), 0, 1.0, 0.0))


@njit(cache=True)
def _largest_deviation(columns, inside, strictly, level, volume, best):  # type: ignore[no-untyped-def]
    """Return the largest deviation, at least `best`, of the boxes whose first `level` sides are fixed.

    `inside` are the points inside or on those sides, in the order of the last coordinate; `strictly` says which are not
    on them; `volume` is that of the sides.
    """
    d, n = columns.shape
    if d == 1:
        return _sweep_last(columns[0], inside, strictly, volume, best)
    places = columns[level][inside]
    inner, below = np.empty_like(inside), np.empty_like(strictly)
    for side in np.unique(np.append(places, 1.0))[::-1]:
        count = 0
        for position in range(len(places)):
            if places[position] <= side:
                inner[count] = inside[position]
                below[count] = strictly[position] and places[position] < side
                count += 1
        if max(volume * side, count / n) <= best:
            # Sides come in falling order and both bounds fall with the side: the rest is no better.
            break
        if level == d - 2:
            best = _sweep_last(columns[d - 1], inner[:count], below[:count], volume * side, best)
        else:
            best = _largest_deviation(columns, inner[:count], below[:count], level + 1, volume * side, best)
    return best


@njit(cache=True)
def _sweep_last(last, inside, strictly, volume, best):  # type: ignore[no-untyped-def]
    """Return the largest deviation, at least `best`, over the sides of the last coordinate."""
    n, strictly_below, position = last.size, 0, 0
    while position < inside.size:
        side = last[inside[position]]
        best = max(best, volume * side - strictly_below / n)
        while position < inside.size and last[inside[position]] == side:
            strictly_below += 1 if strictly[position] else 0
            position += 1
        best = max(best, position / n - volume * side)
    return max(best, volume - strictly_below / n)
