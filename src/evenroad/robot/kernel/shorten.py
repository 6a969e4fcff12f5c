"""Shortening of paths in compiled code; a motion is only put in where it is proved free."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.addresses import doubles_at, matrix_at
from evenroad.robot.kernel.lane_world import LaneWorld
from evenroad.robot.kernel.layout import LANES, program, quick, quick_inlined
from evenroad.robot.kernel.motion import canonical, distance_and_way, enter
from evenroad.robot.kernel.motion_checks import (
    COARSE,
    Checks,
    checks_of,
    motion_free,
    motion_proved,
)
from evenroad.robot.kernel.motion_states import BATCHES as BATCHES_DONE
from evenroad.robot.kernel.motion_states import COUNTS, MOTIONS
from evenroad.robot.kernel.slide import SPARE, slide

Floats = npt.NDArray[np.float64]

TOLERANCE = 1e-3
BATCHES = 64
"""Limits of the proof of a motion that would make the path shorter [m]."""

WORTH_WHILE = 3e-3
CUT_WORTH_WHILE = 1e-3
"""Motions that shorten the path by less than this share are not looked at; the second where corners are cut."""

SLIDES, PAIRS, ENOUGH = 8, 4, 3e-3
"""After so many slides so many pairs are tried, again and again until both together gain less than this share."""

_BESIDE = 1 << 32
"""Two counts in one number: less to read after a call."""


def shorten_path(
    world: LaneWorld,
    path: Floats,
    most_cuts: int,
    most_batches: int,
    pairs: int,
    count: int,
    most_slides: int = 0,
    ball: int = 0,
    ball_count: int = 0,
) -> tuple[Floats, int]:
    """Return a path that is no longer, without waypoints where it is not finite, and how many motions were looked at.

    Parameters
    ----------
    world : LaneWorld
        The robot in its scene.
    path : float64 array, shape (p, dim), p >= 2
        Waypoints, every motion free.
    most_cuts : int
        So many cuts of corners are tried at most.
    most_batches : int
        After so many batches of sixteen checks nothing more is tried; of slides, which come before cuts, no more.
    pairs, count
        Address of a float64 array, (count, 2): shares of the path's length, from 0 to 1, between which places a
        straight motion is tried.
    most_slides : int
        So often a waypoint slides at most; 0 for pairs alone.
    ball, ball_count
        Address of a float64 array, (ball_count, dim): directions of slides.
    """
    size, dim = path.shape
    rows = size + count + most_cuts + most_slides + PAIRS + 4
    room, arguments = world.arguments(COUNTS + (2 * dim + 2) * rows + (SPARE + 3) * dim + LANES)
    points = room[-rows * dim :].reshape(rows, dim)
    room[:COUNTS], points[:size] = 0.0, path
    work = pairs, count, most_cuts, most_batches, most_slides, ball, ball_count
    motions, left = divmod(shorten_points(rows, size, dim, *work, *arguments), _BESIDE)
    return points[:left].copy(), motions


@program
def shorten_points(
    rows: int,
    size: int,
    dim: int,
    shares: int,
    count: int,
    most_cuts: int,
    most_batches: int,
    most_slides: int,
    ball: int,
    ball_count: int,
    check: int,
    resolution: float,
    tables: int,
    by_joint: int,
    memory: int,
    room: int,
) -> int:
    """Do the work of `shorten_path` on the last `rows` of the memory; return how many are left, and 2^32 a motion.

    0 where the path is not finite.
    """
    checks = checks_of(check, resolution, tables, by_joint, memory, room)
    pairs, own = matrix_at(shares, (count, 2)), room + 8 * COUNTS
    ends, way = matrix_at(own, (2, dim)), doubles_at(own + 8 * 2 * dim, (dim,))
    places = doubles_at(own + 8 * 3 * dim, (rows,))
    sliding, steps = own + 8 * (3 * dim + rows), matrix_at(ball, (ball_count, dim))
    points = matrix_at(sliding + 8 * ((SPARE + rows) * dim + LANES + rows), (rows, dim))
    for i in range(size):
        for k in range(dim):
            if not np.isfinite(points[i, k]):
                return 0
        enter(points[i], checks.bounds, points[i])
    size = _pass_by(points, size, checks)
    _measure(points, places, size, way, checks)
    if most_slides > 0:
        size = _slide_on(
            points, places, size, pairs, steps, most_slides, most_batches, sliding, ends, way, checks
        )
        # Cuts are few, and worth more than their checks where waypoints have slid.
        size = _cut_corners(points, places, size, most_cuts, 1 << 60, ends, way, checks)
    else:
        for row in range(count):
            if checks.counts[BATCHES_DONE] >= most_batches:
                break
            size = _pair_joined(points, places, size, pairs[row], ends, way, checks)
        size = _cut_corners(points, places, size, most_cuts, most_batches, ends, way, checks)
    if checks.counts[BATCHES_DONE] < most_batches:
        size = _pass_by(points, size, checks)
    return size + _BESIDE * checks.counts[MOTIONS]


@quick
def _slide_on(
    points: Floats,
    places: Floats,
    size: int,
    pairs: Floats,
    steps: Floats,
    most_slides: int,
    most_batches: int,
    room: int,
    ends: Floats,
    way: Floats,
    checks: Checks,
) -> int:
    """Let waypoints slide, try pairs and pass by what is not needed, again and again; return the path's new size."""
    slides = pair = 0
    while size > 2 and slides < most_slides and checks.counts[BATCHES_DONE] < most_batches:
        before = places[size - 1]
        if slide(points, size, slides, SLIDES, steps, LANES * slides, room, checks):
            _measure(points, places, size, way, checks)
        slides += SLIDES
        for _ in range(PAIRS):
            size = _pair_joined(points, places, size, pairs[pair], ends, way, checks)
            pair = (pair + 1) % len(pairs)
        if size > 2:
            size = _pass_by(points, size, checks)
            _measure(points, places, size, way, checks)
        if places[size - 1] > before * (1.0 - ENOUGH):
            break
    return size


@quick
def _pair_joined(
    points: Floats, places: Floats, size: int, pair: Floats, ends: Floats, way: Floats, checks: Checks
) -> int:
    """Join two places, shares of the path's length, where that is worth while and free; return its new size."""
    low, high = min(pair[0], pair[1]) * places[size - 1], max(pair[0], pair[1]) * places[size - 1]
    return _joined(points, places, size, low, high, WORTH_WHILE, ends, way, checks)


@quick
def _cut_corners(
    points: Floats,
    places: Floats,
    size: int,
    most_cuts: int,
    most_batches: int,
    ends: Floats,
    way: Floats,
    checks: Checks,
) -> int:
    """Cut corners, one after the other and again while that gains anything; return the path's new size.

    Of each the shorter side is cut off, or half of it, or a quarter.
    """
    cuts, i, gained = 0, 1, places[size - 1]
    while cuts < most_cuts and i < size - 1 and checks.counts[BATCHES_DONE] < most_batches:
        reach = min(places[i] - places[i - 1], places[i + 1] - places[i])
        length = places[size - 1]
        for _ in range(3):
            cuts += 1
            low, high = places[i] - reach, places[i] + reach
            size = _joined(points, places, size, low, high, CUT_WORTH_WHILE, ends, way, checks)
            if places[size - 1] < length:
                break
            reach *= 0.5
        i += 1
        if i >= size - 1 and places[size - 1] < gained * (1.0 - WORTH_WHILE):
            i, gained = 1, places[size - 1]
    return size


@quick
def _joined(
    points: Floats,
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
    _splice(points, size, begin, end, ends)
    size += 2 - (end - begin)
    _measure(points, places, size, way, checks)
    return size


@quick_inlined
def _is_shortcut(a: Floats, b: Floats, checks: Checks) -> bool:
    """Return whether the motion between two free configurations is free and proved."""
    return motion_free(a, b, COARSE, checks) and motion_proved(a, b, TOLERANCE, BATCHES, checks)


@quick
def _pass_by(points: Floats, size: int, checks: Checks) -> int:
    """Go from each waypoint straight to the farthest one that can be reached; return how many are left."""
    i = 0
    while i < size - 2:
        j = size - 1
        while j > i + 1:
            if _is_shortcut(points[i], points[j], checks):
                for row in range(j, size):
                    _move(points, row, i + 1 + row - j)
                size -= j - i - 1
                break
            # One after the other where few are left, in larger strides along a path of hundreds.
            j -= max(1, (j - i) // 8)
        i += 1
    return size


@quick_inlined
def _measure(points: Floats, places: Floats, size: int, way: Floats, checks: Checks) -> None:
    """Write how far along the path each waypoint is."""
    places[0] = 0.0
    for i in range(1, size):
        places[i] = places[i - 1] + distance_and_way(points[i - 1], points[i], checks.bounds, way)


@quick_inlined
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
def _splice(points: Floats, size: int, begin: int, end: int, ends: Floats) -> None:
    """Put the motion between `ends` in place of the waypoints from `begin` on, to before `end`."""
    grown = 2 - (end - begin)
    if grown > 0:
        for row in range(size - 1, end - 1, -1):
            _move(points, row, row + grown)
    elif grown < 0:
        for row in range(end, size):
            _move(points, row, row + grown)
    for k in range(points.shape[1]):
        points[begin, k], points[begin + 1, k] = ends[0, k], ends[1, k]


@quick
def _move(points: Floats, row: int, to: int) -> None:
    """Copy a waypoint."""
    for k in range(points.shape[1]):
        points[to, k] = points[row, k]
