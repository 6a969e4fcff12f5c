"""The native kernel's scene of a robot: its obstacles, and its clouds and meshes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from evenroad._arrays import Bools
from evenroad._native import robot as native
from evenroad.collision.native_surfaces import MANY, surface_of, surfaces_around
from evenroad.collision.placed_capsules import FARTHEST, PlacedCapsule
from evenroad.collision.robot_tables import RobotTables
from evenroad.errors import InvalidValue, UnknownName
from evenroad.geometry.shapes import Mesh, PointCloud
from evenroad.scenes.scene import Scene


def native_scene(
    robot: native.Robot, tables: RobotTables, links: tuple[str, ...], scene: Scene, clearance: float
) -> native.Scene:
    """Return a scene as a robot of these links is checked in it, all its bodies larger by a clearance [m].

    Raises UnknownName if an allowed contact names a link or an obstacle that is not there; InvalidValue if an obstacle
    is so far, or so large, that too few digits are left.
    """
    tested = tested_contacts(tables.capsules, links, scene)
    reach = tables.reach + clearance
    surfaces, bodies = [], []
    for number, obstacle in scene.surfaces:
        body = obstacle.body
        assert isinstance(body, PointCloud | Mesh)  # all others have rows
        if not tested[:, number].any():
            continue
        if (surface := surface_of(body, reach, obstacle.clearance)) is not None:
            surfaces.append(native.SurfaceObstacle(surface, number, np.ascontiguousarray(tested[:, number])))
            bodies.append((body, obstacle.clearance))
    around = surfaces_around(tuple(bodies), reach) if len(bodies) >= MANY else None
    solid = tested if not scene.surfaces else np.delete(tested, [number for number, _ in scene.surfaces], axis=1)
    made = native.Scene(robot, scene.rows, np.ascontiguousarray(solid), surfaces, around, clearance)
    if made.too_far >= 0:
        # Boxes along the axes are never too far: they are cut off where the robot never comes.
        far = [obstacle for obstacle in scene.obstacles if obstacle.row][made.too_far]
        raise InvalidValue(f"obstacle {far.name!r} must be within {FARTHEST:g} m, got size {far.size!r} at {far.xyz!r}")
    return made


def tested_contacts(capsules: Sequence[PlacedCapsule], links: Sequence[str], scene: Scene) -> Bools:
    """Return which capsules of a robot of these links are tested against which obstacles: (capsules, obstacles).

    Raises UnknownName if an allowed contact names a link or an obstacle that is not there.
    """
    # Bytes, of which each is soon set.
    count = len(scene.names)
    tested = bytearray(b"\1") * (len(capsules) * count)
    if scene.allowed:
        bodied = [each.link for each in capsules]
        for link, name in scene.allowed:
            if link not in links:
                raise UnknownName.among("link", link, links)
            if name not in scene.names:
                raise UnknownName.among("obstacle", name, scene.names)
            index = scene.names.index(name)
            for other in bodied:
                if other == link:
                    tested[index] = 0
                index += count
    return np.frombuffer(tested, dtype=np.bool_).reshape(len(capsules), count)
