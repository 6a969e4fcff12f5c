"""A point in the unit cube among obstacles that repeat with period 1: balls, and boxes in some of the coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats, Ints, set_fields
from evenroad._checks import require_count, require_positive
from evenroad.errors import InvalidValue
from evenroad.space.batch import as_cube_batch
from evenroad_studies.worlds.corridor import ROUNDING, CubeWorld, and_in_blocks, are_in_cube, in_order


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
        return and_in_blocks(are_in_cube(q), self._are_outside, self.centres.size, q)

    def _motion_valid(self, a: Floats, b: Floats) -> Bools:
        free = self._valid(a) & self._valid(b)
        moves = (a != b).any(axis=1)
        return free & (~moves | and_in_blocks(free & moves, self._miss, self.centres.size, *in_order(a, b)))

    def _are_outside(self, q: Floats) -> Bools:
        offset = _from_nearest(q[:, np.newaxis] - self.centres)
        return ((offset * offset).sum(axis=-1) >= self.radius**2).all(axis=1)

    def _miss(self, a: Floats, b: Floats) -> Bools:
        """Return which motions, none of length 0, stay out of every ball.

        The squared distance from a centre on the torus is the sum over the axes of the squared distance from its
        nearest copy along that axis.  Between the times at which some axis changes its nearest copy it is one parabola.
        """
        step = b - a
        length = (step * step).sum(axis=1)
        # Most balls are out of reach of a short motion, wherever on it: its middle says so.
        offset = _from_nearest((a + 0.5 * step)[:, np.newaxis] - self.centres)
        reach = self.radius + 0.5 * np.sqrt(length) + ROUNDING
        row, ball = np.nonzero((offset * offset).sum(axis=-1) <= (reach * reach)[:, np.newaxis])
        begin, along, length = a[row] - self.centres[ball], step[row], length[row, np.newaxis]
        times = _sorted_times(begin, along, (-0.5, 0.5))
        begin, along = begin[:, np.newaxis], along[:, np.newaxis]
        middle = 0.5 * (times[:, :-1] + times[:, 1:])[..., np.newaxis]
        offset = begin - np.rint(begin + middle * along)
        slope = (offset * along).sum(axis=-1)
        nearest = np.clip(-slope / length, times[:, :-1], times[:, 1:])
        squared = (offset * offset).sum(axis=-1) + nearest * (2.0 * slope + nearest * length)
        free = np.ones(len(a), dtype=np.bool_)
        free[row[(squared < self.radius**2).any(axis=1)]] = False
        return free


def _from_nearest(offset: Floats) -> Floats:
    """Return offsets from the nearest copy of a centre, given those from the centre."""
    return offset - np.rint(offset)


def _sorted_times(begin: Floats, step: Floats, borders: Sequence[float] | Floats) -> Floats:
    """Return the times at which ``begin + t step``, (p, d), passes borders, cut off at 0 and 1, with these, (p, m).

    `borders` are the same for all axes, or (p, d, b).
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        times = (np.asarray(borders) - begin[..., np.newaxis]) / step[..., np.newaxis]
    ends = np.tile((0.0, 1.0), (len(begin), 1))
    times = np.clip(np.nan_to_num(times, nan=0.0), 0.0, 1.0)
    return np.sort(np.concatenate([ends, *times.transpose(1, 0, 2)], axis=1), axis=1)


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
        return and_in_blocks(are_in_cube(q), self._are_outside, self.centres.size, q)

    def _motion_valid(self, a: Floats, b: Floats) -> Bools:
        free = self._valid(a) & self._valid(b)
        return and_in_blocks(free, self._miss, self.centres.size, *in_order(a, b))

    def _are_outside(self, q: Floats) -> Bools:
        offset = _from_nearest(q[:, self.axes] - self.centres)
        outside: Bools = np.all(np.any(np.abs(offset) >= self.half_extents, axis=-1), axis=1)
        return outside

    def _miss(self, a: Floats, b: Floats) -> Bools:
        """Return which motions are never within one box: not in the middle between two times at which they pass a face
        along some axis.
        """
        step, begin = (b - a)[:, self.axes], a[:, self.axes] - self.centres
        # Most boxes are out of reach along some axis: the middle of the motion says so.
        middle = np.abs(_from_nearest(begin + 0.5 * step))
        row, box = np.nonzero((middle <= self.half_extents + 0.5 * np.abs(step) + ROUNDING).all(axis=-1))
        begin, step, half = begin[row, box], step[row, box], self.half_extents[box]
        borders = half[..., np.newaxis] * (-1.0, 1.0)
        times = _sorted_times(begin, step, np.concatenate([borders - 1.0, borders, borders + 1.0], axis=-1))
        middle = 0.5 * (times[:, :-1] + times[:, 1:])[..., np.newaxis]
        offset = _from_nearest(begin[:, np.newaxis] + middle * step[:, np.newaxis])
        within = (np.abs(offset) < half[:, np.newaxis]).all(axis=-1) & (times[:, :-1] < times[:, 1:])
        free = np.ones(len(a), dtype=np.bool_)
        free[row[within.any(axis=1)]] = False
        return free


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
