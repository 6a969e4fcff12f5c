"""Sets of small star discrepancy in space: annealed for the L2 one, then their coordinates are relaxed for the measure.

A set's order along the axes says how many points every box at the origin holds.  With the other two coordinates kept,
each box bounds one coordinate of one point from above or below; a point in the middle between its bounds has the least
excess.  Sweeps over the three axes gain 8 to 20 %.  For all coordinates together the bounds are no differences, as they
are in the plane (:mod:`evenroad_studies.training.order`), so the places are not the best of their order.
"""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad._checks import require_count
from evenroad._rng import RngLike, generator
from evenroad.points.anneal import LOWEST, Annealed, anneal
from evenroad.points.measures import MEASURES, star_discrepancy
from evenroad.points.pointset import BELOW_ONE

STEPS, SWEEPS = 3000, 30
"""Steps of an annealing, and sweeps over the axes after it; one takes n^3 time, 10 ms for 128 points."""


def search_in_space(n: int, *, tries: int = 1, sweeps: int = SWEEPS, rng: RngLike = 0) -> Annealed:
    """Return n points in three dimensions of small star discrepancy, the best of some tries, and the exact value."""
    require_count("n", n)
    seeds = generator(rng).spawn(require_count("tries", tries))
    starts = (anneal(n, 3, MEASURES["star"], steps=STEPS, rng=each).points for each in seeds)
    return min((relaxed(each, sweeps) for each in starts), key=lambda made: made.value)


def relaxed(points: Floats, sweeps: int = SWEEPS) -> Annealed:
    """Return the best of what so many sweeps make of points, (n, 3), with its exact star discrepancy."""
    now = points.copy()
    orders = [np.argsort(now[:, axis], kind="stable") for axis in range(3)]
    ranks = [np.argsort(order) for order in orders]
    best, value = now.copy(), star_discrepancy(now)
    reached = value
    for _ in range(sweeps):
        for axis in range(3):
            order, second, third = orders[axis], (axis + 1) % 3, (axis + 2) % 3
            others = (now[orders[second], second], now[orders[third], third])
            low, high = coordinate_bounds(ranks[second][order], ranks[third][order], *others, reached)
            middle = np.clip(0.5 * (low + np.minimum(high, 1.0)), LOWEST, BELOW_ONE)
            now[order, axis] = np.maximum.accumulate(middle)
        reached = star_discrepancy(now)
        if reached < value:
            best, value = now.copy(), reached
    best.setflags(write=False)
    return Annealed(best, value)


def coordinate_bounds(second: Ints, third: Ints, y: Floats, z: Floats, t: float) -> tuple[Floats, Floats]:
    """Return the bounds between which each coordinate keeps all boxes within t, in the order of this axis: two (n,).

    `second` and `third` are the points' ranks along the other axes, y and z the sorted coordinates there, (n,).
    """
    n = second.size
    by_y, by_z = (1.0 / np.append(np.maximum(each, 1e-9), 1.0) for each in (y, z))
    closed = np.minimum(np.arange(n + 1) + 1, n)
    counts, low, high = np.zeros((n + 1, n + 1)), np.empty(n), np.empty(n)
    for i in range(n):
        # The open boxes up to point i, which hold those before it ...
        high[i] = (((t + counts) * by_z).min(axis=1) * by_y).min()
        counts[second[i] + 1 :, third[i] + 1 :] += 1.0 / n
        # ... and the closed ones, which hold it and those on their other sides, too.
        low[i] = (((counts[np.ix_(closed, closed)] - t) * by_z).max(axis=1) * by_y).max()
    return np.maximum(low, 0.0), high
