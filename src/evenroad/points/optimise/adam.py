"""One step of noisy Adam on coordinates, in place (Kingma and Ba 2015, with Gaussian noise added)."""

from __future__ import annotations

import math

from numba import njit

FIRST_DECAY = 0.9
SECOND_DECAY = 0.999

TINY = 1e-30
"""Keeps 0/0 away and nothing more, so that the scale of the objective does not matter."""


@njit(cache=True)
def adam_step(columns, first, second, gradient, noise, step, rate, spread, low, high, wrap):  # type: ignore[no-untyped-def]
    """Move `columns` (d, n) against `gradient` by Adam and along `noise`; update both moments.

    `step` counts from 1, `rate` is the learning rate, `spread` the standard deviation of the noise.
    Coordinates stay in [low, high]: wrapped modulo 1 first if `wrap`, then clipped.
    """
    first_scale = 1.0 / (1.0 - FIRST_DECAY**step)
    second_scale = 1.0 / (1.0 - SECOND_DECAY**step)
    d, n = columns.shape
    for k in range(d):
        for i in range(n):
            slope = gradient[k, i]
            first[k, i] = FIRST_DECAY * first[k, i] + (1.0 - FIRST_DECAY) * slope
            second[k, i] = SECOND_DECAY * second[k, i] + (1.0 - SECOND_DECAY) * slope * slope
            move = first[k, i] * first_scale / (math.sqrt(second[k, i] * second_scale) + TINY)
            moved = columns[k, i] - rate * move + spread * noise[k, i]
            if wrap:
                moved -= math.floor(moved)
            columns[k, i] = min(max(moved, low), high)
