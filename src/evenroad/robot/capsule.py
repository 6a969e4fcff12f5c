"""Capsule: the one shape that robots are made of here."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Capsule:
    """All points within `radius` of the segment from `a` to `b`; a sphere where the two are one point.

    Attributes
    ----------
    link : str
        Name of the link that it is fixed to.
    a, b : tuple of 3 floats
        End points in the link's frame [m].
    radius : float
        Radius, > 0 [m].
    """

    link: str
    a: tuple[float, float, float]
    b: tuple[float, float, float]
    radius: float
