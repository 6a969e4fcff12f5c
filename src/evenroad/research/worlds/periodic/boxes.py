"""PeriodicBoxes: a point in the unit cube among boxes that bound only some of its coordinates."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_count
from evenroad.errors import InvalidValue
from evenroad.research.worlds.periodic.box_kernel import motions_are_free, points_are_free
from evenroad.space import Box
from evenroad.space.batch import as_batch, as_batch_pair, as_cube_batch


@dataclass(frozen=True, eq=False)
class PeriodicBoxes:
    """A point robot in [0, 1]^d among open boxes in some of the coordinates, with period 1 along every axis.

    A configuration is in a box if each of the box's own m coordinates is closer to the centre than the half extent;
    its other coordinates are free, as an obstacle in the workspace of an arm leaves the joints free that do not move
    the link it stands by.  With centres drawn uniformly the free set is stationary: no place of the cube is freer than
    another.  Only the obstacles are periodic: the space is the cube, whose faces stop the robot, and motions are
    straight.  They are tested exactly, without any step length, up to float rounding.

    Parameters
    ----------
    d : int
        Dimension, >= 1.
    axes : array_like of int, shape (n, m)
        The coordinates that each box bounds, all different, in 0 .. d - 1.
    centres : array_like, shape (n, m)
        Of the boxes along these axes, in [0, 1].
    half_extents : array_like, shape (n, m)
        Along these axes, in (0, 0.5].

    Raises
    ------
    InvalidValue
        If an argument is no such number or array.
    """

    d: int
    axes: npt.NDArray[np.int64]
    centres: npt.NDArray[np.float64]
    half_extents: npt.NDArray[np.float64]
    _space: Box = field(init=False, repr=False)

    def __post_init__(self) -> None:
        d = require_count("d", self.d)
        axes = _as_axes(self.axes, d)
        object.__setattr__(self, "d", d)
        object.__setattr__(self, "axes", axes)
        for name in ("centres", "half_extents"):
            if np.shape(getattr(self, name)) != axes.shape:
                raise InvalidValue(
                    f"{name} must have the shape of axes, {axes.shape}, got {np.shape(getattr(self, name))}"
                )
            array = np.array(getattr(self, name), dtype=np.float64, order="C")
            object.__setattr__(self, name, as_cube_batch(array, axes.shape[1]))
        outside = (self.half_extents <= 0.0) | (self.half_extents > 0.5)
        if outside.any():
            raise InvalidValue(
                f"half_extents must be in (0, 0.5], got {float(self.half_extents[outside][0])!r}"
            )
        object.__setattr__(self, "_space", Box([0.0] * d, [1.0] * d))

    @property
    def space(self) -> Box:
        """The unit cube with the Euclidean metric."""
        return self._space

    def valid(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return which configurations, (n, d), are in the cube and in no box: (n,).

        Raises
        ------
        InvalidValue
            If `q` has another shape or an entry that is not finite.
        """
        return points_are_free(as_batch("q", q, self.d), self.axes, self.centres, self.half_extents)

    def motion_valid(self, a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return which straight motions from a row of `a` to that of `b`, two (m, d) arrays, are free: (m,).

        Raises
        ------
        InvalidValue
            If the two differ in length, or as `valid`.
        """
        return motions_are_free(*as_batch_pair(a, b, self.d), self.axes, self.centres, self.half_extents)


def _as_axes(values: npt.ArrayLike, d: int) -> npt.NDArray[np.int64]:
    """Return the axes as a read-only (n, m) array, or raise InvalidValue."""
    axes = np.asarray(values)
    if axes.ndim != 2 or axes.shape[1] == 0 or not np.issubdtype(axes.dtype, np.integer):
        raise InvalidValue(
            f"axes must be integers of shape (n, m) with m >= 1, got {axes.dtype} of shape {axes.shape}"
        )
    outside = (axes < 0) | (axes >= d)
    if outside.any():
        raise InvalidValue(f"axes must be in 0 .. {d - 1}, got {int(axes[outside][0])}")
    in_order = np.sort(axes, axis=1)
    twice = (in_order[:, 1:] == in_order[:, :-1]).any(axis=1)
    if twice.any():
        raise InvalidValue(f"the axes of a box must be different, got {axes[twice][0].tolist()}")
    axes = np.array(axes, dtype=np.int64, order="C")
    axes.setflags(write=False)
    return axes
