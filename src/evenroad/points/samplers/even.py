"""The default: a Korobov lattice, in many dimensions scrambled Sobol points, contracted for sparse roadmaps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_count, require_positive
from evenroad._rng import RngLike, generator, seed_of
from evenroad.errors import InvalidValue
from evenroad.points.pointset import Origin, PointSet
from evenroad.points.randomise import Symmetry
from evenroad.points.samplers.korobov import Korobov, rank_one_vector
from evenroad.points.samplers.plain import Sobol

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

    ``studies/docs/results.md`` has the evidence for the lattice.  Where n has few multipliers, as many multiples of 24,
    the generating vector is that of :func:`~evenroad.points.samplers.korobov.rank_one_vector`.  From six
    dimensions on axes mostly differ in weight, as the joints of an arm do.  The short vectors of the lattice may then
    lie in axes of little weight, and with k < 2 d neighbours the roadmap falls apart into sheets.  So each set there
    has a random order of the axes.
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
    """Return the points contracted to the middle of the cube by a factor, 0 < share <= 1.

    Motions between them are shorter, which pays where each point has few neighbours:
    ``studies/docs/sparse-roadmaps.md`` has the evidence.
    """
    method = f"{points.origin.method}, drawn in to {share:g}"
    return PointSet(0.5 + share * (points.points - 0.5), points.origin).with_origin(method=method)


@dataclass(frozen=True)
class Sliced:
    """Poses for sparse roadmaps in SE(3): scrambled Sobol points, a share of which lies in one slice.

    The slice is a Korobov lattice of positions with one random rotation.  It has three dimensions instead of six, so
    few neighbours connect its poses by short motions without a turn; the others lead there.
    """

    share: float = 1 / 3
    """Share of the poses in the slice, 0 .. 1, chosen in random worlds of the tuning stream."""

    name = "sliced"
    about = "poses in SE(3), a third of them with one rotation"

    def __post_init__(self) -> None:
        require_positive("share", self.share, or_zero=True, at_most=1.0)

    def draw(self, n: int, d: int = 6, *, rng: RngLike = 0) -> PointSet:
        """Return n points of the cube of SE3, d = 6."""
        n, d = require_count("n", n), require_count("d", d)
        if d != 6:
            raise InvalidValue(f"sliced poses have d = 6 (SE3), got d={d}")
        random = generator(rng)
        sliced = round(self.share * n)
        cube = np.empty((n, d))
        rotation = random.standard_normal((1, 4))
        cube[:sliced, 3:] = _cube_of_quaternions(rotation / np.linalg.norm(rotation))
        if sliced:
            cube[:sliced, :3] = Korobov().draw(sliced, 3, rng=random).points
        if sliced < n:
            cube[sliced:] = Sobol().draw(n - sliced, d, rng=random).points
        # In no order: some rules join each point to earlier ones.
        points = np.clip(random.permutation(cube), 0.0, np.nextafter(1.0, 0.0))
        method = f"{sliced} of one rotation, the others Sobol"
        return PointSet(points, Origin(family=self.name, method=method, seed=seed_of(rng)))


def _cube_of_quaternions(q: Floats) -> Floats:
    """Return the points of the cube that Shoemake's map takes to quaternions (w, x, y, z), (n, 4) -> (n, 3)."""
    w, x, y, z = q.T
    angles = np.column_stack([np.arctan2(x, y), np.arctan2(z, w)]) / (2.0 * np.pi)
    return np.column_stack([z * z + w * w, angles % 1.0])
