"""Objects of MoveIt's messages: shapes in the frames of the planning scene, of links, and of other objects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from evenroad._checks import require_known
from evenroad._yaml import numbers
from evenroad.errors import BrokenFile, InvalidValue, UnknownName, shown
from evenroad.geometry.mesh import TriangleMesh
from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.geometry.shapes import Mesh, Shape, shape_of
from evenroad.robots.held import HeldObject
from evenroad.scenes.entry import Entry, pose_of

ROOT = ""
"""The frame of the robot's root link."""
PLANNING_FRAMES = (ROOT, "world")
"""Frames that are the robot's root link wherever a file does not say more."""
SIZES = {"box": 3, "sphere": 1, "cylinder": 2}
"""Shapes that are read, and how many dimensions each has."""
_TYPES = {1: "box", 2: "sphere", 3: "cylinder", 4: "cone"}
"""Numbers of shape_msgs/SolidPrimitive."""
_ADD, _REMOVE, _APPEND, _MOVE = _OPERATIONS = ("add", "remove", "append", "move")
"""Operations of moveit_msgs/CollisionObject, by their numbers."""


class Frame(NamedTuple):
    """A frame by its pose in that of a link, ROOT for the root link."""

    link: str
    pose: Pose = IDENTITY

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
        bodies = [replace(each, pose=self.frame.pose @ each.pose) for each in (*solid, *meshes)]
        return dict(zip(names, bodies, strict=True))

    def frames(self, name: str) -> Frames:
        """Return its frame and its subframes, as others name them."""
        return {name: self.frame} | {f"{name}/{sub}": self.frame.at(pose) for sub, pose in self.subframes.items()}


def given_frames(scene: Entry) -> Frames:
    """Return the frames that a file places in its planning frame, which is the robot's root link."""
    given = scene.parts("fixed_frame_transforms")
    frames = dict.fromkeys((*PLANNING_FRAMES, *map(header_frame, given)), Frame(ROOT))
    for each in given:
        frames[str(each.get("child_frame_id"))] = Frame(ROOT, message_pose(each.part("transform")))
    return frames


def header_frame(message: Entry) -> str:
    """Return the frame that the header of a message names."""
    return str(message.part("header").get("frame_id") or "")


def message_pose(message: Entry) -> Pose:
    """Return a pose or a transform: rows of numbers, as lists or by their letters."""
    rows = []
    for letters, keys in (("xyz", ("translation", "position")), ("xyzw", ("rotation", "orientation"))):
        key = next((key for key in keys if key in message), keys[1])
        row = message.get(key)
        row = [row.get(letter, 0.0) for letter in letters] if isinstance(row, Mapping) else row
        rows.append(numbers(row, len(letters), f"{key} of {message.where}"))
    return pose_of(rows[0], rows[1], message.where)


def objects_after_all(messages: list[Entry], frames: Frames) -> dict[str, Object]:
    """Return the objects that are there after all operations, by their names.

    A frame that neither is one of `frames` nor belongs to an object before it is that of a link of this name.
    """
    objects: dict[str, Object] = {}
    for each in messages:
        name = _name_of(each)
        message = each.called(f"object {name!r} in {each.where}")
        operation = _operation(message)
        if operation == _REMOVE:
            objects = {own: kept for own, kept in objects.items() if name not in ("", own)}
            continue
        known = frames | {own: frame for one, kept in objects.items() for own, frame in kept.frames(one).items()}
        made = _object(message, known.get(header_frame(each)) or Frame(header_frame(each)))
        if operation == _MOVE:
            if name not in objects or made.shapes:
                raise InvalidValue(f"{message.where} is moved: it must be there before, and have a pose alone")
            objects[name].frame = made.frame
        elif operation == _APPEND and name in objects:
            first = objects[name].frame
            if made.frame.link != first.link:
                both = f"{first.link!r} and {made.frame.link!r}"
                raise InvalidValue(f"{message.where} must have all its shapes in one frame, got {both}")
            back = first.pose.inverse() @ made.frame.pose
            objects[name].shapes += [replace(shape, pose=back @ shape.pose) for shape in made.shapes]
        elif name in objects:
            raise InvalidValue(f"objects in {each.where} must have names of their own, twice: {name!r}")
        else:
            objects[name] = made
    return objects


class AttachedObject(NamedTuple):
    """What is attached: its bodies, in the frame of a link, which need not be the one that carries them."""

    bodies: tuple[HeldObject, ...]
    link: str
    frames: Frames


def attached_object(message: Entry, frames: Frames) -> AttachedObject | None:
    """Return what a message attaches, None where it lets go."""
    inside, link = message.part("object"), message.get("link_name")
    name = _name_of(inside)
    inside = inside.called(f"attached object {name!r} in {message.where}")
    if _operation(inside) == _REMOVE:
        return None
    if not isinstance(link, str) or not link:
        raise InvalidValue(f"{inside.where} must have the link_name of what carries it, got {shown(link)}")
    touches = message.called(inside.where).texts("touch_links", "links")
    its = header_frame(inside) or link
    made = _object(inside, Frame(link) if its == link else frames.get(its) or Frame(its))
    if not made.shapes:
        raise InvalidValue(f"{inside.where} has no shapes: write them, not its name alone")
    held = tuple(HeldObject(own, body, link, touches) for own, body in made.named(name).items())
    return AttachedObject(held, made.frame.link, made.frames(name))


def _name_of(message: Entry) -> str:
    if message.get("id") is None:
        raise BrokenFile(f"every object in {message.where} must have an 'id', got {shown(message.content)}")
    return str(message.get("id"))


def _operation(message: Entry) -> str:
    given = message.get("operation")
    if isinstance(given, int | None) and 0 <= (given or 0) < len(_OPERATIONS):
        return _OPERATIONS[given or 0]
    if (name := str(given).strip().lower()) in _OPERATIONS:
        return name
    raise UnknownName.among(f"operation of {message.where}:", given, _OPERATIONS)


def _object(message: Entry, frame: Frame) -> Object:
    """Return an object whose header names this frame."""
    if message.get("planes"):
        raise InvalidValue(f"{message.where} must consist of {', '.join(SIZES)} and meshes: it has a plane")
    found = Object(frame.at(message_pose(message.part("pose"))) if message.get("pose") else frame)
    names = message.entries("subframe_names")
    found.subframes.update(zip(map(str, names), _poses(message, "subframe", len(names)), strict=True))
    solids, meshes = message.parts("primitives"), message.parts("meshes")
    for solid, pose in zip(solids, _poses(message, "primitive", len(solids)), strict=True):
        given = solid.get("type")
        kind = (_TYPES.get(given, "") if isinstance(given, int) else "") or str(given).lower()
        count = dimensions_of(kind, message.where)
        size = numbers(solid.get("dimensions"), count, f"dimensions of {message.where}")
        # Height and radius in messages, radius and length everywhere else.
        size = size[::-1] if kind == "cylinder" else size
        found.shapes.append(solid_of(kind, size, pose, message.where))
    for mesh, pose in zip(meshes, _poses(message, "mesh", len(meshes)), strict=True):
        found.shapes.append(Mesh(_mesh(mesh.called(f"a mesh of {message.where}")), pose=pose))
    return found


def dimensions_of(kind: str, where: str) -> int:
    """Return the number of dimensions of a shape; UnknownName, which names `where`, if it is none of these."""
    require_known(f"shape of {where}:", kind, SIZES)
    return SIZES[kind]


def solid_of(kind: str, size: tuple[float, ...], pose: Pose, where: str) -> Shape:
    """Return a shape by its kind and dimensions; InvalidValue names `where`."""
    try:
        return shape_of(kind, size, pose)
    except InvalidValue as error:
        raise InvalidValue(f"{where}: {error}") from None


def _poses(message: Entry, what: str, count: int) -> list[Pose]:
    """Return the poses of things of a kind; BrokenFile unless there are that many."""
    poses = message.parts(f"{what}_poses")
    if len(poses) != count:
        raise BrokenFile(f"{message.where} must have a pose for each {what}, got {count} and {len(poses)}")
    return [message_pose(each) for each in poses]


def _mesh(message: Entry) -> TriangleMesh:
    """Return a mesh: vertices, and triangles by their ``vertex_indices``."""
    if not {"vertices", "triangles"} <= message.content.keys():
        raise InvalidValue(f"{message.where} must have vertices and triangles, got {shown(message.content)}")
    vertices, triangles = (
        np.array([numbers(_row(each), 3, f"{what} of {message.where}") for each in message.entries(key)]).reshape(-1, 3)
        for key, what in (("vertices", "a vertex"), ("triangles", "a triangle"))
    )
    if (broken := triangles != np.rint(triangles)).any():
        raise InvalidValue(f"{message.where} must have whole vertex_indices, got {triangles[broken][0]:g}")
    try:
        return TriangleMesh(vertices, triangles.astype(int))
    except InvalidValue as error:
        raise InvalidValue(f"{message.where}: {error}") from None


def _row(entry: object) -> object:
    """Return a vertex or a triangle as a list of numbers."""
    if not isinstance(entry, Mapping):
        return entry
    return entry["vertex_indices"] if "vertex_indices" in entry else [entry.get(letter) for letter in "xyz"]
