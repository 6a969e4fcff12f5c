"""The checks of one motion, at states a resolution apart or by a proof, compiled once and called by their address.

What `lane_check` says of the check of sixteen configurations holds for a motion's, too: planners call it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numba import cfunc, types

from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.addresses import (
    address_of,
    call_at,
    doubles_at,
    integers_at,
    matrix_at,
    singles_at,
)
from evenroad.robot.kernel.lane_check import ANY_LENGTH, check_address, scratch_memory, unpacked
from evenroad.robot.kernel.layout import inner, quick
from evenroad.robot.kernel.motion import span
from evenroad.robot.kernel.motion_proof import MOST_WAITING, is_proved
from evenroad.robot.kernel.motion_states import COUNTS, MOTIONS, Motion, World, are_free, blocked_states

LANES = at.LANES
Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

NO_END, START, BOTH_ENDS, COARSE, PROOF, STATES = range(6)
"""What a motion is checked for: that its states are free where neither end, its start or both are known to be; that no
more than sixteen states between free ends are, which before a proof is enough; that it is free throughout.  The last is
for no motion but sixteen states."""

_DESK = 15
"""Length of the desk: eleven entries of `World`, the memory of a motion, dim, capsules and pairs of capsules."""


class Checks(NamedTuple):
    """A world's checks as their callers hold them, made by `checks_of` for one call: few arrays are soon compiled.

    Attributes
    ----------
    address : int
        Of the check of a motion.
    resolution : float
        Largest distance between neighbouring states of a motion.
    desk : int64 array
        What that check reads: addresses and sizes of a world's tables and of memory, see `World`.
    memory : float64 array
        Keeps that memory.
    states : float64 array
        Sixteen configurations for `blocked`, sixteen numbers a coordinate.
    bounds : float64 array, shape (3, dim)
        Low, high and period of each coordinate.
    counts : int64 array, shape (3,)
        Motions asked for, configurations and batches tested.
    """

    address: int
    resolution: float
    desk: Ints
    memory: Floats
    states: Floats
    bounds: Floats
    counts: Ints


def addresses() -> tuple[int, int]:
    """Return the addresses, good for this process, that `checks_of` takes."""
    return check_address(), int(_motion_check.address)


@inner
def checks_of(
    addresses: tuple[int, int],
    resolution: float,
    bounds: Floats,
    tables: Ints,
    arms: Floats,
    pair_arms: Floats,
    counts: Ints,
) -> Checks:
    """Return the checks of a world.

    Parameters
    ----------
    addresses : two ints
        As `addresses` gives them.
    resolution, bounds, counts
        As in `Checks`.
    tables : int64 array
        ``ArmTables.lanes``; it, and the two that follow, must outlive what is returned.
    arms, pair_arms : float64 arrays
        ``RobotTables.speeds_by_joint``.
    """
    dim, capsules, pairs = bounds.shape[1], arms.shape[1], pair_arms.shape[1]
    ints, table = unpacked(tables)
    states, scratch = scratch_memory(addresses[0], dim, ints, table)
    own = 3 * dim + LANES + capsules + pairs + MOST_WAITING
    memory = np.empty(own + MOST_WAITING + (len(table) + 1) // 2)
    enlarged = memory[own + MOST_WAITING :].view(np.float32)
    # A loop, and addresses out of an intrinsic: what numpy has for both takes seconds to compile.
    for place in range(len(table)):
        enlarged[place] = table[place]
    desk = np.empty(_DESK, dtype=np.int64)
    desk[0], desk[1], desk[2], desk[3] = (
        addresses[0],
        address_of(bounds),
        address_of(states),
        address_of(counts),
    )
    desk[4], desk[5] = address_of(ints), address_of(table)
    desk[6], desk[7] = address_of(arms), address_of(pair_arms)
    desk[8], desk[9], desk[10] = address_of(scratch), address_of(enlarged), address_of(memory[own:])
    desk[11], desk[12], desk[13], desk[14] = address_of(memory), dim, capsules, pairs
    return Checks(addresses[1], resolution, desk, memory, states, bounds, counts)


@quick
def blocked(c: Checks) -> int:
    """Return the mask of the sixteen configurations in ``c.states`` that touch something."""
    return call_at(c.address, (c.states, c.states, STATES, 0.0, 0, 1.0, c.desk))


@quick
def motion_free(a: Floats, b: Floats, known: int, c: Checks) -> bool:
    """Return whether the motion from `a` to `b`, both within bounds, is free at its states.

    These are ``k / n`` of the way, n the number of segments of at most the resolution.  The first sixteen are spread
    over the motion; the others follow in stretches of sixteen neighbours, halves before quarters before eighths.

    Parameters
    ----------
    a, b : float64 arrays, shape (dim,)
        Its ends.
    known : int
        NO_END, START, BOTH_ENDS or COARSE: which ends are known to be free and not tested again.
    c : Checks
        The world.
    """
    return _checked(a, b, known, 0.0, 0, c)


@quick
def motion_proved(a: Floats, b: Floats, tolerance: float, most_batches: int, c: Checks) -> bool:
    """Return whether the motion from `a` to `b`, within bounds, is proved free: throughout, not at states alone.

    Parameters
    ----------
    a, b : float64 arrays, shape (dim,)
        Its ends.
    tolerance : float
        A stretch of which half moves nothing by more than this is not halved again [m].
    most_batches : int
        After so many batches of sixteen stretches the answer is no.
    c : Checks
        The world.
    """
    return _checked(a, b, PROOF, tolerance, most_batches, c)


@quick
def _checked(a: Floats, b: Floats, kind: int, tolerance: float, most_batches: int, c: Checks) -> bool:
    return call_at(c.address, (a, b, kind, tolerance, most_batches, c.resolution, c.desk)) != 0


@cfunc(
    types.int64(
        types.int64, types.int64, types.int64, types.float64, types.int64, types.float64, types.int64
    ),
    cache=True,
    error_model="numpy",
    _nrt=False,
)
def _motion_check(
    a: int, b: int, kind: int, tolerance: float, most_batches: int, resolution: float, desk: int
) -> int:
    """Return 1 where a motion is what `kind` says, else 0; for STATES the mask of those that touch something."""
    d = integers_at(desk, (_DESK,))
    dim, capsules, pairs = d[12], d[13], d[14]
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
        integers_at(d[10], (MOST_WAITING,)),
    )
    if kind == STATES:
        return blocked_states(w, w.table, LANES)
    # Bytes; eight for each double.
    room, row = d[11], 8 * dim
    speeds = room + 3 * row + 8 * LANES
    m = Motion(
        doubles_at(room, (dim,)),
        doubles_at(room + row, (dim,)),
        doubles_at(room + 2 * row, (dim,)),
        doubles_at(room + 3 * row, (LANES,)),
        doubles_at(speeds, (capsules,)),
        doubles_at(speeds + 8 * capsules, (pairs,)),
        doubles_at(speeds + 8 * (capsules + pairs), (MOST_WAITING,)),
    )
    begin, end = doubles_at(a, (dim,)), doubles_at(b, (dim,))
    for k in range(dim):
        m.start[k], m.end[k] = begin[k], end[k]
    segments = span(m.start, m.end, w.bounds, resolution, m.way)
    w.counts[MOTIONS] += 1
    if kind == PROOF:
        return 1 if is_proved(m, tolerance, most_batches, w) else 0
    exchanged = False
    for k in range(dim):
        exchanged |= m.start[k] != begin[k]
    first_state, last_state = 0, segments
    if kind >= BOTH_ENDS or (kind == START and not exchanged):
        first_state = 1
    if kind >= BOTH_ENDS or (kind == START and exchanged):
        last_state = segments - 1
    return 1 if are_free(m, segments, first_state, last_state, kind == COARSE, w) else 0
