"""A robot's URDF and SRDF: links, joints, collision shapes, and the pairs of links that are no part of a claim."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote

import numpy as np

from evenroad_verify.errors import BadInput, Floats, Pose, number, numbers, require
from evenroad_verify.files import Files, attribute, only, parse_xml, required
from evenroad_verify.meshes import read_mesh
from evenroad_verify.shapes import DIMENSIONS, Shape, pose_of, primitive

KINDS = ("fixed", "revolute", "continuous", "prismatic")


@dataclass(frozen=True)
class Joint:
    """A joint; `leader` is the joint whose value it takes, times `factor` plus `offset`: itself if it is no mimic."""

    name: str
    kind: str
    parent: str
    child: str
    origin: Pose
    axis: Floats
    lower: float
    upper: float
    leader: str
    factor: float
    offset: float


@dataclass(frozen=True)
class Robot:
    """A tree of links, parents first: `joints[i]` leads to `links[i + 1]`."""

    links: tuple[str, ...]
    joints: tuple[Joint, ...]
    shapes: dict[str, list[Shape]]
    disabled: frozenset[frozenset[str]] | None
    """Pairs that the SRDF disables; None without an SRDF that disables any."""

    @property
    def depth(self) -> int:
        """Number of joints on the longest chain."""
        depth = {self.links[0]: 0}
        for joint in self.joints:
            depth[joint.child] = depth[joint.parent] + 1
        return max(depth.values())


def read_robot(files: Files, urdf: Path, srdf: Path | None, packages: dict[str, Path]) -> Robot:
    """Return a robot of its files."""
    data = files.read(urdf)
    root = parse_xml(data, urdf.name)
    require(root.tag == "robot" and b"<xacro:" not in data, f"{urdf.name} is no URDF, or a xacro")
    names = [attribute(link, "name") for link in root.findall("link")]
    joints = [_joint(element) for element in root.findall("joint")]
    links, ordered = _tree(names, joints)
    disabled = None
    if srdf is not None and (said := files.read(srdf)):
        disabled = _disabled(parse_xml(said, srdf.name), links)
    shapes: dict[str, list[Shape]] = {}
    for link in root.findall("link"):
        for body in link.findall("collision"):
            shapes.setdefault(attribute(link, "name"), []).extend(_body(files, body, urdf, packages))
    return Robot(links, ordered, {link: some for link, some in shapes.items() if some}, disabled or None)


def _joint(element: ET.Element) -> Joint:
    name, kind = attribute(element, "name"), attribute(element, "type")
    parent, child = (attribute(required(element, tag), "link") for tag in ("parent", "child"))
    along = only(element, "axis")
    axis = numbers("1 0 0" if along is None else along.get("xyz", "1 0 0"), 3)
    # Joints of several coordinates stand still at 0: a certificate that moves them carries a URDF without them.
    kind = "fixed" if kind in ("planar", "floating") else kind
    require(kind in KINDS, f"the joint {name} is of the unknown kind {kind}")
    length = float(np.linalg.norm(axis))
    require(length > 1e-9 or kind == "fixed", f"the axis of {name} is zero")
    lower, upper = -1e3, 1e3
    if kind in ("revolute", "prismatic"):
        limit = required(element, "limit")
        lower, upper = number(limit.get("lower", "0")), number(limit.get("upper", "0"))
    mimic, leader, factor, offset = only(element, "mimic"), name, 1.0, 0.0
    if mimic is not None and kind != "fixed":
        leader = attribute(mimic, "joint")
        factor, offset = number(mimic.get("multiplier", "1")), number(mimic.get("offset", "0"))
    axis = axis / max(length, 1e-9)
    return Joint(name, kind, parent, child, _origin(element), axis, lower, upper, leader, factor, offset)


def _origin(element: ET.Element) -> Pose:
    origin = only(element, "origin")
    said = {} if origin is None else origin.attrib
    require(said.keys() <= {"xyz", "rpy"}, f"an <origin> has {', '.join(said)}")
    return pose_of(numbers(said.get("xyz", "0 0 0"), 3), numbers(said.get("rpy", "0 0 0"), 3))


def _tree(names: list[str], joints: list[Joint]) -> tuple[tuple[str, ...], tuple[Joint, ...]]:
    """Return links and joints depth first, children in the order of the file."""
    above = {joint.child: joint for joint in joints}
    require(len(set(names)) == len(names) and len(above) == len(joints), "two links, or two joints, go by one name")
    require(len({joint.name for joint in joints}) == len(joints), "two joints have one name")
    require({end for joint in joints for end in (joint.parent, joint.child)} <= set(names), "a joint lacks its link")
    below: dict[str, list[Joint]] = {name: [] for name in names}
    for joint in joints:
        below[joint.parent].append(joint)
    roots = [name for name in names if name not in above]
    require(len(roots) == 1, "the links form no tree")
    links, ordered, pending = roots[:1], [], below[roots[0]][::-1]
    while pending:
        joint = pending.pop()
        links.append(joint.child)
        ordered.append(joint)
        pending += below[joint.child][::-1]
    require(len(links) == len(names), "the links form no tree")
    return tuple(links), tuple(ordered)


def _body(files: Files, body: ET.Element, urdf: Path, packages: dict[str, Path]) -> list[Shape]:
    at, geometry = _origin(body), required(body, "geometry")
    require(len(geometry) == 1, "a <geometry> has not one shape")
    kind, said = geometry[0].tag, dict(geometry[0].attrib)
    require(kind == "mesh" or kind in DIMENSIONS, f"a link has the unknown shape {kind}")
    if kind != "mesh":
        shape = primitive(kind, said)
        return [] if shape is None else [shape.at(at)]
    scale = said.get("scale", "1").split()
    name = attribute(geometry[0], "filename")
    file = Path(name) if files.own else _mesh_file(name, urdf, packages)
    return [
        each.at(at)
        for each in read_mesh(files.read(file), file.name, numbers(scale * 3 if len(scale) == 1 else scale, 3))
    ]


def _mesh_file(name: str, urdf: Path, packages: dict[str, Path]) -> Path:
    """Return the file that a URDF means: beside it, or in a package that is given or lies around it."""
    scheme, separator, rest = name.partition("://")
    folder, rest = urdf.absolute().parent, unquote(rest)
    if not separator or scheme == "file":
        return Path(rest) if separator else folder / name
    package, _, inside = rest.partition("/")
    around = [
        each
        for above in (folder, *folder.parents)
        for each in ([above] if above.name == package else [above / package])
    ]
    for each in [packages[package]] if package in packages else around:
        if (each / inside).is_file():
            return each / inside
    raise BadInput(f"the mesh {name} is missing; --package {package}=FOLDER says where the package is")


def _disabled(root: ET.Element, links: tuple[str, ...]) -> frozenset[frozenset[str]]:
    def pairs(tag: str) -> set[frozenset[str]]:
        return {frozenset((attribute(each, "link1"), attribute(each, "link2"))) for each in root.findall(tag)}

    default = {attribute(each, "link") for each in root.findall("disable_default_collisions")}
    by_default = {frozenset((link, other)) for link in default & set(links) for other in links if other != link}
    disabled = pairs("disable_collisions") | by_default - pairs("enable_collisions")
    return frozenset(pair for pair in disabled if pair <= set(links))
