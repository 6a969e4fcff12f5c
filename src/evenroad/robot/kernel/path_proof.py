"""Proofs of a whole path in compiled code: a motion that is free only at its states is bent.

What was drawn tight lies so near to obstacles that between two states a motion may touch one.  A small bend mends that
where else all of the path would be lost.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.layout import quick
from evenroad.robot.kernel.motion import canonical, distance_and_direction, enter
from evenroad.robot.kernel.motion_checks import (
    BOTH_ENDPOINTS,
    NO_ENDPOINT,
    Checks,
    look_at,
    motion_free,
    motion_proved,
)
from evenroad.robot.kernel.shorten import move, move_to

Floats = npt.NDArray[np.float64]

TOLERANCE, PROOF_BATCHES = 1e-6, 1024
"""Limits of the proofs [m]."""

MOST_BENT, SAMPLES = 2, 8
"""So many motions of a path are bent, and so many places are tried for the waypoint in the middle of one: beside it as
far as two states are apart, about half of them do."""


@quick
def is_proved(points: Floats, size: int, checks: Checks) -> bool:
    """Return whether every motion of a path is proved free."""
    i = 0
    while i < size - 1 and _is_motion_proved(points[i], points[i + 1], checks):
        i += 1
    return i == size - 1


@quick
def proved_or_bent(
    points: Floats,
    size: int,
    wider: int,
    directions: Floats,
    there: Floats,
    direction: Floats,
    checks: Checks,
) -> int:
    """Return the size of a path whose motions are all proved free, those that were not with a bend; 0 where that fails.

    `points` have `MOST_BENT` rows to spare; `wider` is the address of the lengths by which states of bends are judged.
    """
    i = bent = 0
    while i < size - 1:
        if _is_motion_proved(points[i], points[i + 1], checks):
            i += 1
            continue
        if bent == MOST_BENT or not _is_bent(
            points[i], points[i + 1], wider, directions, there, direction, checks
        ):
            return 0
        for row in range(size - 1, i, -1):
            move(points, row, row + 1)
        move_to(there, points[i + 1])
        # Both of its motions are proved.
        size, i, bent = size + 1, i + 2, bent + 1
    return size


@quick
def _is_bent(
    a: Floats, b: Floats, wider: int, directions: Floats, there: Floats, direction: Floats, checks: Checks
) -> bool:
    """Write a place beside the middle of a motion by which both ways are proved; return whether there is one."""
    for number in range(SAMPLES):
        distance_and_direction(a, b, checks.bounds, direction)
        for k in range(len(a)):
            there[k] = a[k] + 0.5 * direction[k] + checks.resolution * directions[number % len(directions), k]
        within = enter(there, checks.bounds, there)
        canonical(there, checks.bounds)
        if not within:
            continue
        # What is free with larger bodies is nearly always proved, and known sooner.
        plain = look_at(wider, checks)
        free = motion_free(a, there, NO_ENDPOINT, checks) and motion_free(there, b, BOTH_ENDPOINTS, checks)
        look_at(plain, checks)
        if free and _is_motion_proved(a, there, checks) and _is_motion_proved(there, b, checks):
            return True
    return False


@quick
def _is_motion_proved(a: Floats, b: Floats, checks: Checks) -> bool:
    return motion_proved(a, b, TOLERANCE, PROOF_BATCHES, checks)
