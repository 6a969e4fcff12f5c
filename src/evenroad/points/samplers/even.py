"""The default: A_3* in space, else rank-1 lattices with good projections; and poses for sparse roadmaps."""

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
from evenroad.points.samplers.korobov import Korobov
from evenroad.points.samplers.lattice import Lattice
from evenroad.points.samplers.plain import Sobol
from evenroad.points.samplers.rank_one import has_distinct_axes, rank_one_vector

IN_ALL_DIRECTIONS, MOST = 3, 2**20
"""Dimension in which `even` is A_d*, and its largest number of points: it needs several times their memory."""


@dataclass(frozen=True)
class Even(Korobov):
    """Our default for roadmaps: the lattice A_3* in space, else a rank-1 lattice with good projections.

    A point of A_3* has 8 nearest neighbours in all directions; the six nearest of a rank-1 lattice mostly lie in a
    plane.  From four dimensions on A_d* loses more in the spread of projections than it gains by its neighbours.  There
    each set has a random order of the axes, because axes may differ in weight, as the joints of an arm do.  If n has
    too few multipliers for axes that differ, the set is Sobol's.  ``studies/docs/which-points.md`` has the evidence.
    """

    name = "even"
    about = "our default for roadmaps: the lattice A_3* in d = 3, else a rank-1 lattice with good projections"
    # A lattice is shifted as it is drawn; A_3* does not match across faces.
    symmetries = frozenset({Symmetry.PERMUTATION, Symmetry.REFLECTION})
    turned_from = 3

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return n points, shape (n, d); limits are those of :class:`Korobov`."""
        n, d = require_count("n", n), require_count("d", d)
        if d == IN_ALL_DIRECTIONS and n <= MOST:
            return Lattice().draw(n, d, rng=rng).with_origin(family=self.name)
        if d > IN_ALL_DIRECTIONS and not has_distinct_axes(n, d):
            return Sobol().draw(n, d, rng=rng).with_origin(family=self.name)
        return super().draw(n, d, rng=rng).with_origin(objective="")

    def _vector(self, n: int, d: int) -> tuple[Sequence[int], str]:
        vector = rank_one_vector(n, d)
        return vector, f"z={' '.join(map(str, vector))}"


@dataclass(frozen=True)
class Sliced:
    """Poses for sparse roadmaps in SE(3): scrambled Sobol points, a share of which lies in one slice.

    The slice is a Korobov lattice of positions with one random rotation.  It has three dimensions instead of six, so
    few neighbours connect its poses, by short motions without a turn.  The other poses lead to the slice.
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
        # Shuffled, because some rules join each point to earlier ones.
        points = np.clip(random.permutation(cube), 0.0, np.nextafter(1.0, 0.0))
        method = f"{sliced} of one rotation, the others Sobol"
        return PointSet(points, Origin(family=self.name, method=method, seed=seed_of(rng)))


def _cube_of_quaternions(q: Floats) -> Floats:
    """Return the points of the cube that Shoemake's map takes to quaternions (w, x, y, z), (n, 4) -> (n, 3)."""
    w, x, y, z = q.T
    angles = np.column_stack([np.arctan2(x, y), np.arctan2(z, w)]) / (2.0 * np.pi)
    return np.column_stack([z * z + w * w, angles % 1.0])
