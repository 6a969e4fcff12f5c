"""What the checks of periodic obstacles have in common."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

ROUNDING = 1e-9
"""What bounds leave for rounding, so that they never decide what the exact test would decide otherwise."""


@njit(cache=True, nogil=True, inline="always")
def is_in_cube(q: npt.NDArray[np.float64]) -> bool:
    """Return whether `q`, (d,), lies in the closed unit cube."""
    inside = True
    for coordinate in q:
        inside &= 0.0 <= coordinate <= 1.0
    return inside


@njit(cache=True, nogil=True, inline="always")
def comes_first(a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> bool:
    """Return whether `a` is not after `b` in the order of words.

    Motions are tested from the end that comes first: one and its reverse then give the same bits.
    """
    for k in range(len(a)):
        if a[k] != b[k]:
            return bool(a[k] < b[k])
    return True
