"""PoseTask: where a chain's tip is wanted, in the frame of the root."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Floats
from evenroad.geometry.pose import IDENTITY, Pose, Vector


@dataclass(frozen=True)
class PoseTask:
    """A pose of a chain's tip in the frame of the root, and what counts of it."""

    pose: Pose = IDENTITY
    pointing: tuple[Vector, Vector] | None = None
    """An axis of the tip and the direction in which it is to point, where that alone counts of the rotation."""
    placed: bool = True
    """Whether the position counts."""
    turned: bool = True
    """Whether the rotation counts."""
    position_tolerance: float = 0.0
    angle_tolerance: float = 0.0

    @property
    def turns_fully(self) -> bool:
        """Whether all of the rotation counts."""
        return self.turned and self.pointing is None

    @property
    def numbers(self) -> int:
        """Number of numbers that the task fixes; those with a tolerance do not count."""
        turned = 0 if self.angle_tolerance or not self.turned else 3 if self.turns_fully else 2
        return turned + (0 if self.position_tolerance or not self.placed else 3)

    @property
    def row(self) -> Floats:
        """The task for compiled code, (22,)."""
        axis, direction = self.pointing or ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        turn = 0 if not self.turned else 2 if self.turns_fully else 1
        counts = self.placed, turn, self.position_tolerance, self.angle_tolerance
        return np.array([*self.pose.rotation, *self.pose.xyz, *axis, *direction, *counts], dtype=np.float64)

    def misses(self, tip: Floats) -> tuple[float, float]:
        """Return the deviations of a pose of the tip, (12,), from position [m] and rotation [rad]."""
        near = math.dist(tip[9:], self.pose.xyz) if self.placed else 0.0
        turn = tip[:9].reshape(3, 3)
        if not self.turned:
            return near, 0.0
        if self.pointing is not None:
            axis, direction = turn @ self.pointing[0], np.array(self.pointing[1])
            return near, math.atan2(float(np.linalg.norm(np.cross(axis, direction))), float(axis @ direction))
        between = self.pose.rotation_matrix @ turn.T
        sine = 0.5 * np.linalg.norm(
            [between[2, 1] - between[1, 2], between[0, 2] - between[2, 0], between[1, 0] - between[0, 1]]
        )
        return near, math.atan2(float(sine), 0.5 * (float(np.trace(between)) - 1.0))
