"""The largest cube centred in the unit square or cube that holds no point: the linf-dispersion."""

from __future__ import annotations

import numpy as np
from numba import njit

from evenroad.points.measures.terms import Array

_SLABS = 32
"""Slabs that the search is split into; any number gives the same answer."""


def largest_hole(coordinates: Array) -> float:
    """Return the largest r such that some place of [0, 1]^d has linf-distance r to the nearest point.

    The unit cube is cut into slabs, taken in a fixed random order.  A slab is bisected only if it holds a larger
    hole than all before: a few of them, so the whole costs little more than one test of coverage (the
    randomised optimisation of Chan 1999).

    Parameters
    ----------
    coordinates : ndarray, shape (n, d)
        n >= 1 points, d = 2 or 3.
    """
    n, d = coordinates.shape
    ordered = coordinates[np.argsort(coordinates[:, -1], kind="stable")]
    if d == 3:
        first, edges = np.ascontiguousarray(ordered[:, 0]), np.linspace(0.0, 1.0, _SLABS + 1)
    else:
        # A square is a section of a cube: one slab without thickness, and every point in it.
        first, edges = np.zeros(n), np.zeros(2)
    middle, last = np.ascontiguousarray(ordered[:, -2]), np.ascontiguousarray(ordered[:, -1])
    by_middle = np.argsort(middle, kind="stable")
    best = 0.0
    for slab in np.random.default_rng(0).permutation(edges.size - 1):
        low, high = edges[slab], edges[slab + 1]
        if not _hole_exists(first, middle, last, by_middle, low, high, np.nextafter(best, 1.0)):
            continue
        reached, missed = np.nextafter(best, 1.0), 2.0
        while True:
            radius = 0.5 * (reached + missed)
            if radius in (reached, missed):
                break
            if _hole_exists(first, middle, last, by_middle, low, high, radius):
                reached = radius
            else:
                missed = radius
        best = float(reached)
    return best


@njit(cache=True)
def _hole_exists(first, middle, last, by_middle, low, high, radius):  # type: ignore[no-untyped-def]
    """Whether a place of [low, high] x [0, 1] x [0, 1] is at least `radius` from every point.

    Of all such places take the one that comes first, coordinate by coordinate: it is pushed against the low
    side of the box or against the high side of a point's open cube.  So only those values need be tried: for
    each in `first`, the line along `last` is swept through `middle`, and the gaps between the cubes on it are
    counted as cubes enter and leave.  Points are sorted by `last`; `by_middle` sorts them by `middle`.

    The cubes are compared by their rounded sides throughout: then a place on a side is never inside by
    rounding, and growing the radius never uncovers a place.
    """
    n = first.size
    near = np.empty(n, np.int64)
    on_line = np.zeros(n, np.bool_)
    for candidate in range(-1, n):
        place = low if candidate < 0 else first[candidate] + radius
        if place < low or place > high:
            continue
        count = 0
        for position in range(n):
            i = by_middle[position]
            on_line[i] = False
            if first[i] - radius < place < first[i] + radius:
                near[count] = i
                count += 1
        # With no cube the whole line is one gap.
        gaps = 1
        entering, leaving = 0, 0
        middle_place = 0.0
        while True:
            while entering < count and middle[near[entering]] - radius < middle_place:
                gaps += _gaps_opened_by(near[entering], last, on_line, radius)
                on_line[near[entering]] = True
                entering += 1
            while leaving < count and middle[near[leaving]] + radius <= middle_place:
                on_line[near[leaving]] = False
                gaps -= _gaps_opened_by(near[leaving], last, on_line, radius)
                leaving += 1
            if gaps > 0:
                return True
            # No gap means that a cube is on the line, so one is left to leave.
            middle_place = middle[near[leaving]] + radius
            if middle_place > 1.0:
                break
    return False


@njit(cache=True)
def _gaps_opened_by(point, last, on_line, radius):  # type: ignore[no-untyped-def]
    """Change of the number of gaps on the line when the cube of `point`, not on it yet, enters."""
    below, above = point - 1, point + 1
    while below >= 0 and not on_line[below]:
        below -= 1
    while above < last.size and not on_line[above]:
        above += 1
    end_below = last[below] + radius if below >= 0 else 0.0
    start_above = last[above] - radius if above < last.size else 1.0
    before = 1 if start_above >= end_below else 0
    after_below = 1 if last[point] - radius >= end_below else 0
    after_above = 1 if start_above >= last[point] + radius else 0
    return after_below + after_above - before
