"""Objects of a scene from files of other tools: a URDF, glTF and what else trimesh reads, or another scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from evenroad._checks import require_known
from evenroad.errors import BrokenFile, InvalidValue
from evenroad.geometry.mesh import convex_hull
from evenroad.geometry.mesh_file import GLTF, Y_UP, load_objects
from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.geometry.shapes import WORLD, Mesh, Shape
from evenroad.loading.robot_file import RobotFile
from evenroad.loading.urdf import read_urdf
from evenroad.robots.joint import require_within
from evenroad.robots.kinematics import poses_at, with_mimics

ROBOT_FILES = (".urdf", ".xacro")
"""Suffixes of what has links and joints."""
OBJECT_FILES = (*ROBOT_FILES, *GLTF)
"""Suffixes of files that are scenes of their own."""


def objects_of(path: Path, joints: Mapping[str, float], *, convex: bool = False) -> dict[str, Shape]:
    """Return the bodies of a file by their names, in its frame.

    A URDF gives the collision shapes of its links, or visual shapes where a link has none, with its joints at the given
    values, else at 0 or the nearest limit.  A file of meshes gives each object of its scene, with `convex` its convex
    hull.  Raises as the readers of such files do; UnknownName for a joint that there is not;
    InvalidValue for a value beyond its limits, and for `convex` of a URDF.
    """
    if path.suffix.lower() in ROBOT_FILES:
        if convex:
            raise InvalidValue(f"convex goes with a mesh's file; the shapes of {path} are as they are")
        return _of_urdf(path, joints)
    require_known(f"joint of {path}:", next(iter(joints), ""), ("",))
    frame = Y_UP if path.suffix.lower() in GLTF else IDENTITY
    bodies: dict[str, Shape] = {}
    for name, mesh in load_objects(path):
        hull = convex_hull(mesh.vertices[np.unique(mesh.triangles)], mesh.name) if convex else mesh
        bodies[_new_name(name, bodies)] = Mesh(hull, pose=frame)
    return bodies


def _of_urdf(path: Path, joints: Mapping[str, float]) -> dict[str, Shape]:
    urdf = read_urdf(RobotFile(path, use_visuals=True))
    moving = {joint.name: joint for joint in urdf.joints if joint.kind != "fixed" and joint.mimic is None}
    for name, value in joints.items():
        require_known(f"joint of {path}:", name, moving)
        require_within(moving[name], value, f"the scene, of {path.name},")
    values = {name: np.array([joints.get(name, joint.neutral)]) for name, joint in moving.items()}
    (poses,) = poses_at(urdf, with_mimics(urdf, values), 1)
    frames = {link: Pose.from_matrix(pose) for link, pose in zip(urdf.links, poses, strict=True)}
    bodies: dict[str, Shape] = {}
    for shape in urdf.shapes:
        bodies[_new_name(shape.link, bodies)] = replace(shape, pose=frames[shape.link] @ shape.pose, link=WORLD)
    if not bodies:
        raise BrokenFile(f"{path} has no collision geometry: nothing would ever touch it")
    return bodies


def _new_name(name: str, taken: Mapping[str, object]) -> str:
    """Return a name that is not taken: the second body of a link is ``door 1``."""
    return name if name not in taken else next(t for k in range(1, len(taken) + 2) if (t := f"{name} {k}") not in taken)
