"""Batches in lanes: sixteen configurations at once, or sixteen states of a motion."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.contact import blocked_lanes
from evenroad.robot.kernel.forward_kinematics import scratch_memory, unpacked, write_values
from evenroad.robot.kernel.layout import inner
from evenroad.robot.kernel.motion import enter, span

LANES = at.LANES
Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]


@njit(cache=True, nogil=True)
def configurations_free(q: Floats, bounds: Floats, tables: Ints) -> npt.NDArray[np.bool_]:
    """Return which rows of `q`, (n, dim), are within `bounds`, (3, dim), and free: (n,)."""
    n, dim = q.shape
    ints, table = unpacked(tables)
    states, state, scratch = scratch_memory(dim, ints, table)
    free = np.empty(n, dtype=np.bool_)
    for first in range(0, n, LANES):
        count = min(LANES, n - first)
        for lane in range(LANES):
            # Lanes to spare repeat the last row.
            row = first + min(lane, count - 1)
            free[row] = enter(q[row], bounds, state)
            for k in range(dim):
                # What is out of bounds may be too large for single precision.
                states[k * LANES + lane] = state[k] if free[row] else bounds[0, k]
        write_values(scratch, states, ints, table)
        blocked = blocked_lanes(scratch, ints, table, np.int64(LANES))
        for lane in range(count):
            free[first + lane] &= (blocked >> lane) & 1 == 0
    return free


@njit(cache=True, nogil=True)
def motions_free(
    a: Floats, b: Floats, resolution: float, bounds: Floats, tables: Ints
) -> npt.NDArray[np.bool_]:
    """Return which motions, from rows of `a` to those of `b`, are free at both ends and at states between.

    The states are ``k / n`` of the way, n the number of segments of at most `resolution`.  The first sixteen
    are spread over the motion, ends included; the others follow in stretches of sixteen neighbours, halves
    before quarters before eighths.
    """
    m, dim = a.shape
    ints, table = unpacked(tables)
    states, start, scratch = scratch_memory(dim, ints, table)
    end, direction, share = np.empty(dim), np.empty(dim), np.empty(LANES)
    free = np.empty(m, dtype=np.bool_)
    for row in range(m):
        free[row] = False
        if not (enter(a[row], bounds, start) and enter(b[row], bounds, end)):
            continue
        segments = span(start, end, bounds, resolution, direction)
        for lane in range(LANES):
            state = min(lane, segments) if segments < LANES else lane * segments // (LANES - 1)
            share[lane] = state / max(segments, 1)
        _write_states(states, start, direction, share)
        for k in range(dim):
            # Exactly the end, so that a motion is free only where its end is.
            states[k * LANES + LANES - 1] = end[k]
        write_values(scratch, states, ints, table)
        if blocked_lanes(scratch, ints, table, np.int64(1)) == 0:
            free[row] = segments < LANES or _rest_is_free(
                scratch, states, start, direction, share, segments, ints, table
            )
    return free


@inner
def _rest_is_free(
    scratch: Singles,
    states: Floats,
    start: Floats,
    direction: Floats,
    share: Floats,
    segments: int,
    ints: Ints,
    table: Singles,
) -> bool:
    """Test the states between the sixteen that were spread over the motion."""
    rest = segments + 1 - LANES
    stretches = (rest + LANES - 1) // LANES
    level = 0
    while (1 << level) < stretches:
        level += 1
    for place in range(1 << level):
        stretch = 0
        for bit in range(level):
            stretch |= ((place >> bit) & 1) << (level - 1 - bit)
        if stretch >= stretches:
            continue
        # The r-th of these states has number r + 1 + gap, where gap counts the spread ones passed since the start.
        gap = 0
        for lane in range(LANES):
            rank = min(stretch * LANES + lane, rest - 1)
            while (gap + 1) * segments // (LANES - 1) - (gap + 1) <= rank:
                gap += 1
            share[lane] = (rank + 1 + gap) / segments
        _write_states(states, start, direction, share)
        write_values(scratch, states, ints, table)
        if blocked_lanes(scratch, ints, table, np.int64(1)) != 0:
            return False
    return True


@inner
def _write_states(states: Floats, start: Floats, direction: Floats, share: Floats) -> None:
    """Write the configurations at sixteen shares of a motion."""
    for k in range(len(start)):
        for lane in range(LANES):
            states[k * LANES + lane] = start[k] + share[lane] * direction[k]
