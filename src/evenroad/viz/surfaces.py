"""Surfaces of bodies as triangles, for viewers in three dimensions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad.errors import EvenroadError
from evenroad.geometry.shapes import Box, Capsule, Cylinder, Mesh, Shape, Sphere, along_z
from evenroad.robot import Robot
from evenroad.robot.load import read_robot
from evenroad.robot.urdf_xml import RobotFile

Surface = tuple[Floats, Ints]
"""Vertices, (v, 3) [m], and triangles, (t, 3), as rows of them."""


def surface_of(shape: Shape) -> Surface:
    """Return the surface of a body in the frame of what carries it; of a cloud a cube a point would be, so nothing."""
    from trimesh import creation

    shape = along_z(shape) if isinstance(shape, Capsule) else shape
    if isinstance(shape, Mesh):
        mesh = shape.triangles
        return shape.pose.apply(mesh.vertices), mesh.triangles
    if isinstance(shape, Box):
        solid = creation.box(extents=shape.size)
    elif isinstance(shape, Sphere):
        solid = creation.icosphere(subdivisions=2, radius=shape.radius)
    elif isinstance(shape, Cylinder):
        solid = creation.cylinder(radius=shape.radius, height=shape.length, sections=32)
    elif isinstance(shape, Capsule):
        solid = creation.capsule(radius=shape.radius, height=shape.length, count=(24, 24))
    else:
        return np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)
    centred = np.array(solid.vertices)
    if isinstance(shape, Capsule):
        # Whichever end trimesh begins with: the middle is the origin.
        centred = centred - 0.5 * (centred.max(axis=0) + centred.min(axis=0))
    return shape.pose.apply(centred), np.array(solid.faces, dtype=np.int64)


def joined(surfaces: Sequence[Surface]) -> Surface:
    """Return several surfaces, one or more, as one."""
    firsts = np.cumsum([0, *(len(vertices) for vertices, _ in surfaces)])
    triangles = [rows + first for (_, rows), first in zip(surfaces, firsts, strict=False)]
    return np.concatenate([vertices for vertices, _ in surfaces]), np.concatenate(triangles)


def link_surfaces(robot: Robot, file: RobotFile | None) -> dict[str, Surface]:
    """Return link -> surface in the link's frame: what the robot's file draws, else what stands for it in checks.

    A drawing that cannot be read is no reason to show nothing: its link is shown as its capsules.
    """
    surfaces = surfaces_by_link(robot.capsules)
    if file is not None:
        surfaces |= surfaces_by_link(_drawn(file))
    return {link: surface for link, surface in surfaces.items() if link in robot.links}


def _drawn(file: RobotFile) -> tuple[Shape, ...]:
    try:
        return read_robot(RobotFile(file.path, False, file.packages, file.arguments, as_drawn=True)).shapes
    except EvenroadError:
        return ()


def surfaces_by_link(shapes: Iterable[Shape]) -> dict[str, Surface]:
    """Return link -> surface of the shapes that it carries."""
    of_link: dict[str, list[Surface]] = {}
    for shape in shapes:
        try:
            of_link.setdefault(shape.link, []).append(surface_of(shape))
        except EvenroadError:
            of_link.pop(shape.link, None)
    return {link: joined(parts) for link, parts in of_link.items() if sum(len(rows) for _, rows in parts)}
