"""A point in the unit cube among boxes, among rods, or in a cave: nothing repeats, motions are tested exactly."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from evenroad._arrays import Bools, Floats, Ints, set_fields
from evenroad.errors import InvalidValue
from evenroad_studies.worlds.corridor import CubeWorld, comes_first, is_in_cube


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
        return _motions_miss_boxes(q, q, self.low, self.high)

    def _motion_valid(self, a: Floats, b: Floats) -> Bools:
        return _motions_miss_boxes(a, b, self.low, self.high)


@njit(cache=True, nogil=True)
def _motions_miss_boxes(a: Floats, b: Floats, low: Floats, high: Floats) -> Bools:
    """Return which straight motions stay in the unit cube and meet no box."""
    free = np.empty(len(a), dtype=np.bool_)
    for row in range(len(a)):
        first, last = (a[row], b[row]) if comes_first(a[row], b[row]) else (b[row], a[row])
        free[row] = is_in_cube(first) and is_in_cube(last)
        box = 0
        while free[row] and box < len(low):
            free[row] = _misses_box(first, last, low[box], high[box])
            box += 1
    return free


@njit(cache=True, nogil=True)
def _misses_box(a: Floats, b: Floats, low: Floats, high: Floats) -> bool:
    """Return whether a motion never is within one open box: on each axis it is within for one span of times."""
    begin, end = 0.0, 1.0
    for k in range(len(a)):
        if max(a[k], b[k]) <= low[k] or min(a[k], b[k]) >= high[k]:
            return True
        step = b[k] - a[k]
        if step == 0.0:
            continue
        enter, leave = (low[k] - a[k]) / step, (high[k] - a[k]) / step
        if step < 0.0:
            enter, leave = leave, enter
        begin, end = max(begin, enter), min(end, leave)
        if begin >= end:
            return True
    return False


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
        return _motions_miss_rods(q, q, self.axes, self.first, self.last, self.radius)

    def _motion_valid(self, a: Floats, b: Floats) -> Bools:
        return _motions_miss_rods(a, b, self.axes, self.first, self.last, self.radius)


@njit(cache=True, nogil=True)
def _motions_miss_rods(a: Floats, b: Floats, axes: Ints, first: Floats, last: Floats, radius: float) -> Bools:
    """Return which straight motions stay in the unit cube and meet no rod."""
    free = np.empty(len(a), dtype=np.bool_)
    for row in range(len(a)):
        p, q = (a[row], b[row]) if comes_first(a[row], b[row]) else (b[row], a[row])
        free[row] = is_in_cube(p) and is_in_cube(q)
        rod = 0
        while free[row] and rod < len(axes):
            free[row] = _squared_gap(p, q, axes[rod], first[rod], last[rod]) >= radius * radius
            rod += 1
    return free


@njit(cache=True, nogil=True)
def _squared_gap(p: Floats, q: Floats, axes: Ints, first: Floats, last: Floats) -> float:
    """Return the squared distance of two segments (Ericson 2005, section 5.1.9), in some coordinates of the first."""
    uu = vv = uv = uw = vw = ww = 0.0
    for j in range(len(axes)):
        k = axes[j]
        u, v, w = q[k] - p[k], last[j] - first[j], p[k] - first[j]
        uu, vv, uv, uw, vw, ww = uu + u * u, vv + v * v, uv + u * v, uw + u * w, vw + v * w, ww + w * w
    determinant = uu * vv - uv * uv
    s = min(max((uv * vw - vv * uw) / determinant, 0.0), 1.0) if determinant > 1e-14 * uu * vv else 0.0
    t = (uv * s + vw) / vv if vv > 0.0 else 0.0
    t = min(max(t, 0.0), 1.0)
    s = min(max((uv * t - uw) / uu, 0.0), 1.0) if uu > 0.0 else 0.0
    gap = ww + s * s * uu + t * t * vv + 2.0 * (s * uw - t * vw - s * t * uv)
    return max(gap, 0.0)


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
        return _motions_in_cave(q, q, self.centres, self.radii)

    def _motion_valid(self, a: Floats, b: Floats) -> Bools:
        return _motions_in_cave(a, b, self.centres, self.radii)


@njit(cache=True, nogil=True)
def _motions_in_cave(a: Floats, b: Floats, centres: Floats, radii: Floats) -> Bools:
    """Return which straight motions stay in the unit cube, each of their states in some ball."""
    free = np.empty(len(a), dtype=np.bool_)
    begin, end = np.empty(len(centres)), np.empty(len(centres))
    for row in range(len(a)):
        first, last = (a[row], b[row]) if comes_first(a[row], b[row]) else (b[row], a[row])
        free[row] = is_in_cube(first) and is_in_cube(last) and _covered(first, last, centres, radii, begin, end)
    return free


@njit(cache=True, nogil=True)
def _covered(a: Floats, b: Floats, centres: Floats, radii: Floats, begin: Floats, end: Floats) -> bool:
    """Return whether the spans of times that a motion is in the balls cover [0, 1]; the last two are scratch."""
    length = 0.0
    for k in range(len(a)):
        length += (b[k] - a[k]) ** 2
    count = 0
    for i in range(len(centres)):
        along, apart = 0.0, -radii[i] * radii[i]
        for k in range(len(a)):
            offset = a[k] - centres[i, k]
            along += offset * (b[k] - a[k])
            apart += offset * offset
        if length == 0.0:
            if apart <= 0.0:
                return True
            continue
        under = along * along - length * apart
        if under >= 0.0:
            root = math.sqrt(under)
            if along <= root and -along + root >= 0.0:
                begin[count], end[count] = (-along - root) / length, (-along + root) / length
                count += 1
    reached = 0.0
    while True:
        furthest = -1.0
        for i in range(count):
            if begin[i] <= reached:
                furthest = max(furthest, end[i])
        if furthest >= 1.0 or furthest <= reached:
            return furthest >= 1.0
        reached = furthest
