"""Reading a URDF: its tree of links and joints, and its collision geometry."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from evenroad._checks import require_known
from evenroad.errors import InvalidValue
from evenroad.geometry.mesh_file import GLTF, Y_UP
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import PRIMITIVES, Mesh, Shape, shape_of
from evenroad.loading.description import RobotDescription, as_tree
from evenroad.loading.robot_file import RobotFile, find_mesh
from evenroad.loading.urdf_limits import soft_notes, with_limits_of
from evenroad.loading.urdf_xml import drawn_only, read_urdf_xml
from evenroad.robots.free_joints import coordinates, held_note
from evenroad.robots.joint import Joint, Kind, Mimic

_KINDS: dict[str, Kind] = {
    **{"revolute": "revolute", "continuous": "continuous", "prismatic": "prismatic", "fixed": "fixed"},
    **{"planar": "fixed", "floating": "fixed"},
}
"""Type of a joint in a URDF -> its kind; those with several coordinates are read as fixed, then replaced."""


def read_urdf(source: Path | RobotFile) -> RobotDescription:
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
        [link_shape(link.attrib["name"], each, file) for link in links for each in link.findall("collision")],
        str(file.path),
        drawn_only(root),
        notes + soft_notes(joints),
    )


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


def link_shape(link: str, collision: Element, file: RobotFile) -> Shape:
    """Return the shape of a checked ``<collision>``; BrokenFile if its mesh is not found."""
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
