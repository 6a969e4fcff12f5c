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
from evenroad.robot.kernel.forward_kinematics import scratch_memory, unpacked
from evenroad.robot.kernel.lane_check import ANY_LENGTH, DOUBLES, INTEGERS, SINGLES, call_at, check_address
from evenroad.robot.kernel.layout import inner, quick
from evenroad.robot.kernel.motion import span

LANES = at.LANES
Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

MOTIONS, CONFIGURATIONS, BATCHES, COUNTS = range(4)
"""What is counted, and how many things that is."""

NO_END, START, BOTH_ENDS, COARSE, PROOF = range(5)
"""What a motion is checked for: that its states are free where neither end, its start or both are known to be; that no
more than sixteen states between free ends are, which before a proof is enough; that it is free throughout."""

_UP = np.float32(1.0 + 3e-7)
"""What sums of single precision are multiplied by to be no less than the true ones."""

_STACK = 640
"""Stretches that may wait: 16 more at most for each halving, of which single precision bears some thirty."""


class Checks(NamedTuple):
    """A world's tables and the memory that its checks need; made by `checks_of` for one call.

    Attributes
    ----------
    addresses : two ints
        Of the check of sixteen configurations and of that of a motion.
    resolution : float
        Largest distance between neighbouring states of a motion.
    bounds : float64 array, shape (3, dim)
        Low, high and period of each coordinate.
    ints, table : arrays
        The tables of the lanes.
    enlarged : float32 array
        A copy of `table` with radii for proofs.
    arms, pair_arms : float64 arrays, shapes (dim, capsules) and (dim, capsule pairs)
        How fast each coordinate moves a capsule, and the two of a pair against each other, at most [m/rad].
    states, scratch : arrays
        As ``forward_kinematics.scratch_memory`` makes them.
    room : float64 array
        Memory of one motion.
    levels : int64 array, shape (640,)
        How often stretches that are still to be proved were halved.
    counts : int64 array, shape (3,)
        Motions asked for, configurations and batches tested.
    """

    addresses: tuple[int, int]
    resolution: float
    bounds: Floats
    ints: Ints
    table: Singles
    enlarged: Singles
    arms: Floats
    pair_arms: Floats
    states: Floats
    scratch: Singles
    room: Floats
    levels: Ints
    counts: Ints


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
    """Return the checks of a world, from what `Checks` says of it and ``ArmTables.lanes``."""
    dim = bounds.shape[1]
    ints, table = unpacked(tables)
    states, _, scratch = scratch_memory(dim, ints, table)
    room = np.empty(3 * dim + LANES + arms.shape[1] + pair_arms.shape[1] + _STACK)
    levels = np.empty(_STACK, dtype=np.int64)
    return Checks(
        addresses,
        resolution,
        bounds,
        ints,
        table,
        table.copy(),
        arms,
        pair_arms,
        states,
        scratch,
        room,
        levels,
        counts,
    )


@quick
def blocked(c: Checks, table: Singles, enough: int) -> int:
    """Return the mask of the sixteen configurations in ``c.states`` that touch something."""
    c.counts[BATCHES] += 1
    return call_at(c.addresses[0], (c.scratch, c.states, c.ints, table, enough))


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
    arguments = (
        a, b, kind, tolerance, most_batches,
        c.addresses[0], c.addresses[1], c.resolution, c.bounds.shape[1], c.bounds, c.ints, c.table, c.enlarged,
        c.arms, c.arms.shape[1], c.pair_arms, c.pair_arms.shape[1],
        c.states, c.scratch, c.room, c.levels, c.counts,
    )  # fmt: skip
    return call_at(c.addresses[1], arguments) != 0


@quick
def _write_states(m: _Motion, c: Checks) -> None:
    """Write the configurations at the sixteen shares of a motion."""
    for k in range(len(m.start)):
        start, way = m.start[k], m.way[k]
        states = c.states[k * LANES : (k + 1) * LANES]
        # A length that the compiler does not know: it then makes vectors of the loop instead of unrolling it.
        for lane in range(len(states)):
            states[lane] = start + m.share[lane] * way


@quick
def _are_free(m: _Motion, segments: int, first: int, last: int, sixteen_do: bool, c: Checks) -> bool:
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
        _write_states(m, c)
        if place < 0:
            if last == segments:
                for k in range(len(m.end)):
                    # Exactly the end, so that a motion is free only where its end is.
                    c.states[k * LANES + LANES - 1] = m.end[k]
            c.counts[CONFIGURATIONS] += min(count, LANES)
        if blocked(c, c.table, 1) != 0:
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
        c.counts[CONFIGURATIONS] += min(LANES, rest - stretch * LANES)


@quick
def _is_proved(m: _Motion, tolerance: float, most_batches: int, c: Checks) -> bool:
    """Return whether a motion is proved free throughout; see `motion_proved`."""
    fastest = max(_write_speeds(c.arms, m.way, m.speeds), _write_speeds(c.pair_arms, m.way, m.pair_speeds))
    for lane in range(LANES):
        # The first stretch is the last to be pushed and the first to be looked at.
        m.centres[lane], c.levels[lane] = 1.0 - (lane + 0.5) / LANES, 0
    waiting, enlarged_for = LANES, -1
    half = 0.0
    for _ in range(most_batches):
        level = c.levels[waiting - 1]
        if level != enlarged_for:
            half = 0.5 / (LANES << level)
            _enlarge(half, m, c)
            enlarged_for = level
        count = 0
        while count < LANES and count < waiting and c.levels[waiting - 1 - count] == level:
            m.share[count] = m.centres[waiting - 1 - count]
            count += 1
        for lane in range(count, LANES):
            m.share[lane] = m.share[count - 1]
        _write_states(m, c)
        c.counts[CONFIGURATIONS] += count
        near = blocked(c, c.enlarged, LANES) & ((1 << count) - 1)
        waiting -= count
        if near != 0 and (half * fastest < tolerance or waiting + 2 * LANES > _STACK):
            return False
        for lane in range(count - 1, -1, -1):
            if (near >> lane) & 1:
                for side in range(2):
                    m.centres[waiting] = m.share[lane] + (0.5 - side) * half
                    c.levels[waiting] = level + 1
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
def _enlarge(half: float, m: _Motion, c: Checks) -> None:
    """Write lengths that are larger by what `half` of a motion can move the bodies: all that a test is decided by."""
    ints, table, wide = c.ints, c.table, c.enlarged
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
    types.int64(
        DOUBLES, DOUBLES, types.int64, types.float64, types.int64,
        types.int64, types.int64, types.float64, types.int64, DOUBLES, INTEGERS, SINGLES, SINGLES,
        DOUBLES, types.int64, DOUBLES, types.int64,
        DOUBLES, SINGLES, DOUBLES, INTEGERS, INTEGERS,
    ),
    cache=True,
    error_model="numpy",
)  # fmt: skip
def _motion_check(
    a: Any, b: Any, kind: int, tolerance: float, most_batches: int,
    check: int, motion: int, resolution: float, dim: int, bounds: Any, ints: Any, table: Any, enlarged: Any,
    arms: Any, capsules: int, pair_arms: Any, pairs: int,
    states: Any, scratch: Any, room: Any, levels: Any, counts: Any,
) -> int:  # fmt: skip
    """Return 1 where a motion is what `kind` says, else 0."""
    c = Checks(
        (check, motion),
        resolution,
        carray(bounds, (3, dim)),
        carray(ints, ANY_LENGTH),
        carray(table, ANY_LENGTH),
        carray(enlarged, ANY_LENGTH),
        carray(arms, (dim, capsules)),
        carray(pair_arms, (dim, pairs)),
        carray(states, dim * LANES),
        carray(scratch, ANY_LENGTH),
        carray(room, ANY_LENGTH),
        carray(levels, _STACK),
        carray(counts, COUNTS),
    )
    first, second, third = dim, 2 * dim, 3 * dim
    fourth = third + LANES
    fifth = fourth + capsules
    sixth = fifth + pairs
    m = _Motion(
        c.room[:first],
        c.room[first:second],
        c.room[second:third],
        c.room[third:fourth],
        c.room[fourth:fifth],
        c.room[fifth:sixth],
        c.room[sixth : sixth + _STACK],
    )
    begin, end = carray(a, dim), carray(b, dim)
    for k in range(dim):
        m.start[k], m.end[k] = begin[k], end[k]
    segments = span(m.start, m.end, c.bounds, resolution, m.way)
    c.counts[MOTIONS] += 1
    if kind == PROOF:
        return 1 if _is_proved(m, tolerance, most_batches, c) else 0
    exchanged = False
    for k in range(dim):
        exchanged |= m.start[k] != begin[k]
    first_state, last_state = 0, segments
    if kind >= BOTH_ENDS or (kind == START and not exchanged):
        first_state = 1
    if kind >= BOTH_ENDS or (kind == START and exchanged):
        last_state = segments - 1
    return 1 if _are_free(m, segments, first_state, last_state, kind == COARSE, c) else 0
