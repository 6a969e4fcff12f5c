"""Base of the constraints that hold along a whole path.

A constraint has a residual, a vector whose length is the deviation, and may be up to `limit`.  Residuals are affine in
the rotation and origin of tips, or distances from such.  Along a motion their length is thus convex up to a second
derivative, which `bend` bounds from the motion of the tips.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from evenroad._arrays import Floats
from evenroad.geometry.pose import Pose
from evenroad.poses.cartesian_path import Moves
from evenroad.poses.chain import chain_of
from evenroad.poses.constraint import Constraint
from evenroad.robots.robot import Robot

if TYPE_CHECKING:
    from evenroad._native.robot import KeepKind

WITHIN = 1e-4
"""Default of the largest deviation of a tip [m]."""


class Keep(Constraint):
    """Base of constraints that hold along a whole path."""

    unit: ClassVar[str] = "m"
    deviation: ClassVar[str]
    """Name in the deviations of a result."""
    kept: ClassVar[str] = ""
    """The kept quantity, in words."""
    within: float

    def bound(self, robot: Robot, q: Floats, tip: str) -> Keep:
        """Return the constraint with unset fields filled from a start, (dim,), and a tip."""
        raise NotImplementedError

    @property
    def tips(self) -> tuple[str, ...]:
        """The constrained links."""
        return (self.tip,)  # type: ignore[attr-defined]

    @property
    def limit(self) -> float:
        """Largest length of the residual."""
        return self.within

    @property
    def residual(self) -> tuple[KeepKind, Floats]:
        """Its residual for compiled code: a kind, and its parameters, (k,).

        ``linear``: rows of twelve coefficients of the tip's pose, and a constant to subtract.  ``box``: the distance of
        the tip's origin from a box; parameters are its low and high corner.  ``circle``: the distance from a circle and
        its plane, and a tenth of the tip's rotation away from the turn of the circle.  ``together``: the shift of the
        second tip from its place relative to the first, and a tenth of its rotation; the parameter is the relative
        pose.  ``joints``: distances of joints from their ranges; parameters are lows and highs of all joints.
        """
        raise NotImplementedError

    def bend(self, moves: Sequence[Moves]) -> Floats:
        """Return bounds on the residual's second derivative along motions, (n,)."""
        raise NotImplementedError

    def off(self, lengths: Floats) -> Floats:
        """Return the deviation, in its unit, for residuals of these lengths."""
        return lengths

    def words(self, off: float) -> str:
        """Return in words the deviation, and its limit."""
        return f"{self.tips[0]!r} is {off:.4g} {self.unit} off {self.kept}, more than {self.within:.4g}"


def tip_row(robot: Robot, tip: str, q: Floats) -> tuple[float, ...]:
    """Return the pose of a tip at a configuration, (dim,): its rotation row by row, and its origin."""
    return tuple(chain_of(robot, tip).tip_poses(q[np.newaxis])[0].tolist())


def tip_pose(robot: Robot, tip: str, q: Floats) -> Pose:
    """Return the pose of a tip at a configuration, (dim,)."""
    row = tip_row(robot, tip, q)
    return Pose(row[9:], row[:9])


def pose_row(pose: Pose) -> list[float]:
    """Return a pose in the form of compiled code: its rotation row by row, and its origin."""
    return [*pose.rotation, *pose.xyz]
