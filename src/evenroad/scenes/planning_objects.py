"""Objects of MoveIt's messages: shapes in the frames of the planning scene, of links, and of other objects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from evenroad._yaml import numbers
from evenroad.errors import BrokenFile, InvalidValue, UnknownName, shown
from evenroad.geometry.mesh import TriangleMesh
from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.geometry.shapes import Mesh, Shape, shape_of
from evenroad.robots.held import HeldObject
from evenroad.scenes.moveit_scene import SIZES, dimensions_of, pose_of

ROOT = ""
"""The frame of the robot's root link."""
PLANNING_FRAMES = (ROOT, "world")
"""Frames that are the robot's root link wherever a file does not say more."""
_TYPES = {1: "box", 2: "sphere", 3: "cylinder", 4: "cone"}
"""Numbers of shape_msgs/SolidPrimitive."""
_ADD, _REMOVE, _APPEND, _MOVE = "add", "remove", "append", "move"
_OPERATIONS = {0: _ADD, 1: _REMOVE, 2: _APPEND, 3: _MOVE}
"""Numbers of moveit_msgs/CollisionObject."""


class Frame(NamedTuple):
    """A frame by its pose in that of a link, ROOT for the root link."""

    link: str
    pose: Pose

    def at(self, pose: Pose) -> Frame:
        """Return the frame that has this pose in this one."""
        return Frame(self.link, self.pose @ pose)


Frames = dict[str, Frame]


@dataclass
class Object:
    """An object while a scene is read: its frame, and its shapes and subframes in that."""

    frame: Frame
    shapes: list[Shape] = field(default_factory=list)
    subframes: dict[str, Pose] = field(default_factory=dict)

    def named(self, name: str) -> dict[str, Shape]:
        """Return its shapes where they are in the link's frame, by names of their own."""
        solid = [each for each in self.shapes if not isinstance(each, Mesh)]
        meshes = [each for each in self.shapes if isinstance(each, Mesh)]
        # A lone solid shape keeps the object's name beside meshes, too.
        names = [name] if len(solid) == 1 else [f"{name}/{i}" for i in range(len(solid))]
        names += [f"{name}/mesh{i}" for i in range(len(meshes))] if len(self.shapes) > 1 else [name] * len(meshes)
        return {own: self._placed(each) for own, each in zip(names, (*solid, *meshes), strict=True)}

    def _placed(self, shape: Shape) -> Shape:
        return replace(shape, pose=self.frame.pose @ shape.pose)

    def frames(self, name: str) -> Frames:
        """Return its frame and its subframes, as others name them."""
        return {name: self.frame} | {f"{name}/{sub}": self.frame.at(pose) for sub, pose in self.subframes.items()}


def given_frames(document: Mapping[str, Any], path: Path) -> Frames:
    """Return the frames that a file places in its planning frame, which is the robot's root link."""
    root = Frame(ROOT, IDENTITY)
    given = document.get("fixed_frame_transforms") or []
    frames = dict.fromkeys((*PLANNING_FRAMES, *map(frame_id, given)), root)
    for each in given:
        frames[str(each.get("child_frame_id"))] = root.at(transform_of(each.get("transform"), f"a frame of {path}"))
    return frames


def transform_of(entry: Mapping[str, Any] | None, where: str) -> Pose:
    """Return the pose of a geometry_msgs/Transform."""
    said = entry or {}
    return _pose({"position": said.get("translation"), "orientation": said.get("rotation")}, where)


def frame_id(entry: Mapping[str, Any]) -> str:
    """Return the frame that the header of a message names."""
    return str((entry.get("header") or {}).get("frame_id") or "")


def objects_after_all(entries: list[Mapping[str, Any]], frames: Frames, path: Path) -> dict[str, Object]:
    """Return the objects that are there after all operations, by their names.

    A frame that neither is one of `frames` nor belongs to an object before it is that of a link of this name.
    """
    objects: dict[str, Object] = {}
    for each in entries:
        name = _name_of(each, path)
        where = f"object {name!r} in {path}"
        operation = _operation(each, where)
        if operation == _REMOVE:
            objects = {own: kept for own, kept in objects.items() if name not in ("", own)}
            continue
        known = frames | {own: frame for one, kept in objects.items() for own, frame in kept.frames(one).items()}
        made = _object(each, known.get(frame_id(each)) or Frame(frame_id(each), IDENTITY), where)
        if operation == _MOVE:
            if name not in objects or made.shapes:
                raise InvalidValue(f"{where} is moved: it must be there before, and have a pose alone")
            objects[name].frame = made.frame
        elif operation == _APPEND and name in objects:
            first = objects[name].frame
            if made.frame.link != first.link:
                raise InvalidValue(
                    f"{where} must have all its shapes in one frame, got {first.link!r} and {made.frame.link!r}"
                )
            back = first.pose.inverse() @ made.frame.pose
            objects[name].shapes += [replace(shape, pose=back @ shape.pose) for shape in made.shapes]
        elif name in objects:
            raise InvalidValue(f"objects in {path} must have names of their own, twice: {name!r}")
        else:
            objects[name] = made
    return objects


class AttachedObject(NamedTuple):
    """What is attached: its bodies, in the frame of a link, which need not be the one that carries them."""

    bodies: tuple[HeldObject, ...]
    link: str
    frames: Frames


def attached_object(entry: Mapping[str, Any], frames: Frames, path: Path) -> AttachedObject | None:
    """Return what a message attaches, None where it lets go."""
    inside = entry.get("object") or {}
    name, link = _name_of(inside, path), entry.get("link_name")
    where = f"attached object {name!r} in {path}"
    if _operation(inside, where) == _REMOVE:
        return None
    if not isinstance(link, str) or not link:
        raise InvalidValue(f"{where} must have the link_name of what carries it, got {shown(link)}")
    touches = entry.get("touch_links") or []
    if not isinstance(touches, list) or not all(isinstance(each, str) for each in touches):
        raise InvalidValue(f"touch_links of {where} must be a list of links, got {shown(touches)}")
    its = frame_id(inside) or link
    made = _object(inside, Frame(link, IDENTITY) if its == link else frames.get(its) or Frame(its, IDENTITY), where)
    bodies = made.named(name)
    if not bodies:
        raise InvalidValue(f"{where} has no shapes: write them, not its name alone")
    held = tuple(HeldObject(own, body, link, tuple(touches)) for own, body in bodies.items())
    return AttachedObject(held, made.frame.link, made.frames(name))


def _name_of(entry: Mapping[str, Any], path: Path) -> str:
    if "id" not in entry:
        raise BrokenFile(f"every entry of collision_objects in {path} must have an 'id', got {shown(entry)}")
    return str(entry["id"])


def _operation(entry: Mapping[str, Any], where: str) -> str:
    given = entry.get("operation", 0)
    given = given.strip().lower() if isinstance(given, str) else _OPERATIONS.get(given, given)
    if given not in _OPERATIONS.values():
        raise UnknownName.among(f"operation of {where}:", given, _OPERATIONS.values())
    return str(given)


def _object(entry: Mapping[str, Any], frame: Frame, where: str) -> Object:
    """Return an object of a message whose header names this frame."""
    if entry.get("planes"):
        raise InvalidValue(f"{where} must consist of {', '.join(SIZES)} and meshes: it has a plane")
    found = Object(frame.at(_pose(entry["pose"], where)) if entry.get("pose") else frame)
    names = entry.get("subframe_names") or []
    for subframe, pose in _with_poses(names, entry.get("subframe_poses"), "subframe", where):
        found.subframes[str(subframe)] = _pose(pose, where)
    for primitive, pose in _with_poses(entry.get("primitives"), entry.get("primitive_poses"), "primitive", where):
        given = primitive.get("type")
        kind = str(_TYPES.get(given, given)).lower()
        size = numbers(primitive.get("dimensions"), dimensions_of(kind, where), f"dimensions of {where}")
        try:
            # Height and radius in messages, radius and length everywhere else.
            found.shapes.append(shape_of(kind, size[::-1] if kind == "cylinder" else size, _pose(pose, where)))
        except InvalidValue as error:
            raise InvalidValue(f"{where}: {error}") from None
    for mesh, pose in _with_poses(entry.get("meshes"), entry.get("mesh_poses"), "mesh", where):
        found.shapes.append(Mesh(_mesh(mesh, where), pose=_pose(pose, where)))
    return found


def _with_poses(things: Any, poses: Any, what: str, where: str) -> list[tuple[Any, Any]]:
    """Return things with their poses; a single thing without one stands in the object's frame."""
    things, poses = things or [], poses or []
    if len(things) != len(poses):
        raise BrokenFile(f"{where} must have a pose for each {what}, got {len(things)} and {len(poses)}")
    return list(zip(things, poses, strict=True))


def _mesh(entry: object, where: str) -> TriangleMesh:
    """Return a mesh of a message: vertices, and triangles by their ``vertex_indices``."""
    where = f"a mesh of {where}"
    parts = entry if isinstance(entry, dict) else {}
    if not {"vertices", "triangles"} <= parts.keys():
        raise InvalidValue(f"{where} must have vertices and triangles, got {shown(entry)}")
    rows = [
        [each[key] for key in "xyz"] if isinstance(each, dict) and {*"xyz"} <= each.keys() else each
        for each in parts.get("vertices") or []
    ]
    corners = [each.get("vertex_indices") if isinstance(each, dict) else each for each in parts.get("triangles") or []]
    vertices = np.array([numbers(row, 3, f"a vertex of {where}") for row in rows]).reshape(-1, 3)
    triangles = np.array([numbers(row, 3, f"a triangle of {where}") for row in corners]).reshape(-1, 3)
    if (broken := triangles != np.rint(triangles)).any():
        raise InvalidValue(f"{where} must have whole vertex_indices, got {triangles[broken][0]:g}")
    try:
        return TriangleMesh(vertices, triangles.astype(int))
    except InvalidValue as error:
        raise InvalidValue(f"{where}: {error}") from None


def _pose(entry: object, where: str) -> Pose:
    """Return a pose of a message: position and orientation, as lists or by their letters."""
    rows = []
    for key, letters in (("position", "xyz"), ("orientation", "xyzw")):
        row = entry.get(key) if isinstance(entry, dict) else None
        if isinstance(row, dict):
            row = [row.get(letter, 0.0) for letter in letters]
        rows.append(numbers(row, len(letters), f"{key} of {where}"))
    return pose_of(rows[0], rows[1], where)
