"""The Korobov lattice with the smallest periodic Riesz energy, for any n and d.

A rank-1 lattice looks the same from each of its points, so its energy is a sum over n - 1 points, in O(n d).  A search
over all multipliers takes milliseconds.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice
from math import gcd

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad._checks import require_count
from evenroad._rng import RngLike, generator, seed_of
from evenroad._time_limit import look_at_clock
from evenroad.errors import InvalidValue
from evenroad.points.pointset import Origin, PointSet
from evenroad.points.randomise import ALL_SYMMETRIES

MAX_N = 2**26
"""Largest n for which products of two residues, and the multiple of n next to them, are exact in float64."""

MOST_D = 1024
"""Largest dimension of lattices that are scored by a discrepancy: beyond it the products overflow."""

WORK = 3 * 10**7
"""Limit on the coordinates that a search examines: it bounds the number of multipliers tried."""

FEWEST_TRIED = 32
"""Least number of multipliers to try, however large n and d are."""

BLOCK = 2**14
"""Number of lattice points, over all multipliers, after which multipliers that cannot win are dropped."""

ROWS = 2**13
"""Number of points of a set that are made together."""

PART = 2**18
"""Number of lattice points of which the energy of one multiplier is summed at a time."""

TIE = 1e-9
"""Relative difference below which energies are equal: rounding does not choose between mirrored lattices."""


@dataclass(frozen=True)
class Korobov:
    """The points i (1, a, a^2, ..., a^(d-1)) / n modulo 1 (Korobov 1959), under one random shift modulo 1.

    The multiplier a is that of :func:`korobov_generator`, of the least energy: no other objective planned better.  It
    has no common divisor with n, so each coordinate takes n equally spaced values once.
    """

    name = "korobov"
    about = "best Korobov lattice, randomly shifted"
    any_n = True
    symmetries = ALL_SYMMETRIES
    turned_from = math.inf

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return n lattice points, shape (n, d), in the order of i; see :class:`~evenroad.points.Sampler`.

        Raises InvalidValue also for what :func:`korobov_generator` refuses.
        """
        n, d = require_count("n", n), require_count("d", d)
        vector, method = self._vector(n, d)
        random = generator(rng)
        shift, how = random.random(d), "shifted"
        if d >= self.turned_from:
            vector, how = [vector[int(axis)] for axis in random.permutation(d)], "axes permuted, shifted"
        points = shifted_lattice(n, vector, shift)
        method = f"rank-1 lattice {method}, {how}"
        return PointSet(points, Origin(family=self.name, method=method, objective="riesz", seed=seed_of(rng)))

    def _vector(self, n: int, d: int) -> tuple[Sequence[int], str]:
        """Return the generating vector, and its text in the origin."""
        multiplier = korobov_generator(n, d)
        return [pow(multiplier, axis, n) for axis in range(d)], f"a={multiplier}"


def shifted_lattice(n: int, vector: Sequence[int], shift: Floats) -> Floats:
    """Return the points i z / n + shift modulo 1, i = 0 .. n - 1, (n, d), read-only; n <= 2**26 and 0 <= z < n.

    They are made in blocks of rows, without a second array of this size.  The remainders of a block are those of the
    first one plus a whole number, minus n if they reach it.  No number is divided, so each is exact below 2**53.
    """
    rows, points = min(n, ROWS), np.empty((n, len(vector)))
    remainders = np.array([np.arange(rows) * z % n for z in vector], dtype=np.float64)
    sums, wholes = np.empty(rows), np.empty(rows)
    for first in range(0, n, rows):
        block = points[first : first + rows]
        rest, whole = sums[: len(block)], wholes[: len(block)]
        for axis, z in enumerate(vector):
            np.add(remainders[axis, : len(block)], first * int(z) % n, out=rest)
            np.greater_equal(rest, n, out=whole)
            rest -= np.multiply(whole, n, out=whole)
            rest /= n
            rest += shift[axis]
            np.subtract(rest, np.floor(rest, out=whole), out=block[:, axis])
    points.setflags(write=False)
    return points


def require_dimensions(d: int) -> None:
    """Raise InvalidValue if products over this many dimensions would overflow."""
    if d > MOST_D:
        raise InvalidValue(
            f"d must be at most {MOST_D} for a lattice with good projections, got {d}: discrepancies in more dimensions"
            " exceed double precision; korobov, sobol and halton have more"
        )


def korobov_generator(n: int, d: int) -> int:
    """Return the multiplier a whose Korobov lattice of n points has the smallest periodic Riesz energy, s = 2d.

    a, n - a and the inverse of a modulo n give the same lattice up to a reflection or the order of the axes.  One
    of the four is tried, and the smallest is returned.  Lattices with two equal or opposite axes count only if there is
    no other: n may have too few multipliers.  While n^2 d <= 10^8, all multipliers without a common
    divisor with n are tried, so a is the best one.  Above that a fixed choice of them is tried, spread over
    1 .. n/2, as many as :data:`WORK` allows.  Raises InvalidValue unless n is 1 .. 2**26 and d >= 1.
    """
    n, d = require_count("n", n), require_count("d", d)
    if n > MAX_N:
        raise InvalidValue(f"n must be at most {MAX_N} for the korobov sampler, got {n}")
    return _searched(n, d)


@lru_cache(maxsize=1024)
def _searched(n: int, d: int) -> int:
    return 1 if n <= 2 or d == 1 else _least_energy(_candidates(n, d), n, d)


def _candidates(n: int, d: int) -> Ints:
    """Return the multipliers to try, each the smallest of the four that give its lattice."""
    tried = islice(multipliers(n), max(FEWEST_TRIED, WORK // (n // 2 * d)))
    pairs = ((a, pow(a, -1, n)) for a in tried)
    every = np.array(sorted({min(a, n - a, b, n - b) for a, b in pairs}), dtype=np.int64)
    # A power of 1 or -1 repeats an axis, up to its direction: all points of that plane then lie on one line.
    later = powers(every, n, d)[:, 1:]
    apart = ~((later == 1) | (later == n - 1)).any(axis=1)
    return every[apart] if apart.any() else every


def powers(multipliers: Ints, n: int, d: int) -> Floats:
    """Return the generating vectors, (m, d)."""
    vectors = np.empty((len(multipliers), d))
    power = np.ones_like(multipliers)
    for k in range(d):
        vectors[:, k] = power
        power = power * multipliers % n
    return vectors


def multipliers(n: int) -> Iterator[int]:
    """Yield each number of 1 .. n/2 that has no common divisor with n, in an order whose parts are all spread out.

    It steps by the golden ratio. Regular steps would land near fractions with small denominators, which are bad.
    """
    half = n // 2
    stride = max(1, round(half * 0.6180339887498949))
    while gcd(stride, half) != 1:
        stride += 1
    for i in range(half):
        a = 1 + i * stride % half
        if gcd(a, n) == 1:
            yield a


def _least_energy(candidates: Ints, n: int, d: int) -> int:
    """Return the smallest of the candidates of least energy.

    All partial sums grow together.  A candidate is dropped when its sum exceeds the whole energy of a promising one.
    The first coordinate of point j is j / n, so the decisive short distances come early.
    """
    vectors, half = powers(candidates, n, d), n // 2
    log_sums = np.full(len(candidates), -np.inf)
    limit = np.inf
    first, looks = 1, 0
    while first <= half:
        look_at_clock()
        last = min(half, first + BLOCK // len(vectors))
        log_sums = np.logaddexp(log_sums, _log_energies(vectors, n, first, last))
        first, looks = last + 1, looks + 1
        if looks & (looks - 1) == 0:
            # A whole energy costs as much as many rounds, so it is computed after 1, 2, 4, 8, ... rounds only.
            promising = vectors[[np.argmin(log_sums)]]
            parts = range(1, half + 1, PART)
            whole = [_log_energies(promising, n, at, min(half, at + PART - 1))[0] for at in parts]
            limit = min(limit, np.logaddexp.reduce(whole) + TIE)
        in_race = log_sums <= limit
        candidates, vectors, log_sums = candidates[in_race], vectors[in_race], log_sums[in_race]
    return int(candidates[log_sums <= log_sums.min() + TIE][0])


def _log_energies(vectors: Floats, n: int, first: int, last: int) -> Floats:
    """Return the log of the sum of distance^(-2d) over the points first .. last <= n/2 of every lattice.

    Point n - j is the mirror image of j, so half of the points are enough; n/2 is its own and counts half.
    Distances are in units of 1/n, so their squares are integers, and exact.  Powers are relative to the
    shortest one, so nothing overflows for any d.
    """
    d = vectors.shape[1]
    j = np.arange(first, last + 1, dtype=np.float64)
    squared = np.zeros((len(vectors), len(j)))
    gap, multiple = np.empty_like(squared), np.empty_like(squared)
    for k in range(d):
        # Distance to the nearest multiple of n.  Rounding may choose the other one only if both are n/2 away.
        np.multiply(vectors[:, k, np.newaxis], j, out=gap)
        np.rint(np.multiply(gap, 1.0 / n, out=multiple), out=multiple)
        gap -= np.multiply(multiple, n, out=multiple)
        squared += np.multiply(gap, gap, out=gap)
    shortest = squared.min(axis=1)
    terms = integer_power(shortest[:, np.newaxis] / squared, d)
    if 2 * last == n:
        terms[:, -1] *= 0.5
    scores: Floats = np.log(terms.sum(axis=1)) - d * np.log(shortest)
    return scores


def integer_power(base: Floats, exponent: int) -> Floats:
    """Return base**exponent, exponent >= 1, by repeated squaring: several times faster than NumPy's power."""
    result = np.ones_like(base)
    while exponent:
        if exponent % 2 == 1:
            result *= base
        base = base * base
        exponent //= 2
    return result
