"""What has changed between two worlds of an arm, for a roadmap that keeps what it knows."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from evenroad.robot import ArmWorld, Scene
from evenroad.robot.scene import scene_of_rows
from evenroad.robot.scene_delta import changed_names, delta_of


def names_changed(before: ArmWorld, after: ArmWorld) -> set[str] | None:
    """Return the names of obstacles that two worlds do not have in common.

    None where the worlds differ in more than that, or have clouds or meshes.
    """
    same = before.robot is after.robot and before.clearance == after.clearance
    if not same or before.resolution != after.resolution or before.scene.surfaces or after.scene.surfaces:
        return None
    return changed_names(before.scene, after.scene)


def changed_dynamic(dynamic: ArmWorld, static: Scene, before: Scene, after: Scene, names: Collection[str]) -> ArmWorld:
    """Return the world of what a roadmap has not checked, after the change: without the obstacles of its static scene.

    The dynamic world was made for the scene before.
    """
    there = delta_of(after)
    left = after.without(*(name for name in static.names if name in there))
    gone, come = ([name for name in names if name in delta_of(scene)] for scene in (before, after))
    return dynamic._changed(left, gone, come)


def world_of_changes(dynamic: ArmWorld, before: Scene, after: Scene, names: Collection[str]) -> ArmWorld:
    """Return the robot among those obstacles alone that were there before, or are there after the change."""
    rows, called = [], 0
    allowed: set[tuple[str, str]] = set()
    for scene in (before, after):
        there = [name for name in names if name in delta_of(scene)]
        number = {name: str(called + i) for i, name in enumerate(there)}
        rows.append(delta_of(scene).rows(there))
        allowed.update((link, number[name]) for link, name in scene.allowed if name in number)
        called += len(there)
    scene = scene_of_rows(np.concatenate(rows), tuple(map(str, range(called))), "changes", frozenset(allowed))
    return ArmWorld(dynamic.robot, scene, resolution=dynamic.resolution, clearance=dynamic.clearance)
