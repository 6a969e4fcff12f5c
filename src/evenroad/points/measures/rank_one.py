"""Figures of a rank-1 lattice for a roadmap: its successive minima, and the span of k neighbours.

`n`, `vector`, `scale` and errors are those of :func:`~evenroad.points.measures.short_vectors.lattice_basis`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints, set_fields
from evenroad._checks import require_count
from evenroad.points.measures.short_vectors import short_vectors, squared_lengths
from evenroad.points.pointset import as_unit_points

EXACT = 1e-5
"""Tolerance of the differences of a lattice's points from whole numbers, in units of 1/n."""


def generating_vector(points: object) -> Ints | None:
    """Return z, (d,), of points, (n, d), that are i z / n modulo 1, i = 0 .. n - 1, shifted; None if they are not."""
    coordinates = as_unit_points(points)
    n = len(coordinates)
    if n < 2:
        return None
    steps = (coordinates - coordinates[0]) * n
    z = np.rint(steps[1]).astype(np.int64) % n
    off = (steps - np.arange(n)[:, np.newaxis] * z + 0.5 * n) % n - 0.5 * n
    return z if np.abs(off).max() < EXACT else None


def successive_minima(n: int, vector: npt.ArrayLike, scale: npt.ArrayLike | None = None) -> Floats:
    """Return the successive minima, (d,): the i-th is the least length up to which i vectors are independent.

    The first is the smallest distance of two points on the torus.
    """
    vectors, _ = short_vectors(n, vector, scale=scale)
    span, lengths = _Span(vectors.shape[1]), np.sqrt(squared_lengths(vectors, _weights(vectors, scale))) / n
    return np.array([each for each, v in zip(lengths, vectors.tolist(), strict=True) if span.add(v)])


def minima_ratio(n: int, vector: npt.ArrayLike, scale: npt.ArrayLike | None = None) -> float:
    """Return the last successive minimum over the first: 1 at best, bounded over all n for quasi-uniform lattices."""
    minima = successive_minima(n, vector, scale)
    return float(minima[-1] / minima[0])


@dataclass(frozen=True, eq=False)
class Directions:
    """Where the k nearest neighbours of a lattice's points lie, far from faces.

    `vectors`, (m, d) in units of 1/n, are one of each opposite pair, and include all of equal length.  They span
    `rank` dimensions.  `sheets` is the number of components of the graph without obstacles if the rank is d, else inf.
    It is 1 if the vectors generate the lattice: then the neighbours are `connected`.
    """

    vectors: Ints
    rank: int
    sheets: float

    def __post_init__(self) -> None:
        set_fields(self, vectors=self.vectors)

    @property
    def connected(self) -> bool:
        """Whether the graph of neighbours is connected without obstacles and faces."""
        return self.sheets == 1


def neighbour_directions(n: int, vector: npt.ArrayLike, k: int, scale: npt.ArrayLike | None = None) -> Directions:
    """Return the directions of the k >= 1 nearest neighbours, symmetrised: one of two opposite ones is enough."""
    pairs = (require_count("k", k) + 1) // 2
    vectors, rank = short_vectors(n, vector, pairs, scale)
    vectors = vectors[rank <= rank[pairs - 1]]
    d = vectors.shape[1]
    span = _Span(d)
    for each in vectors.tolist():
        span.add(each)
    return Directions(vectors, span.rank, span.volume // n ** (d - 1) if span.rank == d else math.inf)


def least_neighbours(n: int, vector: npt.ArrayLike, scale: npt.ArrayLike | None = None) -> int:
    """Return the least k whose nearest neighbours, symmetrised, generate the lattice, so that they connect all points.

    All equally near ones count, although a graph takes only some of them.
    """
    vectors, rank = short_vectors(n, vector, scale=scale)
    d = vectors.shape[1]
    span = _Span(d)
    for last, each in zip(rank.tolist(), vectors.tolist(), strict=True):
        span.add(each)
        if span.rank == d and span.volume == n ** (d - 1):
            return 2 * int(np.searchsorted(rank, last)) + 1
    raise AssertionError("a basis generates its lattice")


class _Span:
    """The lattice that whole vectors generate: rows in echelon form."""

    def __init__(self, d: int) -> None:
        self.rows: list[list[int] | None] = [None] * d

    def add(self, vector: list[int]) -> bool:
        """Add a vector; return whether it is independent of those before."""
        for axis, row in enumerate(self.rows):
            if not vector[axis]:
                continue
            if row is None:
                self.rows[axis] = vector
                return True
            while vector[axis]:
                times = row[axis] // vector[axis]
                row, vector = vector, [x - times * y for x, y in zip(row, vector, strict=True)]
            self.rows[axis] = row
        return False

    @property
    def rank(self) -> int:
        return sum(row is not None for row in self.rows)

    @property
    def volume(self) -> int:
        """Volume of a cell, if the rank is full."""
        return math.prod(abs(row[axis]) for axis, row in enumerate(self.rows) if row is not None)


def _weights(vectors: Ints, scale: npt.ArrayLike | None) -> Floats:
    return np.ones(vectors.shape[1]) if scale is None else np.asarray(scale, dtype=np.float64)
