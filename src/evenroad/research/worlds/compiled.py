"""What the compiled worlds share: their batches, the unit cube, and one direction for both orders of a motion."""

from __future__ import annotations

from abc import ABC, abstractmethod

from numba import njit

from evenroad._arrays import Bools, Floats
from evenroad.space import Space
from evenroad.space.batch import as_batch, as_batch_pair

ROUNDING = 1e-9
"""What bounds leave for rounding, so that they never decide what the exact test would decide otherwise."""


class CompiledWorld(ABC):
    """A world with compiled checks; a subclass gives its space and the checks of sound batches."""

    @property
    @abstractmethod
    def space(self) -> Space:
        """The space that the configurations live in."""

    def valid(self, q: Floats) -> Bools:
        """Return which configurations, (n, dim), are free: (n,)."""
        return self._valid(as_batch("q", q, self.space.dim))

    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """Return which motions from each row of `a` to that of `b`, two (m, dim) arrays, are free: (m,)."""
        return self._motion_valid(*as_batch_pair(a, b, self.space.dim))

    @abstractmethod
    def _valid(self, q: Floats) -> Bools: ...

    @abstractmethod
    def _motion_valid(self, a: Floats, b: Floats) -> Bools: ...


@njit(cache=True, nogil=True, inline="always")
def comes_first(a: Floats, b: Floats) -> bool:
    """Return whether `a` is not after `b` in the order of words.

    Motions are tested from the end that comes first: one and its reverse then give the same bits.
    """
    for k in range(len(a)):
        if a[k] != b[k]:
            return bool(a[k] < b[k])
    return True


@njit(cache=True, nogil=True)
def is_in_cube(q: Floats) -> bool:
    """Return whether `q`, (d,), lies in the closed unit cube."""
    inside = True
    for coordinate in q:
        inside &= 0.0 <= coordinate <= 1.0
    return inside
