"""Robots and scenes from values, names or files."""

from __future__ import annotations

import os
from collections.abc import Mapping

from evenroad._above import above
from evenroad.errors import InvalidValue, shown
from evenroad.robot.robot import Robot, require_robot
from evenroad.robot.scene import Scene


def as_robot(robot: object) -> Robot:
    """Return a robot: itself, or that which ``load_robot`` loads.  InvalidValue for anything else."""
    if isinstance(robot, str | os.PathLike):
        robot = above("ArmWorld.robot")(robot)
    require_robot(robot)
    assert isinstance(robot, Robot)  # as require_robot has seen to
    return robot


def as_scene(scene: object) -> Scene:
    """Return a scene: itself, that which ``load_scene`` loads, or one of shapes or a mapping."""
    if isinstance(scene, Scene):
        return scene
    if isinstance(scene, str | os.PathLike):
        loaded: Scene = above("ArmWorld.scene")(scene)
        return loaded
    if isinstance(scene, Mapping | list | tuple):
        return Scene(scene)
    raise InvalidValue(f"scene must be a Scene, or the name of one or its file, got {shown(scene)}")
