"""Reading MoveIt's scenes: text files ``.scene``, and planning scenes in YAML, as MotionBenchMaker has them.

Only the objects of the world are read: boxes, spheres and cylinders, in YAML meshes, too; in a planning frame that
must be the robot's root link.  Quaternions are (x, y, z, w) there.  An object of several shapes becomes obstacles
``NAME/0``, ``NAME/1``, ...
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from evenroad._checks import require_known
from evenroad._files import read_bytes
from evenroad._yaml import numbers
from evenroad.errors import BrokenFile, EvenroadError, InvalidValue, shown
from evenroad.geometry.mesh import TriangleMesh
from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.geometry.shapes import Mesh, shape_of
from evenroad.robot.scene import Obstacle, Scene

Numbers = tuple[float, ...]
_SIZES = {"box": 3, "sphere": 1, "cylinder": 2}
_TYPES = {1: "box", 2: "sphere", 3: "cylinder", 4: "cone"}
"""Numbers of shape_msgs/SolidPrimitive."""


def read_scene_text(path: Path) -> Scene:
    """Read a ``.scene`` file: a name, then objects that begin with ``*``, and a full stop.

    An object has a name, in newer files a pose, the number of its shapes, and each shape with its dimensions, pose and
    colour; in newer files subframes follow, which are skipped.  Raises BrokenFile if the file is missing or ends too
    early, or a number is none; UnknownName if a shape is none of box, sphere and cylinder; InvalidValue if a dimension
    is not > 0, a quaternion has no direction, or two objects share a name.
    """
    try:
        lines = read_bytes(path).decode().splitlines()
    except (OSError, ValueError) as error:
        raise BrokenFile(f"cannot read scene {path}: {getattr(error, 'strerror', None) or error}") from error
    return Scene(tuple(_from_text(lines, path)), name=lines[0].strip() or path.stem if lines else path.stem)


def _from_text(lines: list[str], path: Path) -> Iterator[Obstacle]:
    """Read the obstacles of a text, word by word."""
    first = next((i for i, line in enumerate(lines) if line.lstrip().startswith("*")), len(lines))
    # Newer files have the object's position, three numbers, where older ones have the number of its shapes.
    posed = first + 1 < len(lines) and len(lines[first + 1].split()) > 1
    rest = [line.split() for line in lines[1:]][::-1]

    def word(what: str) -> str:
        while rest and not rest[-1]:
            rest.pop()
        if not rest:
            raise BrokenFile(f"{path} ends where {what} must be")
        return rest[-1].pop(0)

    def row(count: int) -> Numbers:
        words = [word("a number") for _ in range(count)]
        try:
            return tuple(map(float, words))
        except ValueError:
            raise BrokenFile(f"{path} must have {count} number(s), got {' '.join(words)!r}") from None

    def how_many(what: str) -> range:
        count = word(f"the number of {what}")
        if not count.isdecimal() or len(count) > 6:
            raise BrokenFile(f"{path} must have a number of {what}, got {count!r}")
        return range(int(count))

    def pose() -> Pose:
        return _from_xyzw(row(3), row(4), str(path))

    while (marker := word("'*' or '.'")) != ".":
        if marker != "*":
            raise BrokenFile(f"{path} must have '*' before every object and '.' at its end, got {marker!r}")
        name = " ".join(rest.pop())
        frame = pose() if posed else IDENTITY
        shapes = []
        for _ in how_many("shapes"):
            kind = word("a shape")
            shapes.append((kind, row(_count(kind, name, path)), frame @ pose()))
            row(4)
        for _ in how_many("subframes") if posed else ():
            word("a subframe")
            pose()
        yield from _obstacles(name, shapes, path)


def read_planning_scene(document: Mapping[str, Any], path: Path) -> Scene:
    """Return the scene of a planning scene that was read from YAML: objects in ``world: collision_objects``.

    Raises as :func:`read_scene_text`; InvalidValue also if an object has a plane, or a mesh that is none.
    """
    world = document.get("world")
    if not isinstance(world, dict):
        raise BrokenFile(f"'world' in {path} must consist of 'key: value' entries, got {world!r}")
    obstacles: list[Obstacle] = []
    for each in world.get("collision_objects") or []:
        if not isinstance(each, dict) or "id" not in each:
            raise BrokenFile(f"every entry of collision_objects in {path} must have an 'id', got {each!r}")
        name = str(each["id"])
        if each.get("planes"):
            raise InvalidValue(
                f"object {name!r} in {path} must consist of {', '.join(_SIZES)} and meshes: it has a plane"
            )
        frame = _pose(each["pose"], name, path) if "pose" in each else IDENTITY
        primitives, poses = each.get("primitives") or [], each.get("primitive_poses") or []
        if len(primitives) != len(poses):
            raise BrokenFile(
                f"object {name!r} in {path} must have a pose for each primitive, got {len(primitives)} and {len(poses)}"
            )
        shapes = []
        for primitive, pose in zip(primitives, poses, strict=True):
            given = primitive.get("type") if isinstance(primitive, dict) else None
            kind = str(_TYPES.get(given, given)).lower()  # type: ignore[arg-type]
            count = _count(kind, name, path)
            size = numbers(primitive.get("dimensions"), count, f"dimensions of {name!r} in {path}")
            # Height and radius in messages, radius and length everywhere else.
            shapes.append((kind, size[::-1] if kind == "cylinder" else size, frame @ _pose(pose, name, path)))
        obstacles += _obstacles(name, shapes, path)
        meshes = [_mesh(entry, name, path) for entry in each.get("meshes") or []]
        poses = each.get("mesh_poses") or []
        if len(meshes) != len(poses):
            raise BrokenFile(
                f"object {name!r} in {path} must have a pose for each mesh, got {len(meshes)} and {len(poses)}"
            )
        for i, (mesh, pose) in enumerate(zip(meshes, poses, strict=True)):
            body = Mesh(mesh, pose=frame @ _pose(pose, name, path))
            alone = len(meshes) == 1 and not shapes
            obstacles.append(Obstacle(name if alone else f"{name}/mesh{i}", body))
    return Scene(tuple(obstacles), name=str(document.get("name") or path.stem))


def _mesh(entry: object, name: str, path: Path) -> TriangleMesh:
    """Return a mesh of a message: vertices, and triangles by their ``vertex_indices``."""
    where = f"a mesh of object {name!r} in {path}"
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
        return TriangleMesh(vertices, triangles.astype(int), name)
    except InvalidValue as error:
        raise InvalidValue(f"{where}: {error}") from None


def _obstacles(name: str, shapes: list[tuple[str, Numbers, Pose]], path: Path) -> Iterator[Obstacle]:
    for i, (kind, size, pose) in enumerate(shapes):
        try:
            body = shape_of(kind, size, pose)
        except InvalidValue as error:
            raise InvalidValue(f"object {name!r} in {path}: {error}") from None
        yield Obstacle(name if len(shapes) == 1 else f"{name}/{i}", body)


def _count(kind: str, name: str, path: Path) -> int:
    """Return the number of dimensions of a shape."""
    require_known(f"shape of object {name!r} in {path}:", kind, _SIZES)
    return _SIZES[kind]


def _pose(entry: object, name: str, path: Path) -> Pose:
    """Return a pose of a message: position and orientation, as lists or by their letters."""
    rows = []
    for key, letters in (("position", "xyz"), ("orientation", "xyzw")):
        row = entry.get(key) if isinstance(entry, dict) else None
        if isinstance(row, dict):
            row = [row.get(letter, 0.0) for letter in letters]
        rows.append(numbers(row, len(letters), f"{key} of object {name!r} in {path}"))
    return _from_xyzw(rows[0], rows[1], f"object {name!r} in {path}")


def _from_xyzw(xyz: Numbers, quaternion: Numbers, where: str) -> Pose:
    try:
        return Pose.from_quaternion(xyz, xyzw=quaternion)
    except EvenroadError as error:
        raise InvalidValue(f"{where}: {error}") from None
