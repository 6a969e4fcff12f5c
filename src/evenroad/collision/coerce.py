"""Robots and scenes from values, names or files."""

from __future__ import annotations

import os
from collections.abc import Mapping

from evenroad.errors import InvalidValue, shown
from evenroad.robots.robot import Robot, require_robot
from evenroad.scenes.scene import Scene


def as_robot(robot: object) -> Robot:
    """Return a robot: itself, or that which ``load_robot`` loads.  InvalidValue for anything else."""
    if isinstance(robot, Robot):
        return robot
    if isinstance(robot, str | os.PathLike):
        # Imported late: reading files takes more than most worlds.
        from evenroad.loading.load import load_robot

        return load_robot(robot)
    return require_robot(robot)


def as_scene(scene: object) -> Scene:
    """Return a scene: itself, that which ``load_scene`` loads, or one of shapes or a mapping."""
    if isinstance(scene, Scene):
        return scene
    if isinstance(scene, str | os.PathLike):
        from evenroad.scenes.scene_file import load_scene

        return load_scene(scene)
    if isinstance(scene, Mapping | list | tuple):
        return Scene(scene)
    raise InvalidValue(f"scene must be a Scene, or the name of one or its file, got {shown(scene)}")
