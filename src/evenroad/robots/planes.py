"""Planes: half spaces from the file of a robot, as obstacles of every scene that the robot is in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad.geometry.pose import Pose, Vector
from evenroad.geometry.shapes import Box

SIDE, DEPTH = 200.0, 100.0
"""Side and depth of the box that stands for a half space, its upper side around the robot [m]."""


@dataclass(frozen=True)
class Plane:
    """A half space: all that is below the x-y plane of a frame, given in that of the robot's root link.

    Links in `untested` are not tested against it: those that stand still, and those that the file lets through.
    """

    name: str
    xyz: Vector
    rotation: tuple[float, ...]
    untested: tuple[str, ...] = ()

    @property
    def body(self) -> Box:
        """The box that stands for it, as far as an arm reaches."""
        pose = Pose(self.xyz, self.rotation)
        x, y, _ = pose.inverse().apply(np.zeros(3)).tolist()
        return Box((SIDE, SIDE, DEPTH), pose=pose @ Pose((x, y, -0.5 * DEPTH)))
