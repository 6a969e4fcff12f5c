"""Proofs that a motion is free throughout, not at states alone.

The method is that of ``evenroad.robot.certified``, for sixteen stretches of a motion at once: every stretch is tested
in its middle with bodies enlarged by what half of the stretch can move them, and halved where that fails.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.lane_memory import row
from evenroad.robot.kernel.layout import LANES, MOST_WAITING, quick, quick_inlined
from evenroad.robot.kernel.motion_states import CONFIGURATIONS, Motion, World, blocked_states, write_states

Floats = npt.NDArray[np.float64]

_UP = np.float32(1.0 + 3e-7)
"""What sums of single precision are multiplied by to be no less than the true ones."""


@quick_inlined
def is_proved(m: Motion, tolerance: float, most_batches: int, w: World) -> bool:
    """Return whether a motion is proved free throughout; see `motion_proved`."""
    fastest = max(
        _write_speeds(w.arms, m.direction, m.speeds), _write_speeds(w.pair_arms, m.direction, m.pair_speeds)
    )
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
        write_states(m, w)
        w.counts[CONFIGURATIONS] += count
        near = blocked_states(w, w.enlarged, LANES) & ((1 << count) - 1)
        waiting -= count
        if near != 0 and (half * fastest < tolerance or waiting + 2 * LANES > MOST_WAITING):
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
def _write_speeds(arms: Floats, direction: Floats, speeds: Floats) -> float:
    """Write how far each body can move during the whole motion, and return the largest [m]."""
    for i in range(len(speeds)):
        speeds[i] = 0.0
    for k in range(len(direction)):
        size = abs(direction[k])
        row = arms[k]
        for i in range(len(row)):
            speeds[i] += row[i] * size
    return _largest(speeds)


@quick
def _wider(length: np.float32, margin: float) -> np.float32:
    """Return a length of single precision that is no less than the sum of the two [m]."""
    return (length + np.float32(margin)) * _UP


@quick_inlined
def _enlarge(half: float, m: Motion, w: World) -> None:
    """Write lengths that are larger by what `half` of a motion can move the bodies: all that a test is decided by."""
    ints, given, wide = w.ints, w.table, w.enlarged
    # Through parts of the arrays whose places are known not to be below 0, which is looked at else.
    first, size = ints[at.CAPSULE_FLOATS], at.CAPSULE_FLOAT_ROW * len(m.speeds)
    table, rows = given[first : first + size], wide[first : first + size]
    for i in range(len(m.speeds)):
        index = at.CAPSULE_FLOAT_ROW * i + 6
        rows[index] = _wider(table[index], half * m.speeds[i])
    # What is around a body moves no farther than the fastest of its capsules.
    for body in range(ints[at.BODIES]):
        _, first, end = row(ints, ints[at.BODY_INTS] + at.BODY_INT_ROW * body, 3)
        fastest = _largest(m.speeds[first:end])
        index = ints[at.BODY_FLOATS] + at.BODY_FLOAT_ROW * body + 3
        table, rows = given[index : index + 4], wide[index : index + 4]
        for entry in range(4):
            rows[entry] = _wider(table[entry], half * fastest)
    by_hulls = ints[at.HULL_PAIRS]
    capsule_pairs = len(m.pair_speeds) - by_hulls
    first, size = ints[at.PAIR_FLOATS], at.PAIR_FLOAT_ROW * capsule_pairs
    table, rows = given[first : first + size], wide[first : first + size]
    for pair in range(capsule_pairs):
        margin, index = half * m.pair_speeds[pair], at.PAIR_FLOAT_ROW * pair
        rows[index] = _wider(table[index], margin)
        rows[index + 1] = _wider(table[index + 1], margin)
    first, size = ints[at.BODY_PAIR_FLOATS], ints[at.BODY_PAIRS]
    table, rows = given[first : first + size], wide[first : first + size]
    for p in range(len(rows)):
        _, _, begin, end = row(ints, ints[at.BODY_PAIR_INTS] + at.BODY_PAIR_INT_ROW * p, 4)
        rows[p] = _wider(table[p], half * _largest(m.pair_speeds[begin:end]))
    first = ints[at.HULL_MARGINS]
    table, rows = given[first : first + by_hulls], wide[first : first + by_hulls]
    for p in range(by_hulls):
        rows[p] = _wider(table[p], half * m.pair_speeds[capsule_pairs + p])


@quick
def _largest(speeds: Floats) -> float:
    largest = 0.0
    for i in range(len(speeds)):
        largest = max(largest, speeds[i])
    return largest
