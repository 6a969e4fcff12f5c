"""The A_d* lattice, randomly rotated and shifted: the thinnest known lattice covering in low dimensions."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_count
from evenroad._rng import RngLike, generator, seed_of
from evenroad.errors import InvalidValue
from evenroad.points.measures.covering import dispersion_bounds
from evenroad.points.pointset import Origin, PointSet
from evenroad.points.randomise import Symmetry

MAX_D = 12
"""Largest dimension. Beyond it the ball around the cube has thousands of times as many lattice points as the cube."""


@dataclass(frozen=True)
class Lattice:
    """A_d* (Conway and Sloane 1999, chapter 4.6.6), under a random rotation and a random shift.

    To keep exactly n points, a cube around a uniformly random centre in the rotated lattice grows until it holds n.
    It grows by half the distance to the next point, and is then scaled to the unit cube.
    """

    name = "lattice"
    about = "A_d*, randomly rotated and shifted"
    any_n = True
    # Symmetries of the cube give an equally likely set. A shift would join two faces where the lattice does not match.
    symmetries = frozenset({Symmetry.PERMUTATION, Symmetry.REFLECTION})

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return n lattice points, shape (n, d), d <= 12; see :class:`~evenroad.points.Sampler`."""
        n, d = require_count("n", n), require_count("d", d)
        offsets, edge = around_cube(n, d, generator(rng))
        points = np.clip(0.5 + 0.5 * offsets / edge, 0.0, np.nextafter(1.0, 0.0))
        return PointSet(points, Origin(family=self.name, method="A_d* turned and shifted", seed=seed_of(rng)))


def around_cube(n: int, d: int, random: np.random.Generator) -> tuple[Floats, float]:
    """Return n points of A_d*, one per unit of volume, in a cube around a random centre, (n, d), and its half side.

    Raises InvalidValue if d > 12.
    """
    if d > MAX_D:
        raise InvalidValue(f"d must be at most {MAX_D} for points of A_d*, got {d}")
    rotation, shift = _random_rotation(d, random), random.random(d)
    basis = _unit_density_basis(d)
    half = 0.5 * (n + 1) ** (1 / d)
    while True:
        # The margin only changes the number of candidates.
        half *= 1.03
        offsets = _points_in_ball(basis, shift, radius=half * np.sqrt(d)) @ rotation
        reach = np.abs(offsets).max(axis=1)
        inside = np.flatnonzero(reach <= half)
        if inside.size > n:
            break
    inside = inside[np.argsort(reach[inside], kind="stable")]
    return offsets[inside[:n]], float(0.5 * (reach[inside[n - 1]] + reach[inside[n]]))


def _unit_density_basis(d: int) -> Floats:
    """Return a lower-triangular basis of A_d*: rows with the Gram matrix I - J/(d+1), scaled to determinant 1."""
    basis: Floats = np.linalg.cholesky(np.eye(d) - np.full((d, d), 1.0 / (d + 1))) * (d + 1) ** (0.5 / d)
    return basis


def _random_rotation(d: int, random: np.random.Generator) -> Floats:
    """Return a Haar-distributed orthogonal matrix: QR of a Gaussian one, signs fixed (Mezzadri 2007)."""
    q, r = np.linalg.qr(random.standard_normal((d, d)))
    rotation: Floats = q * np.sign(np.diagonal(r))
    return rotation


def _points_in_ball(basis: Floats, shift: Floats, radius: float) -> Floats:
    """Return every (z + shift) @ basis, z integer, within `radius` of the origin, shape (m, d).

    The basis is lower triangular, so coordinate k depends on z_k .. z_d only.  The last coefficient is fixed first, and
    all partial vectors that can still end inside are kept together (Fincke and Pohst 1985).
    """
    d = basis.shape[0]
    partial = np.zeros((1, d))
    for k in range(d - 1, -1, -1):
        remaining = np.sqrt(np.maximum(radius**2 - (partial[:, k + 1 :] ** 2).sum(axis=1), 0.0))
        step = basis[k, k]
        lowest = np.ceil((-remaining - partial[:, k]) / step - shift[k]).astype(np.int64)
        highest = np.floor((remaining - partial[:, k]) / step - shift[k]).astype(np.int64)
        count = np.maximum(highest - lowest + 1, 0)
        parent = np.repeat(np.arange(len(partial)), count)
        z = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count) + lowest[parent]
        partial = partial[parent] + (z + shift[k])[:, None] * basis[k]
    return partial


MARGINS = (0.0, 0.2, 0.35, 0.5, 0.6, 0.7, 0.85, 1.0)
"""Margins of the lattice beyond the cube, on each side, as shares of its covering radius."""

WORK = 2e8
"""Limit on the coordinates examined to measure one margin: a fifth of a second at most."""


@dataclass(frozen=True)
class Cover:
    """A_d* over the cube and a margin, with points outside projected to the cube.

    A lattice cut at the faces has its largest holes at corners, twice as wide as inside.  The cube is convex, so the
    projection lengthens no distance to a position of the cube.  A margin of the covering radius keeps the radius of the
    lattice: sqrt(d (d + 2) / (12 (d + 1))) (d + 1)^(1 / (2 d)) for one point per unit of volume (Conway and Sloane
    1999, chapter 4.6.6).  In d >= 4 that costs too many points: the margin of smallest certified dispersion is used.
    """

    name = "cover"
    about = "A_d* with the smallest dispersion, faces included"
    any_n = True
    # Symmetries of the cube, as for the lattice; a shift would also move points off the faces.
    symmetries = frozenset({Symmetry.PERMUTATION, Symmetry.REFLECTION})

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return n points, shape (n, d), d <= 12; see :class:`~evenroad.points.Sampler`."""
        n, d = require_count("n", n), require_count("d", d)
        offsets, half = around_cube(n, d, generator(rng))
        covering = covering_radius(d)
        best: tuple[float, float, Floats] | None = None
        for margin in MARGINS:
            inner = half - margin * covering
            if inner <= 0.0:
                break
            points = np.clip(0.5 + 0.5 * offsets / inner, 0.0, np.nextafter(1.0, 0.0))
            dispersion = dispersion_bounds(points, work=WORK).upper
            if best is None or dispersion < best[0]:
                best = dispersion, margin, points
        assert best is not None
        method = f"A_d* turned and shifted, margin {best[1]:g}"
        return PointSet(best[2], Origin(family=self.name, method=method, seed=seed_of(rng)))


def covering_radius(d: int) -> float:
    """Return the covering radius of A_d* with one point per unit of volume."""
    return float(sqrt(d * (d + 2) / (12 * (d + 1))) * (d + 1) ** (0.5 / d))
