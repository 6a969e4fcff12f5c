"""Annealing: noisy Adam on the coordinates, where the noise falls with the learning rate."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._checks import require_count
from evenroad._rng import RngLike, generator
from evenroad._time_limit import look_at_clock
from evenroad.errors import InvalidValue
from evenroad.points.pointset import BELOW_ONE, as_unit_points

LOWEST = 1.0 - BELOW_ONE
"""Smallest coordinate of a returned point; the largest is BELOW_ONE."""

Callback = Callable[[int, int, float], object]
"""``callback(step, steps, best)`` after every step."""

SCHEDULE = 2
"""Version of the start and of the schedule of rates and noise. Sets of one seed differ between versions."""

LARGEST_RATE, LAST_OVER_FIRST, HOTTEST = 0.02, 1 / 2000, 0.3

FIRST_DECAY, SECOND_DECAY = 0.9, 0.999
"""Decay rates of Adam's two moments."""

TINY = 1e-30
"""Term that avoids 0/0. It is so small that the scale of the objective does not matter."""


class Minimised(Protocol):
    """An objective that annealing minimises: an L2 discrepancy, or a sum of several terms."""

    @property
    def periodic(self) -> bool:
        """Whether a shift modulo 1 of all points changes nothing."""

    @property
    def least_points(self) -> int:
        """Smallest number of points that it is defined for: 2 with an energy, else 1."""

    def of_columns(self, columns: Floats) -> tuple[float, Floats]:
        """Return the value and its gradient, shape (d, n), at points of shape (d, n)."""


class Annealed(NamedTuple):
    """The best points that were found, (n, d) in (0, 1), read-only, below 1 as float32, and the value there."""

    points: Floats
    value: float


def anneal(
    n: int,
    d: int,
    objective: Minimised,
    *,
    steps: int = 5000,
    rng: RngLike = 0,
    start: npt.ArrayLike | None = None,
    rates: tuple[float, float] | None = None,
    callback: Callback | None = None,
) -> Annealed:
    """Minimise the objective of n points in [0, 1)^d, on one thread; the same seed gives the same bits.

    The optimiser is Adam (0.9, 0.999).  Its learning rate falls 2000-fold along a half cosine.  Gaussian noise in
    proportion to the rate finds a good basin.  The best points seen are kept.  Bits may change with the version of
    numpy and of this package.  Arguments out of range raise InvalidValue.

    Parameters
    ----------
    n, d : int
        Number of points and dimension, >= 1 (n >= 2 for an energy).
    objective : Minimised
        One of ``MEASURES``, or an objective of the studies: anything with the attributes of :class:`Minimised`.
    steps : int
        5000 is the standard; 20000 gains about one more per cent.
    rng : int, SeedSequence or Generator
        Seed of the start and the noise.
    start : array_like, shape (n, d), optional
        Start points, default random. Coordinates at a face of the cube are moved off it by 6e-8.
    rates : two floats, optional
        First learning rate, and the noise's standard deviation over the rate; default: those of the schedule.
    callback : callable, optional
        Called as ``callback(step, steps, best)`` after every step; what it raises stops the annealing.
    """
    n, d, steps = require_count("n", n), require_count("d", d), require_count("steps", steps)
    require_points_for(objective, n)
    draws = generator(rng)
    columns = _first_columns(n, d, start, draws)
    best_value, best_columns = math.inf, columns.copy()
    moments, normal = (np.zeros((d, n)), np.zeros((d, n))), np.empty((d, n))
    highest_rate, spread = (first_rate(n, d), noise_over_rate(objective, n, d)) if rates is None else rates
    for step in range(1, steps + 1):
        look_at_clock()
        value, gradient = objective.of_columns(columns)
        if value < best_value:
            best_value = value
            best_columns[:] = columns
        now = learning_rate(step, steps, highest_rate)
        draws.standard_normal(out=normal)
        _adam_step(columns, moments, gradient, normal, step, now, spread * now, objective.periodic)
        if callback is not None:
            callback(step, steps, best_value)
    last_value, _ = objective.of_columns(columns)
    if last_value < best_value:
        best_value, best_columns = last_value, columns
    points = np.ascontiguousarray(best_columns.T)
    points.setflags(write=False)
    return Annealed(points, best_value)


def require_points_for(objective: Minimised, n: int) -> None:
    """Raise InvalidValue unless the objective is defined for `n` points."""
    if n < objective.least_points:
        raise InvalidValue(f"the objective '{objective}' needs at least {objective.least_points} points, got {n}")


def learning_rate(step: int, steps: int, first: float) -> float:
    """Return the rate of step 1 .. `steps`: from `first` to a 2000th of it along a half cosine."""
    share = (step - 1) / max(steps - 1, 1)
    last = first * LAST_OVER_FIRST
    return last + (first - last) * 0.5 * (1.0 + math.cos(math.pi * share))


def first_rate(n: int, d: int) -> float:
    """Return the learning rate of the first step: 0.02 or a fifth of the spacing n^(-1/d), whichever is less.

    A step of Adam is about as long as its rate.  Steps of half a spacing never settle: 0.02 at d = 2, n = 512.
    """
    return min(LARGEST_RATE, float(0.2 * n ** (-1.0 / d)))


def noise_over_rate(objective: Minimised, n: int, d: int) -> float:
    """Return the noise's standard deviation over the learning rate: fitted to trials, not derived.

    With an energy it starts at a fiftieth of the spacing.  Discrepancies alone need more noise if there are fewer
    points per dimension (d = 2 .. 14, n = 16 .. 1024).
    """
    if objective.least_points == 2:
        return min(HOTTEST, float(0.02 * n ** (-1.0 / d)) / first_rate(n, d))
    if n <= 32:
        return HOTTEST
    return min(HOTTEST, max(0.05, max(0.02 * d, 0.1) * math.sqrt(128.0 / n)))


def _first_columns(n: int, d: int, start: npt.ArrayLike | None, draws: np.random.Generator) -> Floats:
    if start is None:
        random = np.ascontiguousarray(draws.random((n, d)).T)
        # Points on a line cannot pass each other, so each cell gets one point at the start.
        return (np.arange(n) + random) / n if d == 1 else random
    given = as_unit_points(start)
    if given.shape != (n, d):
        raise InvalidValue(f"start must have shape ({n}, {d}), got {given.shape}")
    return np.ascontiguousarray(np.clip(given.T, LOWEST, BELOW_ONE))


def _adam_step(
    columns: Floats,
    moments: tuple[Floats, Floats],
    gradient: Floats,
    noise: Floats,
    step: int,
    rate: float,
    spread: float,
    wrap: bool,
) -> None:
    """Move `columns` (d, n) against `gradient` by Adam (Kingma and Ba 2015) and along `noise`; update both moments.

    `step` counts from 1.  Coordinates stay in [LOWEST, BELOW_ONE]: wrapped modulo 1 first if `wrap`, then clipped.
    """
    first, second = moments
    first *= FIRST_DECAY
    first += (1.0 - FIRST_DECAY) * gradient
    second *= SECOND_DECAY
    second += (1.0 - SECOND_DECAY) * gradient * gradient
    first_scale, second_scale = 1.0 / (1.0 - FIRST_DECAY**step), 1.0 / (1.0 - SECOND_DECAY**step)
    columns -= rate * (first * first_scale / (np.sqrt(second * second_scale) + TINY))
    columns += spread * noise
    if wrap:
        columns -= np.floor(columns)
    np.clip(columns, LOWEST, BELOW_ONE, out=columns)
