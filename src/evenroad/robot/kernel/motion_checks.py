"""Checks of one motion at a time: at states a resolution apart, and proofs without gaps.

The proofs are those of ``evenroad.robot.certified``, sixteen stretches of a motion at once: every stretch is tested
in its middle with bodies enlarged by what half of the stretch can move them, and halved where that fails.

Both are compiled once, as a function that is called by its address: see ``lane_check``.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from numba import carray, cfunc, types

from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.addresses import (
    DOUBLES,
    INTEGERS,
    address_of,
    call_at,
    doubles_at,
    integers_at,
    singles_at,
)
from evenroad.robot.kernel.forward_kinematics import scratch_memory, unpacked
from evenroad.robot.kernel.lane_check import ANY_LENGTH, check_address
from evenroad.robot.kernel.layout import inner, quick
from evenroad.robot.kernel.motion import span

LANES = at.LANES
Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

MOTIONS, CONFIGURATIONS, BATCHES, COUNTS = range(4)
"""What is counted, and how many things that is."""

NO_END, START, BOTH_ENDS, COARSE, PROOF, STATES = range(6)
"""What a motion is checked for: that its states are free where neither end, its start or both are known to be; that no
more than sixteen states between free ends are, which before a proof is enough; that it is free throughout.  The last is
for no motion but sixteen states."""

_DESK = 15
"""Length of the desk: eleven entries of `_World`, the memory of a motion, dim, capsules and pairs of capsules."""

_UP = np.float32(1.0 + 3e-7)
"""What sums of single precision are multiplied by to be no less than the true ones."""

_STACK = 640
"""Stretches that may wait: 16 more at most for each halving, of which single precision bears some thirty."""


class Checks(NamedTuple):
    """A world's checks as their callers hold them, made by `checks_of` for one call: few arrays are soon compiled.

    Attributes
    ----------
    address : int
        Of the check of a motion.
    resolution : float
        Largest distance between neighbouring states of a motion.
    desk : int64 array
        What that check reads: addresses and sizes of a world's tables and of memory, see `_World`.
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


class _World(NamedTuple):
    """What the check of a motion reads, in the order of the desk.

    Attributes
    ----------
    check : int
        Address of the check of sixteen configurations.
    bounds, states, counts : arrays
        As in `Checks`.
    ints, table : arrays
        The tables of the lanes.
    arms, pair_arms : float64 arrays, shapes (dim, capsules) and (dim, capsule pairs)
        How fast each coordinate moves a capsule, and the two of a pair against each other, at most [m/rad].
    scratch : float32 array
        As ``forward_kinematics.scratch_memory`` makes it.
    enlarged : float32 array
        A copy of `table` with radii for proofs.
    levels : int64 array, shape (640,)
        How often stretches that are still to be proved were halved.
    """

    check: int
    bounds: Floats
    states: Floats
    counts: Ints
    ints: Ints
    table: Singles
    arms: Floats
    pair_arms: Floats
    scratch: Singles
    enlarged: Singles
    levels: Ints


class _Motion(NamedTuple):
    """A motion that is checked.

    Attributes
    ----------
    start, end, way : float64 arrays, shape (dim,)
        Its ends in a fixed order, and the way between them.
    share : float64 array, shape (16,)
        Where its states at hand are.
    speeds, pair_speeds : float64 arrays
        How far it moves each capsule and each pair at most [m].
    centres : float64 array, shape (640,)
        Middles of stretches that are still to be proved.
    """

    start: Floats
    end: Floats
    way: Floats
    share: Floats
    speeds: Floats
    pair_speeds: Floats
    centres: Floats


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
    states, _, scratch = scratch_memory(dim, ints, table)
    own = 3 * dim + LANES + capsules + pairs + _STACK
    memory = np.empty(own + _STACK + (len(table) + 1) // 2)
    enlarged = memory[own + _STACK :].view(np.float32)
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


@quick
def _blocked(w: _World, table: Singles, enough: int) -> int:
    w.counts[BATCHES] += 1
    return call_at(w.check, (w.scratch, w.states, w.ints, table, enough))


@quick
def _write_states(m: _Motion, w: _World) -> None:
    """Write the configurations at the sixteen shares of a motion."""
    for k in range(len(m.start)):
        start, way = m.start[k], m.way[k]
        states = w.states[k * LANES : (k + 1) * LANES]
        # A length that the compiler does not know: it then makes vectors of the loop instead of unrolling it.
        for lane in range(len(states)):
            states[lane] = start + m.share[lane] * way


@quick
def _are_free(m: _Motion, segments: int, first: int, last: int, sixteen_do: bool, w: _World) -> bool:
    """Return whether the states of a motion from number `first` to `last`, of 0 to `segments`, are free."""
    count = last - first + 1
    if count <= 0:
        return True
    rest = max(count - LANES, 0)
    stretches = (rest + LANES - 1) // LANES
    level = 0
    while (1 << level) < stretches:
        level += 1
    for lane in range(LANES):
        number = lane * (count - 1) // (LANES - 1) if rest > 0 else min(lane, count - 1)
        m.share[lane] = (first + number) / max(segments, 1)
    place = -1
    while True:
        _write_states(m, w)
        if place < 0:
            if last == segments:
                for k in range(len(m.end)):
                    # Exactly the end, so that a motion is free only where its end is.
                    w.states[k * LANES + LANES - 1] = m.end[k]
            w.counts[CONFIGURATIONS] += min(count, LANES)
        if _blocked(w, w.table, 1) != 0:
            return False
        if rest == 0 or sixteen_do:
            return True
        stretch = stretches
        while stretch >= stretches:
            place += 1
            if place == 1 << level:
                return True
            stretch = 0
            for bit in range(level):
                stretch |= ((place >> bit) & 1) << (level - 1 - bit)
        # The r-th of these has number r + 1 + gap, where gap counts the spread ones passed since the first.
        gap = 0
        for lane in range(LANES):
            rank = min(stretch * LANES + lane, rest - 1)
            while (gap + 1) * (count - 1) // (LANES - 1) - (gap + 1) <= rank:
                gap += 1
            m.share[lane] = (first + rank + 1 + gap) / segments
        w.counts[CONFIGURATIONS] += min(LANES, rest - stretch * LANES)


@quick
def _is_proved(m: _Motion, tolerance: float, most_batches: int, w: _World) -> bool:
    """Return whether a motion is proved free throughout; see `motion_proved`."""
    fastest = max(_write_speeds(w.arms, m.way, m.speeds), _write_speeds(w.pair_arms, m.way, m.pair_speeds))
    for lane in range(LANES):
        # The first stretch is the last to be pushed and the first to be looked at.
        m.centres[lane], w.levels[lane] = 1.0 - (lane + 0.5) / LANES, 0
    waiting, enlarged_for = LANES, -1
    half = 0.0
    for _ in range(most_batches):
        level = w.levels[waiting - 1]
        if level != enlarged_for:
            half = 0.5 / (LANES << level)
            _enlarge(half, m, w)
            enlarged_for = level
        count = 0
        while count < LANES and count < waiting and w.levels[waiting - 1 - count] == level:
            m.share[count] = m.centres[waiting - 1 - count]
            count += 1
        for lane in range(count, LANES):
            m.share[lane] = m.share[count - 1]
        _write_states(m, w)
        w.counts[CONFIGURATIONS] += count
        near = _blocked(w, w.enlarged, LANES) & ((1 << count) - 1)
        waiting -= count
        if near != 0 and (half * fastest < tolerance or waiting + 2 * LANES > _STACK):
            return False
        for lane in range(count - 1, -1, -1):
            if (near >> lane) & 1:
                for side in range(2):
                    m.centres[waiting] = m.share[lane] + (0.5 - side) * half
                    w.levels[waiting] = level + 1
                    waiting += 1
        if waiting == 0:
            return True
    return False


@quick
def _write_speeds(arms: Floats, way: Floats, speeds: Floats) -> float:
    """Write how far each body can move during the whole motion, and return the largest [m]."""
    for i in range(len(speeds)):
        speeds[i] = 0.0
    for k in range(len(way)):
        size = abs(way[k])
        row = arms[k]
        for i in range(len(row)):
            speeds[i] += row[i] * size
    largest = 0.0
    for i in range(len(speeds)):
        largest = max(largest, speeds[i])
    return largest


@quick
def _wider(length: np.float32, margin: float) -> np.float32:
    """Return a length of single precision that is no less than the sum of the two [m]."""
    return (length + np.float32(margin)) * _UP


@quick
def _enlarge(half: float, m: _Motion, w: _World) -> None:
    """Write lengths that are larger by what `half` of a motion can move the bodies: all that a test is decided by."""
    ints, table, wide = w.ints, w.table, w.enlarged
    place = ints[at.CAPSULE_FLOATS] + 6
    for i in range(len(m.speeds)):
        wide[place] = _wider(table[place], half * m.speeds[i])
        place += at.CAPSULE_FLOAT_ROW
    # What is around a body moves no farther than the fastest of its capsules.
    for body in range(ints[at.BODIES]):
        row = ints[at.BODY_INTS] + at.BODY_INT_ROW * body
        place = ints[at.BODY_FLOATS] + at.BODY_FLOAT_ROW * body
        fastest = 0.0
        for i in range(ints[row + 1], ints[row + 2]):
            fastest = max(fastest, m.speeds[i])
        for entry in range(place + 3, place + 7):
            wide[entry] = _wider(table[entry], half * fastest)
    row, first = ints[at.BODY_PAIR_INTS], ints[at.PAIR_FLOATS]
    for p in range(ints[at.BODY_PAIRS]):
        most = 0.0
        for pair in range(ints[row + 2], ints[row + 3]):
            margin = half * m.pair_speeds[pair]
            most = max(most, margin)
            place = first + at.PAIR_FLOAT_ROW * pair
            wide[place] = _wider(table[place], margin)
            wide[place + 1] = _wider(table[place + 1], margin)
        row += at.BODY_PAIR_INT_ROW
        place = ints[at.BODY_PAIR_FLOATS] + p
        wide[place] = _wider(table[place], most)


@cfunc(
    types.int64(DOUBLES, DOUBLES, types.int64, types.float64, types.int64, types.float64, INTEGERS),
    cache=True,
    error_model="numpy",
)
def _motion_check(
    a: Any, b: Any, kind: int, tolerance: float, most_batches: int, resolution: float, desk: Any
) -> int:
    """Return 1 where a motion is what `kind` says, else 0; for STATES the mask of those that touch something."""
    d = carray(desk, _DESK)
    dim, capsules, pairs = d[12], d[13], d[14]
    w = _World(
        d[0],
        carray(doubles_at(d[1]), (np.int64(3), dim)),
        carray(doubles_at(d[2]), dim * LANES),
        carray(integers_at(d[3]), COUNTS),
        carray(integers_at(d[4]), ANY_LENGTH),
        carray(singles_at(d[5]), ANY_LENGTH),
        carray(doubles_at(d[6]), (dim, capsules)),
        carray(doubles_at(d[7]), (dim, pairs)),
        carray(singles_at(d[8]), ANY_LENGTH),
        carray(singles_at(d[9]), ANY_LENGTH),
        carray(integers_at(d[10]), _STACK),
    )
    if kind == STATES:
        return _blocked(w, w.table, LANES)
    room = carray(doubles_at(d[11]), ANY_LENGTH)
    first, second, third = dim, 2 * dim, 3 * dim
    fourth = third + LANES
    fifth = fourth + capsules
    sixth = fifth + pairs
    m = _Motion(
        room[:first],
        room[first:second],
        room[second:third],
        room[third:fourth],
        room[fourth:fifth],
        room[fifth:sixth],
        room[sixth : sixth + _STACK],
    )
    begin, end = carray(a, dim), carray(b, dim)
    for k in range(dim):
        m.start[k], m.end[k] = begin[k], end[k]
    segments = span(m.start, m.end, w.bounds, resolution, m.way)
    w.counts[MOTIONS] += 1
    if kind == PROOF:
        return 1 if _is_proved(m, tolerance, most_batches, w) else 0
    exchanged = False
    for k in range(dim):
        exchanged |= m.start[k] != begin[k]
    first_state, last_state = 0, segments
    if kind >= BOTH_ENDS or (kind == START and not exchanged):
        first_state = 1
    if kind >= BOTH_ENDS or (kind == START and exchanged):
        last_state = segments - 1
    return 1 if _are_free(m, segments, first_state, last_state, kind == COARSE, w) else 0
