"""Batches in lanes: sixteen configurations at once, or sixteen states of a motion."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.addresses import address, bytes_at, matrix_at
from evenroad.robot.kernel.lane_world import LaneWorld
from evenroad.robot.kernel.layout import LANES, MEMORY, Given, Pair, program
from evenroad.robot.kernel.motion import enter, wrapped
from evenroad.robot.kernel.motion_checks import (
    NO_ENDPOINT,
    blocked,
    checks_of,
    motion_free,
    motion_proved,
)
from evenroad.robot.kernel.motion_states import COUNTS
from evenroad.space.joints import SLACK

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]

_MOST_BATCHES = 1 << 11
"""A motion that needs more batches of sixteen stretches is not proved: some ten milliseconds; usual ones need a few."""


def configurations_free(world: LaneWorld, q: Floats) -> Flags:
    """Return which rows of `q`, (n, dim), are within bounds and free: (n,)."""
    n, dim = q.shape
    free = np.empty(n, dtype=np.bool_)
    check_configurations(address(q), n, dim, address(free), world.arguments(COUNTS)[1])
    return free


def motions_free(world: LaneWorld, a: Floats, b: Floats, tolerance: float) -> Flags:
    """Return which motions, from rows of `a` to those of `b`, are free at both ends and at states between.

    Where the tolerance is > 0, motions must be proved free, too: a stretch that moves nothing by more than this is then
    not halved again [m].
    """
    m, dim = a.shape
    free = np.empty(m, dtype=np.bool_)
    _, given = world.arguments(COUNTS + 2 * dim)
    check_motions((address(a), address(b)), m, dim, tolerance, address(free), given)
    return free


@program
def check_configurations(q: int, n: int, dim: int, free: int, given: Given) -> None:
    """Do the work of `configurations_free`, arrays by their addresses."""
    checks = checks_of(*given)
    rows, results = matrix_at(q, (n, dim)), bytes_at(free, (n,))
    for first in range(0, n, LANES):
        count = min(LANES, n - first)
        outside = 0
        for k in range(dim):
            low, high, period = checks.bounds[0, k], checks.bounds[1, k], checks.bounds[2, k]
            states = checks.states[k * LANES : (k + 1) * LANES]
            for lane in range(LANES):
                # Lanes to spare repeat the last row.
                value = rows[first + min(lane, count - 1), k]
                if period != np.inf:
                    value = wrapped(value, low, high, period)
                within = low - SLACK <= value <= high + SLACK
                outside |= (1 - within) << lane
                # What is out of bounds may be too large for single precision.
                states[lane] = value if within else low
        outside |= blocked(checks)
        for lane in range(count):
            results[first + lane] = 1 - ((outside >> lane) & 1)


@program
def check_motions(motions: Pair, m: int, dim: int, tolerance: float, free: int, given: Given) -> None:
    """Do the work of `motions_free`, arrays by their addresses: where motions begin, and where they end."""
    checks = checks_of(*given)
    starts, goals = matrix_at(motions[0], (m, dim)), matrix_at(motions[1], (m, dim))
    inner_endpoints, results = matrix_at(given[MEMORY] + 8 * COUNTS, (2, dim)), bytes_at(free, (m,))
    start, end = inner_endpoints[0], inner_endpoints[1]
    for row in range(m):
        results[row] = (
            enter(starts[row], checks.bounds, start)
            and enter(goals[row], checks.bounds, end)
            and motion_free(start, end, NO_ENDPOINT, checks)
            and (tolerance <= 0.0 or motion_proved(start, end, tolerance, _MOST_BATCHES, checks))
        )
