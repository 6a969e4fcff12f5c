"""Distance: how far a robot is from contact, and which two bodies are nearest."""

from __future__ import annotations

from typing import NamedTuple

from evenroad._arrays import Floats

Pair = tuple[str, str]


class Distance(NamedTuple):
    """The least distance of a robot's bodies from obstacles and from each other.

    Attributes
    ----------
    metres : float, or float64 ndarray, shape (n,)
        0.0 where two touch, also such as no joint moves, and > 0 in every free configuration; 1.0 where all are that
        far, or farther.
    pair : (str, str) or None, or list of n such
        Which two: a link and an obstacle, or two links; None where nothing is nearer than 1 m.
    """

    metres: float | Floats
    pair: Pair | list[Pair | None] | None


MOST = 1.0
"""Largest distance that is measured [m]."""

LEAST = 1e-9
"""Smallest distance of bodies that do not touch, even where rounding leaves less [m]."""
