"""Batches in lanes: sixteen configurations at once, or sixteen states of a motion."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.addresses import call_at
from evenroad.robot.kernel.lane_check import scratch_memory, unpacked
from evenroad.robot.kernel.layout import quick
from evenroad.robot.kernel.motion import enter, wrapped
from evenroad.robot.kernel.motion_checks import NO_END, Checks, checks_of, motion_free, motion_proved
from evenroad.robot.kernel.motion_states import COUNTS

LANES = at.LANES
Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Flags = npt.NDArray[np.bool_]

_MOST_BATCHES = 1 << 11
"""A motion that needs more batches of sixteen stretches is not proved: some ten milliseconds; usual ones need a few."""


@njit(cache=True, nogil=True)
def configurations_free(q: Floats, address: int, bounds: Floats, tables: Ints) -> Flags:
    """Return which rows of `q`, (n, dim), are within `bounds`, (3, dim), and free: (n,).

    `address` is that of the check of sixteen configurations, `tables` are ``ArmTables.lanes``.
    """
    n, dim = q.shape
    ints, table = unpacked(tables)
    states, scratch = scratch_memory(address, dim, ints, table)
    inside, free = np.empty(LANES, dtype=np.bool_), np.empty(n, dtype=np.bool_)
    for first in range(0, n, LANES):
        count = min(LANES, n - first)
        inside[:] = True
        for k in range(dim):
            low, high, period = bounds[0, k], bounds[1, k], bounds[2, k]
            for lane in range(LANES):
                # Lanes to spare repeat the last row.
                value = q[first + min(lane, count - 1), k]
                if period != np.inf:
                    value = wrapped(value, low, high, period)
                within = low <= value <= high
                inside[lane] &= within
                # What is out of bounds may be too large for single precision.
                states[k * LANES + lane] = value if within else low
        blocked = call_at(address, (scratch, states, ints, table, LANES))
        for lane in range(count):
            free[first + lane] = inside[lane] and (blocked >> lane) & 1 == 0
    return free


@njit(cache=True, nogil=True)
def motions_free(
    a: Floats,
    b: Floats,
    tolerance: float,
    addresses: tuple[int, int],
    resolution: float,
    bounds: Floats,
    tables: Ints,
    arms: Floats,
    pair_arms: Floats,
) -> Flags:
    """Return which motions, from rows of `a` to those of `b`, are free at both ends and at states between.

    Parameters
    ----------
    a, b : float64 arrays, shape (m, dim)
        Ends of the motions.
    tolerance : float
        Where it is > 0, motions must be proved free, too: a stretch that moves nothing by more than this is then not
        halved again [m].
    addresses, resolution, bounds, tables, arms, pair_arms
        As ``motion_checks.checks_of`` takes them.
    """
    m, dim = a.shape
    checks = checks_of(
        addresses, resolution, bounds, tables, arms, pair_arms, np.zeros(COUNTS, dtype=np.int64)
    )
    free = np.empty(m, dtype=np.bool_)
    _write_verdicts(a, b, tolerance, np.empty(dim), np.empty(dim), checks, free)
    return free


@quick
def _write_verdicts(
    a: Floats, b: Floats, tolerance: float, start: Floats, end: Floats, checks: Checks, free: Flags
) -> None:
    for row in range(len(free)):
        free[row] = (
            enter(a[row], checks.bounds, start)
            and enter(b[row], checks.bounds, end)
            and motion_free(start, end, NO_END, checks)
            and (tolerance <= 0.0 or motion_proved(start, end, tolerance, _MOST_BATCHES, checks))
        )
