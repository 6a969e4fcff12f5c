"""The order in which states of motions are checked: halves, quarters, eighths, all motions together.

A motion of n segments has the states 1 .. n - 1 between its endpoints.  Level l has the multiples of n / 2^l,
rounded down, that no earlier level has: van der Corput's order, level by level.  A blocked motion is thus found
after few states, long before a walk from one endpoint would reach the obstacle.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from evenroad._arrays import Bools, Ints
from evenroad.errors import InvalidValue

MOST_SEGMENTS = 2**30
"""Largest number of segments of a motion. More would take hours, so the resolution must be a mistake."""
_STATES_AT_ONCE = 65536
"""Number of states per yield: large enough to hide the cost of a call, small enough to stay in memory."""


def require_few_segments(resolution: object, segments: float) -> None:
    """Raise InvalidValue if a resolution divides the longest motion into more than 2^30 segments."""
    if segments > MOST_SEGMENTS:
        raise InvalidValue(
            f"resolution must be larger: {resolution!r} divides a motion into {segments:.3g} segments, more than 2^30"
        )


def between_endpoints(segments: Ints, open_motions: Bools) -> Iterator[tuple[Ints, Ints]]:
    """Yield the states between the endpoints of motions with these numbers of segments, (m,), level by level.

    They are the motions' indices and the states' numbers; state k of n lies at the fraction k / n.  A motion is skipped
    as soon as the caller clears its entry in `open_motions`, (m,).
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
            # An odd multiple may round down to an even one, which belongs to another level.
            before, after = ((multiple - 1) * count) >> level, ((multiple + 1) * count) >> level
            wanted = (before < state) & (state < after) & open_motions[motion]
            if wanted.any():
                yield motion[wanted], state[wanted]
        level += 1
