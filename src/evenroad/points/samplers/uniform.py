"""Independent uniform points: what every other sampler is compared with."""

from __future__ import annotations

from dataclasses import dataclass

from evenroad._checks import require_count
from evenroad._rng import RngLike, generator, seed_of
from evenroad.points.pointset import Origin, PointSet


@dataclass(frozen=True)
class Uniform:
    """Independent points, uniform on the cube (PCG64)."""

    name = "uniform"

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Draw n independent points.

        Parameters
        ----------
        n, d : int
            Number of points (>= 1) and dimension (>= 1).
        rng : int, SeedSequence or Generator
            A passed Generator is spawned.

        Returns
        -------
        PointSet
            Shape (n, d).

        Raises
        ------
        InvalidValue
            If n, d or rng is not of that kind.
        """
        n, d = require_count("n", n), require_count("d", d)
        origin = Origin(family=self.name, method="independent", seed=seed_of(rng))
        return PointSet(generator(rng).random((n, d)), origin)
