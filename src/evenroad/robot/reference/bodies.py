"""What engines of others are given for the links: the shapes of the URDF, meshes included, or our capsules."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np

from evenroad.errors import InvalidValue
from evenroad.robot.capsule import Capsule
from evenroad.robot.geometry import Geometry
from evenroad.robot.kernel.moving_tree import rotation_from_z
from evenroad.robot.load import find_robot
from evenroad.robot.meshes import load_triangles
from evenroad.robot.robot import Robot
from evenroad.robot.urdf import read_urdf
from evenroad.world.mesh import TriangleMesh


def original_geometries(source: str | os.PathLike[str], robot: Robot) -> tuple[Geometry, ...]:
    """Return the collision shapes that a robot's URDF gives, before any capsule was fitted to them.

    Parameters
    ----------
    source : str or path-like
        The URDF, or the name of a shipped robot, from which `robot` was loaded.
    robot : Robot
        Its links that have no shape in the URDF, because their capsules were given, keep those.

    Raises
    ------
    BrokenFile, InvalidValue, UnknownName
        As :func:`evenroad.robot.load.load_model`.
    """
    geometries = read_urdf(find_robot(source)[0]).geometries
    there = {geometry.link for geometry in geometries}
    return geometries + tuple(shape for shape in capsule_geometries(robot) if shape.link not in there)


def capsule_geometries(robot: Robot) -> tuple[Geometry, ...]:
    """Return the capsules of a robot as collision shapes."""
    return tuple(map(_as_geometry, robot.capsules))


def sound_geometries(robot: Robot, geometries: Sequence[Geometry] | None) -> tuple[Geometry, ...]:
    """Return the shapes to test: those given, or the robot's capsules.

    Raises
    ------
    InvalidValue
        If there is none, one is of a link that is not there, or a link with capsules has none: its checks would
        all pass.
    """
    chosen = capsule_geometries(robot) if geometries is None else tuple(geometries)
    links = {geometry.link for geometry in chosen}
    unknown = sorted(links - set(robot.links))
    bare = sorted({capsule.link for capsule in robot.capsules} - links)
    if not chosen or unknown or bare:
        raise InvalidValue(
            f"geometries must be those of links of {robot.name!r}, one or more; got {len(chosen)}"
            + (f", of links that are not there: {', '.join(unknown)}" if unknown else "")
            + (f", none of {', '.join(bare)}" if bare else "")
        )
    return chosen


def scaled_mesh(geometry: Geometry) -> TriangleMesh:
    """Return the triangles of a mesh shape, in the shape's frame, with the URDF's scale.

    Raises
    ------
    InvalidValue
        If the scale makes it flat: engines pass over triangles without area.
    NotAvailable, BrokenFile
        As :func:`evenroad.world.load_mesh`.
    """
    assert geometry.file is not None
    if 0.0 in geometry.size:
        raise InvalidValue(
            f"the scale of {geometry} of link {geometry.link!r} must not be 0, got {geometry.size}"
        )
    vertices, triangles = load_triangles(geometry.file)
    return TriangleMesh(vertices * np.array(geometry.size), triangles, geometry.file.name)


def _as_geometry(capsule: Capsule) -> Geometry:
    a, b = np.array(capsule.a), np.array(capsule.b)
    x, y, z = (0.5 * (a + b)).tolist()
    length = float(np.linalg.norm(b - a))
    if length == 0.0:
        return Geometry(
            capsule.link, "sphere", (capsule.radius,), (x, y, z), tuple(np.eye(3).ravel().tolist())
        )
    along = ((b - a) / length).tolist()
    turn = rotation_from_z((along[0], along[1], along[2]))
    return Geometry(
        capsule.link, "capsule", (capsule.radius, length), (x, y, z), tuple(turn.ravel().tolist())
    )
