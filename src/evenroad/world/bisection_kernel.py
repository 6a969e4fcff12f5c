"""The order of ``evenroad.world.bisection`` for compiled code, which looks at one motion after the other."""

from __future__ import annotations

from numba import njit


@njit(cache=True, nogil=True)
def next_between(level: int, multiple: int, segments: int) -> tuple[int, int, int]:
    """Return the next state between the ends of a motion of so many segments, with its place in the order.

    `level` and `multiple` are the place of the state before; 1 and -1 for the first.  State k of n lies a fraction k /
    n along the motion; it is 0 where there are no more.
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
