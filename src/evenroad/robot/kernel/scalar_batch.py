"""Batches without explicit lanes: what runs where the vector type does not."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.motion import enter, span
from evenroad.robot.kernel.scalar import SEPARATE, first_contact
from evenroad.world.bisection_kernel import next_between

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


@njit(cache=True, nogil=True)
def configurations_free(q: Floats, bounds: Floats, ints: Ints, floats: Floats) -> npt.NDArray[np.bool_]:
    """Return which rows of `q`, (n, dim), are within `bounds`, (3, dim), and free: (n,)."""
    no_margins = np.zeros(1 + ints[at.CAPSULES] ** 2)
    frames, capsules = np.empty((ints[at.FRAMES] + 1, 12)), np.empty((ints[at.CAPSULES], 6))
    state = np.empty(q.shape[1])
    free = np.empty(len(q), dtype=np.bool_)
    for row in range(len(q)):
        free[row] = (
            enter(q[row], bounds, state)
            and first_contact(state, ints, floats, no_margins, no_margins, frames, capsules)[0] == SEPARATE
        )
    return free


@njit(cache=True, nogil=True)
def motions_free(
    a: Floats, b: Floats, resolution: float, bounds: Floats, ints: Ints, floats: Floats
) -> npt.NDArray[np.bool_]:
    """Return which motions, from rows of `a` to those of `b`, are free at both ends and at states between.

    The states are ``k / n`` of the way, n the number of segments of at most `resolution`, in the order of
    ``evenroad.world.bisection``.
    """
    no_margins = np.zeros(1 + ints[at.CAPSULES] ** 2)
    frames, capsules = np.empty((ints[at.FRAMES] + 1, 12)), np.empty((ints[at.CAPSULES], 6))
    dim = a.shape[1]
    start, end, way, state = np.empty(dim), np.empty(dim), np.empty(dim), np.empty(dim)
    free = np.empty(len(a), dtype=np.bool_)
    for row in range(len(a)):
        free[row] = False
        if not (enter(a[row], bounds, start) and enter(b[row], bounds, end)):
            continue
        segments = span(start, end, bounds, resolution, way)
        if first_contact(start, ints, floats, no_margins, no_margins, frames, capsules)[0] != SEPARATE:
            continue
        if first_contact(end, ints, floats, no_margins, no_margins, frames, capsules)[0] != SEPARATE:
            continue
        level, multiple, number = next_between(1, -1, segments)
        while number > 0:
            for k in range(dim):
                state[k] = start[k] + number / segments * way[k]
            if first_contact(state, ints, floats, no_margins, no_margins, frames, capsules)[0] != SEPARATE:
                break
            level, multiple, number = next_between(level, multiple, segments)
        free[row] = number == 0
    return free
