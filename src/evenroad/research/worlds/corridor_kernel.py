"""Compiled checks of the hypercube corridor, for configurations and for the states of motions."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from numba import njit


@njit(cache=True, nogil=True)
def points_are_free(
    q: npt.NDArray[np.float64], width: float, axes: npt.NDArray[np.int64]
) -> npt.NDArray[np.bool_]:
    """Return which rows of `q`, (n, d), lie in the unit cube and in the corridor along `axes`."""
    free = np.empty(len(q), dtype=np.bool_)
    for row in range(len(q)):
        free[row] = _is_in_cube(q[row]) and _is_in_corridor(q[row], q[row], 1.0, 0.0, width, axes)
    return free


@njit(cache=True, nogil=True)
def motions_are_free(
    a: npt.NDArray[np.float64],
    b: npt.NDArray[np.float64],
    resolution: float,
    width: float,
    axes: npt.NDArray[np.int64],
) -> npt.NDArray[np.bool_]:
    """Return which motions are free at both ends and at states at most `resolution` apart, in bisection order."""
    free = np.empty(len(a), dtype=np.bool_)
    for row in range(len(a)):
        free[row] = (
            _is_in_cube(a[row])
            and _is_in_cube(b[row])
            and _is_in_corridor(a[row], b[row], 1.0, 0.0, width, axes)
            and _is_in_corridor(a[row], b[row], 0.0, 1.0, width, axes)
            and _way_is_free(a[row], b[row], resolution, width, axes)
        )
    return free


@njit(cache=True, nogil=True)
def _way_is_free(
    a: npt.NDArray[np.float64],
    b: npt.NDArray[np.float64],
    resolution: float,
    width: float,
    axes: npt.NDArray[np.int64],
) -> bool:
    squared = 0.0
    for k in range(len(a)):
        squared += (b[k] - a[k]) * (b[k] - a[k])
    segments = math.ceil(math.sqrt(squared) / resolution)
    # As evenroad.world.bisection_kernel, but written out: a state takes so little here that a call for each shows.
    level = 1
    while (1 << (level - 1)) < segments:
        before = 0
        for multiple in range(1, 1 << level, 2):
            state = (multiple * segments) >> level
            after = ((multiple + 1) * segments) >> level
            if before < state < after:
                # Two weights, not one fraction: a motion and its reverse then have the same states.
                from_a, from_b = (segments - state) / segments, state / segments
                if not _is_in_corridor(a, b, from_a, from_b, width, axes):
                    return False
            before = after
        level += 1
    return True


@njit(cache=True, nogil=True)
def _is_in_cube(q: npt.NDArray[np.float64]) -> bool:
    inside = True
    for coordinate in q:
        inside &= 0.0 <= coordinate <= 1.0
    return inside


@njit(cache=True, nogil=True)
def _is_in_corridor(
    a: npt.NDArray[np.float64],
    b: npt.NDArray[np.float64],
    from_a: float,
    from_b: float,
    width: float,
    axes: npt.NDArray[np.int64],
) -> bool:
    """Test ``from_a a + from_b b``: along `axes`, past the first coordinate > width none is < 1 - width."""
    past_the_corner = False
    for axis in axes:
        coordinate = from_a * a[axis] + from_b * b[axis]
        if past_the_corner:
            if coordinate < 1.0 - width:
                return False
        elif coordinate > width:
            past_the_corner = True
    return True
