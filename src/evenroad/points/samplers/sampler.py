"""What a sampler is: a small frozen value that draws point sets."""

from __future__ import annotations

from typing import Protocol

from evenroad._rng import RngLike
from evenroad.points.pointset import PointSet


class Sampler(Protocol):
    """Draws sets of n points in d dimensions; the same arguments always give the same bits."""

    @property
    def name(self) -> str:
        """The name under which users ask for it."""
        ...

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return n points of [0, 1)^d, with their origin."""
        ...
