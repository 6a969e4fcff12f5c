"""A motion's states: sixteen at a time, a resolution apart, until one touches something."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.addresses import call_at
from evenroad.robot.kernel.lane_memory import store_along
from evenroad.robot.kernel.layout import LANES, quick_inlined

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

MOTIONS, CONFIGURATIONS, BATCHES, COUNTS = range(4)
"""What is counted, and how many things that is."""


class World(NamedTuple):
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
        Where `check` keeps places.
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


class Motion(NamedTuple):
    """A motion that is checked.

    Attributes
    ----------
    start, end, direction : float64 arrays, shape (dim,)
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
    direction: Floats
    share: Floats
    speeds: Floats
    pair_speeds: Floats
    centres: Floats


@quick_inlined
def blocked_states(w: World, table: Singles, enough: int) -> int:
    """Return the mask of the sixteen states that touch something; with `enough` 1, of the first that do."""
    w.counts[BATCHES] += 1
    return call_at(w.check, (w.scratch, w.states, w.ints, table, enough))


@quick_inlined
def write_states(m: Motion, w: World) -> None:
    """Write the configurations at the sixteen shares of a motion."""
    for k in range(len(m.start)):
        store_along(w.states, k * LANES, m.start[k], m.share, m.direction[k])


@quick_inlined
def are_free(m: Motion, segments: int, first: int, last: int, sixteen_do: bool, w: World) -> bool:
    """Return whether the states of a motion from number `first` to `last`, of 0 to `segments`, are free."""
    count = last - first + 1
    if count <= 0:
        return True
    rest = max(count - LANES, 0)
    intervals = (rest + LANES - 1) // LANES
    level = 0
    while (1 << level) < intervals:
        level += 1
    for lane in range(LANES):
        number = lane * (count - 1) // (LANES - 1) if rest > 0 else min(lane, count - 1)
        m.share[lane] = (first + number) / max(segments, 1)
    index = -1
    while True:
        write_states(m, w)
        if index < 0:
            if last == segments:
                for k in range(len(m.end)):
                    # Exactly the end, so that a motion is free only where its end is.
                    w.states[k * LANES + LANES - 1] = m.end[k]
            w.counts[CONFIGURATIONS] += min(count, LANES)
        if blocked_states(w, w.table, 1) != 0:
            return False
        if rest == 0 or sixteen_do:
            return True
        interval = intervals
        while interval >= intervals:
            index += 1
            if index == 1 << level:
                return True
            interval = 0
            for bit in range(level):
                interval |= ((index >> bit) & 1) << (level - 1 - bit)
        # The r-th of these has number r + 1 + gap, where gap counts the spread ones passed since the first.
        gap = 0
        for lane in range(LANES):
            rank = min(interval * LANES + lane, rest - 1)
            while (gap + 1) * (count - 1) // (LANES - 1) - (gap + 1) <= rank:
                gap += 1
            m.share[lane] = (first + rank + 1 + gap) / segments
        w.counts[CONFIGURATIONS] += min(LANES, rest - interval * LANES)
