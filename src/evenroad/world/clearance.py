"""The least clearance of a path from obstacles."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from evenroad._arrays import Floats

_MOST_PIECES = 200_000
"""Largest number of pieces of a path that are examined to tighten a bound."""


def least_distance(path: Floats, distance: Callable[[Floats], Floats], tolerance: float) -> float:
    """Return a lower bound of the least distance along a path, (p, dim), at most `tolerance` too small.

    `distance` returns the distances of configurations, (n, dim), from obstacles.  Between two configurations it changes
    by at most their distance.  So a piece of the path is halved while it may contain the minimum (S. Piyavskii, 1972,
    for functions with a Lipschitz constant).
    """
    waypoints = path if len(path) > 1 else np.repeat(path, 2, axis=0)
    a, b = waypoints[:-1], waypoints[1:]
    least, looked_at = float(distance(waypoints).min()), 0
    floor = np.inf
    while len(a):
        middle = 0.5 * (a + b)
        half = 0.5 * np.linalg.norm(b - a, axis=1)
        here = distance(middle)
        least = min(least, float(here.min()))
        looked_at += len(a)
        bound = here - half
        open_ = bound < least - tolerance
        if looked_at > _MOST_PIECES:
            return max(0.0, min(floor, float(bound.min())))
        floor = min(floor, float(bound[~open_].min(initial=np.inf)))
        a, b = np.concatenate([a[open_], middle[open_]]), np.concatenate([middle[open_], b[open_]])
    return max(0.0, min(least, floor))


def largest_kept(keeps: Callable[[float], bool], known: float, most: float, tolerance: float) -> float | None:
    """Return the largest clearance up to `most` that is proved, within `tolerance`; None if none is.

    `keeps` says whether a clearance is proved; `known` is the clearance of the query.
    """
    if not keeps(known):
        return None
    low, step = known, 16.0 * tolerance
    while low < most and keeps(high := min(low + step, most)):
        low, step = high, 2.0 * step
    if low >= most:
        return most
    while high - low > tolerance:
        middle = 0.5 * (low + high)
        if keeps(middle):
            low = middle
        else:
            high = middle
    return low
