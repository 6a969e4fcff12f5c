"""The lattice that leaves the smallest holes in the cube, faces and corners included: for guarantees."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_count
from evenroad._rng import RngLike, generator, seed_of
from evenroad.points.measures.covering import dispersion_bounds
from evenroad.points.pointset import Origin, PointSet
from evenroad.points.randomise import Symmetry
from evenroad.points.samplers.lattice import around_cube

MARGINS = (0.0, 0.2, 0.35, 0.5, 0.6, 0.7, 0.85, 1.0)
"""Margins beyond the cube, on each side, within which the lattice is cut out: shares of its covering radius."""

WORK = 2e8
"""Limit on the coordinates examined to measure one margin: a fifth of a second at most."""


@dataclass(frozen=True)
class Cover:
    """A_d* over the cube and some of its surroundings, what lies outside moved to the nearest place of the cube.

    A set that is cut out at the faces leaves its largest holes there, at corners above all: twice as wide as inside.
    No place of the cube is farther from a moved point than it was before, since the cube is convex.  With a margin of
    the whole covering radius, that of the lattice is kept: sqrt(d (d + 2) / (12 (d + 1))) (d + 1)^(1 / (2 d)) for one
    point a unit of volume (Conway and Sloane 1999, chapter 4.6.6).  In d >= 4 that costs too many points: of some
    margins the one with the smallest certified dispersion is taken.
    """

    name = "cover"
    about = "A_d* with the smallest dispersion, faces included"
    any_n = True
    # As for the lattice; a shift would also tear the faces' points off.
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
    """Return the covering radius of A_d* with one point a unit of volume."""
    return sqrt(d * (d + 2) / (12 * (d + 1))) * (d + 1) ** (0.5 / d)
