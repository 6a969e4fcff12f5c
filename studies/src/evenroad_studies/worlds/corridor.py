"""What worlds of arrays share; and Corridor, along edges of the unit cube of any dimension: the reference world."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from evenroad._arrays import Bools, Floats, Ints, set_fields
from evenroad._checks import require_count, require_known, require_positive
from evenroad.errors import InvalidValue
from evenroad.space import BoxSpace, Space
from evenroad.space.batch import as_batch, as_batch_pair
from evenroad.world.bisection import between_endpoints

ROUNDING = 1e-9
"""What bounds leave for rounding, so that they never decide what the exact test would decide otherwise."""


class BatchWorld(ABC):
    """A world of arrays; a subclass gives its space and the checks of sound batches."""

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


class CubeWorld(BatchWorld):
    """One in the unit cube of dimension `d`."""

    d: int

    @cached_property
    def space(self) -> BoxSpace:
        """The unit cube with the Euclidean metric."""
        return BoxSpace([0.0] * self.d, [1.0] * self.d)


def in_order(a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """Return both ends of motions, (m, d) each, first the one that comes first in the order of words.

    Motions are tested from there: one and its reverse then give the same bits.
    """
    rows, differing = np.arange(len(a)), (a != b).argmax(axis=1)
    turned = (a[rows, differing] > b[rows, differing])[:, np.newaxis]
    return np.where(turned, b, a), np.where(turned, a, b)


def are_in_cube(q: Floats) -> Bools:
    """Return which rows of `q`, (n, d), lie in the closed unit cube."""
    inside: Bools = np.all((q >= 0.0) & (q <= 1.0), axis=1)
    return inside


AT_ONCE = 200_000
"""Number of values in an array that a check works on at once: few enough to stay in the processor's memory."""


def and_in_blocks(so_far: Bools, check: Callable[..., Bools], each: int, *rows: Floats) -> Bools:
    """Return which rows pass a check too, block by block, where one row has so many values to work on."""
    free = so_far.copy()
    left, step = np.flatnonzero(so_far), max(1, AT_ONCE // max(1, each))
    for at in range(0, len(left), step):
        block = left[at : at + step]
        free[block] = check(*(array[block] for array in rows))
    return free


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
        return are_in_cube(q) & self._in_corridor(q)

    def _motion_valid(self, a: Floats, b: Floats) -> Bools:
        free = self._valid(a) & self._valid(b)
        segments = np.zeros(len(a), dtype=np.int64)
        segments[free] = np.ceil(np.sqrt(((b[free] - a[free]) ** 2).sum(axis=1)) / self.resolution)
        for motion, state in between_endpoints(segments, free):
            count = segments[motion]
            # Two weights, not one fraction: a motion and its reverse then have the same states.
            from_a, from_b = (((count - state) / count)[:, np.newaxis], (state / count)[:, np.newaxis])
            free[motion[~self._in_corridor(from_a * a[motion] + from_b * b[motion])]] = False
        return free

    def _in_corridor(self, q: Floats) -> Bools:
        """Return which configurations have, along the axes, none < 1 - lam past the first coordinate > lam."""
        q = q[:, self._axes]
        past = np.logical_or.accumulate(q[:, :-1] > self.lam, axis=1)
        free: Bools = np.all(~past | (q[:, 1:] >= 1.0 - self.lam), axis=1)
        return free
