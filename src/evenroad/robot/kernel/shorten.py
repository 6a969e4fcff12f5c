"""Shortening of paths in compiled code; a motion is only put in where it is proved free."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad.robot.kernel.inner import inner
from evenroad.robot.kernel.motion import enter
from evenroad.robot.kernel.tree_checks import (
    Checks,
    canonical,
    checks_of,
    distance_and_way,
    motion_free,
    motion_proved,
)

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Flags = npt.NDArray[np.bool_]

TOLERANCE = 1e-3
BATCHES = 64
"""Limits of the proof of a motion that would make the path shorter [m]."""

LAST_TOLERANCE = 1e-6
LAST_BATCHES = 1024
"""Limits for motions of the path as it was given [m]."""

WORTH_WHILE = 3e-3
"""Motions that shorten the path by less than this share are not looked at."""


@njit(cache=True, nogil=True)
def shorten_path(
    path: Floats,
    given_proved: bool,
    pairs: Floats,
    counts: Ints,
    address: int,
    resolution: float,
    bounds: Floats,
    tables: Ints,
    arms: Floats,
    pair_arms: Floats,
) -> tuple[Floats, Flags]:
    """Return a path that is no longer, and which of its motions are proved free.

    Parameters
    ----------
    path : float64 array, shape (p, dim), p >= 2
        Waypoints, every motion free.
    given_proved : bool
        Whether these are proved already.
    pairs : float64 array, shape (n, 2)
        Shares of the path's length, from 0 to 1: between which places a straight motion is tried.
    counts : int64 array, shape (3,)
        Added to: motions asked for, configurations and batches tested.
    address, resolution, bounds, tables, arms, pair_arms
        As ``tree_checks.checks_of`` takes them.
    """
    checks = checks_of(address, resolution, bounds, tables, arms, pair_arms, counts)
    dim = path.shape[1]
    points = np.empty((len(path) + len(pairs) + 4, dim))
    proved = np.empty(len(points), dtype=np.bool_)
    places, way = np.empty(len(points)), np.empty(dim)
    ends = np.empty((2, dim))
    size = len(path)
    for i in range(size):
        enter(path[i], bounds, points[i])
        proved[i] = given_proved
    size = _pass_by(points, proved, size, checks)
    _measure(points, places, size, way, checks)
    for row in range(len(pairs)):
        length = places[size - 1]
        low = min(pairs[row, 0], pairs[row, 1]) * length
        high = max(pairs[row, 0], pairs[row, 1]) * length
        first, last = 0, size - 2
        while first < size - 2 and places[first + 1] <= low:
            first += 1
        while last > 0 and places[last] >= high:
            last -= 1
        if first >= last:
            continue
        _place_at(points, places, first, low, ends[0], way, checks)
        _place_at(points, places, last, high, ends[1], way, checks)
        if high - low - distance_and_way(ends[0], ends[1], bounds, way) < WORTH_WHILE * length:
            continue
        if not _is_shortcut(ends[0], ends[1], checks):
            continue
        # What lies between goes, the two ends come in.
        begin = first if places[first] >= low else first + 1
        end = last + 1
        if size - (end - begin) + 2 > len(points):
            break
        _splice(points, proved, size, begin, end, ends)
        size += 2 - (end - begin)
        _measure(points, places, size, way, checks)
    size = _pass_by(points, proved, size, checks)
    for i in range(size - 1):
        if not proved[i]:
            proved[i] = motion_proved(points[i], points[i + 1], LAST_TOLERANCE, LAST_BATCHES, checks)
    return points[:size].copy(), proved[: size - 1].copy()


@inner
def _is_shortcut(a: Floats, b: Floats, checks: Checks) -> bool:
    """Return whether the motion between two free configurations is free and proved."""
    return motion_free(a, b, True, checks) and motion_proved(a, b, TOLERANCE, BATCHES, checks)


@inner
def _pass_by(points: Floats, proved: Flags, size: int, checks: Checks) -> int:
    """Go from each waypoint straight to the farthest one that can be reached; return how many are left."""
    i = 0
    while i < size - 2:
        j = size - 1
        while j > i + 1:
            if _is_shortcut(points[i], points[j], checks):
                for row in range(j, size):
                    for k in range(points.shape[1]):
                        points[i + 1 + row - j, k] = points[row, k]
                    proved[i + 1 + row - j] = proved[row]
                proved[i] = True
                size -= j - i - 1
                break
            # One after the other where few are left, in larger strides along a path of hundreds.
            j -= max(1, (j - i) // 8)
        i += 1
    return size


@inner
def _measure(points: Floats, places: Floats, size: int, way: Floats, checks: Checks) -> None:
    """Write how far along the path each waypoint is."""
    places[0] = 0.0
    for i in range(1, size):
        places[i] = places[i - 1] + distance_and_way(points[i - 1], points[i], checks.bounds, way)


@inner
def _place_at(
    points: Floats, places: Floats, i: int, along: float, into: Floats, way: Floats, checks: Checks
) -> None:
    """Write the configuration `along` the path, on the motion that begins at waypoint i."""
    length = distance_and_way(points[i], points[i + 1], checks.bounds, way)
    share = min((along - places[i]) / length, 1.0) if length > 0.0 else 0.0
    for k in range(len(into)):
        into[k] = points[i, k] + share * way[k]
    canonical(into, checks.bounds)


@inner
def _splice(points: Floats, proved: Flags, size: int, begin: int, end: int, ends: Floats) -> None:
    """Put the motion between `ends` in place of the waypoints from `begin` on, to before `end`."""
    grown = 2 - (end - begin)
    # From the second end on it is the rest of the motion that this lies on.
    rest = proved[end - 1]
    if grown > 0:
        for row in range(size - 1, end - 1, -1):
            points[row + grown], proved[row + grown] = points[row], proved[row]
    elif grown < 0:
        for row in range(end, size):
            points[row + grown], proved[row + grown] = points[row], proved[row]
    for k in range(points.shape[1]):
        points[begin, k], points[begin + 1, k] = ends[0, k], ends[1, k]
    proved[begin], proved[begin + 1] = True, rest
