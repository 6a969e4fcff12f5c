"""Many sets from one: random permutations, reflections and shifts."""

from __future__ import annotations

from collections.abc import Collection
from enum import StrEnum

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad._rng import RngLike, generator
from evenroad.points.pointset import BELOW_ONE, PointSet, below_one


class Symmetry(StrEnum):
    """A kind of transformation of the unit cube."""

    PERMUTATION = "permutations of the coordinates"
    REFLECTION = "reflections"
    SHIFT = "shifts modulo 1"


ALL_SYMMETRIES = frozenset(Symmetry)


def randomise(points: PointSet, symmetries: Collection[Symmetry], *, rng: RngLike = 0) -> PointSet:
    """Return the points after random transformations of these kinds: permuted, then reflected, then shifted.

    The method of the origin records them with all digits: ``annealed, permuted 2 0 1, reflected 0``.  A coordinate
    reflected to 1 becomes the largest float32 below.  ``make_sampler(name).symmetries`` keep the quality of its sets.
    """
    random = generator(rng)
    if Symmetry.PERMUTATION in symmetries:
        order = random.permutation(points.d)
        if (order != np.arange(points.d)).any():
            points = _moved(points, points.points[:, order], "permuted", order)
    if Symmetry.REFLECTION in symmetries:
        flipped = random.random(points.d) < 0.5
        if flipped.any():
            mirrored = np.minimum(1.0 - points.points, BELOW_ONE)
            coordinates = np.where(flipped, mirrored, points.points)
            points = _moved(points, coordinates, "reflected", np.flatnonzero(flipped))
    if Symmetry.SHIFT in symmetries:
        vector = random.random(points.d)
        # Both summands are >= 0, so the remainder is exact and below 1.
        points = _moved(points, (points.points + vector) % 1.0, "shifted", vector)
    return points


def _moved(points: PointSet, coordinates: Floats, verb: str, values: Floats | Ints) -> PointSet:
    how = " ".join([verb, *map(str, values.tolist())])
    return PointSet(below_one(coordinates), points.origin).with_origin(method=f"{points.origin.method}, {how}")
