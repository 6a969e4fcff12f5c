"""The checks of one motion, at states a resolution apart or by a proof, compiled once and called by their address.

What `lane_check` says of the check of sixteen configurations holds for a motion's, too: planners call it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numba import types

from evenroad._njit import cfunc
from evenroad._shared import once
from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.addresses import (
    ANY_LENGTH,
    call_at,
    doubles_at,
    integers_at,
    matrix_at,
    singles_at,
)
from evenroad.robot.kernel.layout import LANES, MOST_WAITING, WORKSPACE, quick, quick_inlined
from evenroad.robot.kernel.motion import span
from evenroad.robot.kernel.motion_proof import is_proved
from evenroad.robot.kernel.motion_states import COUNTS, MOTIONS, Motion, World, are_free, blocked_states

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

NO_ENDPOINT, START, BOTH_ENDPOINTS, COARSE, SHORTCUT, PROOF, STATES = range(7)
"""What a motion is checked for: that its states are free where neither end, its start or both are known to be; that no
more than sixteen states between free ends are, which before a proof is enough; that they are, and then that it is free
throughout; that alone.  The last is for no motion but sixteen states."""


class Checks(NamedTuple):
    """A world's checks as their callers hold them, made by `checks_of` for one call.

    Attributes
    ----------
    address, workspace : int
        Of the check of a motion, and of what it reads: addresses and sizes of tables and of memory, see `World`.
    resolution : float
        Largest distance between neighbouring states of a motion.
    states : float64 array
        Sixteen configurations for `blocked`, sixteen numbers a coordinate.
    bounds : float64 array, shape (3, dim)
        Low, high and period of each coordinate.
    counts : int64 array, shape (3,)
        Motions asked for, configurations and batches tested.
    """

    address: int
    workspace: int
    resolution: float
    states: Floats
    bounds: Floats
    counts: Ints


@quick
def checks_of(
    addresses: int, resolution: float, tables: int, by_joint: int, memory: int, counts: int
) -> Checks:
    """Return the checks of a world; its memory is cut up, and what does not move put into its place."""
    ints, check = integers_at(tables, (ANY_LENGTH,)), integers_at(addresses, (3,))
    dim, capsules, pairs = ints[at.COORDINATES], ints[at.CAPSULES], ints[at.PAIRS]
    table = tables + 8 * ints[at.INTEGERS]
    bounds = matrix_at(by_joint, (3, dim))
    arms = by_joint + 8 * 3 * dim
    workspace = integers_at(memory, (WORKSPACE,))
    # Lanes begin on a cache line.
    states = (memory + 8 * WORKSPACE + 63) // 64 * 64
    scratch = states + 8 * LANES * dim
    # Behind the places the check of sixteen keeps where hulls are decided.
    enlarged = scratch + 4 * ints[at.SCRATCH] + 64
    floats = ints[at.BLOCK_FLOATS] + at.BLOCK_FLOAT_ROW * ints[at.BLOCKS]
    given, copied = singles_at(table, (floats,)), singles_at(enlarged, (floats,))
    for index in range(floats):
        copied[index] = given[index]
    motion = enlarged + (4 * floats + 7) // 8 * 8
    workspace[0], workspace[1], workspace[2], workspace[3], workspace[4], workspace[5] = (
        check[1],
        by_joint,
        states,
        counts,
        tables,
        table,
    )
    workspace[6], workspace[7], workspace[8], workspace[9] = (
        arms,
        arms + 8 * dim * capsules,
        scratch,
        enlarged,
    )
    workspace[10], workspace[11], workspace[12], workspace[13] = motion, dim, capsules, pairs
    call_at(check[1], (scratch, check[2], tables, table, 0))
    return Checks(
        check[0],
        memory,
        resolution,
        doubles_at(states, (dim * LANES,)),
        bounds,
        integers_at(counts, (COUNTS,)),
    )


@quick_inlined
def blocked(c: Checks) -> int:
    """Return the mask of the sixteen configurations in ``c.states`` that touch something."""
    return call_at(c.address, (0, 0, STATES, 0.0, 0, 1.0, c.workspace))


@quick_inlined
def motion_free(a: Floats, b: Floats, known: int, c: Checks) -> bool:
    """Return whether the motion from `a` to `b`, both within bounds, is free at its states.

    These are ``k / n`` of the way, n the number of segments of at most the resolution.  The first sixteen are spread
    over the motion; the others follow in stretches of sixteen neighbours, halves before quarters before eighths.
    `known` says which ends are known to be free and not tested again: NO_END, START, BOTH_ENDS or COARSE.
    """
    return call_at(c.address, (a, b, known, 0.0, 0, c.resolution, c.workspace)) != 0


@quick_inlined
def motion_proved(a: Floats, b: Floats, tolerance: float, most_batches: int, c: Checks) -> bool:
    """Return whether the motion from `a` to `b`, within bounds, is proved free: throughout, not at states alone.

    A stretch of which half moves nothing by more than the tolerance is not halved again [m], and after so many batches
    of sixteen stretches the answer is no.
    """
    return call_at(c.address, (a, b, PROOF, tolerance, most_batches, c.resolution, c.workspace)) != 0


@once
def motion_check_address() -> int:
    """Return the address, good for this process, of the check of a motion; compiled when first asked."""
    kind = types.int64(*[types.int64] * 3, types.float64, types.int64, types.float64, types.int64)
    return int(cfunc(kind, cache=True, error_model="numpy", _nrt=False)(_motion_check).address)


def _motion_check(
    a: int, b: int, kind: int, tolerance: float, most_batches: int, resolution: float, workspace: int
) -> int:
    """Return 1 where a motion is what `kind` says, else 0; for STATES the mask of those that touch something."""
    d = integers_at(workspace, (WORKSPACE,))
    buffer, dim, capsules, pairs = d[10], d[11], d[12], d[13]
    # Bytes; eight for each double.
    row = 8 * dim
    speeds = buffer + 3 * row + 8 * LANES
    waiting = speeds + 8 * (capsules + pairs)
    w = World(
        d[0],
        matrix_at(d[1], (3, dim)),
        doubles_at(d[2], (dim * LANES,)),
        integers_at(d[3], (COUNTS,)),
        integers_at(d[4], (ANY_LENGTH,)),
        singles_at(d[5], (ANY_LENGTH,)),
        matrix_at(d[6], (dim, capsules)),
        matrix_at(d[7], (dim, pairs)),
        singles_at(d[8], (ANY_LENGTH,)),
        singles_at(d[9], (ANY_LENGTH,)),
        integers_at(waiting + 8 * MOST_WAITING, (MOST_WAITING,)),
    )
    if kind == STATES:
        return blocked_states(w, w.table, LANES)
    m = Motion(
        doubles_at(buffer, (dim,)),
        doubles_at(buffer + row, (dim,)),
        doubles_at(buffer + 2 * row, (dim,)),
        doubles_at(buffer + 3 * row, (LANES,)),
        doubles_at(speeds, (capsules,)),
        doubles_at(speeds + 8 * capsules, (pairs,)),
        doubles_at(waiting, (MOST_WAITING,)),
    )
    begin, end = doubles_at(a, (dim,)), doubles_at(b, (dim,))
    for k in range(dim):
        m.start[k], m.end[k] = begin[k], end[k]
    segments = span(m.start, m.end, w.bounds, resolution, m.direction)
    w.counts[MOTIONS] += 1
    if kind != PROOF:
        exchanged = False
        for k in range(dim):
            exchanged |= m.start[k] != begin[k]
        first_state, last_state = 0, segments
        if kind >= BOTH_ENDPOINTS or (kind == START and not exchanged):
            first_state = 1
        if kind >= BOTH_ENDPOINTS or (kind == START and exchanged):
            last_state = segments - 1
        free = are_free(m, segments, first_state, last_state, kind >= COARSE, w)
        if kind != SHORTCUT or not free:
            return 1 if free else 0
        w.counts[MOTIONS] += 1
    return 1 if is_proved(m, tolerance, most_batches, w) else 0
