"""PeriodicBalls: a point in the unit cube among balls on the torus."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_positive
from evenroad.errors import InvalidValue
from evenroad.research.worlds.periodic.ball_kernel import motions_are_free, points_are_free
from evenroad.space import Box
from evenroad.space.batch import as_batch, as_batch_pair, as_cube_batch


@dataclass(frozen=True, eq=False)
class PeriodicBalls:
    """A point robot in [0, 1]^d among open balls of one radius that repeat with period 1 along every axis.

    With centres drawn uniformly the free set is stationary: no place of the cube, at its faces or in the middle, is
    freer than another.  Only the obstacles are periodic.  The space is the cube, whose faces stop the robot as joint
    limits do, and motions are straight.  They are tested exactly, without any step length, up to float rounding.

    Parameters
    ----------
    centres : array_like, shape (n, d)
        In [0, 1].  Copied to a read-only array.
    radius : float
        Of all balls, > 0; where it exceeds one half, a ball overlaps its own copies.

    Raises
    ------
    InvalidValue
        If the centres are no such array, or the radius is not such a number.
    """

    centres: npt.NDArray[np.float64]
    radius: float
    _space: Box = field(init=False, repr=False)

    def __post_init__(self) -> None:
        shape = np.shape(self.centres)
        if len(shape) != 2 or shape[1] == 0:
            raise InvalidValue(f"centres must have shape (n, d) with d >= 1, got {shape}")
        centres = as_cube_batch(np.array(self.centres, dtype=np.float64, order="C"), shape[1])
        object.__setattr__(self, "centres", centres)
        object.__setattr__(self, "radius", require_positive("radius", self.radius))
        object.__setattr__(self, "_space", Box([0.0] * self.d, [1.0] * self.d))

    @property
    def d(self) -> int:
        """Dimension."""
        return int(self.centres.shape[1])

    @property
    def space(self) -> Box:
        """The unit cube with the Euclidean metric."""
        return self._space

    def valid(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return which configurations, (n, d), are in the cube and in no ball: (n,).

        Raises
        ------
        InvalidValue
            If `q` has another shape or an entry that is not finite.
        """
        return points_are_free(as_batch("q", q, self.d), self.centres, self.radius**2)

    def motion_valid(self, a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return which straight motions from a row of `a` to that of `b`, two (m, d) arrays, are free: (m,).

        Raises
        ------
        InvalidValue
            If the two differ in length, or as `valid`.
        """
        return motions_are_free(*as_batch_pair(a, b, self.d), self.centres, self.radius**2)
