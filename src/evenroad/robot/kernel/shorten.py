"""Shortcutting of paths in compiled code, with motions that are proved free."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.addresses import doubles_at, matrix_at
from evenroad.robot.kernel.lane_world import LaneWorld
from evenroad.robot.kernel.layout import MEMORY, Given, Pair, Triple, program, quick, quick_inlined
from evenroad.robot.kernel.motion import canonical, distance_and_direction, enter
from evenroad.robot.kernel.motion_checks import BOTH_ENDPOINTS, SHORTCUT, Checks, checks_of, motion_is
from evenroad.robot.kernel.motion_states import BATCHES as BATCHES_DONE
from evenroad.robot.kernel.motion_states import COUNTS, MOTIONS

Floats = npt.NDArray[np.float64]

TOLERANCE = 1e-3
BATCHES = 64
"""Limits of the proof of a motion that would make the path shorter [m]."""

WORTH_WHILE = 3e-3
SHORTCUT_WORTH_WHILE = 1e-3
"""Motions that shorten the path by less than this share are not looked at; the second where corners are cut."""

_BESIDE = 1 << 32
"""Two counts in one number: less to read after a call."""

MOST_SHORTCUTS, NO_LIMIT = 64, 1 << 60
"""So many cuts of corners are tried at most where nothing else is said; so many batches where there is no limit."""


class Buffer(NamedTuple):
    """A path as it changes: rows of waypoints, some to spare, and how far along it each is; room for a motion."""

    points: Floats
    positions: Floats
    endpoints: Floats
    direction: Floats


def shorten_path(
    world: LaneWorld, path: Floats, pairs: tuple[int, int], most_shortcuts: int = MOST_SHORTCUTS
) -> tuple[Floats, int]:
    """Return a path that is no longer, without waypoints where it is not finite, and how many motions were looked at.

    `pairs` is the address and length of what `share_pairs` returns: between these places, shares of the path's length,
    a straight motion is tried.
    """
    size, dim = path.shape
    rows = size + pairs[1] + most_shortcuts + 4
    memory, given = world.arguments(COUNTS + rows * (dim + 1) + 3 * dim)
    points = memory[-rows * dim :].reshape(rows, dim)
    memory[:COUNTS], points[:size] = 0.0, path
    motions, left = divmod(shorten_points((rows, size, dim), pairs, most_shortcuts, given), _BESIDE)
    return points[:left].copy(), motions


@program
def shorten_points(shape: Triple, shares: Pair, most_shortcuts: int, given: Given) -> int:
    """Do the work of `shorten_path` on the last rows of the memory; return how many are left, and 2^32 a motion.

    0 where the path is not finite.  The shape is that of all rows: how many, how many are the path's, and the length of
    one.
    """
    checks = checks_of(*given)
    rows, size, dim = shape
    pairs, own = matrix_at(shares[0], (shares[1], 2)), given[MEMORY] + 8 * COUNTS
    buffer = Buffer(
        matrix_at(own + 8 * (3 * dim + rows), (rows, dim)),
        doubles_at(own + 8 * 3 * dim, (rows,)),
        matrix_at(own, (2, dim)),
        doubles_at(own + 8 * 2 * dim, (dim,)),
    )
    points = buffer.points
    for i in range(size):
        for k in range(dim):
            if not np.isfinite(points[i, k]):
                return 0
        enter(points[i], checks.bounds, points[i])
    size = pass_by(points, size, True, checks)
    measure(buffer, size, checks)
    for row in range(shares[1]):
        size = pair_joined(buffer, size, pairs[row], True, checks)
    size = shortcut_corners(buffer, size, most_shortcuts, NO_LIMIT, True, checks)
    size = pass_by(points, size, True, checks)
    return size + _BESIDE * checks.counts[MOTIONS]


@quick
def pair_joined(buffer: Buffer, size: int, pair: Floats, proved: bool, checks: Checks) -> int:
    """Join two places, shares of the path's length, as `joined` does."""
    length = buffer.positions[size - 1]
    low, high = min(pair[0], pair[1]) * length, max(pair[0], pair[1]) * length
    return joined(buffer, size, low, high, WORTH_WHILE, proved, checks)


@quick
def shortcut_corners(
    buffer: Buffer, size: int, most_shortcuts: int, most_batches: int, proved: bool, checks: Checks
) -> int:
    """Cut corners, one after the other and again while that gains anything; return the path's new size.

    Of each the shorter side is cut off, or half of it, or a quarter.
    """
    positions = buffer.positions
    shortcuts, i, gained = 0, 1, positions[size - 1]
    while shortcuts < most_shortcuts and i < size - 1 and checks.counts[BATCHES_DONE] < most_batches:
        reach = min(positions[i] - positions[i - 1], positions[i + 1] - positions[i])
        length = positions[size - 1]
        for _ in range(3):
            shortcuts += 1
            size = joined(
                buffer, size, positions[i] - reach, positions[i] + reach, SHORTCUT_WORTH_WHILE, proved, checks
            )
            if positions[size - 1] < length:
                break
            reach *= 0.5
        i += 1
        if i >= size - 1 and positions[size - 1] < gained * (1.0 - WORTH_WHILE):
            i, gained = 1, positions[size - 1]
    return size


@quick
def joined(
    buffer: Buffer, size: int, low: float, high: float, worth_while: float, proved: bool, checks: Checks
) -> int:
    """Join two places of a path by a straight motion where that is worth while and free; return its new size.

    With `proved` the motion has to be proved as well, else it is free at its states.
    """
    positions, endpoints = buffer.positions, buffer.endpoints
    length = positions[size - 1]
    # Places as near as this to a waypoint are taken for it.
    near = 1e-9 * length
    first, last = 0, size - 2
    while first < size - 2 and positions[first + 1] <= low + near:
        first += 1
    while last > 0 and positions[last] >= high - near:
        last -= 1
    if first >= last:
        return size
    begin, end = first + 1, last + 1
    if low <= positions[first] + near:
        low, begin = positions[first], first
    if high >= positions[last + 1] - near:
        high, end = positions[last + 1], last + 2
    _write_point_at(buffer, first, low, endpoints[0], checks)
    _write_point_at(buffer, last, high, endpoints[1], checks)
    gain = high - low - distance_and_direction(endpoints[0], endpoints[1], checks.bounds, buffer.direction)
    if gain < worth_while * length or not _is_shortcut(endpoints[0], endpoints[1], proved, checks):
        return size
    # What lies between goes, the two ends come in.
    splice(buffer.points, size, begin, end, endpoints)
    size += 2 - (end - begin)
    measure(buffer, size, checks)
    return size


@quick_inlined
def _is_shortcut(a: Floats, b: Floats, proved: bool, checks: Checks) -> bool:
    """Return whether the motion between two free configurations is free and proved, or free at its states."""
    return motion_is(a, b, SHORTCUT if proved else BOTH_ENDPOINTS, TOLERANCE, BATCHES, checks)


@quick
def pass_by(points: Floats, size: int, proved: bool, checks: Checks) -> int:
    """Go from each waypoint straight to the farthest one that can be reached; return how many are left."""
    i = 0
    while i < size - 2:
        j = size - 1
        while j > i + 1:
            if _is_shortcut(points[i], points[j], proved, checks):
                for row in range(j, size):
                    move(points, row, i + 1 + row - j)
                size -= j - i - 1
                break
            # One after the other where few are left, in larger strides along a path of hundreds.
            j -= max(1, (j - i) // 8)
        i += 1
    return size


@quick_inlined
def measure(buffer: Buffer, size: int, checks: Checks) -> None:
    """Write how far along the path each waypoint is."""
    points, positions, direction = buffer.points, buffer.positions, buffer.direction
    positions[0] = 0.0
    for i in range(1, size):
        positions[i] = positions[i - 1] + distance_and_direction(
            points[i - 1], points[i], checks.bounds, direction
        )


@quick_inlined
def _write_point_at(buffer: Buffer, i: int, along: float, into: Floats, checks: Checks) -> None:
    """Write the configuration `along` the path, on the motion that begins at waypoint i."""
    points, positions, direction = buffer.points, buffer.positions, buffer.direction
    if along >= positions[i + 1]:
        for k in range(len(into)):
            into[k] = points[i + 1, k]
        return
    distance_and_direction(points[i], points[i + 1], checks.bounds, direction)
    share = (along - positions[i]) / (positions[i + 1] - positions[i])
    for k in range(len(into)):
        into[k] = points[i, k] + share * direction[k]
    canonical(into, checks.bounds)


@quick
def splice(points: Floats, size: int, begin: int, end: int, endpoints: Floats) -> None:
    """Put the motion between `endpoints` in place of the waypoints from `begin` on, to before `end`."""
    grown = 2 - (end - begin)
    if grown > 0:
        for row in range(size - 1, end - 1, -1):
            move(points, row, row + grown)
    elif grown < 0:
        for row in range(end, size):
            move(points, row, row + grown)
    for k in range(points.shape[1]):
        points[begin, k], points[begin + 1, k] = endpoints[0, k], endpoints[1, k]


@quick
def move(points: Floats, row: int, to: int) -> None:
    """Copy a waypoint."""
    move_to(points[row], points[to])


@quick
def move_to(q: Floats, into: Floats) -> None:
    """Copy a configuration."""
    for k in range(len(q)):
        into[k] = q[k]
