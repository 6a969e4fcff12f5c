"""A point in the unit cube among obstacles that repeat with period 1: balls, and boxes in some of the coordinates."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad._arrays import Bools, Floats, Ints, set_fields
from evenroad._checks import require_count, require_positive
from evenroad.errors import InvalidValue
from evenroad.space.batch import as_cube_batch
from evenroad_studies.worlds.corridor import ROUNDING, CubeWorld, comes_first, is_in_cube


@dataclass(frozen=True, eq=False)
class PeriodicBalls(CubeWorld):
    """A point robot in [0, 1]^d among open balls of one radius that repeat with period 1 along every axis.

    With centres, (n, d) in [0, 1], drawn uniformly the free set is stationary: no place of the cube, at its faces or in
    the middle, is freer than another.  Only the obstacles are periodic.  The space is the cube, whose faces stop the
    robot as joint limits do, and motions are straight.  They are tested exactly, without any step length, up to float
    rounding.  A ball whose radius exceeds one half overlaps its own copies.
    """

    centres: Floats
    radius: float

    def __post_init__(self) -> None:
        shape = np.shape(self.centres)
        if len(shape) != 2 or shape[1] == 0:
            raise InvalidValue(f"centres must have shape (n, d) with d >= 1, got {shape}")
        centres = as_cube_batch(np.array(self.centres, dtype=np.float64, order="C"), shape[1])
        set_fields(self, centres=centres, radius=require_positive("radius", self.radius))

    @property
    def d(self) -> int:  # type: ignore[override]
        """Dimension."""
        return int(self.centres.shape[1])

    def _valid(self, q: Floats) -> Bools:
        return _points_miss_balls(q, self.centres, self.radius**2)

    def _motion_valid(self, a: Floats, b: Floats) -> Bools:
        return _motions_miss_balls(a, b, self.centres, self.radius**2)


@njit(cache=True, nogil=True)
def _points_miss_balls(q: Floats, centres: Floats, squared_radius: float) -> Bools:
    """Return which rows of `q`, (n, d), lie in the unit cube and in no ball."""
    free = np.empty(len(q), dtype=np.bool_)
    for row in range(len(q)):
        free[row] = is_in_cube(q[row]) and _is_outside_balls(q[row], centres, squared_radius)
    return free


@njit(cache=True, nogil=True)
def _motions_miss_balls(a: Floats, b: Floats, centres: Floats, squared_radius: float) -> Bools:
    """Return which straight motions stay in the unit cube and meet no ball."""
    free = np.empty(len(a), dtype=np.bool_)
    d = a.shape[1]
    # A step along an axis is at most 1 long: it passes at most two borders between copies.
    step, times, axes = np.empty(d), np.empty(2 * d), np.empty(2 * d, dtype=np.int64)
    for row in range(len(a)):
        first, last = (a[row], b[row]) if comes_first(a[row], b[row]) else (b[row], a[row])
        free[row] = (
            is_in_cube(first)
            and is_in_cube(last)
            and _is_outside_balls(first, centres, squared_radius)
            and _is_outside_balls(last, centres, squared_radius)
            and _misses_balls(first, last, centres, squared_radius, step, times, axes)
        )
    return free


@njit(cache=True, nogil=True)
def _is_outside_balls(q: Floats, centres: Floats, squared_radius: float) -> bool:
    for i in range(len(centres)):
        squared = 0.0
        for k in range(len(q)):
            offset = q[k] - centres[i, k]
            offset -= np.rint(offset)
            squared += offset * offset
        if squared < squared_radius:
            return False
    return True


@njit(cache=True, nogil=True)
def _misses_balls(
    a: Floats, b: Floats, centres: Floats, squared_radius: float, step: Floats, times: Floats, axes: Ints
) -> bool:
    """Return whether ``a + t (b - a)``, t in [0, 1], stays out of every ball; the last three are room to work in.

    The squared distance from a centre on the torus is the sum over the axes of the squared distance from its nearest
    copy along that axis.  Between the times at which some axis changes its nearest copy it is one parabola.
    """
    squared_length = 0.0
    for k in range(len(a)):
        step[k] = b[k] - a[k]
        squared_length += step[k] * step[k]
    if squared_length == 0.0:
        return True
    in_reach = math.sqrt(squared_radius) + 0.5 * math.sqrt(squared_length) + ROUNDING
    for i in range(len(centres)):
        # Most balls are out of reach of a short motion, wherever on it: its middle says so.
        squared = 0.0
        for k in range(len(a)):
            offset = a[k] + 0.5 * step[k] - centres[i, k]
            offset -= np.rint(offset)
            squared += offset * offset
        if squared > in_reach * in_reach:
            continue
        # The parabola squared + 2 t along + t^2 squared_length, and the changes in the order of their times.
        squared, along, changes = 0.0, 0.0, 0
        for k in range(len(a)):
            offset = a[k] - centres[i, k]
            offset -= np.rint(offset)
            squared += offset * offset
            along += offset * step[k]
            sign = 1.0 if step[k] > 0.0 else -1.0
            border = 0.5
            while sign * (offset + step[k]) > border:
                time = (sign * border - offset) / step[k]
                place = changes
                while place > 0 and times[place - 1] > time:
                    times[place], axes[place] = times[place - 1], axes[place - 1]
                    place -= 1
                times[place], axes[place] = time, k
                changes += 1
                border += 1.0
        begin = 0.0
        for change in range(changes + 1):
            end = times[change] if change < changes else 1.0
            nearest = min(max(-along / squared_length, begin), end)
            if squared + nearest * (2.0 * along + nearest * squared_length) < squared_radius:
                return False
            if change < changes:
                # The offset that is now half a period is minus half a period from the next copy.
                k = axes[change]
                sign = 1.0 if step[k] > 0.0 else -1.0
                squared += 1.0 - 2.0 * sign * (0.5 * sign - end * step[k])
                along -= sign * step[k]
                begin = end
    return True


@dataclass(frozen=True, eq=False)
class PeriodicBoxes(CubeWorld):
    """A point robot in [0, 1]^d among open boxes in some of the coordinates, with period 1 along every axis.

    A configuration is in a box if each of the box's own m coordinates is closer to the centre than the half extent;
    its other coordinates are free, as an obstacle in the workspace of an arm leaves the joints free that do not move
    the link it stands by.  With centres drawn uniformly the free set is stationary: no place of the cube is freer than
    another.  Only the obstacles are periodic: the space is the cube, whose faces stop the robot, and motions are
    straight.  They are tested exactly, without any step length, up to float rounding.

    `axes`, (n, m), are the coordinates that each box bounds, all different; along these `centres` are in [0, 1] and
    `half_extents` in (0, 0.5], (n, m) each.
    """

    d: int
    axes: Ints
    centres: Floats
    half_extents: Floats

    def __post_init__(self) -> None:
        d = require_count("d", self.d)
        set_fields(self, d=d, axes=_as_axes(self.axes, d))
        shape = self.axes.shape
        for name in ("centres", "half_extents"):
            array = np.array(getattr(self, name), dtype=np.float64, order="C")
            if array.shape != shape:
                raise InvalidValue(f"{name} must have the shape of axes, {shape}, got {array.shape}")
            set_fields(self, **{name: as_cube_batch(array, shape[1])})
        outside = self.half_extents[(self.half_extents <= 0.0) | (self.half_extents > 0.5)]
        if len(outside):
            raise InvalidValue(f"half_extents must be in (0, 0.5], got {float(outside[0])!r}")

    def _valid(self, q: Floats) -> Bools:
        return _points_miss_boxes(q, self.axes, self.centres, self.half_extents)

    def _motion_valid(self, a: Floats, b: Floats) -> Bools:
        return _motions_miss_boxes(a, b, self.axes, self.centres, self.half_extents)


def _as_axes(values: npt.ArrayLike, d: int) -> Ints:
    """Return the axes as an (n, m) array, or raise InvalidValue."""
    axes = np.asarray(values)
    if axes.ndim != 2 or axes.shape[1] == 0 or not np.issubdtype(axes.dtype, np.integer):
        raise InvalidValue(f"axes must be integers of shape (n, m) with m >= 1, got {axes.dtype} of shape {axes.shape}")
    outside = (axes < 0) | (axes >= d)
    if outside.any():
        raise InvalidValue(f"axes must be in 0 .. {d - 1}, got {int(axes[outside][0])}")
    in_order = np.sort(axes, axis=1)
    twice = (in_order[:, 1:] == in_order[:, :-1]).any(axis=1)
    if twice.any():
        raise InvalidValue(f"the axes of a box must be different, got {axes[twice][0].tolist()}")
    return np.array(axes, dtype=np.int64, order="C")


@njit(cache=True, nogil=True)
def _points_miss_boxes(q: Floats, axes: Ints, centres: Floats, half_extents: Floats) -> Bools:
    """Return which rows of `q`, (n, d), lie in the unit cube and in no box."""
    free = np.empty(len(q), dtype=np.bool_)
    for row in range(len(q)):
        free[row] = is_in_cube(q[row]) and _is_outside_boxes(q[row], axes, centres, half_extents)
    return free


@njit(cache=True, nogil=True)
def _motions_miss_boxes(a: Floats, b: Floats, axes: Ints, centres: Floats, half_extents: Floats) -> Bools:
    """Return which straight motions stay in the unit cube and meet no box."""
    free = np.empty(len(a), dtype=np.bool_)
    # Each axis can be within the box in three spans of time, and an intersection has fewer spans than both together.
    room = 3 * axes.shape[1] + 1
    spans, narrowed, on_axis = np.empty((room, 2)), np.empty((room, 2)), np.empty((3, 2))
    for row in range(len(a)):
        first, last = (a[row], b[row]) if comes_first(a[row], b[row]) else (b[row], a[row])
        free[row] = (
            is_in_cube(first)
            and is_in_cube(last)
            and _is_outside_boxes(first, axes, centres, half_extents)
            and _is_outside_boxes(last, axes, centres, half_extents)
        )
        box = 0
        while free[row] and box < len(axes):
            free[row] = _misses_box(first, last, axes[box], centres[box], half_extents[box], spans, narrowed, on_axis)
            box += 1
    return free


@njit(cache=True, nogil=True)
def _is_outside_boxes(q: Floats, axes: Ints, centres: Floats, half_extents: Floats) -> bool:
    for box in range(len(axes)):
        inside = True
        for j in range(axes.shape[1]):
            offset = q[axes[box, j]] - centres[box, j]
            inside &= abs(offset - np.rint(offset)) < half_extents[box, j]
        if inside:
            return False
    return True


@njit(cache=True, nogil=True)
def _misses_box(a, b, axes, centre, half_extent, spans, narrowed, on_axis):  # type: ignore[no-untyped-def]
    """Return whether ``a + t (b - a)``, 0 <= t <= 1, is never within one box; the last three are room to work in."""
    for j in range(len(axes)):
        # Most boxes are out of reach along some axis: the middle of the motion says so.
        step = b[axes[j]] - a[axes[j]]
        middle = a[axes[j]] + 0.5 * step - centre[j]
        if abs(middle - np.rint(middle)) > half_extent[j] + 0.5 * abs(step) + ROUNDING:
            return True
    spans[0, 0], spans[0, 1] = 0.0, 1.0
    count = 1
    for j in range(len(axes)):
        begin = a[axes[j]] - centre[j]
        found = _times_within(begin, b[axes[j]] - a[axes[j]], half_extent[j], on_axis)
        kept = 0
        for s in range(count):
            for t in range(found):
                low, high = max(spans[s, 0], on_axis[t, 0]), min(spans[s, 1], on_axis[t, 1])
                if low < high:
                    narrowed[kept, 0], narrowed[kept, 1] = low, high
                    kept += 1
        if kept == 0:
            return True
        spans, narrowed, count = narrowed, spans, kept
    return False


@njit(cache=True, nogil=True)
def _times_within(begin: float, step: float, half_extent: float, spans: Floats) -> int:
    """Write the spans of time in which ``begin + t step`` is closer than `half_extent` to an integer; return how many.

    `begin` and ``begin + step`` lie in [-1, 1], so that only -1, 0 and 1 can be near.
    """
    count = 0
    for copy in range(-1, 2):
        low, high = copy - half_extent - begin, copy + half_extent - begin
        if step == 0.0:
            low, high = (0.0, 1.0) if low < 0.0 < high else (1.0, 0.0)
        elif step > 0.0:
            low, high = low / step, high / step
        else:
            low, high = high / step, low / step
        low, high = max(low, 0.0), min(high, 1.0)
        if low < high:
            spans[count, 0], spans[count, 1] = low, high
            count += 1
    return count
