"""Poses of a body for sparse roadmaps, as points of the cube of SE3."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_count, require_positive
from evenroad._rng import RngLike, generator, seed_of
from evenroad.errors import InvalidValue
from evenroad.points.pointset import Origin, PointSet
from evenroad.points.samplers.korobov import Korobov
from evenroad.points.samplers.plain import Sobol


@dataclass(frozen=True)
class Sliced:
    """Poses in space for sparse roadmaps: scrambled Sobol points, of which a share lies in one slice, as cube of SE3.

    The slice is one rotation, drawn at random, with a Korobov lattice of places.  It has three dimensions instead of
    six, so its poses are so near to each other that few neighbours connect them, by short motions without a turn; the
    others lead there.
    """

    share: float = 1 / 3
    """Of the poses that are in the slice, 0 .. 1; random worlds of the tuning stream chose it."""

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
