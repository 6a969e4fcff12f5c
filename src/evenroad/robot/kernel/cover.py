"""Spheres that cover a capsule, all of one radius a little larger than its own."""

from __future__ import annotations

import math
from dataclasses import dataclass

LARGEST_EXCESS = 1.10
"""The spheres' radius is at most this many times the capsule's."""


@dataclass(frozen=True)
class Cover:
    """Spheres along a capsule whose union contains it.

    Attributes
    ----------
    places : tuple of floats
        Centres along the segment, from -1 at one end to 1 at the other.
    radius : float
        Of every sphere [m].
    """

    places: tuple[float, ...]
    radius: float


def cover_capsule(half_length: float, radius: float) -> Cover:
    """Return the fewest spheres, evenly spaced, that cover a capsule at no more than `LARGEST_EXCESS`.

    The spheres' radius is R.  Neighbours d apart cover the tube between them if ``R^2 >= radius^2 + (d/2)^2``,
    and the outermost cover the caps if they lie at most ``R - radius`` inside the ends, since a ball holds
    every smaller one that touches it from within.  With both taken as equalities n spheres reach a half
    length of ``(n - 1) sqrt(R^2 - radius^2) + (R - radius)``, which rises with R: the least R is found by bisection.

    Parameters
    ----------
    half_length : float
        Half of the segment's length, >= 0 [m].
    radius : float
        Of the capsule, > 0 [m].
    """
    if half_length == 0.0:
        return Cover((0.0,), radius)
    most = LARGEST_EXCESS * radius
    gaps = max(0, math.ceil((half_length - (most - radius)) / math.sqrt(most**2 - radius**2)))
    least = radius
    for _ in range(60):
        middle = 0.5 * (least + most)
        if gaps * math.sqrt(middle**2 - radius**2) + (middle - radius) < half_length:
            least = middle
        else:
            most = middle
    outermost = (half_length - (most - radius)) / half_length if gaps else 0.0
    places = [outermost * (2.0 * i / gaps - 1.0) for i in range(gaps + 1)] if gaps else [0.0]
    return Cover(tuple(places), most)
