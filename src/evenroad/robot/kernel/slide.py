"""Waypoints that slide along what they touch: straight shortcuts leave them where they first touched it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.addresses import doubles_at, matrix_at
from evenroad.robot.kernel.layout import LANES, quick
from evenroad.robot.kernel.motion import canonical, distance_and_way, enter
from evenroad.robot.kernel.motion_checks import BOTH_ENDS, Checks, blocked, motion_free, motion_proved
from evenroad.robot.kernel.motion_states import CONFIGURATIONS, MOTIONS

Floats = npt.NDArray[np.float64]

TOLERANCE, BATCHES = 1e-4, 64
"""Limits of the proof of a motion [m]."""

NEAREST, FARTHEST = 0.2, 1.0
"""Places are this far away, as a share of the motion to the nearer neighbour."""

TRIED = 3
"""Of sixteen places so many of those that are free are tried, the shortest way first."""

WORTH_WHILE = 1e-3
"""The way from neighbour to neighbour becomes shorter by this share or more."""

SPARE = LANES + 1
"""Rows that a slide works in."""


@quick
def slide(
    points: Floats, size: int, begin: int, count: int, ball: Floats, first: int, room: int, checks: Checks
) -> bool:
    """Let waypoints slide one after the other, from `begin` on and round about; return whether any has moved.

    `ball`, (m, dim), are directions to be used in turn.  All motions are proved at the end, and where one is not,
    nothing has moved.  `room` has place for SPARE waypoints, sixteen numbers, the whole path and a number a waypoint.
    """
    dim = points.shape[1]
    kept = matrix_at(room + 8 * (SPARE * dim + LANES), (size, dim))
    moved = doubles_at(room + 8 * (SPARE * dim + LANES + size * dim), (size,))
    for i in range(size):
        moved[i] = 0.0
        for k in range(dim):
            kept[i, k] = points[i, k]
    any_moved = False
    for number in range(count):
        i = 1 + (begin + number) % (size - 2)
        if _slid(points, i, ball, first + LANES * number, room, checks):
            moved[i], any_moved = 1.0, True
    for i in range(size - 1):
        if moved[i] + moved[i + 1] > 0.0 and not motion_proved(
            points[i], points[i + 1], TOLERANCE, BATCHES, checks
        ):
            for row in range(size):
                for k in range(dim):
                    points[row, k] = kept[row, k]
            return False
    return any_moved


@quick
def _slid(points: Floats, i: int, ball: Floats, first: int, room: int, checks: Checks) -> bool:
    """Move a waypoint to the best of sixteen places around it by which the way is shorter and free at its states."""
    dim = points.shape[1]
    places, lengths = matrix_at(room, (SPARE, dim)), doubles_at(room + 8 * SPARE * dim, (LANES,))
    a, here, b, way = points[i - 1], points[i], points[i + 1], places[LANES]
    before, after = (
        distance_and_way(a, here, checks.bounds, way),
        distance_and_way(here, b, checks.bounds, way),
    )
    reach, least, inside = min(before, after), (before + after) * (1.0 - WORTH_WHILE), 0
    for lane in range(LANES):
        place, direction = places[lane], ball[(first + lane) % len(ball)]
        size = 0.0
        for k in range(dim):
            size += direction[k] * direction[k]
        size = NEAREST * (FARTHEST / NEAREST) ** (lane / (LANES - 1.0)) * reach / np.sqrt(size)
        # One of the two sides leads away.
        for _ in range(2):
            for k in range(dim):
                place[k] = here[k] + size * direction[k]
            within = enter(place, checks.bounds, place)
            canonical(place, checks.bounds)
            lengths[lane] = distance_and_way(a, place, checks.bounds, way) + distance_and_way(
                place, b, checks.bounds, way
            )
            if lengths[lane] <= least:
                inside |= int(within) << lane
                break
            size = -size
        for k in range(dim):
            checks.states[k * LANES + lane] = place[k]
    if inside == 0:
        return False
    inside &= ~blocked(checks)
    checks.counts[CONFIGURATIONS] += LANES
    # Sixteen states, as of a motion.
    checks.counts[MOTIONS] += 1
    for _ in range(TRIED):
        best = -1
        for lane in range(LANES):
            if (inside >> lane) & 1 and (best < 0 or lengths[lane] < lengths[best]):
                best = lane
        if best < 0:
            return False
        inside &= ~(1 << best)
        place = places[best]
        if motion_free(a, place, BOTH_ENDS, checks) and motion_free(place, b, BOTH_ENDS, checks):
            for k in range(dim):
                here[k] = place[k]
            return True
    return False
