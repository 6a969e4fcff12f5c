"""Rank-1 lattices for roadmaps: points that are well separated, also in their projections.

A lattice of least energy alone may be poor in projections.  In the best Korobov lattice of 512 points in four
dimensions, some pairs of axes have the points on a quarter as many lines as possible.  A wall with a gap bounds only
two or three axes, so a projection decides whether a motion passes.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import islice
from math import gcd

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad._time_limit import look_at_clock
from evenroad.errors import InvalidValue
from evenroad.points.samplers.korobov import (
    MAX_N,
    TIE,
    integer_power,
    korobov_generator,
    multipliers,
    powers,
    require_dimensions,
)

FEW, OF_FEW, OF_MANY = 5, 6.0, 2.0
"""Dimension up to which axes are few, and the weight of the discrepancy beside the energy, both as logs, for few axes
and for more: chosen in tuning worlds of ``points_apart``."""

STARTS, SWEEPS = 3, 20
"""Number of descents, the first from the best powers, and the most sweeps over all axes in each."""

LARGEST = 2**14
"""Number of points up to which vectors other than powers are searched."""

TRIED, FEWEST_TRIED = 2 * 10**6, 32
"""Number of points of all lattices that a step of a descent examines, for each axis, and least number of lattices."""

WORK, FEWEST_POWERS = 3 * 10**7, 8
"""Number of coordinates that the search among powers examines, and least number of multipliers."""

BLOCK = 2**14
"""Number of points of a lattice that are examined together."""


def evenness(d: int) -> float:
    """Return the weight of the discrepancy in d dimensions."""
    return OF_FEW if d <= FEW else OF_MANY


@lru_cache(maxsize=1024)
def rank_one_vector(n: int, d: int) -> tuple[int, ...]:
    """Return the generating vector of small energy and discrepancy; in the plane that of :class:`Korobov`.

    The score is log(E) / (2 d) + w log(W), with E the periodic Riesz energy, s = 2d, and w :func:`evenness`.  W is the
    wrap-around L2 discrepancy, the root mean square of Hickernell's over all shifts.  Each axis in turn tries all
    numbers without common divisor with n, or as many as :data:`TRIED` allows.  Raises InvalidValue if n > 2**26 or
    d > 1024.
    """
    if n > MAX_N:
        raise InvalidValue(f"n must be at most {MAX_N} for a lattice, got {n}")
    require_dimensions(d)
    if n <= 3 or d <= 2:
        multiplier = korobov_generator(n, d)
        return tuple(pow(multiplier, axis, n) for axis in range(d))
    count = max(FEWEST_POWERS, WORK // (n // 2 * d))
    candidates = powers(np.array(sorted(islice(multipliers(n), count)), dtype=np.int64), n, d).astype(np.int64)
    apart = ~((candidates[:, 1:] == 1) | (candidates[:, 1:] == n - 1)).any(axis=1)
    candidates = candidates[apart] if apart.any() else candidates
    scores = [_score(*_sums(each, n), n, d) for each in candidates]
    best = tuple(candidates[_first_least(np.array(scores))].tolist())
    return best if n > LARGEST else _descended(n, best)


def has_distinct_axes(n: int, d: int) -> bool:
    """Return whether n has d multipliers of which no two are equal or opposite: half of Euler's totient or more."""
    totient, left, prime = n, n, 2
    while prime * prime <= left:
        if left % prime == 0:
            totient -= totient // prime
            while left % prime == 0:
                left //= prime
        prime += 1
    return (totient - totient // left if left > 1 else totient) // 2 >= d


def _descended(n: int, first: tuple[int, ...]) -> tuple[int, ...]:
    """Return the vector of least score over all descents, one of which begins at `first`.

    An axis never takes the number of another one or its opposite: all points of that plane would lie on one line.
    """
    d, random = len(first), np.random.default_rng([n, len(first)])
    most = max(FEWEST_TRIED, TRIED // (n * (d - 1)))
    units = np.array([i for i in range(1, n // 2 + 1) if gcd(i, n) == 1])
    tried = units if len(units) <= most else np.sort(random.choice(units, most, replace=False))
    steps = np.arange(1, n // 2 + 1)
    of_tried = _terms(tried, steps, n)
    best, least = first, np.inf
    for start in range(STARTS):
        z = np.array([1, *random.choice(units, d - 1)] if start else first)
        score, before = np.inf, np.inf
        for _ in range(SWEEPS):
            for axis in range(1, d):
                look_at_clock()
                rest = np.delete(z, axis)
                taken = np.minimum(rest, n - rest)
                squared, kernel = _terms(rest, steps, n)
                others = squared.sum(axis=0), kernel.prod(axis=0)
                scores = _score(*_summed(others[0] + of_tried[0], others[1] * of_tried[1], steps, n, d), n, d)
                scores[np.isin(tried, taken)] = np.inf
                score = np.inf
                if min(z[axis], n - z[axis]) not in taken:
                    own = _terms(z[[axis]], steps, n)
                    score = _score(*_summed(others[0] + own[0], others[1] * own[1], steps, n, d), n, d)[0]
                if scores.min() < score - TIE:
                    z[axis], score = tried[_first_least(scores)], scores.min()
            if score > before - TIE:
                break
            before = score
        if score < least - TIE:
            best, least = tuple(z.tolist()), score
    return best


def _first_least(scores: Floats) -> int:
    """Return the first of the least scores: rounding does not choose between mirrored lattices."""
    return int(np.flatnonzero(scores <= scores.min() + TIE)[0])


def _terms(vector: Ints, steps: Ints, n: int) -> tuple[Floats, Floats]:
    """Return each axis's term of a squared distance, and its kernel, for each number of a vector and each step."""
    gaps = steps * vector[:, np.newaxis] % n / n
    gaps = np.minimum(gaps, 1.0 - gaps)
    return gaps * gaps, 1.5 - gaps * (1.0 - gaps)


def _summed(squared: Floats, kernel: Floats, steps: Ints, n: int, d: int) -> tuple[Floats, Floats]:
    """Return the sums over all differences, each of which stands for its mirror image, too: rows of (m, steps)."""
    # Distances are in units of the spacing.  A lattice whose energy overflows is too poor to be chosen.
    with np.errstate(over="ignore", under="ignore"):
        energy = integer_power(n ** (-2.0 / d) / squared, d)
    if 2 * steps[-1] == n:
        energy[..., -1] *= 0.5
        return 2.0 * energy.sum(axis=-1), 2.0 * kernel.sum(axis=-1) - kernel[..., -1]
    return 2.0 * energy.sum(axis=-1), 2.0 * kernel.sum(axis=-1)


def _sums(vector: Ints, n: int) -> tuple[Floats, Floats]:
    """Return the sums of one lattice, in blocks."""
    energy, kernel = np.zeros(()), np.zeros(())
    for first in range(1, n // 2 + 1, BLOCK):
        steps = np.arange(first, min(n // 2, first + BLOCK - 1) + 1)
        squared, kernels = _terms(vector, steps, n)
        more = _summed(squared.sum(axis=0), kernels.prod(axis=0), steps, n, len(vector))
        energy, kernel = energy + more[0], kernel + more[1]
    return energy, kernel


def _score(energy: Floats, kernel: Floats, n: int, d: int) -> Floats:
    uneven = (1.5**d + kernel) / n - (4.0 / 3.0) ** d
    logs = np.log(np.maximum(energy, 1e-300)) / (2 * d) + 0.5 * evenness(d) * np.log(np.maximum(uneven, 1e-300))
    return np.asarray(logs)
