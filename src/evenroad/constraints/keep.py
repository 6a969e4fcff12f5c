"""Base of the constraints that hold along a whole path.

A constraint has a residual, a vector whose length is how far it is off, and which may be `limit` long.  Residuals are
affine in the rotation and the origin of tips, or distances from them, so that along a motion their length is convex but
for a second derivative, which `bend` bounds by how the tips move.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from evenroad._arrays import Floats
from evenroad.robot import Robot
from evenroad.robot.cartesian_path import Moves
from evenroad.robot.constraint import Constraint

WITHIN = 1e-4
"""Default for how far a tip may be off [m]."""


class Keep(Constraint):
    """Base of constraints that hold along a whole path."""

    unit: ClassVar[str] = "m"
    deviation: ClassVar[str]
    """Name in the deviations of a result."""
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

    def residual(self, q: Floats, tips: Sequence[Floats]) -> Floats:
        """Return the residuals, (n, m), at configurations, (n, dim), with poses of the tips, (n, 12) each."""
        raise NotImplementedError

    def derivative(self, q: Floats, tips: Sequence[Floats], of_tips: Sequence[Floats]) -> Floats:
        """Return the residual's derivatives by the joints, (n, m, dim), from those of the tips, (n, 6, dim) each."""
        raise NotImplementedError

    def bend(self, moves: Sequence[Moves]) -> Floats:
        """Return bounds on the residual's second derivative along motions, (n,)."""
        raise NotImplementedError

    def off(self, lengths: Floats) -> Floats:
        """Return by how much it is off, in its unit, where residuals have these lengths."""
        return lengths

    def words(self, off: float) -> str:
        """Return, in words, that it is off by so much, and how much it may be."""
        return f"{self.tips[0]!r} is {off:.4g} {self.unit} off {self}, more than {self.within:.4g}"


def turns_of(tips: Floats) -> Floats:
    """Return the rotations of poses, (n, 12): (n, 3, 3)."""
    return tips[:, :9].reshape(-1, 3, 3)


def cross_matrix(v: Floats) -> Floats:
    """Return the matrices of the cross products with vectors, (n, 3): (n, 3, 3)."""
    zero = np.zeros(len(v))
    x, y, z = v.T
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)


def turned_derivative(turns: Floats, by: Floats) -> Floats:
    """Return the derivatives of rotations' nine entries, (n, 9, dim), where they turn by (n, 3, dim)."""
    columns = [-cross_matrix(turns[:, :, k]) @ by for k in range(3)]
    return np.stack(columns, axis=2).reshape(len(turns), 9, -1)
