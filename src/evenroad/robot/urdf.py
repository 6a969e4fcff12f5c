"""Reading a URDF: its tree of links and joints, and its collision geometry."""

from __future__ import annotations

import logging
import math
from collections.abc import Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from evenroad.errors import BrokenFile, InvalidValue, UnknownName
from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.geometry.shapes import Mesh, Shape, shape_of
from evenroad.robot.joint import Joint, Mimic, with_direct_mimics, within_limits_of_mimics
from evenroad.robot.urdf_xml import drawn_only, find_mesh, read_urdf_xml

_KINDS = ("revolute", "continuous", "prismatic", "fixed")


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
        ``joints[i]`` is the joint whose child is ``links[i + 1]``; a mimic follows a joint that is no mimic,
        with limits that keep the mimic within its own.
    order : tuple of str
        Names of the joints as the file lists them: the order of configurations.
    shapes : tuple of Shape
        The collision geometry, each shape in its link's frame.
    drawn_only : tuple of str
        Links that have a ``<visual>`` but no ``<collision>``.
    """

    name: str
    links: tuple[str, ...]
    joints: tuple[Joint, ...]
    order: tuple[str, ...]
    shapes: tuple[Shape, ...]
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
        shapes=tuple(
            _shape(link.name, collision, path) for link in parsed.links for collision in link.collisions
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
    origin = _pose(joint.origin)
    lower, upper, velocity = _limits(joint, where)
    mimic = None
    if joint.mimic is not None and joint.type != "fixed":
        mimic = Mimic(joint.mimic.joint, float(joint.mimic.multiplier), float(joint.mimic.offset))
    return Joint(
        name=joint.name,
        kind=joint.type,
        parent=joint.parent,
        child=joint.child,
        xyz=origin.xyz,
        rotation=origin.rotation,
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
            f" (missing: {', '.join(missing)}); one that rotates without limits is of type continuous"
        )
    if limit.lower > limit.upper:
        raise InvalidValue(
            f"the limits of {where} must satisfy lower <= upper, got {limit.lower:g}, {limit.upper:g}"
        )
    return float(limit.lower), float(limit.upper), velocity


def _shape(link: str, collision: Any, path: Path) -> Shape:
    pose, given = _pose(collision.origin), collision.geometry
    if given.mesh is not None:
        x, y, z = np.broadcast_to(1.0 if given.mesh.scale is None else given.mesh.scale, 3).tolist()
        return Mesh(find_mesh(given.mesh.filename, path, link), (x, y, z), pose=pose, link=link)
    if given.box is not None:
        return shape_of("box", given.box.size.tolist(), pose, link)
    if given.sphere is not None:
        return shape_of("sphere", (float(given.sphere.radius),), pose, link)
    size = (float(given.cylinder.radius), float(given.cylinder.length))
    return shape_of("capsule" if collision.name == "capsule" else "cylinder", size, pose, link)


def _pose(origin: Any) -> Pose:
    if origin is None:
        return IDENTITY
    x, y, z = origin[:3, 3].tolist()
    return Pose((x, y, z), tuple(origin[:3, :3].ravel().tolist()))


def in_tree_order(links: Sequence[str], joints: Sequence[Joint], where: str) -> list[Joint]:
    """Return the joints so that every joint's parent is the root or the child of an earlier one.

    Depth first, children in the order given.  `where` names the file in errors.

    Raises
    ------
    BrokenFile
        If links or joints share a name, a joint joins links that there are not, a link has two parents, there
        is more than one root, or the joints form a cycle; the text names them.
    """
    _require_distinct("link", list(links), where)
    _require_distinct("joint", [joint.name for joint in joints], where)
    parent_joint: dict[str, Joint] = {}
    for joint in joints:
        for role, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in links:
                raise BrokenFile(
                    f"joint {joint.name!r} in {where} has the {role} {link!r}, which is no link; "
                    f"links: {', '.join(links)}"
                )
        if joint.child in parent_joint:
            raise BrokenFile(
                f"link {joint.child!r} in {where} hangs on two joints,"
                f" {parent_joint[joint.child].name!r} and {joint.name!r}: the links must form a tree"
            )
        parent_joint[joint.child] = joint
    roots = [link for link in links if link not in parent_joint]
    if len(roots) > 1:
        raise BrokenFile(f"{where} has more than one root: no joint leads to {', '.join(map(repr, roots))}")
    children: dict[str, list[Joint]] = {link: [] for link in links}
    for joint in joints:
        children[joint.parent].append(joint)
    ordered: list[Joint] = []
    pending = list(reversed(children[roots[0]])) if roots else []
    while pending:
        joint = pending.pop()
        ordered.append(joint)
        pending.extend(reversed(children[joint.child]))
    if len(ordered) < len(joints):
        reached = {joint.name for joint in ordered}
        start = next(joint for joint in joints if joint.name not in reached)
        raise BrokenFile(f"the joints of {where} form a cycle: {' -> '.join(_cycle(start, parent_joint))}")
    return ordered


def _cycle(joint: Joint, parent_joint: dict[str, Joint]) -> list[str]:
    """Return the names along the cycle that one comes to by going up from `joint`."""
    above = [joint]
    while parent_joint[above[-1].parent] not in above:
        above.append(parent_joint[above[-1].parent])
    closing = parent_joint[above[-1].parent]
    names = [each.name for each in above[above.index(closing) :]]
    return [closing.name, *reversed(names)]


def _require_distinct(what: str, names: list[str], where: str) -> None:
    for name in names:
        if names.count(name) > 1:
            raise BrokenFile(f"{where} has more than one {what} named {name!r}")
