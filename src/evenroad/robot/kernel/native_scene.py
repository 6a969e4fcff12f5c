"""The native kernel's scene of a robot: its obstacles, and its clouds and meshes."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from evenroad._native import robot as native
from evenroad.geometry.shapes import Mesh, PointCloud
from evenroad.robot.kernel.obstacles import obstacle_rows, tested_contacts
from evenroad.robot.kernel.robot_tables import RobotTables
from evenroad.robot.kernel.scene_surfaces import MANY, reached_parts
from evenroad.robot.scene import Scene


def native_scene(
    robot: native.Robot, tables: RobotTables, links: tuple[str, ...], scene: Scene, clearance: float
) -> native.Scene:
    """Return a scene as a robot of these links is checked in it, all its bodies larger by a clearance [m]."""
    tested = tested_contacts(tables.capsules, links, scene)
    solid = np.array([bool(obstacle.row) for obstacle in scene.obstacles], dtype=np.bool_)
    reach = tables.reach + clearance
    surfaces, bodies = [], []
    for number, obstacle in enumerate(scene.obstacles):
        body = obstacle.body
        if not isinstance(body, PointCloud | Mesh) or not tested[:, number].any():
            continue
        if (surface := _surface(body, reach)) is not None:
            surfaces.append((surface, number, np.ascontiguousarray(tested[:, number])))
            bodies.append(body)
    around = _around(tuple(bodies), reach) if len(bodies) >= MANY else None
    return native.Scene(
        robot, obstacle_rows(scene), np.ascontiguousarray(tested[:, solid]), surfaces, around, clearance
    )


@lru_cache(maxsize=64)
def _surface(body: PointCloud | Mesh, reach: float) -> native.Surface | None:
    """Return what a robot of this reach can touch of a body; kept, since the next scene often has it, too."""
    reached = reached_parts(body, reach)
    if reached is None:
        return None
    corners, radius, grid = reached
    given: dict[str, object] = {
        "low": np.ascontiguousarray(grid.low),
        "cell": np.array([grid.cell, grid.excess]),
        "distances": grid.distances,
    }
    if grid.windings is not None:
        given |= {"windings": grid.windings, "turned": grid.turned}
    return native.Surface(np.ascontiguousarray(corners), radius, given)


@lru_cache(maxsize=4)
def _around(bodies: tuple[PointCloud | Mesh, ...], reach: float) -> native.Surface:
    """Return the grid around several bodies that can be reached; kept, as they are."""
    return native.Surface.around([_surface(body, reach) for body in bodies])
