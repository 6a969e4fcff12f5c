"""What a sampler is: a small frozen value that draws point sets."""

from __future__ import annotations

from enum import StrEnum
from typing import Protocol

from evenroad._rng import RngLike
from evenroad.points.pointset import PointSet


class Symmetry(StrEnum):
    """A kind of transformation of the unit cube."""

    PERMUTATION = "permutations of the coordinates"
    REFLECTION = "reflections"
    SHIFT = "shifts modulo 1"


ALL_SYMMETRIES = frozenset(Symmetry)


class Sampler(Protocol):
    """Draws sets of n points in d dimensions; the same arguments give the same bits on one kind of processor."""

    @property
    def name(self) -> str:
        """The name under which users ask for it."""

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return n >= 1 points of [0, 1)^d, d >= 1, with their origin; all that is random comes from `rng`.

        A passed Generator is spawned.  Raises InvalidValue if n, d or rng is not of that kind, or the sampler does not
        go up to this n or d; NotAvailable if it has no set of this n and d.
        """


class KnownSampler(Sampler, Protocol):
    """A sampler of the registry says itself what lists and other verbs need to know of it."""

    @property
    def about(self) -> str:
        """What its sets are, in one line."""

    @property
    def any_n(self) -> bool:
        """Whether it has a set of every n, in every dimension that it takes."""

    @property
    def symmetries(self) -> frozenset[Symmetry]:
        """Which transformations keep the quality of its sets."""
