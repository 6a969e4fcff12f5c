"""Sets of small star discrepancy in the plane: the best places of points in a given order, and a search over orders.

The order of n points by x and by y says how many of them every box [0, x_i) x [0, y_j) holds.  A discrepancy of at most
t is then a set of bounds on the products x_i y_j, that is on the differences of log x_i and -log y_j.  Rounds of the
tightest bounds (Bellman and Ford) solve such a system, and halving finds the smallest t: the best places for this
order, with no local minimum in the way.  That the order decides is from Clement, Doerr, Klamroth and Paquete (2024).
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints
from evenroad._checks import require_count, require_positive
from evenroad._rng import RngLike, generator
from evenroad.errors import InvalidValue, shown
from evenroad.points.anneal import Annealed, Callback
from evenroad.points.measures import star_discrepancy
from evenroad.points.pointset import BELOW_ONE

GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0
"""Multiples of it modulo 1, from a random shift on, are the orders that the search begins with."""

HEAT = 0.003
"""The search takes an order that is worse by about this share of the discrepancy, at first; less and less later.

With few points 0.02 is better: their orders differ more.
"""

QUICK_ROUNDS, ROUNDS = 60, 400
"""Rounds of bounds before a discrepancy counts as out of reach, in the search and at its end: never too good."""


def place_order(order: npt.ArrayLike) -> Annealed:
    """Return the points of least star discrepancy among all whose i-th by x is the order[i]-th by y.

    `order`, (n,), holds 0 .. n - 1, else InvalidValue.  The value is the exact star discrepancy of the points.
    """
    ranks = np.ascontiguousarray(order, np.int64)
    if ranks.ndim != 1 or not ranks.size or not np.array_equal(np.sort(ranks), np.arange(ranks.size)):
        raise InvalidValue(f"an order of n points holds each of 0 .. n - 1 once, got {shown(order)}")
    _, found = _place(ranks, 1.0, ROUNDS, 1e-9)
    assert found is not None  # within 1 all places are
    x, y = found
    points = np.minimum(np.column_stack([x, y[ranks]]), BELOW_ONE)
    points.setflags(write=False)
    return Annealed(points, star_discrepancy(points))


def search_orders(
    n: int, *, steps: int = 5000, heat: float = HEAT, rng: RngLike = 0, callback: Callback | None = None
) -> Annealed:
    """Return n points in the plane of small star discrepancy: the best order of many, placed exactly.

    Parameters
    ----------
    n : int
        Number of points, >= 1.  A step takes O(n^2) time.
    steps : int
        Orders that are tried: half of them multiples of the golden ratio, then neighbours of the best of those.
    heat : float
        Share of the discrepancy by which a worse order is taken at first, >= 0.
    rng : int, SeedSequence or Generator
        Draws shifts and neighbours.
    callback : callable, optional
        Called as ``callback(step, steps, best)`` after every step; what it raises stops the search.
    """
    n, steps, draws = require_count("n", n), require_count("steps", steps), generator(rng)
    require_positive("heat", heat, or_zero=True)
    now, best, order = 1.0, 1.0, np.arange(n)
    kept = order
    for step in range(1, steps + 1):
        beginning = 2 * step <= steps or n == 1
        cooling = 0.0 if beginning else 2.0 * (steps - step) / steps
        tried = _golden(n, draws.random()) if beginning else _neighbour(order, draws)
        limit = now * (1.0 + heat * cooling * draws.exponential())
        value, _ = _place(tried, limit, QUICK_ROUNDS, 1e-4 * now)
        if value < limit:
            now, order = value, tried
            if now < best:
                best, kept = now, order
        if callback is not None:
            callback(step, steps, best)
    return place_order(kept)


def _golden(n: int, shift: float) -> Ints:
    return np.argsort(np.argsort((np.arange(n) * GOLDEN + shift) % 1.0, kind="stable"), kind="stable")


def _neighbour(order: Ints, draws: np.random.Generator) -> Ints:
    """Return an order in which two near points have changed places by y or by x, or one has moved anywhere."""
    n = order.size
    near = order.copy()
    first = int(draws.integers(n - 1))
    second = min(n - 1, first + 1 + int(draws.integers(max(1, n // 10))))
    kind = draws.integers(3)
    if kind == 0:
        near[[first, second]] = near[[second, first]]
    elif kind == 1:
        near[order == first], near[order == second] = second, first
    else:
        moved, rank = int(draws.integers(n)), int(draws.integers(n))
        near[order > order[moved]] -= 1
        near[near >= rank] += 1
        near[moved] = rank
    return near


def _place(order: Ints, upper: float, rounds: int, precision: float) -> tuple[float, tuple[Floats, Floats] | None]:
    """Return the least discrepancy of points in this order and their x and y, (n,); `upper` and None if none is less.

    y is in its own order.
    """
    n = order.size
    # The share of points with an x-rank below i and a y-rank below j.
    counts = np.zeros((n + 1, n + 1))
    np.cumsum(np.arange(n + 1) > order[:, np.newaxis], axis=0, out=counts[1:])
    counts /= n
    best = _place_within(counts, upper, rounds)
    if best is None:
        return upper, None
    low, high = 0.5 / n, upper
    while high - low > precision:
        middle = 0.5 * (low + high)
        found = _place_within(counts, middle, rounds)
        if found is None:
            low = middle
        else:
            high, best = middle, found
    return high, best


def _place_within(counts: Floats, t: float, rounds: int) -> tuple[Floats, Floats] | None:
    """Return the x and y, (n,), of places of discrepancy <= t; None if none are found.

    x falls and y rises from round to round, towards the largest x and the smallest y that the bounds allow.
    """
    n = len(counts) - 1
    highest = np.minimum(t + np.arange(n) / n, 1.0)
    x, y = highest.copy(), np.zeros(n)
    closed, opened = counts[1:, 1:] - t, counts[:-1, :-1] + t
    for _ in range(rounds):
        # The closed boxes ask for a least y_j ...
        floor = np.maximum.accumulate(np.maximum((closed / x[:, np.newaxis]).max(axis=0), 0.0))
        if (floor > highest).any():
            return None
        rises = floor > y + 1e-14
        if not rises.any():
            return x, y
        y[rises] = floor[rises]
        # ... and the open ones for a largest x_i.
        most = np.minimum(x, (opened / np.maximum(y, 1e-300)).min(axis=1))
        x = np.minimum.accumulate(most[::-1])[::-1]
    return None
