"""Proofs that a motion is free throughout, not at states alone.

The method is that of ``evenroad.robot.certified``, for sixteen stretches of a motion at once: every stretch is tested
in its middle with bodies enlarged by what half of the stretch can move them, and halved where that fails.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.layout import LANES, quick
from evenroad.robot.kernel.motion_states import CONFIGURATIONS, Motion, World, blocked_states, write_states

Floats = npt.NDArray[np.float64]

_UP = np.float32(1.0 + 3e-7)
"""What sums of single precision are multiplied by to be no less than the true ones."""

MOST_WAITING = 640
"""Stretches that may wait: 16 more at most for each halving, of which single precision bears some thirty."""


@quick
def is_proved(m: Motion, tolerance: float, most_batches: int, w: World) -> bool:
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
def _enlarge(half: float, m: Motion, w: World) -> None:
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
    for p in range(ints[at.HULL_PAIRS]):
        place = ints[at.HULL_MARGINS] + p
        margin = half * m.pair_speeds[len(m.pair_speeds) - ints[at.HULL_PAIRS] + p]
        wide[place] = _wider(table[place], margin)
