"""PeriodicBalls: a point in the unit cube among balls on the torus."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numba import njit

from evenroad._arrays import Bools, Floats, Ints
from evenroad._checks import require_positive
from evenroad.errors import InvalidValue
from evenroad.research.worlds.compiled import ROUNDING, CompiledWorld, comes_first, is_in_cube
from evenroad.space import Box
from evenroad.space.batch import as_cube_batch


@dataclass(frozen=True, eq=False)
class PeriodicBalls(CompiledWorld):
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
        object.__setattr__(self, "centres", centres)
        object.__setattr__(self, "radius", require_positive("radius", self.radius))

    @property
    def d(self) -> int:
        """Dimension."""
        return int(self.centres.shape[1])

    @cached_property
    def space(self) -> Box:
        """The unit cube with the Euclidean metric."""
        return Box([0.0] * self.d, [1.0] * self.d)

    def _valid(self, q: Floats) -> Bools:
        return points_are_free(q, self.centres, self.radius**2)

    def _motion_valid(self, a: Floats, b: Floats) -> Bools:
        return motions_are_free(a, b, self.centres, self.radius**2)


@njit(cache=True, nogil=True)
def points_are_free(q: Floats, centres: Floats, squared_radius: float) -> Bools:
    """Return which rows of `q`, (n, d), lie in the unit cube and in no ball."""
    free = np.empty(len(q), dtype=np.bool_)
    for row in range(len(q)):
        free[row] = is_in_cube(q[row]) and _is_outside_all(q[row], centres, squared_radius)
    return free


@njit(cache=True, nogil=True)
def motions_are_free(a: Floats, b: Floats, centres: Floats, squared_radius: float) -> Bools:
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
            and _is_outside_all(first, centres, squared_radius)
            and _is_outside_all(last, centres, squared_radius)
            and _misses_all(first, last, centres, squared_radius, step, times, axes)
        )
    return free


@njit(cache=True, nogil=True)
def _is_outside_all(q: Floats, centres: Floats, squared_radius: float) -> bool:
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
def _misses_all(
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
