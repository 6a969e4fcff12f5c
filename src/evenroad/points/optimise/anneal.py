"""Annealing: noisy Adam on the coordinates, the noise cooling with the learning rate."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad._arrays import Floats
from evenroad._checks import require_count
from evenroad._rng import RngLike, generator
from evenroad.errors import InvalidValue
from evenroad.points.optimise.objective import (
    Objective,
    objective_of_columns,
    parse_objective,
    require_points_for,
)
from evenroad.points.pointset import BELOW_ONE, as_unit_points

LOWEST = 1.0 - BELOW_ONE
"""Smallest coordinate that an annealing returns; the largest is BELOW_ONE."""

Callback = Callable[[int, int, float], object]
"""``callback(step, steps, best)`` after every step; what it raises stops the annealing."""

SCHEDULE = 2
"""Version of the schedule of rates and noise, and of the start: another one makes other sets of the same seed."""

LARGEST_RATE = 0.02
LAST_OVER_FIRST = 1 / 2000
HOTTEST = 0.3

FIRST_DECAY = 0.9
SECOND_DECAY = 0.999
"""Of Adam's moments."""

TINY = 1e-30
"""Keeps 0/0 away and nothing more, so that the scale of the objective does not matter."""


@dataclass(frozen=True, eq=False)
class Annealed:
    """The best points that an annealing saw, and the objective there.

    Attributes
    ----------
    points : ndarray, shape (n, d)
        Coordinates in (0, 1), read-only; they stay below 1 as float32.
    value, objective : float, Objective
        What was minimised, and its value.
    steps, seconds : int, float
        Gradient steps taken; wall time, compilation excluded as far as it was done before.
    """

    points: Floats
    value: float
    objective: Objective
    steps: int
    seconds: float


def anneal(
    n: int,
    d: int,
    objective: str | Objective = "hickernell",
    *,
    steps: int = 5000,
    rng: RngLike = 0,
    start: npt.ArrayLike | None = None,
    callback: Callback | None = None,
) -> Annealed:
    """Make the objective of n points in [0, 1)^d small; deterministic for a seed, on one thread.

    Adam (.9, .999) with a learning rate that falls 2000-fold along a half cosine, plus Gaussian noise in
    proportion to the rate: the noise is what finds a good basin.  The best points seen are kept.

    Parameters
    ----------
    n, d : int
        Number of points and dimension, >= 1 (n >= 2 for an energy).
    objective : str or Objective
        See :func:`~evenroad.points.optimise.parse_objective`.
    steps : int
        5000 is the standard, 20000 gains another percent or so.
    rng : int, SeedSequence or Generator
        Draws the start and the noise.
    start : array_like, shape (n, d), optional
        Points to start from instead of random ones; a coordinate at a face of the cube is moved off it by 6e-8,
        as the steps do.
    callback : callable, optional
        Called as ``callback(step, steps, best)`` after every step.

    Raises
    ------
    InvalidValue
        For n, d, steps or a start out of range, or an objective that does not parse (UnknownName for a name).

    Notes
    -----
    "Deterministic" means the same bits on one kind of processor, with one version of numpy and numba: sums run
    as vectors, whose width, and so the order of additions, is the processor's.
    """
    n, d, steps = require_count("n", n), require_count("d", d), require_count("steps", steps)
    target = parse_objective(objective)
    require_points_for(target, n)
    draws = generator(rng)
    columns = _first_columns(n, d, start, draws)
    began = time.perf_counter()
    best_value, best_columns = math.inf, columns.copy()
    first, second, noise = np.zeros((d, n)), np.zeros((d, n)), np.empty((d, n))
    highest_rate, spread = first_rate(n, d), noise_over_rate(target, n, d)
    for step in range(1, steps + 1):
        value, gradient = objective_of_columns(target, columns)
        if value < best_value:
            best_value = value
            best_columns[:] = columns
        rate = learning_rate(step, steps, highest_rate)
        draws.standard_normal(out=noise)
        _adam_step(
            columns, first, second, gradient, noise, step, rate, spread * rate,
            LOWEST, BELOW_ONE, target.periodic,
        )  # fmt: skip
        if callback is not None:
            callback(step, steps, best_value)
    last_value, _ = objective_of_columns(target, columns)
    if last_value < best_value:
        best_value, best_columns = last_value, columns
    points = np.ascontiguousarray(best_columns.T)
    points.setflags(write=False)
    return Annealed(points, best_value, target, steps, time.perf_counter() - began)


def learning_rate(step: int, steps: int, first: float) -> float:
    """Return the rate of step 1 .. `steps`: from `first` to a 2000th of it along a half cosine."""
    share = (step - 1) / max(steps - 1, 1)
    last = first * LAST_OVER_FIRST
    return last + (first - last) * 0.5 * (1.0 + math.cos(math.pi * share))


def first_rate(n: int, d: int) -> float:
    """Return the learning rate of the first step: .02, or a fifth of the spacing n^(-1/d) where that is less.

    A step of Adam is about as long as its rate: at d = 2, n = 512 one of .02 is half a spacing, and an energy
    never settles.
    """
    return min(LARGEST_RATE, 0.2 * n ** (-1.0 / d))


def noise_over_rate(objective: Objective, n: int, d: int) -> float:
    """Return the noise's standard deviation over the learning rate: fitted to trials, not derived.

    With an energy it starts at a fiftieth of the spacing.  Discrepancies alone like it the hotter, the fewer
    points a dimension there are (d = 2 .. 14, n = 16 .. 1024).
    """
    if objective.least_points == 2:
        return min(HOTTEST, 0.02 * n ** (-1.0 / d) / first_rate(n, d))
    if n <= 32:
        return HOTTEST
    return min(HOTTEST, max(0.05, max(0.02 * d, 0.1) * math.sqrt(128.0 / n)))


def _first_columns(n: int, d: int, start: npt.ArrayLike | None, draws: np.random.Generator) -> Floats:
    if start is None:
        random = np.ascontiguousarray(draws.random((n, d)).T)
        # On a line points would have to pass each other: there one point a cell is the place to start.
        return (np.arange(n) + random) / n if d == 1 else random
    given = as_unit_points(start)
    if given.shape != (n, d):
        raise InvalidValue(f"start must have shape ({n}, {d}), got {given.shape}")
    return np.ascontiguousarray(np.clip(given.T, LOWEST, BELOW_ONE))


@njit(cache=True)
def _adam_step(columns, first, second, gradient, noise, step, rate, spread, low, high, wrap):  # type: ignore[no-untyped-def]
    """Move `columns` (d, n) against `gradient` by Adam (Kingma and Ba 2015) and along `noise`; update both moments.

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
