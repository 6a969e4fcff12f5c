"""The order in which states of motions are checked: halves, quarters, eighths, all motions together.

A motion of n segments has the states 1 .. n - 1 between its endpoints.  Level l holds the multiples of n / 2^l,
rounded down, that no level before it held: van der Corput's order, taken level by level.  A motion that is
blocked somewhere is thus found after few states, long before a walk from one endpoint would reach it.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from evenroad._arrays import Bools, Ints
from evenroad.errors import InvalidValue

MOST_SEGMENTS = 2**30
"""Largest number of segments of a motion: more would take hours, so the resolution is a slip."""
_STATES_AT_ONCE = 65536
"""Number of states handed out at a time: many enough to hide the cost of a call, few enough to stay in memory."""


def require_few_segments(resolution: object, segments: float) -> None:
    """Raise InvalidValue where a resolution divides the longest motion into more than 2^30 segments."""
    if segments > MOST_SEGMENTS:
        raise InvalidValue(
            f"resolution must be larger: {resolution!r} divides a motion into {segments:.3g} segments, more than 2^30"
        )


def between_endpoints(segments: Ints, open_motions: Bools) -> Iterator[tuple[Ints, Ints]]:
    """Yield the states between the endpoints of motions with these numbers of segments, (m,), level by level, each
    once.

    They are the motions' indices and the states' numbers; state k of n lies a fraction k / n along.  A motion is left
    out from when the caller clears its entry in `open_motions`, (m,).
    """
    level = 1
    while True:
        per_motion = 1 << (level - 1)
        motions = np.flatnonzero(open_motions & (segments > per_motion))
        if len(motions) == 0:
            return
        for start in range(0, len(motions) * per_motion, _STATES_AT_ONCE):
            index = np.arange(start, min(start + _STATES_AT_ONCE, len(motions) * per_motion))
            motion, multiple = motions[index // per_motion], 2 * (index % per_motion) + 1
            count = segments[motion]
            state = (multiple * count) >> level
            # Rounded down, an odd multiple may fall on an even one beside it, which has another level.
            before, after = ((multiple - 1) * count) >> level, ((multiple + 1) * count) >> level
            wanted = (before < state) & (state < after) & open_motions[motion]
            if wanted.any():
                yield motion[wanted], state[wanted]
        level += 1
