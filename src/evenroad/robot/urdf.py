"""Reading a URDF: its tree of links and joints, and its collision geometry."""

from __future__ import annotations

import logging
import math
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from evenroad.errors import BrokenFile, InvalidValue, UnknownName
from evenroad.robot.geometry import Geometry
from evenroad.robot.joint import Joint, Mimic
from evenroad.robot.meshes import find_mesh
from evenroad.robot.mimic import with_direct_mimics, within_limits_of_mimics
from evenroad.robot.tree import in_tree_order
from evenroad.robot.urdf_xml import drawn_only, read_urdf_xml

_KINDS = ("revolute", "continuous", "prismatic", "fixed")
_NO_ROTATION = tuple(np.eye(3).ravel().tolist())


@dataclass(frozen=True)
class Urdf:
    """What a URDF says about motion and collision.

    Attributes
    ----------
    name : str
        Name of the robot.
    links : tuple of str
        All links; the root first, every parent before its children.
    joints : tuple of Joint
        ``joints[i]`` is the joint whose child is ``links[i + 1]``; a mimic follows a joint that is none, whose
        limits are narrow enough for it.
    order : tuple of str
        Names of the joints as the file lists them: the order of configurations.
    geometries : tuple of Geometry
        The collision geometry.
    drawn_only : tuple of str
        Links that have a ``<visual>`` but no ``<collision>``.
    """

    name: str
    links: tuple[str, ...]
    joints: tuple[Joint, ...]
    order: tuple[str, ...]
    geometries: tuple[Geometry, ...]
    drawn_only: tuple[str, ...] = ()

    @property
    def free(self) -> frozenset[str]:
        """Joints that move by themselves: neither fixed nor mimics, nor locked by equal limits."""
        return frozenset(
            joint.name
            for joint in self.joints
            if joint.kind != "fixed" and joint.mimic is None and joint.lower < joint.upper
        )


def read_urdf(path: Path) -> Urdf:
    """Read a URDF file.

    Meshes are looked for but not opened.  An element ``<capsule radius="r" length="l"/>``, a cylinder of length l
    along z with half balls on both ends, is understood beside those of the standard.

    Raises
    ------
    BrokenFile
        If the file is missing, broken or not a URDF, a piece is missing, a joint has no limits, a mesh is not found,
        or the links do not form a tree.
    InvalidValue
        If a number is not one, or out of its range.
    UnknownName
        If a joint is of a type that is not supported (floating, planar).
    """
    root = read_urdf_xml(path)
    drawn = drawn_only(root)
    parsed = _parse(root, path)
    joints = [_joint(joint, path) for joint in parsed.joints]
    ordered = in_tree_order([link.name for link in parsed.links], joints, str(path))
    first = ordered[0].parent if ordered else parsed.links[0].name
    return Urdf(
        name=parsed.name,
        links=(first, *(joint.child for joint in ordered)),
        joints=tuple(within_limits_of_mimics(with_direct_mimics(ordered, path))),
        order=tuple(joint.name for joint in joints),
        geometries=tuple(
            _geometry(link.name, collision, path) for link in parsed.links for collision in link.collisions
        ),
        drawn_only=drawn,
    )


def _parse(root: ElementTree.Element, path: Path) -> Any:
    """Return what yourdfpy reads from a checked tree; its kind of capsule is a cylinder named as such."""
    root.set("name", root.get("name", path.stem))
    for link in root.findall("link"):
        for visual in link.findall("visual"):
            link.remove(visual)
    for collision in root.iterfind("link/collision"):
        capsule = collision.find("geometry/capsule")
        collision.set("name", "cylinder" if capsule is None else "capsule")
        if capsule is not None:
            capsule.tag = "cylinder"
    # Here, since it costs a third of a second, which maps and cached robots do not need to wait for.
    from yourdfpy import URDF

    logging.getLogger("yourdfpy").addHandler(logging.NullHandler())
    source = BytesIO(ElementTree.tostring(root))
    try:
        return URDF.load(source, build_scene_graph=False, load_meshes=False).robot
    except (ValueError, KeyError, TypeError, IndexError, AttributeError) as error:
        raise BrokenFile(f"{path} cannot be read as a URDF: {error}") from error


def _joint(joint: Any, path: Path) -> Joint:
    where = f"joint {joint.name!r} in {path}"
    if joint.type not in _KINDS:
        raise UnknownName.among(f"type of {where}:", joint.type, _KINDS)
    xyz, rotation = _pose(joint.origin)
    lower, upper, velocity = _limits(joint, where)
    mimic = None
    if joint.mimic is not None and joint.type != "fixed":
        mimic = Mimic(joint.mimic.joint, float(joint.mimic.multiplier), float(joint.mimic.offset))
    return Joint(
        name=joint.name,
        kind=joint.type,
        parent=joint.parent,
        child=joint.child,
        xyz=xyz,
        rotation=rotation,
        axis=(0.0, 0.0, 1.0) if joint.type == "fixed" else _axis(joint, where),
        lower=lower,
        upper=upper,
        velocity=velocity,
        mimic=mimic,
    )


def _axis(joint: Any, where: str) -> tuple[float, float, float]:
    length = float(np.linalg.norm(joint.axis))
    if length < 1e-9:
        raise InvalidValue(f"the axis of {where} must not be zero, got {joint.axis.tolist()}")
    x, y, z = (joint.axis / length).tolist()
    return (x, y, z)


def _limits(joint: Any, where: str) -> tuple[float, float, float]:
    """Return lower, upper and velocity; a velocity of 0 in a URDF means that nobody knew it."""
    limit = joint.limit
    velocity = math.inf if limit is None or not limit.velocity else float(limit.velocity)
    if velocity < 0.0:
        raise InvalidValue(f"the velocity limit of {where} must be >= 0, got {velocity:g}")
    if joint.type == "fixed":
        return 0.0, 0.0, velocity
    if joint.type == "continuous":
        return -math.inf, math.inf, velocity
    missing = [end for end in ("lower", "upper") if limit is None or getattr(limit, end) is None]
    if missing:
        raise BrokenFile(
            f"{where} has no limits: a {joint.type} joint needs <limit lower=... upper=...>"
            f" (missing: {', '.join(missing)}); one that turns on and on is of type continuous"
        )
    if limit.lower > limit.upper:
        raise InvalidValue(
            f"the limits of {where} must satisfy lower <= upper, got {limit.lower:g}, {limit.upper:g}"
        )
    return float(limit.lower), float(limit.upper), velocity


def _geometry(link: str, collision: Any, path: Path) -> Geometry:
    xyz, rotation = _pose(collision.origin)
    shape = collision.geometry
    if shape.mesh is not None:
        scale = np.broadcast_to(1.0 if shape.mesh.scale is None else shape.mesh.scale, 3)
        file = find_mesh(shape.mesh.filename, path, link)
        return Geometry(link, "mesh", tuple(scale.tolist()), xyz, rotation, file)
    if shape.box is not None:
        return Geometry(link, "box", tuple(shape.box.size.tolist()), xyz, rotation)
    if shape.sphere is not None:
        return Geometry(link, "sphere", (float(shape.sphere.radius),), xyz, rotation)
    size = (float(shape.cylinder.radius), float(shape.cylinder.length))
    return Geometry(link, "capsule" if collision.name == "capsule" else "cylinder", size, xyz, rotation)


def _pose(origin: Any) -> tuple[tuple[float, float, float], tuple[float, ...]]:
    if origin is None:
        return (0.0, 0.0, 0.0), _NO_ROTATION
    x, y, z = origin[:3, 3].tolist()
    return (x, y, z), tuple(origin[:3, :3].ravel().tolist())
