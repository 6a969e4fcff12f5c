"""An extensible lattice: a sequence whose beginnings are all well spread, for any n and d.

Point i is phi(i) z modulo 1, shifted, with phi van der Corput's radical inverse in base 2 and z whole numbers
(Hickernell, Hong, L'Ecuyer and Lemieux 2000).  The first 2^m points are a rank-1 lattice for every m, and each further
one lies in a hole of it.  z is searched digit by digit, for all lengths at once.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad._checks import require_count
from evenroad._rng import RngLike, generator, seed_of
from evenroad._time_limit import look_at_clock
from evenroad.errors import InvalidValue
from evenroad.points.pointset import Origin, PointSet
from evenroad.points.randomise import ALL_SYMMETRIES
from evenroad.points.samplers.korobov import require_dimensions

DIGITS = 30
LONGEST = 2**DIGITS
"""Number of points of the whole sequence."""

SEARCHED, TOGETHER = 20, 11
"""Number of digits of z that are searched, and of those searched together; further digits are drawn once."""

KEPT, TRIED = 48, 32
"""Number of vectors kept from one digit to the next, and of continuations tried for each."""

MANY = 64 << TOGETHER
"""Number of coordinates of a lattice from which fewer vectors are kept and tried: 64 axes of all points."""

WORK = 2 * 10**7
"""Number of coordinates examined to choose a digit that is not searched together."""

SPREAD, EVENNESS = 1.0, 0.3
"""Weights of the energy and of the discrepancy, both as logs: the second keeps projections even."""

PARTS = (0.25, 0.5, 0.75, 1.0)
"""Parts of a doubling: for digit m, the first 2^(m-1) (1 + part) points are scored."""

_OF_BLOCK = 5e-3
"""Time that a block of vectors takes to score [s]."""

TIE = 1e-9
"""Difference below which scores are equal: rounding does not choose between mirrored lattices."""


@dataclass(frozen=True)
class Growing:
    """Points `start` >= 0, `start` + 1, ... of the growing lattice, with axes in random order and one random shift.

    With one seed, a set begins with every set of fewer points.
    """

    start: int = 0
    name = "growing"
    about = "a lattice that grows: every beginning is well spread"
    any_n = True
    symmetries = ALL_SYMMETRIES

    def __post_init__(self) -> None:
        require_count("start", self.start, at_least=0)

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return points start .. start + n - 1 of the sequence, shape (n, d); see :class:`~evenroad.points.Sampler`.

        Raises InvalidValue also if start + n exceeds 2**30.
        """
        n, d = require_count("n", n), require_count("d", d)
        require_dimensions(d)
        if self.start + n > LONGEST:
            raise InvalidValue(f"the growing lattice ends at index {LONGEST}, asked for {self.start + n}")
        random = generator(rng)
        order, shift = random.permutation(d), random.random(d)
        vector = growing_vector(d, max(self.start + n - 1, 1).bit_length())[order]
        lattice = reversed_digits(self.start, n)[:, np.newaxis] * vector % LONGEST / LONGEST
        # Both summands are >= 0, so the remainder is exact and below 1.
        points = (lattice + shift) % 1.0
        origin = Origin(family=self.name, method="embedded lattices, shifted", seed=seed_of(rng), start=self.start)
        return PointSet(points, origin)


def reversed_digits(first: int, count: int) -> Ints:
    """Return phi(i) 2^30 for i = first .. first + count - 1: the binary digits of i reversed."""
    left, turned = np.arange(first, first + count), np.zeros(count, dtype=np.int64)
    for digit in range(DIGITS):
        turned |= (left >> digit & 1) << (DIGITS - 1 - digit)
    return turned


def growing_vector(d: int, digits: int = DIGITS) -> Ints:
    """Return z, (d,), with at least this number of binary digits of the sequence; the first component is 1.

    A beam search over all beginnings of at most 2048 points finds the first 11 digits together.  The next 9 are found
    one by one, and the rest are random.  Points below 2^m depend on the first m digits alone.  The score of a vector is
    the mean of :data:`SPREAD` log(E) / (2 d) + :data:`EVENNESS` log(W) over those beginnings.  E is the periodic Riesz
    energy with exponent 2 d, W the wrap-around L2 discrepancy: the root mean square of Hickernell's over all shifts.
    """
    vector = _searched(d, max(min(digits, SEARCHED), TOGETHER))
    rest = np.random.default_rng(d).integers(0, 2 ** (DIGITS - SEARCHED), d) << SEARCHED
    rest[0] = 0
    return vector + rest if digits > SEARCHED else vector


@lru_cache(maxsize=256)
def _searched(d: int, digits: int) -> Ints:
    if digits > TOGETHER:
        found = _searched(d, digits - 1)[np.newaxis]
        found, _ = _best(found, np.zeros(1), digits, max(WORK // (d << digits - 1), 2), 1)
    else:
        found, scores = np.ones((1, d), dtype=np.int64), np.zeros(1)
        for digit in range(2, digits + 1):
            share = min(1.0, (MANY / (d << digit)) ** 0.5)
            found, scores = _best(found, scores, digit, max(round(share * TRIED), 2), max(round(share * KEPT), 1))
    vector: Ints = found[0]
    vector.setflags(write=False)
    return vector


def _best(found: Ints, scores: Floats, digit: int, tried: int, kept: int) -> tuple[Ints, Floats]:
    """Return the best extensions, (m, d), of vectors of one digit less, best first, and their scores, (m,)."""
    look_at_clock()
    d = found.shape[1]
    if 2 ** (d - 1) <= tried:
        bits = np.arange(2 ** (d - 1))[:, np.newaxis] >> np.arange(d - 1) & 1
        choices = np.broadcast_to(bits, (len(found), *bits.shape))
    else:
        choices = np.random.default_rng(digit).integers(0, 2, (len(found), tried, d - 1))
    longer = np.repeat(found[:, np.newaxis], choices.shape[1], axis=1)
    longer[:, :, 1:] += choices << digit - 1
    longer, scores = longer.reshape(-1, d), np.repeat(scores, choices.shape[1])
    # Mirrored axes, and axes in another order, make the same lattice.
    same = np.sort(np.minimum(longer[:, 1:], 2**digit - longer[:, 1:]), axis=1)
    _, different = np.unique(same, axis=0, return_index=True)
    longer = longer[different]
    scores = scores[different] + _scores(longer, digit)
    best = np.argsort(np.floor(scores / TIE), kind="stable")[:kept]
    return longer[best], scores[best]


def _scores(vectors: Ints, digit: int) -> Floats:
    """Return the score of each vector, (m,), over the beginnings of 2^(digit - 1) (1 + part) points."""
    size, d = 2**digit, vectors.shape[1]
    multiples, lengths = _differences(digit)
    steps = np.arange(1, size // 2 + 1)
    scores = np.empty(len(vectors))
    block = max(1, 2**19 // (size * d))
    for first in range(0, len(vectors), block):
        look_at_clock(_OF_BLOCK)
        some = vectors[first : first + block, :, np.newaxis]
        gaps = steps * some % size / size
        gaps = np.minimum(gaps, 1.0 - gaps)
        squared = (gaps * gaps).sum(axis=1)
        # Relative to the shortest, so that nothing overflows whatever d is.
        shortest = squared.min(axis=1, keepdims=True)
        energies = _log_sums(shortest / squared, d, multiples) / (2 * d) - 0.5 * np.log(shortest)
        kernel = (1.5 - gaps * (1.0 - gaps)).prod(axis=1)
        uneven = (1.5**d + kernel @ multiples.T) / lengths - (4.0 / 3.0) ** d
        logs = 0.5 * np.log(np.maximum(uneven, 1e-300))
        scores[first : first + block] = (SPREAD * energies + EVENNESS * logs).mean(axis=1)
    return scores


def _log_sums(ratios: Floats, d: int, multiples: Floats) -> Floats:
    """Return the logs of the sums of d-th powers of ratios, (m, steps), weighted by their number in each beginning."""
    sums = ratios**d @ multiples.T
    if sums.all():
        return np.log(sums)
    # A beginning may lack the shortest difference. In many dimensions its own powers vanish beside that one's.
    with np.errstate(divide="ignore"):
        logs: Floats = np.logaddexp.reduce(d * np.log(ratios)[:, np.newaxis] + np.log(multiples), axis=2)
    return logs


@lru_cache(maxsize=2)
def _differences(digit: int) -> tuple[Floats, Floats]:
    """Return how often each difference of phi, 1 .. 2^(digit-1) in units of 2^-digit, occurs per point in each
    beginning, (parts, .), and the lengths of the beginnings.
    """
    size = 2**digit
    positions = reversed_digits(0, size) >> DIGITS - digit
    lengths = [round(size / 2 * (1 + part)) for part in PARTS]
    counts = []
    for length in lengths:
        held = np.zeros(size)
        held[positions[:length]] = 1.0
        spectrum = np.fft.rfft(held)
        pairs = np.rint(np.fft.irfft(spectrum * spectrum.conj(), size))[1 : size // 2 + 1]
        pairs[:-1] *= 2.0
        counts.append(pairs / length)
    return np.array(counts), np.array(lengths, dtype=np.float64)
