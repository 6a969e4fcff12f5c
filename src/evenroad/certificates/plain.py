"""Plain files of a robot and a scene: what evenroad has read of any format, as a checker of certificates reads it.

A robot becomes a URDF and an SRDF, a scene a YAML without files of other formats, with poses in the root's frame.
Meshes and clouds are texts beside them, in the order in which they are named.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from evenroad._arrays import Floats
from evenroad._native.certificates import text_of_rows
from evenroad.collision.arm_world import ArmWorld
from evenroad.geometry.mesh import TriangleMesh, convex_hull
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import PRIMITIVES, Capsule, Cylinder, Mesh, PointCloud, Shape, along_z
from evenroad.loading.description import RobotDescription
from evenroad.robots.held import HeldObject
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Scene

ENDLESS = 1000.0
"""A range of more than this is none [rad or m]."""


def claimed_scene(world: ArmWorld) -> Scene:
    """Return the scene of a world with all that its robot holds, and the ranges of the joints that it plans for."""
    robot, setup = world.robot, world.scene.setup
    held = {each.name: each for each in world.scene.attached}
    attached = tuple(held.get(name) or _held(robot, name) for name in robot.holds)
    ranges = {joint.name: (joint.lower, joint.upper) for joint in robot.joints if joint.name in robot.group}
    limits = {name: (low, high) for name, (low, high) in ranges.items() if high - low <= ENDLESS}
    return replace(world.scene, setup=replace(setup, attached=attached, limits=limits))


def plain_scene(scene: Scene) -> tuple[bytes, ...]:
    """Return the text of a scene, and those of the files that it names."""
    files: list[bytes] = []
    lines = ["obstacles:"] if len(scene.obstacles) else ["obstacles: {}"]
    for each in scene.obstacles:
        kept = f", clearance: {_number(each.clearance)}" if each.clearance else ""
        lines.append(f"  {_quoted(each.name)}: {{{_entry(each.body, files)}{kept}}}")
    allowed: dict[str, list[str]] = {}
    for body, obstacle in sorted(scene.allowed):
        allowed.setdefault(obstacle, []).append(body)
    lines += ["allowed:"] if allowed else []
    lines += [f"  {_quoted(name)}: {_list(map(_quoted, bodies))}" for name, bodies in allowed.items()]
    lines += ["limits:"] if scene.limits else []
    lines += [f"  {_quoted(joint)}: {_list(map(_number, both))}" for joint, both in scene.limits.items()]
    lines += ["attach:"] if scene.attached else []
    for held in scene.attached:
        on = f"link: {_quoted(held.link)}, touches: {_list(map(_quoted, held.touches))}"
        lines.append(f"  {_quoted(held.name)}: {{{_entry(held.body, files)}, {on}}}")
    return ("\n".join(lines) + "\n").encode(), *files


def plain_robot(urdf: RobotDescription) -> tuple[bytes, tuple[bytes, ...]]:
    """Return the URDF of a robot, and the meshes that it names."""
    root, files = ET.Element("robot", name=urdf.name), list[bytes]()
    for link in urdf.links:
        element = ET.SubElement(root, "link", name=link)
        for shape in (each for each in urdf.shapes if each.link == link):
            body = along_z(shape) if isinstance(shape, Capsule) else shape
            collision = ET.SubElement(element, "collision")
            _origin(collision, body.pose)
            geometry = ET.SubElement(collision, "geometry")
            if isinstance(body, Mesh):
                files.append(_mesh(body.triangles))
                ET.SubElement(geometry, "mesh", filename=f"{len(files)}.obj")
                continue
            sizes = zip(PRIMITIVES[body.kind].dimensions, _rows(body), strict=True)
            ET.SubElement(geometry, body.kind, {key: " ".join(map(repr, row)) for (key, _), row in sizes})
    for joint in urdf.joints:
        element = ET.SubElement(root, "joint", name=joint.name, type=joint.kind)
        ET.SubElement(element, "parent", link=joint.parent)
        ET.SubElement(element, "child", link=joint.child)
        _origin(element, joint.origin)
        ET.SubElement(element, "axis", xyz=" ".join(map(repr, joint.axis)))
        lower, upper = joint.stops
        if np.isfinite(upper - lower):
            ET.SubElement(element, "limit", lower=repr(lower), upper=repr(upper))
        if joint.mimic is not None:
            follows = joint.mimic
            rule = {"multiplier": repr(follows.multiplier), "offset": repr(follows.offset)}
            ET.SubElement(element, "mimic", {"joint": follows.joint, **rule})
    ET.indent(root)
    return ET.tostring(root), tuple(files)


def plain_srdf(name: str, untested: Iterable[frozenset[str]]) -> bytes:
    """Return an SRDF that disables some pairs of links."""
    root = ET.Element("robot", name=name)
    for first, second in sorted(sorted(pair) for pair in untested):
        ET.SubElement(root, "disable_collisions", link1=first, link2=second)
    ET.indent(root)
    return ET.tostring(root)


def _origin(element: ET.Element, pose: Pose) -> None:
    roll, pitch, yaw = _angles(pose.rotation_matrix)
    ET.SubElement(element, "origin", xyz=" ".join(map(repr, pose.xyz)), rpy=" ".join(map(repr, (roll, pitch, yaw))))


def _angles(turn: Floats) -> tuple[float, float, float]:
    """Return roll, pitch and yaw whose rotation is this one in all digits, also where two axes fall together."""
    yaw = float(np.arctan2(turn[1, 0], turn[0, 0]))
    c, s = np.cos(yaw), np.sin(yaw)
    pitch = float(np.arctan2(-turn[2, 0], c * turn[0, 0] + s * turn[1, 0]))
    roll = float(np.arctan2(s * turn[0, 2] - c * turn[1, 2], c * turn[1, 1] - s * turn[0, 1]))
    return roll, pitch, yaw


def _entry(body: Shape, files: list[bytes]) -> str:
    """Return what a scene says of a body; the file that it needs is added to `files`."""
    body = along_z(body) if isinstance(body, Capsule) else body
    pose = f"xyz: {_list(map(_number, body.pose.xyz))}, xyzw: {_list(map(_number, body.pose.xyzw))}"
    if isinstance(body, PointCloud):
        files.append(text_of_rows(np.ascontiguousarray(body.points, dtype=float), ""))
        return f"shape: cloud, file: {len(files)}.xyz, radius: {_number(body.radius)}, {pose}"
    if isinstance(body, Mesh):
        files.append(_mesh(body.triangles))
        return f"shape: mesh, file: {len(files)}.obj, {pose}"
    sizes = zip(PRIMITIVES[body.kind].dimensions, _rows(body), strict=True)
    said = [f"{key}: {_list(map(_number, row)) if count > 1 else _number(row[0])}" for (key, count), row in sizes]
    return f"shape: {body.kind}, {', '.join(said)}, {pose}"


def _rows(body: Shape) -> list[Sequence[float]]:
    """Return the numbers of each dimension of a body."""
    left = [float(value) for value in body.size]
    return [[left.pop(0) for _ in range(count)] for _, count in PRIMITIVES[body.kind].dimensions]


def _mesh(mesh: TriangleMesh) -> bytes:
    """Return the text of an OBJ."""
    corners = text_of_rows(np.ascontiguousarray(mesh.vertices, dtype=float), "v ")
    return corners + text_of_rows(np.asarray(mesh.triangles, dtype=float) + 1.0, "f ")


def _held(robot: Robot, name: str) -> HeldObject:
    """Return what a robot holds and its scene does not name: of what a gripper may touch, what it may not go into."""
    joint = next(joint for joint in robot.joints if joint.child == name)
    tested = {frozenset(pair) for pair in robot.pairs}
    touches = tuple(link for link in robot.links if frozenset((link, name)) not in tested and link != name)
    parts = [each for each in robot.shapes if each.link == name]
    body: Shape
    if not parts:
        body = next(capsule for capsule in robot.capsules if capsule.link == name)
    elif parts[0].corners.shape[1] == 2:
        a, b = parts[0].corners[0]
        body = along_z(Capsule(a.tolist(), b.tolist(), 1.0))
        radius = float(np.linalg.norm(parts[0].disc))
        body = Cylinder(radius, float(np.linalg.norm(b - a)), pose=body.pose)
    elif parts[0].of == "mesh":
        corners = np.concatenate([each.corners.reshape(-1, 3) for each in parts])
        body = Mesh(TriangleMesh(corners, np.arange(len(corners)).reshape(-1, 3), name))
    else:
        body = Mesh(convex_hull(np.concatenate([each.corners.reshape(-1, 3) for each in parts]), name))
    return HeldObject(name, replace(body, pose=joint.origin @ body.pose), joint.parent, touches)


def _number(value: float) -> str:
    """Return a number as YAML 1.1 reads it: with a point before an exponent."""
    text = repr(float(value))
    return text.replace("e", ".0e") if "e" in text and "." not in text else text


def _quoted(text: str) -> str:
    doubled = text.replace("'", "''")
    return f"'{doubled}'"


def _list(texts: Iterable[str]) -> str:
    return f"[{', '.join(texts)}]"
