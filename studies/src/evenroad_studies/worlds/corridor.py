"""What compiled worlds share; and Corridor, along edges of the unit cube of any dimension: the reference world."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numba import njit

from evenroad._arrays import Bools, Floats, Ints, set_fields
from evenroad._checks import require_count, require_known, require_positive
from evenroad.errors import InvalidValue
from evenroad.space import BoxSpace, Space
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


class CubeWorld(CompiledWorld):
    """One in the unit cube of dimension `d`."""

    d: int

    @cached_property
    def space(self) -> BoxSpace:
        """The unit cube with the Euclidean metric."""
        return BoxSpace([0.0] * self.d, [1.0] * self.d)


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


_SIDES = ("comment", "demo")


@dataclass(frozen=True)
class Corridor(CubeWorld):
    """The corridor of width `lam` along d edges of the unit cube, from (0, .., 0) to (1, .., 1).

    A configuration is free iff it lies in [0, 1]^d and there is a k with ``x_i <= lam`` for all i < k and
    ``x_i >= 1 - lam`` for all i > k: the Hypercube benchmark of OMPL's demos.  Motions are straight and
    tested at ``n = ceil(length / resolution)`` segments' ends, the first included, in bisection order.  From a width of
    one half on, the straight way from start to goal is free.

    Only the first `checked` coordinates are tested, all by default.  OMPL's demo tests 6, whatever its dimension:
    published results for "d = 10" are of that.  The side "demo" has the two sides swapped against the definition above,
    as the demo's code has against its comment; it matters only where coordinates are not alike (Halton).
    """

    d: int
    lam: float
    checked: int | None = None
    side: Literal["comment", "demo"] = "comment"

    def __post_init__(self) -> None:
        set_fields(self, d=require_count("d", self.d), lam=require_positive("lam", self.lam))
        if self.lam >= 1.0:
            raise InvalidValue(f"lam must be in (0, 1), got {self.lam!r}")
        if self.checked is not None and require_count("checked", self.checked) > self.d:
            raise InvalidValue(f"checked must be at most d = {self.d}, got {self.checked!r}")
        require_known("side", self.side, _SIDES)

    @cached_property
    def _axes(self) -> Ints:
        """The coordinates that are tested, in their order along the corridor."""
        axes = np.arange(self.d if self.checked is None else self.checked)
        axes = axes if self.side == "comment" else axes[::-1].copy()
        axes.setflags(write=False)
        return axes

    @property
    def resolution(self) -> float:
        """Largest distance between states that are tested on a motion: ``0.001 sqrt(d)``, as in the demo."""
        return 0.001 * math.sqrt(self.d)

    @property
    def start(self) -> Floats:
        """One end of the corridor, (0, .., 0)."""
        return np.zeros(self.d)

    @property
    def goal(self) -> Floats:
        """The other end, (1, .., 1)."""
        return np.ones(self.d)

    def _valid(self, q: Floats) -> Bools:
        return points_are_free(q, self.lam, self._axes)

    def _motion_valid(self, a: Floats, b: Floats) -> Bools:
        return motions_are_free(a, b, self.resolution, self.lam, self._axes)


@njit(cache=True, nogil=True)
def points_are_free(q: Floats, width: float, axes: Ints) -> Bools:
    """Return which rows of `q`, (n, d), lie in the unit cube and in the corridor along `axes`."""
    free = np.empty(len(q), dtype=np.bool_)
    for row in range(len(q)):
        free[row] = is_in_cube(q[row]) and _is_in_corridor(q[row], q[row], 1.0, 0.0, width, axes)
    return free


@njit(cache=True, nogil=True)
def motions_are_free(a: Floats, b: Floats, resolution: float, width: float, axes: Ints) -> Bools:
    """Return which motions are free at both ends and at states at most `resolution` apart, in bisection order."""
    free = np.empty(len(a), dtype=np.bool_)
    for row in range(len(a)):
        free[row] = (
            is_in_cube(a[row])
            and is_in_cube(b[row])
            and _is_in_corridor(a[row], b[row], 1.0, 0.0, width, axes)
            and _is_in_corridor(a[row], b[row], 0.0, 1.0, width, axes)
            and _motion_is_free(a[row], b[row], resolution, width, axes)
        )
    return free


@njit(cache=True, nogil=True)
def _motion_is_free(a: Floats, b: Floats, resolution: float, width: float, axes: Ints) -> bool:
    squared = 0.0
    for k in range(len(a)):
        squared += (b[k] - a[k]) * (b[k] - a[k])
    segments = math.ceil(math.sqrt(squared) / resolution)
    # As evenroad.world.bisection, but written out: a state takes so little here that a call for each shows.
    level = 1
    while (1 << (level - 1)) < segments:
        before = 0
        for multiple in range(1, 1 << level, 2):
            state = (multiple * segments) >> level
            after = ((multiple + 1) * segments) >> level
            if before < state < after:
                # Two weights, not one fraction: a motion and its reverse then have the same states.
                from_a, from_b = (segments - state) / segments, state / segments
                if not _is_in_corridor(a, b, from_a, from_b, width, axes):
                    return False
            before = after
        level += 1
    return True


@njit(cache=True, nogil=True)
def _is_in_corridor(a: Floats, b: Floats, from_a: float, from_b: float, width: float, axes: Ints) -> bool:
    """Test ``from_a a + from_b b``: along `axes`, past the first coordinate > width none is < 1 - width."""
    past_the_corner = False
    for axis in axes:
        coordinate = from_a * a[axis] + from_b * b[axis]
        if past_the_corner:
            if coordinate < 1.0 - width:
                return False
        elif coordinate > width:
            past_the_corner = True
    return True
