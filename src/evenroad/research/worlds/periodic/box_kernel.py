"""Compiled checks of boxes in some coordinates, on the torus, for points and straight motions in the unit cube."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad.research.worlds.periodic.cube import ROUNDING, comes_first, is_in_cube


@njit(cache=True, nogil=True)
def points_are_free(
    q: npt.NDArray[np.float64],
    axes: npt.NDArray[np.int64],
    centres: npt.NDArray[np.float64],
    half_extents: npt.NDArray[np.float64],
) -> npt.NDArray[np.bool_]:
    """Return which rows of `q`, (n, d), lie in the unit cube and in no box."""
    free = np.empty(len(q), dtype=np.bool_)
    for row in range(len(q)):
        free[row] = is_in_cube(q[row]) and _is_outside_all(q[row], axes, centres, half_extents)
    return free


@njit(cache=True, nogil=True)
def motions_are_free(
    a: npt.NDArray[np.float64],
    b: npt.NDArray[np.float64],
    axes: npt.NDArray[np.int64],
    centres: npt.NDArray[np.float64],
    half_extents: npt.NDArray[np.float64],
) -> npt.NDArray[np.bool_]:
    """Return which straight motions stay in the unit cube and meet no box."""
    free = np.empty(len(a), dtype=np.bool_)
    # Each axis can be within the box in three spans of time, and an intersection has fewer spans than both together.
    room = 3 * axes.shape[1] + 1
    spans, narrowed, on_axis = np.empty((room, 2)), np.empty((room, 2)), np.empty((3, 2))
    for row in range(len(a)):
        first, last = (a[row], b[row]) if comes_first(a[row], b[row]) else (b[row], a[row])
        free[row] = (
            is_in_cube(first)
            and is_in_cube(last)
            and _is_outside_all(first, axes, centres, half_extents)
            and _is_outside_all(last, axes, centres, half_extents)
        )
        box = 0
        while free[row] and box < len(axes):
            free[row] = _misses(
                first, last, axes[box], centres[box], half_extents[box], spans, narrowed, on_axis
            )
            box += 1
    return free


@njit(cache=True, nogil=True)
def _is_outside_all(
    q: npt.NDArray[np.float64],
    axes: npt.NDArray[np.int64],
    centres: npt.NDArray[np.float64],
    half_extents: npt.NDArray[np.float64],
) -> bool:
    for box in range(len(axes)):
        inside = True
        for j in range(axes.shape[1]):
            offset = q[axes[box, j]] - centres[box, j]
            inside &= abs(offset - np.rint(offset)) < half_extents[box, j]
        if inside:
            return False
    return True


@njit(cache=True, nogil=True)
def _misses(
    a: npt.NDArray[np.float64],
    b: npt.NDArray[np.float64],
    axes: npt.NDArray[np.int64],
    centre: npt.NDArray[np.float64],
    half_extent: npt.NDArray[np.float64],
    spans: npt.NDArray[np.float64],
    narrowed: npt.NDArray[np.float64],
    on_axis: npt.NDArray[np.float64],
) -> bool:
    """Return whether ``a + t (b - a)``, 0 <= t <= 1, is never within one box; the last three are room to work in."""
    for j in range(len(axes)):
        # Most boxes are out of reach along some axis: the middle of the motion says so.
        step = b[axes[j]] - a[axes[j]]
        middle = a[axes[j]] + 0.5 * step - centre[j]
        if abs(middle - np.rint(middle)) > half_extent[j] + 0.5 * abs(step) + ROUNDING:
            return True
    spans[0, 0], spans[0, 1] = 0.0, 1.0
    count = 1
    for j in range(len(axes)):
        begin = a[axes[j]] - centre[j]
        found = _times_within(begin, b[axes[j]] - a[axes[j]], half_extent[j], on_axis)
        kept = 0
        for s in range(count):
            for t in range(found):
                low, high = max(spans[s, 0], on_axis[t, 0]), min(spans[s, 1], on_axis[t, 1])
                if low < high:
                    narrowed[kept, 0], narrowed[kept, 1] = low, high
                    kept += 1
        if kept == 0:
            return True
        spans, narrowed, count = narrowed, spans, kept
    return False


@njit(cache=True, nogil=True)
def _times_within(begin: float, step: float, half_extent: float, spans: npt.NDArray[np.float64]) -> int:
    """Write the spans of time in which ``begin + t step`` is closer than `half_extent` to an integer; return how many.

    `begin` and ``begin + step`` lie in [-1, 1], so that only -1, 0 and 1 can be near.
    """
    count = 0
    for copy in range(-1, 2):
        low, high = copy - half_extent - begin, copy + half_extent - begin
        if step == 0.0:
            low, high = (0.0, 1.0) if low < 0.0 < high else (1.0, 0.0)
        elif step > 0.0:
            low, high = low / step, high / step
        else:
            low, high = high / step, low / step
        low, high = max(low, 0.0), min(high, 1.0)
        if low < high:
            spans[count, 0], spans[count, 1] = low, high
            count += 1
    return count
