"""Reading a URDF: its tree of links and joints, and its collision geometry."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from evenroad._checks import require_known
from evenroad.errors import BrokenFile, InvalidValue
from evenroad.geometry.mesh_file import GLTF, Y_UP
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import PRIMITIVES, Mesh, Shape, shape_of
from evenroad.loading.urdf_limits import soft_notes, with_limits_of
from evenroad.loading.urdf_xml import RobotFile, drawn_only, find_mesh, read_urdf_xml
from evenroad.robots.free_joints import coordinates, held_note
from evenroad.robots.joint import Joint, Kind, Mimic, with_direct_mimics, within_limits_of_mimics
from evenroad.robots.planes import Plane

_KINDS: dict[str, Kind] = {
    **{"revolute": "revolute", "continuous": "continuous", "prismatic": "prismatic", "fixed": "fixed"},
    **{"planar": "fixed", "floating": "fixed"},
}
"""Type of a joint in a URDF -> its kind; those with several coordinates are read as fixed, then replaced."""
_ANY = 1000.0
"""A range of more than this is that of a joint without limits [rad or m]."""
_MOST_LINKS, _MOST_BODIES = 1000, 500
"""Largest number of links of a robot, and of those with bodies: each pair of these is looked at."""


@dataclass(frozen=True)
class Urdf:
    """What the file of a robot says about motion and collision.

    Of the `links` the root comes first, every parent before its children; ``joints[i]`` is the joint whose child is
    ``links[i + 1]``, and a mimic follows a joint that is no mimic, with limits that keep the mimic within its own.
    `order` are the joints' names as the file lists them: the order of configurations.  `shapes` are the collision
    geometry, each in its link's frame; `drawn_only` are links that are drawn and have none; `notes` say what was read
    otherwise than it stands in the file.  `untested` are pairs of links that the file itself lets touch, each with the
    reason; None where it does not say, as no URDF does.  `planes` are half spaces that it has around the robot, and
    `states` are named states of an MJCF, joint -> value [rad or m].
    """

    name: str
    links: tuple[str, ...]
    joints: tuple[Joint, ...]
    order: tuple[str, ...]
    shapes: tuple[Shape, ...]
    drawn_only: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    untested: tuple[tuple[str, str, str], ...] | None = None
    planes: tuple[Plane, ...] = ()
    states: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    @property
    def free(self) -> frozenset[str]:
        """Joints that move by themselves: neither fixed nor mimics, nor locked by equal limits, nor slides without."""
        return frozenset(
            joint.name
            for joint in self.joints
            if joint.kind != "fixed" and joint.mimic is None and joint.lower < joint.upper
            if joint.kind != "prismatic" or joint.upper - joint.lower <= _ANY
        )


def read_urdf(source: Path | RobotFile) -> Urdf:
    """Read a URDF, or a xacro, which is expanded first.

    Meshes are looked for but not opened.  An element ``<capsule radius="r" length="l"/>``, a cylinder of length l
    along z with half balls on both ends, is understood beside those of the standard.

    Raises BrokenFile if the file is missing, broken or not a URDF, a piece is missing, a mesh is not found, or the
    links do not form a tree; InvalidValue if a number is not one, or out of its range; UnknownName if a joint is of a
    type that there is not.
    """
    file = source if isinstance(source, RobotFile) else RobotFile(source)
    root, notes = read_urdf_xml(file)
    links = root.findall("link")
    joints = [each for joint in root.findall("joint") for each in _joints(joint, file.path, notes)]
    names = [link.attrib["name"] for link in links]
    return as_tree(
        root.get("name", file.path.stem),
        [*names, *(joint.child for joint in joints if joint.of and joint.child not in names)],
        joints,
        [_shape(link.attrib["name"], each, file) for link in links for each in link.findall("collision")],
        str(file.path),
        drawn_only(root),
        notes + soft_notes(joints),
    )


def require_few_links(links: int, bodies: int, path: Path) -> None:
    """Raise BrokenFile for a robot with too many links: their pairs would take minutes and gigabytes."""
    if links > _MOST_LINKS or bodies > _MOST_BODIES:
        allowed = (
            f"a robot may have {_MOST_LINKS}, {_MOST_BODIES} of them with bodies; a scene may include larger files"
        )
        raise BrokenFile(f"{path} has {links} links, {bodies} of them with bodies: {allowed}")


def as_tree(
    name: str,
    links: Sequence[str],
    joints: Sequence[Joint],
    shapes: Sequence[Shape],
    where: str,
    drawn_only: tuple[str, ...],
    notes: list[str],
) -> Urdf:
    """Return a robot as the tree that its links and joints, in the file's order, form; `where` names the file."""
    ordered = in_tree_order(links, [_without_end(joint, notes) for joint in joints], where)
    return Urdf(
        name,
        links=(ordered[0].parent if ordered else links[0], *(joint.child for joint in ordered)),
        joints=tuple(within_limits_of_mimics(with_direct_mimics(ordered, where))),
        order=tuple(joint.name for joint in joints),
        shapes=tuple(shapes),
        drawn_only=drawn_only,
        notes=tuple(notes),
    )


def _without_end(joint: Joint, notes: list[str]) -> Joint:
    """Return a joint that turns on for ever where its limits are as good as none; what is done with it is noted."""
    if not joint.upper - joint.lower > _ANY or joint.kind == "continuous":
        return joint
    said = f"joint {joint.name!r} with the limits {joint.lower:g}, {joint.upper:g}"
    if joint.kind == "revolute":
        notes.append(f"{said} turns without end")
        return replace(joint, kind="continuous", lower=-math.inf, upper=math.inf, hard=None)
    notes.append(f"{said} slides without end: it is held, unless a scene limits it and --group names it")
    return joint


def _joints(element: Element, path: Path, notes: list[str]) -> list[Joint]:
    """Return the joint of an element, or the coordinates of a planar or floating one."""
    name, word = element.attrib["name"], element.attrib["type"]
    where = f"joint {name!r} in {path}"
    require_known(f"type of {where}:", word, _KINDS)
    joint = _joint(element, _KINDS[word], where, notes)
    if word not in ("planar", "floating"):
        return [joint]
    plane = (0.0, 0.0, 1.0) if element.find("axis") is None else _axis(element, where)
    joints = coordinates(word, replace(joint, axis=plane))
    notes.append(held_note(word, name, joints))
    return joints


def _joint(element: Element, kind: Kind, where: str, notes: list[str]) -> Joint:
    origin, follows = _pose(element), element.find("mimic")
    mimic = None
    if follows is not None and kind != "fixed":
        multiplier, offset = float(follows.get("multiplier", 1.0)), float(follows.get("offset", 0.0))
        mimic = Mimic(follows.attrib["joint"], multiplier, offset)
    joint = Joint(
        name=element.attrib["name"],
        kind=kind,
        parent=_link(element, "parent"),
        child=_link(element, "child"),
        xyz=origin.xyz,
        rotation=origin.rotation,
        axis=(0.0, 0.0, 1.0) if kind == "fixed" else _axis(element, where),
        mimic=mimic,
    )
    return with_limits_of(element, joint, where, notes)


def _link(joint: Element, end: str) -> str:
    element = joint.find(end)
    assert element is not None, "as read_urdf_xml has seen to"
    return element.attrib["link"]


def _axis(joint: Element, where: str) -> tuple[float, float, float]:
    axis = np.array(_numbers(joint.find("axis"), "xyz", (1.0, 0.0, 0.0)))
    length = float(np.linalg.norm(axis))
    if length < 1e-9:
        raise InvalidValue(f"the axis of {where} must not be zero, got {axis.tolist()}")
    x, y, z = (axis / length).tolist()
    return (x, y, z)


def _shape(link: str, collision: Element, file: RobotFile) -> Shape:
    pose, (shape,) = _pose(collision), collision.iterfind("geometry/*")
    if shape.tag == "mesh":
        x, y, z = np.broadcast_to(_numbers(shape, "scale", (1.0,)), 3).tolist()
        path = find_mesh(shape.attrib["filename"], file, link)
        if file.upright_meshes and path.suffix.lower() in GLTF:
            # Scales are along the axes of the link, as those of a mesh in a scene are along the scene's.
            return Mesh(path, (x, z, y), pose=pose @ Y_UP, link=link)
        return Mesh(path, (x, y, z), pose=pose, link=link)
    names = [name for name, _ in PRIMITIVES[shape.tag].dimensions]
    return shape_of(shape.tag, [size for name in names for size in _numbers(shape, name, (0.0,))], pose, link)


def _pose(owner: Element) -> Pose:
    origin = owner.find("origin")
    x, y, z = _numbers(origin, "xyz", (0.0, 0.0, 0.0))
    if origin is not None and "quat_xyzw" in origin.attrib:
        return Pose.from_quaternion((x, y, z), xyzw=_numbers(origin, "quat_xyzw", ()))
    roll, pitch, yaw = _numbers(origin, "rpy", (0.0, 0.0, 0.0))
    # rotation_from_rpy in another order of operations, in which robots were always read: their capsules, and what was
    # computed with these, keep their last bits.
    (si, sj, sk), (ci, cj, ck) = np.sin([roll, pitch, yaw]).tolist(), np.cos([roll, pitch, yaw]).tolist()
    cc, cs, sc, ss = ci * ck, ci * sk, si * ck, si * sk
    rotation = (
        *(cj * ck, sj * sc - cs, sj * cc + ss),
        *(cj * sk, sj * ss + cc, sj * cs - sc),
        *(-sj, cj * si, cj * ci),
    )
    return Pose((x, y, z), tuple(number + 0.0 for number in rotation))


def _numbers(element: Element | None, attribute: str, default: tuple[float, ...]) -> tuple[float, ...]:
    text = None if element is None else element.get(attribute)
    return default if text is None else tuple(map(float, text.split()))


def in_tree_order(links: Sequence[str], joints: Sequence[Joint], where: str) -> list[Joint]:
    """Return the joints so that every joint's parent is the root or the child of an earlier one.

    Depth first, children in the order given. `where` names the file in errors.  Raises BrokenFile if links or joints
    share a name, a joint joins links that there are not, a link has two parents, there is more than one root, or the
    joints form a cycle; the text names them.
    """
    _require_distinct("link", links, where)
    _require_distinct("joint", (joint.name for joint in joints), where)
    parent_joint: dict[str, Joint] = {}
    for joint in joints:
        for role, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in links:
                said = f"joint {joint.name!r} in {where} has the {role} {link!r}, which is no link"
                raise BrokenFile(f"{said}; links: {', '.join(links)}")
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


def _require_distinct(what: str, names: Iterable[str], where: str) -> None:
    name, count = max(Counter(names).items(), key=lambda item: item[1], default=("", 1))
    if count > 1:
        raise BrokenFile(f"{where} has more than one {what} named {name!r}")
