"""Reading MoveIt's planning scenes in YAML, as MotionBenchMaker and ``ros2 topic echo`` write them.

Of the world boxes, spheres, cylinders and meshes are read, in the order of their operations; what is attached; and
which contacts of objects are allowed.  What else a planning scene may say is refused where it
could be an obstacle, and passes where it is none.  Quaternions are (x, y, z, w), lengths metres.  An object of several
shapes becomes obstacles ``NAME/0``, ``NAME/1``, ...
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from evenroad._understood import Kind, require_understood
from evenroad._yaml import numbers
from evenroad.errors import BrokenFile, InvalidValue, UnknownName, shown
from evenroad.geometry.mesh import TriangleMesh
from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.geometry.shapes import Mesh, Shape, shape_of
from evenroad.robots.held import HeldObject
from evenroad.scenes.moveit_scene import SIZES, dimensions_of, pose_of
from evenroad.scenes.scene import Obstacle, Scene

_TYPES = {1: "box", 2: "sphere", 3: "cylinder", 4: "cone"}
"""Numbers of shape_msgs/SolidPrimitive."""
_ADD, _REMOVE, _APPEND, _MOVE = "add", "remove", "append", "move"
_OPERATIONS = {0: _ADD, 1: _REMOVE, 2: _APPEND, 3: _MOVE}
"""Numbers of moveit_msgs/CollisionObject."""
_PLANNING_FRAMES = ("", "world")
"""Frames that are the robot's root link wherever a file does not say more."""

_XYZ = Kind(("x", "y", "z"))
_POSE = Kind(parts={"position": _XYZ, "orientation": Kind(("x", "y", "z", "w"))})
_HEADER = Kind(("frame_id",), harmless={"stamp", "seq"})
_OBJECT = Kind(
    ("id", "operation", "subframe_names"),
    {
        "header": _HEADER,
        "pose": _POSE,
        "primitives": Kind(("type", "dimensions"), harmless={"polygon"}),
        "meshes": Kind(parts={"vertices": _XYZ, "triangles": Kind(("vertex_indices",))}, harmless={"resource"}),
        "planes": Kind(("coef",)),
        "primitive_poses": _POSE,
        "mesh_poses": _POSE,
        "plane_poses": _POSE,
        "subframe_poses": _POSE,
    },
    harmless={"type"},
)
_ATTACHED = Kind(("link_name", "touch_links"), {"object": _OBJECT}, harmless={"detach_posture", "weight"})
_OCTOMAP = Kind(
    parts={"header": _HEADER, "octomap": Kind(("data",), {"header": _HEADER}, harmless={"binary", "id", "resolution"})},
    harmless={"origin"},
)
_SCENE = Kind(
    ("name", "is_diff"),
    {
        "world": Kind(parts={"collision_objects": _OBJECT, "octomap": _OCTOMAP}),
        "robot_state": Kind(
            parts={"attached_collision_objects": _ATTACHED},
            harmless={"joint_state", "multi_dof_joint_state", "is_diff"},
        ),
        "link_padding": Kind(("link_name", "padding")),
        "link_scale": Kind(("link_name", "scale")),
        "allowed_collision_matrix": Kind(
            ("entry_names", "default_entry_names", "default_entry_values"), {"entry_values": Kind(("enabled",))}
        ),
        "fixed_frame_transforms": Kind(
            ("child_frame_id",),
            {"header": _HEADER, "transform": Kind(parts={"translation": _XYZ, "rotation": Kind(("x", "y", "z", "w"))})},
        ),
    },
    harmless={"robot_model_name", "object_colors"},
)


@dataclass
class _Object:
    """An object while a scene is read: its pose, and its shapes in its own frame, by the names that they get."""

    pose: Pose
    shapes: list[Shape] = field(default_factory=list)
    subframes: dict[str, Pose] = field(default_factory=dict)

    def named(self, name: str) -> dict[str, Shape]:
        """Return its shapes where they are, by names of their own."""
        solid = [each for each in self.shapes if not isinstance(each, Mesh)]
        meshes = [each for each in self.shapes if isinstance(each, Mesh)]
        if len(self.shapes) == 1:
            return {name: self._placed(self.shapes[0])}
        # A lone solid shape keeps the object's name beside meshes, too.
        names = [name] if len(solid) == 1 else [f"{name}/{i}" for i in range(len(solid))]
        names += [f"{name}/mesh{i}" for i in range(len(meshes))]
        return {own: self._placed(each) for own, each in zip(names, (*solid, *meshes), strict=True)}

    def _placed(self, shape: Shape) -> Shape:
        return replace(shape, pose=self.pose @ shape.pose)


def read_planning_scene(document: Mapping[str, Any], path: Path) -> Scene:
    """Return the scene of a planning scene that was read from YAML.

    Raises UnknownName for what a planning scene does not have, a shape that is not read, and a frame that the file does
    not place; BrokenFile for a part of another type, and where numbers of shapes and poses differ; InvalidValue for a
    value out of its range, a plane, an octomap that is not empty, and links that are padded or scaled.
    """
    where = f"the planning scene {path}"
    _require_lists(document, _SCENE, where)
    require_understood(document, _SCENE, where)
    if document.get("is_diff") is True:
        raise InvalidValue(f"{where} is a difference (is_diff: true) from another one: write the whole scene")
    _require_plain_links(document, where)
    world = document["world"]
    if ((world.get("octomap") or {}).get("octomap") or {}).get("data"):
        raise InvalidValue(f"{where} has an octomap: write it with octomap's tools and include it, include: FILE.bt")
    objects = _objects(world.get("collision_objects") or [], _frames(document, path), path)
    obstacles = {own: body for name, each in objects.items() for own, body in each.named(name).items()}
    state = document.get("robot_state") or {}
    attached = [held for each in state.get("attached_collision_objects") or [] for held in _held(each, path)]
    groups = {name: list(each.named(name)) for name, each in objects.items()}
    return Scene(
        [Obstacle(own, body) for own, body in obstacles.items()],
        name=str(document.get("name") or path.stem),
        allowed=frozenset(_allowed(document.get("allowed_collision_matrix") or {}, groups, where)),
        attached=tuple(attached),
    )


def _require_lists(document: Mapping[str, Any], kind: Kind, where: str) -> None:
    """Raise BrokenFile where something that has parts is neither a mapping nor a list of mappings or numbers."""
    waiting: list[tuple[Any, Kind]] = [(document, kind)]
    while waiting:
        value, kind = waiting.pop()
        for name, inner in kind.parts.items():
            part = value.get(name)
            if part is None and name != "world":
                continue
            entries = part if isinstance(part, list) else [part]
            if name in ("position", "orientation", "vertices", "triangles", "translation", "rotation"):
                continue  # Numbers by their letters or as a list: their readers say what is wrong.
            if name == "world" and not isinstance(part, Mapping):
                raise BrokenFile(f"'world' in {where} must consist of 'key: value' entries, got {shown(part)}")
            for each in entries:
                if not isinstance(each, Mapping):
                    raise BrokenFile(f"{name!r} in {where} must consist of 'key: value' entries, got {shown(each)}")
                waiting.append((each, inner))


def _frames(document: Mapping[str, Any], path: Path) -> dict[str, Pose]:
    """Return the frames that a file places in its planning frame, which is the robot's root link."""
    frames = dict.fromkeys(_PLANNING_FRAMES, IDENTITY)
    given = document.get("fixed_frame_transforms") or []
    frames |= {_frame_id(each): IDENTITY for each in given}
    for each in given:
        transform = each.get("transform") or {}
        pose = {"position": transform.get("translation"), "orientation": transform.get("rotation")}
        frames[str(each.get("child_frame_id"))] = _pose(pose, f"a fixed frame of {path}")
    return frames


def _frame_id(entry: Mapping[str, Any]) -> str:
    return str((entry.get("header") or {}).get("frame_id") or "")


def _objects(entries: list[Mapping[str, Any]], frames: dict[str, Pose], path: Path) -> dict[str, _Object]:
    """Return the objects that are there after all operations, by their names."""
    objects: dict[str, _Object] = {}
    unplaced: set[str] = set()
    for each in entries:
        name = _name_of(each, path)
        where = f"object {name!r} in {path}"
        operation = _operation(each, where)
        if operation == _REMOVE:
            objects = {own: kept for own, kept in objects.items() if name not in ("", own)}
            continue
        subframes = {
            f"{own}/{sub}": kept.pose @ pose for own, kept in objects.items() for sub, pose in kept.subframes.items()
        }
        known = frames | {own: kept.pose for own, kept in objects.items()} | subframes
        frame = known.get(_frame_id(each))
        if frame is None:
            # Without the robot nobody knows which link its planning frame is: one frame for all may be that.
            unplaced.add(_frame_id(each))
            if len(unplaced) > 1 or _has_own_frames(frames):
                unknown = UnknownName.among(f"frame of {where}:", _frame_id(each), [one for one in known if one])
                raise UnknownName(f"{unknown}; a link's place is said by fixed_frame_transforms")
            frame = IDENTITY
        made = _object(each, where)
        made.pose = frame @ made.pose
        if operation == _MOVE:
            if name not in objects or made.shapes:
                raise InvalidValue(f"{where} is moved: it must be there before, and have a pose alone")
            objects[name].pose = made.pose
        elif operation == _APPEND and name in objects:
            back = objects[name].pose.inverse()
            objects[name].shapes += [replace(shape, pose=back @ made.pose @ shape.pose) for shape in made.shapes]
        elif name in objects:
            raise InvalidValue(f"objects in {path} must have names of their own, twice: {name!r}")
        else:
            objects[name] = made
    if unplaced:
        warnings.warn(f"{path}: frame {unplaced.pop()!r} is taken as the robot's root link", stacklevel=5)
    return objects


def _has_own_frames(frames: Mapping[str, Pose]) -> bool:
    """Return whether a file says of frames where they are."""
    return len(frames) > len(_PLANNING_FRAMES)


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


def _object(entry: Mapping[str, Any], where: str) -> _Object:
    """Return an object of a message, in its frame."""
    if entry.get("planes"):
        raise InvalidValue(f"{where} must consist of {', '.join(SIZES)} and meshes: it has a plane")
    found = _Object(_pose(entry["pose"], where) if entry.get("pose") else IDENTITY)
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


def _held(entry: Mapping[str, Any], path: Path) -> list[HeldObject]:
    """Return the bodies of what is attached."""
    inside = entry.get("object") or {}
    name, link = _name_of(inside, path), entry.get("link_name")
    where = f"attached object {name!r} in {path}"
    if _operation(inside, where) == _REMOVE:
        return []
    if not isinstance(link, str) or not link:
        raise InvalidValue(f"{where} must have the link_name of what carries it, got {shown(link)}")
    if _frame_id(inside) not in ("", link):
        raise InvalidValue(f"{where} must be in the frame of its link {link!r}, got {shown(_frame_id(inside))}")
    touches = entry.get("touch_links") or []
    if not isinstance(touches, list) or not all(isinstance(each, str) for each in touches):
        raise InvalidValue(f"touch_links of {where} must be a list of links, got {shown(touches)}")
    bodies = _object(inside, where).named(name)
    if not bodies:
        raise InvalidValue(f"{where} has no shapes: write them, not its name alone")
    return [HeldObject(own, body, link, tuple(touches)) for own, body in bodies.items()]


def _require_plain_links(document: Mapping[str, Any], where: str) -> None:
    """Raise InvalidValue where links are padded or scaled: that is the robot's, which a scene does not have."""
    for kind, name, plain in (("link_padding", "padding", 0.0), ("link_scale", "scale", 1.0)):
        for each in document.get(kind) or []:
            link = each.get("link_name")
            (value,) = numbers(each.get(name), 1, f"{name} of link {link!r} in {where}")
            if value != plain:
                give = "give it to the robot: load_robot(file, padding=...) or --padding LINK=METRES"
                raise InvalidValue(
                    f"{where} has {kind} {value:g} of link {link!r}, which a scene does not hold; {give}"
                )


def _allowed(matrix: Mapping[str, Any], groups: Mapping[str, list[str]], where: str) -> set[tuple[str, str]]:
    """Return contacts of links and obstacles that a matrix allows; of two links the robot's own file says that."""
    names, rows = matrix.get("entry_names") or [], matrix.get("entry_values") or []
    enabled = [each.get("enabled") or [] for each in rows]
    if [len(names)] * len(names) != [len(row) for row in enabled]:
        raise BrokenFile(f"allowed_collision_matrix in {where} must have a row and a column for each of its names")
    for name, value in zip(
        matrix.get("default_entry_names") or [], matrix.get("default_entry_values") or [], strict=False
    ):
        if value and name in groups:
            raise InvalidValue(f"{where} allows {name!r} to touch everything by default: name the links that may")
    return {
        (str(link), obstacle)
        for i, link in enumerate(names)
        for k, name in enumerate(names)
        if enabled[i][k] is True and link not in groups and name in groups
        for obstacle in groups[name]
    }


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
