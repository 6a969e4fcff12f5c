"""A point in the unit cube among boxes, among rods, or in a cave: nothing repeats, motions are tested exactly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Bools, Floats, Ints, set_fields
from evenroad.errors import InvalidValue
from evenroad_studies.worlds.corridor import CubeWorld, and_in_blocks, are_in_cube, in_order


def _require_same_shape(**arrays: Floats | Ints) -> None:
    """Raise InvalidValue unless all are (n, m) arrays of one shape, m >= 1."""
    shapes = {name: each.shape for name, each in arrays.items()}
    first = next(iter(shapes.values()))
    if len(first) != 2 or first[1] == 0 or any(shape != first for shape in shapes.values()):
        raise InvalidValue(f"arrays must have one shape (n, m) with m >= 1, got {shapes}")


@dataclass(frozen=True, eq=False)
class Boxes(CubeWorld):
    """A point robot in [0, 1]^d among open boxes from `low` to `high`, (n, d), infinite where they do not bound."""

    low: Floats
    high: Floats

    def __post_init__(self) -> None:
        low, high = (np.array(each, dtype=np.float64, order="C") for each in (self.low, self.high))
        _require_same_shape(low=low, high=high)
        set_fields(self, low=low, high=high)

    @property
    def d(self) -> int:  # type: ignore[override]
        """Dimension."""
        return int(self.low.shape[1])

    def _valid(self, q: Floats) -> Bools:
        return and_in_blocks(are_in_cube(q), self._outside, self.low.size, q)

    def _outside(self, q: Floats) -> Bools:
        q = q[:, np.newaxis]
        outside: Bools = np.all(np.any((q <= self.low) | (q >= self.high), axis=-1), axis=1)
        return outside

    def _motion_valid(self, a: Floats, b: Floats) -> Bools:
        return and_in_blocks(are_in_cube(a) & are_in_cube(b), self._miss, self.low.size, *in_order(a, b))

    def _miss(self, a: Floats, b: Floats) -> Bools:
        """Return which motions never are within one box: on each axis they are within for one span of times."""
        a, b = a[:, np.newaxis], b[:, np.newaxis]
        apart = (np.maximum(a, b) <= self.low) | (np.minimum(a, b) >= self.high)
        with np.errstate(divide="ignore", invalid="ignore"):
            times = np.stack([(self.low - a) / (b - a), (self.high - a) / (b - a)])
        begin = np.where(a == b, 0.0, times.min(axis=0)).max(axis=-1)
        end = np.where(a == b, 1.0, times.max(axis=0)).min(axis=-1)
        return (apart.any(axis=-1) | (np.maximum(begin, 0.0) >= np.minimum(end, 1.0))).all(axis=1)


@dataclass(frozen=True, eq=False)
class Rods(CubeWorld):
    """A point robot in [0, 1]^d among open rods of one radius, each in some of the coordinates.

    A rod is all that is closer than `radius` to the segment from `first` to `last`, (n, m), in the coordinates `axes`,
    (n, m); its other coordinates are free.  Where first and last are one point it is a ball or a column.
    """

    d: int
    axes: Ints
    first: Floats
    last: Floats
    radius: float

    def __post_init__(self) -> None:
        axes = np.array(self.axes, dtype=np.int64, order="C")
        first, last = (np.array(each, dtype=np.float64, order="C") for each in (self.first, self.last))
        _require_same_shape(axes=axes, first=first, last=last)
        set_fields(self, axes=axes, first=first, last=last)

    def _valid(self, q: Floats) -> Bools:
        return self._motion_valid(q, q)

    def _motion_valid(self, a: Floats, b: Floats) -> Bools:
        return and_in_blocks(are_in_cube(a) & are_in_cube(b), self._miss, 3 * self.first.size, *in_order(a, b))

    def _miss(self, p: Floats, q: Floats) -> Bools:
        """Return which motions keep off all rods, by distances of two segments (Ericson 2005, section 5.1.9)."""
        u, v, w = (q - p)[:, self.axes], self.last - self.first, p[:, self.axes] - self.first
        uu, vv, uv, uw, vw, ww = ((x * y).sum(axis=-1) for x, y in ((u, u), (v, v), (u, v), (u, w), (v, w), (w, w)))
        determinant = uu * vv - uv * uv
        s = _share(uv * vw - vv * uw, determinant, determinant > 1e-14 * uu * vv)
        t = _share(uv * s + vw, vv, vv > 0.0)
        s = _share(uv * t - uw, uu, uu > 0.0)
        gap = ww + s * s * uu + t * t * vv + 2.0 * (s * uw - t * vw - s * t * uv)
        return (np.maximum(gap, 0.0) >= self.radius * self.radius).all(axis=1)


def _share(above: Floats, below: Floats, divides: Bools) -> Floats:
    """Return a quotient, cut off at 0 and 1; 0 where nothing divides."""
    return np.clip(np.divide(above, below, out=np.zeros_like(above), where=divides), 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Cave(CubeWorld):
    """A point robot in [0, 1]^d that is free in closed balls alone: centres (n, d), radii (n,)."""

    centres: Floats
    radii: Floats

    def __post_init__(self) -> None:
        centres = np.array(self.centres, dtype=np.float64, order="C")
        _require_same_shape(centres=centres)
        set_fields(self, centres=centres, radii=np.array(self.radii, dtype=np.float64))

    @property
    def d(self) -> int:  # type: ignore[override]
        """Dimension."""
        return int(self.centres.shape[1])

    def _valid(self, q: Floats) -> Bools:
        return self._motion_valid(q, q)

    def _motion_valid(self, a: Floats, b: Floats) -> Bools:
        return and_in_blocks(are_in_cube(a) & are_in_cube(b), self._cover, self.centres.size, *in_order(a, b))

    def _cover(self, a: Floats, b: Floats) -> Bools:
        """Return of which motions the spans of times that they are in the balls cover [0, 1]."""
        step, offset = (b - a)[:, np.newaxis], a[:, np.newaxis] - self.centres
        length = (step * step).sum(axis=-1)
        along, apart = (offset * step).sum(axis=-1), (offset * offset).sum(axis=-1) - self.radii**2
        under = along * along - length * apart
        root = np.sqrt(np.maximum(under, 0.0))
        meets = (under >= 0.0) & (along <= root) & (root >= along)
        with np.errstate(divide="ignore", invalid="ignore"):
            begin = np.where(meets, (-along - root) / length, np.inf)
            end = (-along + root) / length
        begin, end = (
            np.where(length == 0.0, np.where(apart <= 0.0, 0.0, np.inf), begin),
            np.where(length == 0.0, 1.0, end),
        )
        reached, furthest = np.full(len(a), -np.inf), np.zeros(len(a))
        while (furthest > reached).any():
            reached = furthest
            furthest = np.where(begin <= reached[:, np.newaxis], end, 0.0).max(axis=1, initial=0.0)
        return reached >= 1.0
