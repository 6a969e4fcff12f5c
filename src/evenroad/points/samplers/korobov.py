"""The Korobov lattice with the smallest periodic Riesz energy, for any n and d: nothing trained, nothing stored.

A rank-1 lattice looks the same from each of its points, so its energy is a single sum over the n - 1 others:
O(n d) where a general set needs O(n^2 d).  That makes a search over all multipliers a matter of milliseconds.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice
from math import gcd

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad._checks import require_count
from evenroad._rng import RngLike, generator, seed_of
from evenroad.errors import InvalidValue
from evenroad.points.pointset import Origin, PointSet

MAX_N = 2**26
"""Up to here products of two residues, and the multiple of n next to them, are exact in float64."""

WORK = 10**8
"""Coordinates of lattice points that a search may look at: it limits how many multipliers are tried."""

FEWEST_TRIED = 32
"""Multipliers that are tried however large n and d are."""

BLOCK = 128
"""Lattice points between two looks at whether a multiplier can still win; their buffers stay in the first cache."""

TIE = 1e-9
"""Energies closer than this, relatively, are equal: rounding must not decide between mirrored lattices."""


@dataclass(frozen=True)
class Korobov:
    """The points i (1, a, a^2, ..., a^(d-1)) / n modulo 1 (Korobov 1959), under one random shift modulo 1.

    The multiplier a is :func:`korobov_generator`.  It has no common divisor with n, so each coordinate takes n
    equally spaced values, each once.
    """

    name = "korobov"

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return n lattice points, shape (n, d), in the order of i; see :class:`Sampler`.

        Raises
        ------
        InvalidValue
            Also if n > 2**26.
        """
        n, d = require_count("n", n), require_count("d", d)
        multiplier = korobov_generator(n, d)
        lattice = np.arange(n)[:, None] * _powers(multiplier, n, d) % n / n
        # Both summands are >= 0, so the remainder is exact and below 1.
        points = (lattice + generator(rng).random(d)) % 1.0
        method = f"rank-1 lattice a={multiplier}, shifted"
        return PointSet(points, Origin(family=self.name, method=method, objective="riesz", seed=seed_of(rng)))


def korobov_generator(n: int, d: int) -> int:
    """Return the multiplier a whose Korobov lattice of n points has the smallest periodic Riesz energy, s = 2d.

    a, n - a and the inverse of a modulo n give the same lattice up to a reflection or the order of the axes; one
    of the four is tried, and the smallest is returned.  While n^2 d <= 4 10^8 all multipliers without a common
    divisor with n are tried, so a is the best one; above that a fixed choice of them spread over 1 .. n/2, as
    many as :data:`WORK` allows.

    Parameters
    ----------
    n, d : int
        Number of points, 1 .. 2**26, and dimension, >= 1.

    Raises
    ------
    InvalidValue
        If n or d is no such integer.
    """
    n, d = require_count("n", n), require_count("d", d)
    if n > MAX_N:
        raise InvalidValue(f"n must be at most {MAX_N} for the korobov sampler, got {n}")
    return _searched(n, d)


@lru_cache(maxsize=1024)
def _searched(n: int, d: int) -> int:
    if n <= 2 or d == 1:
        return 1
    tried = islice(_multipliers(n), max(FEWEST_TRIED, WORK // (n // 2 * d)))
    candidates = np.array(sorted({_smallest_equivalent(a, n) for a in tried}), dtype=np.int64)
    return int(_least_energy(candidates, n, d))


def _multipliers(n: int) -> Iterator[int]:
    """Yield each number of 1 .. n/2 that has no common divisor with n, in an order whose every part is spread out.

    Steps of the golden ratio: regular steps would land near fractions with small denominators, which are bad.
    """
    half = n // 2
    stride = max(1, round(half * 0.6180339887498949))
    while gcd(stride, half) != 1:
        stride += 1
    for i in range(half):
        a = 1 + i * stride % half
        if gcd(a, n) == 1:
            yield a


def _smallest_equivalent(a: int, n: int) -> int:
    inverse = pow(a, -1, n)
    return min(a, n - a, inverse, n - inverse)


def _powers(a: int, n: int, d: int) -> npt.NDArray[np.int64]:
    return np.array([pow(a, k, n) for k in range(d)], dtype=np.int64)


@njit(cache=True)
def _least_energy(candidates, n, d):  # type: ignore[no-untyped-def]
    """Return the candidate of least energy, the first of equal ones.

    Energies are relative to the shortest squared distance in the best lattice so far, which keeps the best one
    between 1 and n whatever d is; one that overflows has lost.
    """
    vector = np.empty(d)
    best, least, shortest = candidates[0], np.inf, 1.0
    for a in candidates:
        power = 1 % n
        for k in range(d):
            vector[k] = power
            power = power * a % n
        energy, own_shortest = _energy(vector, n, shortest, least * (1.0 - TIE))
        if energy < least * (1.0 - TIE):
            best, shortest = a, own_shortest
            least = _energy(vector, n, shortest, np.inf)[0]
    return best


@njit(cache=True)
def _energy(vector, n, unit, limit):  # type: ignore[no-untyped-def]
    """Sum of (unit / squared distance)^d over the lattice points up to sign, and the shortest squared distance.

    Distances are in units of 1/n: integers, so they are exact.  Gives up as soon as the sum exceeds `limit`.
    The first coordinate of point j is j, so the shortest distances come early and a bad lattice is left early.
    """
    d = vector.size
    squared = np.empty(BLOCK)
    power = np.empty(BLOCK)
    total, shortest = 0.0, np.inf
    for first in range(1, n // 2 + 1, BLOCK):
        size = min(BLOCK, n // 2 + 1 - first)
        for j in range(size):
            squared[j] = 0.0
            power[j] = 1.0
        for k in range(d):
            step = vector[k]
            for j in range(size):
                product = (first + j) * step
                # The nearest multiple of n: where rounding could choose the other of two, both are n/2 away.
                gap = product - n * np.floor(product / n + 0.5)
                squared[j] += gap * gap
        for j in range(size):
            shortest = min(shortest, squared[j])
            squared[j] = unit / squared[j]
        exponent = d
        while exponent > 0:
            if exponent % 2 == 1:
                for j in range(size):
                    power[j] *= squared[j]
            exponent //= 2
            if exponent > 0:
                for j in range(size):
                    squared[j] *= squared[j]
        if n % 2 == 0 and first + size == n // 2 + 1:
            # Point n/2 is its own mirror image: half a pair.
            power[size - 1] *= 0.5
        for j in range(size):
            total += power[j]
        if total > limit:
            break
    return total, shortest
