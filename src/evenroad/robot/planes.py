"""Planes: half spaces from the file of a robot, as obstacles of every scene that the robot is in."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from evenroad.errors import InvalidValue
from evenroad.geometry.pose import Pose, Vector
from evenroad.geometry.shapes import Box
from evenroad.robot.scene import Obstacle, Scene

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
    def obstacle(self) -> Obstacle:
        """The box that stands for it, as far as an arm reaches."""
        pose = Pose(self.xyz, self.rotation)
        x, y, _ = pose.inverse().apply(np.zeros(3)).tolist()
        return Obstacle(self.name, Box((SIDE, SIDE, DEPTH), pose=pose @ Pose((x, y, -0.5 * DEPTH))), cell=True)


def with_planes(scene: Scene, planes: Sequence[Plane], links: Collection[str]) -> Scene:
    """Return the scene with the planes around a robot of these links, where it does not have them yet.

    Raises InvalidValue if another obstacle of the scene has the name of one.
    """
    if not planes:
        return scene
    bodies = {obstacle.name: obstacle.body for obstacle in scene.obstacles}
    missing = []
    for obstacle in (plane.obstacle for plane in planes):
        if bodies.get(obstacle.name, obstacle.body) != obstacle.body:
            raise InvalidValue(
                f"scene {scene.name!r} has an obstacle {obstacle.name!r}, which is the name of a plane in the robot's"
                " file: give it another"
            )
        if obstacle.name not in bodies:
            missing.append(obstacle)
    allowed = {(link, plane.name) for plane in planes for link in plane.untested if link in links}
    return replace(scene, obstacles=(*scene.obstacles, *missing), allowed=scene.allowed | allowed)
