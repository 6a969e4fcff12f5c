"""Checks of one motion at a time for compiled planners: at states a resolution apart, and proofs without gaps.

The proofs are those of ``evenroad.robot.certified``, sixteen stretches of a motion at once: every stretch is tested
in its middle with bodies enlarged by what half of the stretch can move them, and halved where that fails.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.forward_kinematics import scratch_memory, unpacked
from evenroad.robot.kernel.lane_check import blocked_states
from evenroad.robot.kernel.layout import inner, quick
from evenroad.robot.kernel.motion import enter, span

LANES = at.LANES
Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

MOTIONS, CONFIGURATIONS, BATCHES, COUNTS = range(4)
"""What is counted, and how many things that is."""

_ROUNDING = 2e-7
"""Added to every margin: what single precision may cut off a radius when the margin is added to it [m]."""

_STACK = 640
"""Stretches that may wait: 16 more at most for each halving, of which single precision bears some thirty."""


class Checks(NamedTuple):
    """A world's tables and the memory that its checks need; made by `checks_of` for one call.

    Attributes
    ----------
    address : int
        Of the check of sixteen configurations.
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
    start, end, way : float64 arrays, shape (dim,)
        The motion at hand.
    share : float64 array, shape (16,)
        Its states at hand.
    speeds, pair_speeds : float64 arrays
        How far the motion at hand moves each capsule and each pair at most [m].
    centres, levels : arrays
        Stretches that are still to be proved: middles, and how often they were halved.
    counts : int64 array, shape (3,)
        Motions asked for, configurations and batches tested.
    """

    address: int
    resolution: float
    bounds: Floats
    ints: Ints
    table: Singles
    enlarged: Singles
    arms: Floats
    pair_arms: Floats
    states: Floats
    scratch: Singles
    start: Floats
    end: Floats
    way: Floats
    share: Floats
    speeds: Floats
    pair_speeds: Floats
    centres: Floats
    levels: Ints
    counts: Ints


@inner
def checks_of(
    address: int,
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
    a, b, c = dim, 2 * dim, 3 * dim
    d = c + LANES
    e = d + arms.shape[1]
    f = e + pair_arms.shape[1]
    return Checks(
        address,
        resolution,
        bounds,
        ints,
        table,
        table.copy(),
        arms,
        pair_arms,
        states,
        scratch,
        room[:a],
        room[a:b],
        room[b:c],
        room[c:d],
        room[d:e],
        room[e:f],
        room[f:],
        np.empty(_STACK, dtype=np.int64),
        counts,
    )


@quick
def blocked(c: Checks, table: Singles, enough: int) -> int:
    """Return the mask of the sixteen configurations in ``c.states`` that touch something."""
    c.counts[BATCHES] += 1
    return blocked_states(c.address, c.scratch, c.states, c.ints, table, enough)


@quick
def write_states(c: Checks) -> None:
    """Write the configurations at the sixteen shares of the motion at hand."""
    for k in range(len(c.start)):
        start, way = c.start[k], c.way[k]
        states = c.states[k * LANES : (k + 1) * LANES]
        # A length that the compiler does not know: it then makes vectors of the loop instead of unrolling it.
        for lane in range(len(states)):
            states[lane] = start + c.share[lane] * way


@quick
def motion_free(a: Floats, b: Floats, end_is_free: bool, sixteen_do: bool, c: Checks) -> bool:
    """Return whether the motion from `a`, which is free, to `b`, both within bounds, is free.

    The verdict is that of ``batch.motions_free``; an end that is known to be free is not tested again.  Where
    `sixteen_do`, no more than sixteen states, spread over the motion, are looked at: before a proof that is enough.
    """
    for k in range(len(a)):
        c.start[k], c.end[k] = a[k], b[k]
    segments = span(c.start, c.end, c.bounds, c.resolution, c.way)
    exchanged = False
    for k in range(len(a)):
        exchanged |= c.start[k] != a[k]
    first = 0 if exchanged and not end_is_free else 1
    last = segments if not exchanged and not end_is_free else segments - 1
    count = last - first + 1
    c.counts[MOTIONS] += 1
    if count <= 0:
        return True
    rest = max(count - LANES, 0)
    stretches = (rest + LANES - 1) // LANES
    level = 0
    while (1 << level) < stretches:
        level += 1
    # Sixteen spread over the motion, then stretches of sixteen neighbours: halves before quarters before eighths.
    place = -1
    while True:
        if place < 0:
            for lane in range(LANES):
                number = lane * (count - 1) // (LANES - 1) if rest > 0 else min(lane, count - 1)
                c.share[lane] = (first + number) / segments
            write_states(c)
            if last == segments:
                for k in range(len(a)):
                    # Exactly the end, so that a motion is free only where its end is.
                    c.states[k * LANES + LANES - 1] = c.end[k]
            c.counts[CONFIGURATIONS] += min(count, LANES)
        else:
            stretch = 0
            for bit in range(level):
                stretch |= ((place >> bit) & 1) << (level - 1 - bit)
            place += 1
            if stretch >= stretches:
                if place == 1 << level:
                    return True
                continue
            # The r-th of these has number r + 1 + gap, where gap counts the spread ones passed since the first.
            gap = 0
            for lane in range(LANES):
                rank = min(stretch * LANES + lane, rest - 1)
                while (gap + 1) * (count - 1) // (LANES - 1) - (gap + 1) <= rank:
                    gap += 1
                c.share[lane] = (first + rank + 1 + gap) / segments
            write_states(c)
            c.counts[CONFIGURATIONS] += min(LANES, rest - stretch * LANES)
        if blocked(c, c.table, 1) != 0:
            return False
        if place < 0:
            place = 0
            if rest == 0 or sixteen_do:
                return True
        elif place == 1 << level:
            return True


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
    for k in range(len(a)):
        c.start[k], c.end[k] = a[k], b[k]
    span(c.start, c.end, c.bounds, 1.0, c.way)
    fastest = max(_write_speeds(c.arms, c.way, c.speeds), _write_speeds(c.pair_arms, c.way, c.pair_speeds))
    c.counts[MOTIONS] += 1
    for lane in range(LANES):
        # The first stretch is the last to be pushed and the first to be looked at.
        c.centres[lane], c.levels[lane] = 1.0 - (lane + 0.5) / LANES, 0
    waiting, enlarged_for = LANES, -1
    half = 0.0
    for _ in range(most_batches):
        level = c.levels[waiting - 1]
        if level != enlarged_for:
            half = 0.5 / (LANES << level)
            _enlarge(half, c)
            enlarged_for = level
        count = 0
        while count < LANES and count < waiting and c.levels[waiting - 1 - count] == level:
            c.share[count] = c.centres[waiting - 1 - count]
            count += 1
        for lane in range(count, LANES):
            c.share[lane] = c.share[count - 1]
        write_states(c)
        c.counts[CONFIGURATIONS] += count
        near = blocked(c, c.enlarged, LANES) & ((1 << count) - 1)
        waiting -= count
        if near != 0 and (half * fastest < tolerance or waiting + 2 * LANES > _STACK):
            return False
        for lane in range(count - 1, -1, -1):
            if (near >> lane) & 1:
                for side in range(2):
                    c.centres[waiting] = c.share[lane] + (0.5 - side) * half
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
def _enlarge(half: float, c: Checks) -> None:
    """Write radii that are larger by what `half` of the motion at hand can move the bodies."""
    ints, table, wide = c.ints, c.table, c.enlarged
    place = ints[at.CAPSULE_FLOATS] + 6
    for i in range(len(c.speeds)):
        wide[place] = table[place] + np.float32(half * c.speeds[i] + _ROUNDING)
        place += at.CAPSULE_FLOAT_ROW
    # What is around a body moves no farther than the fastest of its capsules.
    for body in range(ints[at.BODIES]):
        row, place = (
            ints[at.BODY_INTS] + at.BODY_INT_ROW * body,
            ints[at.BODY_FLOATS] + at.BODY_FLOAT_ROW * body,
        )
        fastest = 0.0
        for i in range(ints[row + 1], ints[row + 2]):
            fastest = max(fastest, c.speeds[i])
        for entry in range(place + 3, place + 7):
            wide[entry] = table[entry] + np.float32(half * fastest + _ROUNDING)
    row, first = ints[at.BODY_PAIR_INTS], ints[at.PAIR_FLOATS]
    for p in range(ints[at.BODY_PAIRS]):
        most = np.float32(0.0)
        for pair in range(ints[row + 2], ints[row + 3]):
            margin = np.float32(half * c.pair_speeds[pair] + _ROUNDING)
            most = max(most, margin)
            place = first + at.PAIR_FLOAT_ROW * pair
            wide[place] = table[place] + margin
            wide[place + 1] = table[place + 1] + margin
        row += at.BODY_PAIR_INT_ROW
        place = ints[at.BODY_PAIR_FLOATS] + p
        wide[place] = table[place] + most


@quick
def canonical(q: Floats, bounds: Floats) -> None:
    """Bring `q` into bounds: wrapping coordinates into their ranges, the others cut."""
    enter(q, bounds, q)
    for k in range(len(q)):
        if bounds[2, k] == np.inf:
            q[k] = min(max(q[k], bounds[0, k]), bounds[1, k])


@quick
def distance_and_way(a: Floats, b: Floats, bounds: Floats, way: Floats) -> float:
    """Write the short way from `a` to `b` and return its length."""
    squared = 0.0
    for k in range(len(a)):
        apart = b[k] - a[k]
        period = bounds[2, k]
        if period != np.inf:
            apart -= period * np.rint(apart / period)
        way[k] = apart
        squared += apart * apart
    return np.sqrt(squared)
