"""The exact L-infinity star discrepancy, for as many points as an enumeration of critical boxes can take."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from evenroad._checks import require_positive
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.points.pointset import as_unit_points

BUDGET = 1e10
"""Default limit on the estimated work: about a minute."""


def star_discrepancy(points: object, budget: float = BUDGET) -> float:
    """Return the exact star discrepancy: the largest |share of the points in [0, y) - volume| over all boxes.

    The supremum is reached at boxes whose upper sides pass through points (or are 1), counted once without and
    once with the points on those sides (Niederreiter 1972; Gnewuch, Srivastav and Winzen 2009).  They are
    enumerated coordinate by coordinate, only through points that are still inside, and a branch is left where
    neither its volume nor its share of points exceeds the best found.

    Parameters
    ----------
    points : array_like or PointSet, shape (n, d)
        Coordinates in [0, 1), n >= 1.
    budget : float
        Of the estimated work, n^d / d!: at the default n is 140000, 3900, 700, 260 and 139 at most for d = 2 .. 6.

    Raises
    ------
    InvalidValue, NotAvailable
        For no points or bad coordinates; if the estimated work exceeds the budget.
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
    return float(_largest_deviation(np.ascontiguousarray(coordinates[by_last].T)))


@njit(cache=True)
def _largest_deviation(columns):  # type: ignore[no-untyped-def]
    """Star discrepancy of points sorted by their last coordinate; a depth-first walk with its own stack."""
    d, n = columns.shape
    # Level k has fixed the sides of coordinates 0 .. k - 1: the points inside or on them, in the order of the
    # last coordinate, whether they are strictly inside, and the sides still to try for coordinate k.
    inside = np.empty((d, n), np.int64)
    strictly = np.empty((d, n), np.bool_)
    counts = np.zeros(d, np.int64)
    volumes = np.ones(d)
    sides = np.empty((d, n + 1))
    next_side = np.zeros(d, np.int64)
    inside[0] = np.arange(n)
    strictly[0] = True
    counts[0] = n
    best = 0.0
    level = 0
    entering = True
    while level >= 0:
        if entering and level == d - 1:
            last = inside[level], strictly[level], counts[level], volumes[level]
            best = max(best, _sweep_last(columns[level], *last, n))
            level -= 1
            entering = False
            continue
        if entering:
            values = np.ones(counts[level] + 1)
            for position in range(counts[level]):
                values[position] = columns[level, inside[level, position]]
            values = np.unique(values)
            sides[level, : values.size] = values
            next_side[level] = values.size - 1
            entering = False
        if next_side[level] < 0:
            level -= 1
            continue
        side = sides[level, next_side[level]]
        next_side[level] -= 1
        volume = volumes[level] * side
        count = 0
        for position in range(counts[level]):
            point = inside[level, position]
            if columns[level, point] <= side:
                inside[level + 1, count] = point
                strictly[level + 1, count] = strictly[level, position] and columns[level, point] < side
                count += 1
        if max(volume, count / n) <= best:
            # Sides come in falling order and both bounds fall with the side: the rest is no better.
            level -= 1
            continue
        volumes[level + 1] = volume
        counts[level + 1] = count
        level += 1
        entering = True
    return best


@njit(cache=True)
def _sweep_last(last, inside, strictly, count, volume, n):  # type: ignore[no-untyped-def]
    """Largest deviation over the sides of the last coordinate, given the points inside the other sides."""
    best = 0.0
    strictly_below = 0
    position = 0
    while position < count:
        side = last[inside[position]]
        best = max(best, volume * side - strictly_below / n)
        while position < count and last[inside[position]] == side:
            strictly_below += 1 if strictly[position] else 0
            position += 1
        best = max(best, position / n - volume * side)
    return max(best, volume - strictly_below / n)
