"""Base of the constraints that hold along a whole path.

A constraint has a residual, a vector whose length is how far it is off, and which may be `limit` long.  Residuals are
affine in the rotation and the origin of tips, or distances from them, so that along a motion their length is convex but
for a second derivative, which `bend` bounds by how the tips move.
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
"""Default for how far a tip may be off [m]."""


class Keep(Constraint):
    """Base of constraints that hold along a whole path."""

    unit: ClassVar[str] = "m"
    deviation: ClassVar[str]
    """Name in the deviations of a result."""
    kept: ClassVar[str] = ""
    """What it keeps, in words."""
    within: float

    def bound(self, robot: Robot, q: Floats, tip: str) -> Keep:
        """Return the constraint with what it leaves open, taken from a start, (dim,), and a tip."""
        raise NotImplementedError

    @property
    def tips(self) -> tuple[str, ...]:
        """The links that it is about."""
        return (self.tip,)  # type: ignore[attr-defined]

    @property
    def limit(self) -> float:
        """Largest length of the residual."""
        return self.within

    @property
    def residual(self) -> tuple[KeepKind, Floats]:
        """Its residual for compiled code: of which kind it is, and the numbers, (k,), that it is made of.

        ``linear``: rows, each of twelve coefficients of the tip's pose, and what is taken off.  ``box``: the way of the
        tip's origin out of a box, by its low and high corner.  ``circle``: the distance from the circle and its plane,
        and a tenth of how far the tip is from turning with it.  ``together``: the shift of the second tip from where
        the first one holds it, and a tenth of its turn, by the pose that it holds.  ``joints``: how far joints are
        outside of their ranges, lows and highs of all.
        """
        raise NotImplementedError

    def bend(self, moves: Sequence[Moves]) -> Floats:
        """Return bounds on the residual's second derivative along motions, (n,)."""
        raise NotImplementedError

    def off(self, lengths: Floats) -> Floats:
        """Return by how much it is off, in its unit, where residuals have these lengths."""
        return lengths

    def words(self, off: float) -> str:
        """Return, in words, that it is off by so much, and how much it may be."""
        return f"{self.tips[0]!r} is {off:.4g} {self.unit} off {self.kept}, more than {self.within:.4g}"


def tip_row(robot: Robot, tip: str, q: Floats) -> tuple[float, ...]:
    """Return the pose of a tip at a configuration, (dim,): its rotation row by row, and its origin."""
    return tuple(chain_of(robot, tip).tip_poses(q[np.newaxis])[0].tolist())


def tip_pose(robot: Robot, tip: str, q: Floats) -> Pose:
    """Return the same as a value."""
    row = tip_row(robot, tip, q)
    return Pose(row[9:], row[:9])


def pose_row(pose: Pose) -> list[float]:
    """Return a pose as compiled code takes it: its rotation row by row, and its origin."""
    return [*pose.rotation, *pose.xyz]
