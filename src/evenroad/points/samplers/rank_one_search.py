"""Rank-1 lattices whose generating vector is no power: where n has few multipliers, far better than Korobov's.

Powers of one number repeat: of every a without common divisor with 24, a^2 is 1 modulo 24.  So where n is a multiple
of 24, or has few multipliers at all, even the best Korobov lattice has a few vectors that are far too short.
"""

from __future__ import annotations

from functools import lru_cache
from math import gcd

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad.points.measures.rank_one import minima_ratio
from evenroad.points.samplers.korobov import FEWEST_TRIED, TIE, WORK, korobov_generator

POOR = 1.5
"""Ratio of the last successive minimum to the first above which a Korobov lattice is not good enough."""

STARTS, SWEEPS = 4, 20
"""Number of descents, the first from the Korobov lattice, and the most sweeps over all axes in each."""


@lru_cache(maxsize=1024)
def rank_one_vector(n: int, d: int) -> tuple[int, ...]:
    """Return the generating vector of the best Korobov lattice or, where that is poor, one of a smaller energy.

    Descents of the periodic Riesz energy, s = 2d, in which axis after axis tries all numbers without common divisor
    with n, or as many as the search for a multiplier may.  n is 1 .. 2**26 and d 1 .. 16, else InvalidValue.
    """
    multiplier = korobov_generator(n, d)
    powers = tuple(pow(multiplier, i, n) for i in range(d))
    # In the plane every vector that begins with 1 is one of powers.
    return powers if d <= 2 or minima_ratio(n, powers) <= POOR else _descended(n, powers)


def _descended(n: int, powers: tuple[int, ...]) -> tuple[int, ...]:
    """Return the vector of least energy of all descents."""
    d, random = len(powers), np.random.default_rng([n, len(powers)])
    half, most = n // 2, max(FEWEST_TRIED, WORK // (8 * n * d))
    units = np.array([i for i in range(1, half + 1) if gcd(i, n) == 1])
    tried = units if len(units) <= most else np.sort(random.choice(units, most, replace=False))
    steps = np.arange(1, half + 1)
    of_tried = _squared(tried[:, np.newaxis] * steps, n)
    best, least = powers, np.inf
    for start in range(STARTS):
        z = np.array([1, *random.choice(units, d - 1)] if start else powers)
        for _ in range(SWEEPS):
            before, energy = z.copy(), np.inf
            for axis in range(1, d):
                others = sum(_squared(steps * z[i], n) for i in range(d) if i != axis)
                energies = _log_energies(others + of_tried, d)
                energy = _log_energies((others + _squared(steps * z[axis], n))[np.newaxis], d)[0]
                if energies.min() < energy - TIE:
                    z[axis] = tried[energies <= energies.min() + TIE][0]
                    energy = energies.min()
            if (z == before).all():
                break
        if energy < least - TIE:
            best, least = tuple(z.tolist()), energy
    return best


def _squared(multiples: Ints, n: int) -> Floats:
    """Return the squared distances from the nearest multiple of n."""
    rest = multiples % n
    return np.minimum(rest, n - rest).astype(np.float64) ** 2


def _log_energies(squared: Floats, d: int) -> Floats:
    """Return the logs of the sums of squared distance^(-d) over the rows."""
    shortest = squared.min(axis=1, keepdims=True)
    return np.asarray(np.log(((shortest / squared) ** d).sum(axis=1)) - d * np.log(shortest[:, 0]))
