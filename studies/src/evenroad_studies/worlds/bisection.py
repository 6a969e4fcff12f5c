"""The order of ``evenroad.world.bisection`` for one motion at a time, in compiled code."""

from __future__ import annotations

from numba import njit


@njit(cache=True, nogil=True)
def next_between(level: int, multiple: int, segments: int) -> tuple[int, int, int]:
    """Return the next state of a motion of n segments, after its position in the order: (level, multiple, state).

    `level` and `multiple` are those of the state before; 1 and -1 for the first.  The state is 0 after the last.
    """
    while True:
        multiple += 2
        if multiple >= 1 << level:
            level, multiple = level + 1, 1
        if 1 << (level - 1) >= segments:
            return level, multiple, 0
        state = (multiple * segments) >> level
        # Rounded down, an odd multiple may fall on an even one beside it, which has another level.
        before, after = ((multiple - 1) * segments) >> level, ((multiple + 1) * segments) >> level
        if before < state < after:
            return level, multiple, state
