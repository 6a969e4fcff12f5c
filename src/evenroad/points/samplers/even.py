"""The default: a Korobov lattice, in many dimensions scrambled Sobol points, contracted for sparse roadmaps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from evenroad._checks import require_count
from evenroad._rng import RngLike
from evenroad.points.pointset import PointSet
from evenroad.points.randomise import Symmetry
from evenroad.points.samplers.korobov import Korobov
from evenroad.points.samplers.plain import Sobol
from evenroad.points.samplers.rank_one_search import rank_one_vector

TURNED_FROM = 6
"""Dimension from which on `even` permutes the axes of each set; below, ten neighbours are 2 d and span all."""

SOBOL_FROM = 10
"""Dimension from which on `even` is scrambled Sobol points: there no lattice solves more."""

CONTRACTED_FROM = 7
"""Dimension from which on the points of a sparse roadmap are contracted to the middle of a box."""

CONTRACTION = 0.85
"""Factor by which the points of a sparse roadmap are contracted to the middle."""


@dataclass(frozen=True)
class Even(Korobov):
    """Our default: a Korobov lattice, from ten dimensions on scrambled Sobol points.

    ``studies/docs/results.md`` has the evidence for the lattice.  Where n has so few multipliers that the best
    is poor, as many multiples of 24, the generating vector is one of numbers that are no powers
    (:func:`~evenroad.points.samplers.rank_one_search.rank_one_vector`).  From six dimensions on axes hardly ever count
    alike: those of an arm's joints, those of rotations.  The few short vectors of the lattice may then lie in axes that
    count little, and with k < 2 d neighbours the roadmap falls apart into sheets.  No one order of the axes is good
    everywhere, so there each set has another.
    """

    name = "even"
    about = "our default: a shifted rank-1 lattice, from d = 10 on scrambled Sobol"
    # Sobol's; a lattice is shifted as it is drawn.
    symmetries = frozenset({Symmetry.PERMUTATION})
    turned_from = TURNED_FROM

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return n points, shape (n, d); limits are those of :class:`Korobov`, of :class:`Sobol` from d = 10 on."""
        n, d = require_count("n", n), require_count("d", d)
        if d < SOBOL_FROM:
            return super().draw(n, d, rng=rng)
        return Sobol().draw(n, d, rng=rng).with_origin(family=self.name, method="scrambled Sobol")

    def _vector(self, n: int, d: int) -> tuple[Sequence[int], str]:
        vector, text = super()._vector(n, d)
        better = rank_one_vector(n, d)
        return (vector, text) if better == tuple(vector) else (better, f"z={' '.join(map(str, better))}")


def contracted(points: PointSet, share: float = CONTRACTION) -> PointSet:
    """Return the points, each moved towards the middle of the cube to this share of its distance, 0 < share <= 1.

    Motions between them are shorter by that share.  Where each point has few neighbours, that is worth more than to
    reach the corners: ``studies/docs/sparse-roadmaps.md`` has the evidence.
    """
    method = f"{points.origin.method}, drawn in to {share:g}"
    return PointSet(0.5 + share * (points.points - 0.5), points.origin).with_origin(method=method)
