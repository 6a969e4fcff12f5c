"""Proofs that whole motions are free, by bisection with margins."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad._njit import njit
from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.layout import inner
from evenroad.robot.kernel.motion import enter, span
from evenroad.robot.kernel.scalar import SEPARATE, first_contact

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

_ROUNDING = 1e-9
"""Added to every margin: more than double precision loses on a robot of many metres [m]."""

_DEEPEST = 60
"""Intervals are halved at most this often; the tolerance ends it long before."""

_MOST_INTERVALS = 1 << 15
"""A motion that needs more of them is not proved: some hundred milliseconds, where usual ones need some dozen."""


@njit(cache=True, nogil=True)
def motions_certified(
    a: Floats,
    b: Floats,
    tolerance: float,
    bounds: Floats,
    ints: Ints,
    floats: Floats,
    arms: Floats,
    pair_arms: Floats,
) -> npt.NDArray[np.bool_]:
    """Return which motions, from rows of `a`, (m, dim), to those of `b`, are proved free.

    An interval in which nothing moves by more than the tolerance is not halved again [m].  Nor is any, once a motion
    took 2^15 of them: it then counts as not proved.  `arms` and `pair_arms`, (capsules, dim) and (capsule pairs, dim),
    are how fast each coordinate moves a capsule, and the two of a pair against each other, at most [m/rad].
    """
    dim = a.shape[1]
    start, end, direction, state = np.empty(dim), np.empty(dim), np.empty(dim), np.empty(dim)
    speeds, pair_speeds = np.empty(len(arms)), np.empty(len(pair_arms))
    margins, pair_margins = np.empty(len(arms)), np.empty(len(pair_arms))
    frames, capsules = np.empty((ints[at.FRAMES] + 1, 12)), np.empty((ints[at.CAPSULES], 6))
    centres, halves = np.empty(_DEEPEST + 2), np.empty(_DEEPEST + 2)
    proved = np.empty(len(a), dtype=np.bool_)
    for row in range(len(a)):
        proved[row] = False
        if not (enter(a[row], bounds, start) and enter(b[row], bounds, end)):
            continue
        span(start, end, bounds, 1.0, direction)
        fastest = max(_largest_speed(arms, direction, speeds), _largest_speed(pair_arms, direction, pair_speeds))
        # Intervals still to be proved, each by its centre and half its length; the deepest one comes first.
        centres[0], halves[0], waiting, intervals = 0.5, 0.5, 1, 0
        while waiting > 0:
            waiting -= 1
            intervals += 1
            centre, half = centres[waiting], halves[waiting]
            for k in range(dim):
                state[k] = start[k] + centre * direction[k]
            for i in range(len(margins)):
                margins[i] = half * speeds[i] + _ROUNDING
            for i in range(len(pair_margins)):
                pair_margins[i] = half * pair_speeds[i] + _ROUNDING
            if first_contact(state, ints, floats, margins, pair_margins, frames, capsules)[0] == SEPARATE:
                continue
            margins[:] = _ROUNDING
            pair_margins[:] = _ROUNDING
            touches = first_contact(state, ints, floats, margins, pair_margins, frames, capsules)[0] != SEPARATE
            ended = half * fastest < tolerance or waiting == _DEEPEST or intervals >= _MOST_INTERVALS
            if touches or ended:
                waiting = -1
                break
            for side in (1.0, -1.0):
                centres[waiting], halves[waiting] = centre + side * 0.5 * half, 0.5 * half
                waiting += 1
        proved[row] = waiting == 0
    return proved


@inner
def _largest_speed(arms: Floats, direction: Floats, speeds: Floats) -> float:
    """Write how far each body can move during the whole motion, and return the largest [m]."""
    largest = 0.0
    for i in range(len(arms)):
        speeds[i] = 0.0
        for k in range(len(direction)):
            speeds[i] += arms[i, k] * abs(direction[k])
        largest = max(largest, speeds[i])
    return largest
