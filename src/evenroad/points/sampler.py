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
        ...

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return n points of [0, 1)^d, with their origin.

        Parameters
        ----------
        n, d : int
            Number of points and dimension, >= 1.
        rng : int, SeedSequence or Generator
            All that is random comes from it.  A passed Generator is spawned.

        Raises
        ------
        InvalidValue
            If n, d or rng is not of that kind, or the sampler does not go up to this n or d.
        NotAvailable
            If the sampler has no set of this n and d.
        """
        ...


class KnownSampler(Sampler, Protocol):
    """A sampler of the registry: it says itself what lists and other verbs need to know of it."""

    @property
    def about(self) -> str:
        """What its sets are, in one line."""
        ...

    @property
    def any_n(self) -> bool:
        """Whether it has a set of every n, in every dimension that it takes."""
        ...

    @property
    def symmetries(self) -> frozenset[Symmetry]:
        """Which transformations keep the quality of its sets."""
        ...
