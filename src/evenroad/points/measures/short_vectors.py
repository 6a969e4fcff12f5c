"""The short vectors of a rank-1 lattice: its basis reduced, and all vectors up to a length, exactly.

A rank-1 lattice of n points is all i z / n plus whole vectors, with i and z whole numbers.  Here it is in units of
1/n, so all vectors have whole numbers.  Reduction is that of Lenstra, Lenstra and Lovasz (1982), enumeration that of
Fincke and Pohst (1985).  Floats only guide the search; the vectors are exact.
"""

from __future__ import annotations

import math
from operator import mul

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints
from evenroad._checks import require_count
from evenroad.errors import InvalidValue, NotAvailable, shown

LARGEST_N = 2**26
"""Largest n for which squared lengths are whole in float64, or nearly."""

MOST_AXES = 16
"""Largest dimension. Up to it a ball that holds a basis holds a few dozen vectors, beyond it perhaps too many."""

MOST_VECTORS = 10**6
"""Largest number of vectors to examine: seconds."""

SAME = 1e-9
"""Relative difference below which squared lengths are equal."""


def lattice_basis(n: int, vector: npt.ArrayLike, scale: npt.ArrayLike | None = None) -> Ints:
    """Return a reduced basis of the lattice, (d, d) whole numbers in units of 1/n, the shortest first.

    Parameters
    ----------
    n : int
        Points in the unit cube, 1 .. 2**26.
    vector : sequence of int
        The generating vector z, (d,), d <= 16; one of its numbers has no common divisor with n.
    scale : sequence of float, optional
        Weight of each axis, (d,), > 0; default 1.

    Raises InvalidValue if the arguments are not of that kind.
    """
    z, weights = _checked(n, vector, scale)
    basis = _generated(n, z.tolist())
    _reduce(basis, weights.tolist())
    reduced = np.array(basis, dtype=np.int64)
    return reduced[np.argsort(squared_lengths(reduced, weights), kind="stable")]


def short_vectors(
    n: int, vector: npt.ArrayLike, pairs: int = 0, scale: npt.ArrayLike | None = None
) -> tuple[Ints, Ints]:
    """Return the shortest vectors, (m, d) in units of 1/n, and the ranks of their lengths, (m,), equal for equal ones.

    They are one of each opposite pair, at least `pairs`, with a basis among them.  `n`, `vector`, `scale` and errors
    are those of :func:`lattice_basis`.  Raises NotAvailable if a ball that contains a basis has over 10^6 vectors.
    """
    basis = lattice_basis(n, vector, scale)
    weights = np.ones(len(basis)) if scale is None else np.asarray(scale, dtype=np.float64)
    limit = float(squared_lengths(basis, weights)[-1]) * (1.0 + SAME)
    d, cell = len(basis), math.prod(weights.tolist()) * float(n) ** (len(basis) - 1)
    while True:
        ball = math.pi ** (d / 2) / math.gamma(d / 2 + 1) * limit ** (d / 2)
        if ball > MOST_VECTORS * cell:
            raise NotAvailable(f"vectors of the lattice of n={n} differ so much in length that too many are short")
        found = _enumerated(basis.tolist(), weights.tolist(), limit)
        if len(found) >= pairs:
            break
        limit *= 1.25
    vectors = np.array(found, dtype=np.int64) @ basis
    squared = squared_lengths(vectors, weights)
    order = np.argsort(squared, kind="stable")
    rank = np.append(0, np.cumsum(squared[order[1:]] > squared[order[:-1]] * (1.0 + SAME)))
    return vectors[order], rank


def squared_lengths(vectors: Ints, weights: Floats) -> Floats:
    """Return the squared lengths of vectors, (m,), in units of 1/n."""
    return np.asarray(((vectors * weights) ** 2).sum(axis=1))


def _checked(n: int, vector: npt.ArrayLike, scale: npt.ArrayLike | None) -> tuple[Ints, Floats]:
    n = require_count("n", n)
    if n > LARGEST_N:
        raise InvalidValue(f"n must be at most {LARGEST_N} for short vectors, got {n}")
    z = np.asarray(vector)
    if z.ndim != 1 or not 1 <= len(z) <= MOST_AXES or not np.issubdtype(z.dtype, np.integer):
        raise InvalidValue(f"vector must be 1 .. {MOST_AXES} whole numbers, got {shown(vector)}")
    if all(math.gcd(int(each), n) != 1 for each in z):
        raise InvalidValue(f"vector needs a number without common divisor with n={n}, got {shown(vector)}")
    weights = np.ones(len(z)) if scale is None else np.asarray(scale, dtype=np.float64)
    if weights.shape != z.shape or not (np.isfinite(weights) & (weights > 0.0)).all():
        raise InvalidValue(f"scale must be {len(z)} finite numbers > 0, got {shown(scale)}")
    return z, weights


def _generated(n: int, z: list[int]) -> list[list[int]]:
    """Return a basis: z times the factor that makes one of its numbers 1, and n along each other axis."""
    pivot = next(axis for axis, each in enumerate(z) if math.gcd(each, n) == 1)
    inverse = pow(z[pivot], -1, n)
    row = [(each * inverse + n // 2) % n - n // 2 for each in z]
    row[pivot] = 1
    return [row] + [[n * (i == axis) for i in range(len(z))] for axis in range(len(z)) if axis != pivot]


class _Orthogonal:
    """Gram-Schmidt: orthogonal rows, their coefficients and squared lengths."""

    def __init__(self, weights: list[float]) -> None:
        self.weights = weights
        self.left: list[list[float]] = []
        self.slopes: list[list[float]] = []
        self.lengths: list[float] = []

    def add(self, row: list[int]) -> None:
        vector, slopes = list(map(mul, row, self.weights)), []
        for other, length in zip(self.left, self.lengths, strict=True):
            slope = sum(map(mul, vector, other)) / length
            vector = [x - slope * y for x, y in zip(vector, other, strict=True)]
            slopes.append(slope)
        self.slopes.append(slopes)
        self.left.append(vector)
        self.lengths.append(sum(map(mul, vector, vector)))

    def forget(self, row: int) -> None:
        for each in (self.left, self.slopes, self.lengths):
            del each[row:]


def _reduce(basis: list[list[int]], weights: list[float]) -> None:
    """Reduce the rows in place: subtract whole multiples, and swap two rows while that shortens one."""
    known, row = _Orthogonal(weights), 0
    while row < len(basis):
        changed = True
        while changed:
            # Repeated until nothing changes, because the slopes of large multiples are rounded.
            known.forget(row)
            known.add(basis[row])
            changed, slopes = False, known.slopes[row]
            for j in range(row - 1, -1, -1):
                if abs(slopes[j]) > 0.5 + SAME:
                    changed, multiple = True, round(slopes[j])
                    basis[row] = [x - multiple * y for x, y in zip(basis[row], basis[j], strict=True)]
                    for i, slope in enumerate(known.slopes[j]):
                        slopes[i] -= multiple * slope
        if row and known.lengths[row] < (0.999 - slopes[row - 1] ** 2) * known.lengths[row - 1]:
            basis[row], basis[row - 1] = basis[row - 1], basis[row]
            row -= 1
        else:
            row += 1


def _enumerated(basis: list[list[int]], weights: list[float], limit: float) -> list[list[int]]:
    """Return the coefficients of all vectors of squared length 0 < . <= limit, one of each pair."""
    known, d = _Orthogonal(weights), len(basis)
    for row in basis:
        known.add(row)
    slopes, lengths = known.slopes, known.lengths
    found, digits = [], [0] * d

    def descend(row: int, so_far: float, all_zero: bool) -> None:
        centre = -sum(digits[i] * slopes[i][row] for i in range(row + 1, d))
        reach = math.sqrt(max(limit - so_far, 0.0) / lengths[row]) + SAME
        # One of each pair: the last coefficient that is not 0 is positive.
        first = math.ceil(centre - reach)
        first = max(first, 0 if row else 1) if all_zero else first
        for digit in range(first, math.floor(centre + reach) + 1):
            digits[row] = digit
            longer = so_far + (digit - centre) ** 2 * lengths[row]
            if row:
                descend(row - 1, longer, all_zero and digit == 0)
            elif longer <= limit:
                found.append(digits.copy())
        digits[row] = 0

    descend(d - 1, 0.0, True)
    return found
