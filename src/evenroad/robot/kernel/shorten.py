"""Shortening of paths in compiled code; a motion is only put in where it is proved free."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad.robot.kernel.layout import quick
from evenroad.robot.kernel.motion import canonical, distance_and_way, enter
from evenroad.robot.kernel.motion_checks import COARSE, Checks, checks_of, motion_free, motion_proved

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
CUT_WORTH_WHILE = 1e-3
"""Motions that shorten the path by less than this share are not looked at; the second where corners are cut."""

MOST_CUTS = 64
"""So many cuts of corners are tried at most."""


@njit(cache=True, nogil=True, error_model="numpy")
def shorten_path(
    path: Floats,
    given_proved: bool,
    pairs: Floats,
    counts: Ints,
    addresses: tuple[int, int],
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
    addresses, resolution, bounds, tables, arms, pair_arms
        As ``motion_checks.checks_of`` takes them.
    """
    checks = checks_of(addresses, resolution, bounds, tables, arms, pair_arms, counts)
    dim = path.shape[1]
    room = len(path) + len(pairs) + MOST_CUTS + 4
    points, proved, places = np.empty((room, dim)), np.empty(room, dtype=np.bool_), np.empty(room)
    ends, way = np.empty((2, dim)), np.empty(dim)
    size = len(path)
    for i in range(size):
        enter(path[i], bounds, points[i])
        proved[i] = given_proved
    size = _pass_by(points, proved, size, checks)
    _measure(points, places, size, way, checks)
    for row in range(len(pairs)):
        low = min(pairs[row, 0], pairs[row, 1]) * places[size - 1]
        high = max(pairs[row, 0], pairs[row, 1]) * places[size - 1]
        size = _joined(points, proved, places, size, low, high, WORTH_WHILE, ends, way, checks)
    cuts, i, gained = 0, 1, places[size - 1]
    # Corners, one after the other and again while that gains anything: the shorter side, half of it, a quarter.
    while cuts < MOST_CUTS and i < size - 1:
        reach = min(places[i] - places[i - 1], places[i + 1] - places[i])
        length = places[size - 1]
        for _ in range(3):
            cuts += 1
            size = _joined(
                points,
                proved,
                places,
                size,
                places[i] - reach,
                places[i] + reach,
                CUT_WORTH_WHILE,
                ends,
                way,
                checks,
            )
            if places[size - 1] < length:
                break
            reach *= 0.5
        i += 1
        if i >= size - 1 and places[size - 1] < gained * (1.0 - WORTH_WHILE):
            i, gained = 1, places[size - 1]
    size = _pass_by(points, proved, size, checks)
    for i in range(size - 1):
        if not proved[i]:
            proved[i] = motion_proved(points[i], points[i + 1], LAST_TOLERANCE, LAST_BATCHES, checks)
    return points[:size].copy(), proved[: size - 1].copy()


@quick
def _joined(
    points: Floats,
    proved: Flags,
    places: Floats,
    size: int,
    low: float,
    high: float,
    worth_while: float,
    ends: Floats,
    way: Floats,
    checks: Checks,
) -> int:
    """Join two places of a path by a straight motion where that is worth while and free; return its new size."""
    length = places[size - 1]
    # Places as near as this to a waypoint are taken for it.
    near = 1e-9 * length
    first, last = 0, size - 2
    while first < size - 2 and places[first + 1] <= low + near:
        first += 1
    while last > 0 and places[last] >= high - near:
        last -= 1
    if first >= last:
        return size
    begin, end = first + 1, last + 1
    if low <= places[first] + near:
        low, begin = places[first], first
    if high >= places[last + 1] - near:
        high, end = places[last + 1], last + 2
    _place_at(points, places, first, low, ends[0], way, checks)
    _place_at(points, places, last, high, ends[1], way, checks)
    gain = high - low - distance_and_way(ends[0], ends[1], checks.bounds, way)
    if gain < worth_while * length or not _is_shortcut(ends[0], ends[1], checks):
        return size
    # What lies between goes, the two ends come in.
    _splice(points, proved, size, begin, end, ends)
    size += 2 - (end - begin)
    _measure(points, places, size, way, checks)
    return size


@quick
def _is_shortcut(a: Floats, b: Floats, checks: Checks) -> bool:
    """Return whether the motion between two free configurations is free and proved."""
    return motion_free(a, b, COARSE, checks) and motion_proved(a, b, TOLERANCE, BATCHES, checks)


@quick
def _pass_by(points: Floats, proved: Flags, size: int, checks: Checks) -> int:
    """Go from each waypoint straight to the farthest one that can be reached; return how many are left."""
    i = 0
    while i < size - 2:
        j = size - 1
        while j > i + 1:
            if _is_shortcut(points[i], points[j], checks):
                for row in range(j, size):
                    _move(points, proved, row, i + 1 + row - j)
                proved[i] = True
                size -= j - i - 1
                break
            # One after the other where few are left, in larger strides along a path of hundreds.
            j -= max(1, (j - i) // 8)
        i += 1
    return size


@quick
def _measure(points: Floats, places: Floats, size: int, way: Floats, checks: Checks) -> None:
    """Write how far along the path each waypoint is."""
    places[0] = 0.0
    for i in range(1, size):
        places[i] = places[i - 1] + distance_and_way(points[i - 1], points[i], checks.bounds, way)


@quick
def _place_at(
    points: Floats, places: Floats, i: int, along: float, into: Floats, way: Floats, checks: Checks
) -> None:
    """Write the configuration `along` the path, on the motion that begins at waypoint i."""
    if along >= places[i + 1]:
        for k in range(len(into)):
            into[k] = points[i + 1, k]
        return
    distance_and_way(points[i], points[i + 1], checks.bounds, way)
    share = (along - places[i]) / (places[i + 1] - places[i])
    for k in range(len(into)):
        into[k] = points[i, k] + share * way[k]
    canonical(into, checks.bounds)


@quick
def _splice(points: Floats, proved: Flags, size: int, begin: int, end: int, ends: Floats) -> None:
    """Put the motion between `ends` in place of the waypoints from `begin` on, to before `end`."""
    grown = 2 - (end - begin)
    # From the second end on it is the rest of the motion that this lies on.
    rest = proved[end - 1]
    if grown > 0:
        for row in range(size - 1, end - 1, -1):
            _move(points, proved, row, row + grown)
    elif grown < 0:
        for row in range(end, size):
            _move(points, proved, row, row + grown)
    for k in range(points.shape[1]):
        points[begin, k], points[begin + 1, k] = ends[0, k], ends[1, k]
    proved[begin], proved[begin + 1] = True, rest


@quick
def _move(points: Floats, proved: Flags, row: int, to: int) -> None:
    """Copy a waypoint, and whether the motion that begins there is proved."""
    for k in range(points.shape[1]):
        points[to, k] = points[row, k]
    proved[to] = proved[row]
