"""Reading one entry of a scene's file: an obstacle, or those of a file that it includes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from evenroad._checks import require_known, require_positive
from evenroad._files import open_file
from evenroad._npz import read_array, reading
from evenroad._yaml import numbers, require_keys
from evenroad.errors import BrokenFile, InvalidValue, UnknownName, shown
from evenroad.geometry.cloud_file import load_cloud
from evenroad.geometry.mesh import TriangleMesh, convex_hull, height_map
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import CLOUD_RADIUS, PRIMITIVES, Mesh, PointCloud, Shape, shape_of
from evenroad.robots.planes import Plane
from evenroad.scenes.scan import without_shapes
from evenroad.scenes.scene import MARGIN, Cut, Obstacle, Seen
from evenroad.scenes.scene_objects import objects_of

POSE = ("xyz", "rpy", "xyzw")
_OPTIONAL = (*POSE, "cell", "clearance")
_OF_A_CLOUD = ("seen_at", "margin", "cut")
PLANE, HEIGHTS = "plane", "height_map"
_MEANT = {
    **dict.fromkeys(("half_space", "halfspace", "floor", "ground"), "shape: plane is all that is below it"),
    **dict.fromkeys(("hull", "convex", "convex_hull"), "shape: mesh with convex: true is the hull of a file"),
    **dict.fromkeys(("points", "pointcloud", "point_cloud"), "shape: cloud has the points of a file"),
    **dict.fromkeys(("heightmap", "height_field", "heightfield"), "shape: height_map has the heights of a file"),
    **dict.fromkeys(("octomap", "octree"), "include: FILE.bt has the boxes of an OctoMap"),
}
"""What others call a shape -> how it is given here."""


def obstacles_of(name: str, entry: dict[str, Any], path: Path) -> tuple[Obstacle, ...]:
    """Return the obstacles of an entry, one or those of the file that it includes, with its clearance."""
    where = f"obstacle {name!r} in {path}"
    made = _included(name, entry, path, where) if "include" in entry else (obstacle_of(name, entry, path),)
    if "clearance" not in entry:
        return made
    (clearance,) = numbers(entry["clearance"], 1, f"clearance of {where}")
    return tuple(replace(each, clearance=clearance) for each in made)


def _included(name: str, entry: dict[str, Any], path: Path, where: str) -> tuple[Obstacle, ...]:
    require_keys(entry, ("include",), (*_OPTIONAL, "joints", "convex"), where)
    joints = mapping_of(entry.get("joints"), f"joints of {where}")
    values = {joint: numbers(value, 1, f"joint {joint!r} of {where}")[0] for joint, value in joints.items()}
    file = _file({"file": entry["include"]}, path, where)
    bodies, frame = objects_of(file, values, convex=_yes("convex", entry, where)), _pose(entry, where)
    names = {part: f"{name}/{part}" if len(bodies) > 1 else name for part in bodies}
    return tuple(
        Obstacle(names[part], replace(body, pose=frame @ body.pose), _yes("cell", entry, where))
        for part, body in bodies.items()
    )


def obstacle_of(
    name: str, entry: dict[str, Any], path: Path, where: str = "", optional: tuple[str, ...] = _OPTIONAL
) -> Obstacle:
    """Return the obstacle of an entry; `where` names it in errors, and `optional` are keys that any shape may have."""
    where = where or f"obstacle {name!r} in {path}"
    if "quaternion" in entry:
        raise UnknownName(f"{where} must have its quaternion as xyzw: [x, y, z, w], in this order, not as quaternion")
    shape = entry.get("shape")
    kinds = (*PRIMITIVES, PointCloud.kind, Mesh.kind, PLANE, HEIGHTS)
    if "shape" not in entry:
        raise BrokenFile(f"{where} lacks its shape, one of {', '.join(sorted(kinds))}")
    if not isinstance(shape, str) or shape not in kinds:
        if isinstance(shape, str) and shape in _MEANT:
            raise UnknownName(f"unknown shape of {where}: {shown(shape)}; {_MEANT[shape]}")
        raise UnknownName.among(f"shape of {where}:", shape, kinds)
    cell = _yes("cell", entry, where)
    if shape == PointCloud.kind:
        return _cloud(name, entry, path, cell)
    if shape == PLANE:
        require_keys(entry, ("shape",), optional, where)
        pose = _pose(entry, where)
        return Obstacle(name, Plane(name, pose.xyz, pose.rotation).body, cell=cell)
    if shape == HEIGHTS:
        require_keys(entry, ("shape", "file", "spacing"), ("depth", *optional), where)
        return Obstacle(name, Mesh(_heights(entry, path, where), pose=_pose(entry, where)), cell)
    if shape == Mesh.kind:
        require_keys(entry, ("shape", "file"), (*optional, "scale", "convex"), where)
        scale = entry.get("scale", 1)
        x, y, z = numbers(scale if isinstance(scale, list) else [scale] * 3, 3, f"scale of {where}")
        mesh = Mesh(_file(entry, path, where), (x, y, z), pose=_pose(entry, where))
        if _yes("convex", entry, where):
            mesh = Mesh(convex_hull(mesh.triangles.vertices, mesh.source.name), pose=mesh.pose)
        return Obstacle(name, mesh, cell)
    dimensions = PRIMITIVES[shape].dimensions
    require_keys(entry, ("shape", *(key for key, _ in dimensions)), optional, where)
    size: tuple[float, ...] = ()
    for key, count in dimensions:
        size += numbers(entry[key], count, f"{key} of {where}")
    for value in size:
        require_positive(f"the size of {where}", value)
    return Obstacle(name, shape_of(shape, size, _pose(entry, where)), cell)


def _cloud(name: str, entry: dict[str, Any], path: Path, cell: bool) -> Obstacle:
    where = f"obstacle {name!r} in {path}"
    require_keys(entry, ("shape", "file"), ("radius", *_OPTIONAL, *_OF_A_CLOUD), where)
    (radius,) = numbers(entry.get("radius", CLOUD_RADIUS), 1, f"radius of {where}")
    require_positive(f"the radius of {where}", radius)
    (margin,) = numbers(entry.get("margin", MARGIN), 1, f"margin of {where}")
    seen_at = entry.get("seen_at")
    if seen_at is not None and not isinstance(seen_at, str):
        raise InvalidValue(f"seen_at of {where} must be the name of a state or a text as for --start, got {seen_at!r}")
    if seen_at is None and "margin" in entry:
        raise InvalidValue(f"margin of {where} goes with seen_at: where the robot stood")
    seen = None if seen_at is None else Seen(seen_at, margin)
    body = PointCloud(load_cloud(_file(entry, path, where)), radius, pose=_pose(entry, where))
    cuts, rows = [], entry.get("cut", [])
    if not isinstance(rows, list):
        raise InvalidValue(f"cut of {where} must be a list of what is taken out, got {shown(rows)}")
    for row in rows:
        cut = mapping_of(row, f"cut of {where}")
        if "attached" in cut:
            require_keys(cut, ("attached", "at"), ("grow",), f"cut of {where}")
            (grow,) = numbers(cut.get("grow", MARGIN), 1, f"grow in cut of {where}")
            cuts.append(Cut(str(cut["attached"]), str(cut["at"]), grow))
            continue
        shape, grow = region_of({key: cut[key] for key in cut if key != "grow"}, cut, f"cut of {where}", path)
        left = without_shapes(body, [shape], grow)
        if left is None:
            raise InvalidValue(f"cut of {where} leaves nothing of the cloud")
        body = left
    return Obstacle(name, body, cell, seen, tuple(cuts))


def region_of(entry: object, more: dict[str, Any], where: str, path: Path) -> tuple[Shape, float]:
    """Return a region, and by how much it grows as `more` says."""
    region = mapping_of(entry, where)
    require_known(f"shape of {where}:", str(region.get("shape")), PRIMITIVES)
    (grow,) = numbers(more.get("grow", 0.0), 1, f"grow of {where}")
    return obstacle_of("region", region, path, where, POSE).body, require_positive(
        f"grow of {where}", grow, or_zero=True
    )


def _heights(entry: dict[str, Any], path: Path, where: str) -> TriangleMesh:
    """Return the ground under the heights of a .npy, (x, y): as deep as the map is wide, or as the entry says."""
    file = _file(entry, path, where)
    (spacing,) = numbers(entry["spacing"], 1, f"spacing of {where}")
    require_positive(f"spacing of {where}", spacing)
    with reading(file, ".npy of heights", b"\x93NUMPY"), open_file(file) as stream:
        heights = read_array(stream, file.stat().st_size)
    (depth,) = numbers(entry.get("depth", spacing * max(np.shape(heights), default=0)), 1, f"depth of {where}")
    return height_map(heights, spacing, depth=require_positive(f"depth of {where}", depth, or_zero=True))


def _pose(entry: dict[str, Any], where: str) -> Pose:
    """Return the pose that an entry has."""
    xyz = numbers(entry.get("xyz", [0, 0, 0]), 3, f"xyz of {where}")
    if "rpy" in entry and "xyzw" in entry:
        raise InvalidValue(f"{where} must have one of rpy and xyzw, got both")
    if "xyzw" in entry:
        quaternion = numbers(entry["xyzw"], 4, f"the quaternion xyzw of {where}")
        try:
            return Pose.from_quaternion(xyz, xyzw=quaternion)
        except InvalidValue as error:
            raise InvalidValue(f"{where}: {error}") from None
    return Pose.from_rpy(xyz, numbers(entry["rpy"], 3, f"rpy of {where}")) if "rpy" in entry else Pose(xyz)


def _file(entry: dict[str, Any], path: Path, where: str) -> Path:
    """Return the file that an entry names, beside the scene."""
    if not isinstance(entry["file"], str):
        raise InvalidValue(f"file of {where} must be the name of a file, got {entry['file']!r}")
    file = path.parent / entry["file"]
    if not file.is_file():
        raise BrokenFile(f"the file {file} of {where} is missing")
    return file


def _yes(key: str, entry: dict[str, Any], where: str) -> bool:
    value = entry.get(key, False)
    if not isinstance(value, bool):
        raise InvalidValue(f"{key} of {where} must be true or false, got {value!r}")
    return value


def mapping_of(value: object, where: str) -> dict[str, Any]:
    """Return a mapping with texts as keys, empty for None; BrokenFile, which names `where`, if it is none."""
    if value is None:
        return {}
    if not isinstance(value, Mapping):
        raise BrokenFile(f"{where} must consist of 'key: value' entries, got {value!r}")
    return {str(key): entry for key, entry in value.items()}
