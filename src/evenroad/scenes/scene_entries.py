"""Reading one entry of a scene's file: an obstacle, or those of a file that it includes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from evenroad._checks import require_known, require_positive
from evenroad._files import open_file
from evenroad._npz import read_array, reading
from evenroad._yaml import numbers
from evenroad.errors import BrokenFile, InvalidValue, UnknownName, shown
from evenroad.geometry.cloud_file import load_cloud
from evenroad.geometry.mesh import TriangleMesh, convex_hull, height_map
from evenroad.geometry.shapes import CLOUD_RADIUS, PRIMITIVES, Mesh, PointCloud, Shape, shape_of
from evenroad.robots.planes import Plane
from evenroad.scenes.entry import Entry
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
_KINDS = (*PRIMITIVES, PointCloud.kind, Mesh.kind, PLANE, HEIGHTS)


def obstacles_of(name: str, entry: Entry) -> tuple[Obstacle, ...]:
    """Return the obstacles of an entry, one or those of the file that it includes, with its clearance."""
    made = _included(name, entry) if "include" in entry else (obstacle_of(name, entry),)
    if "clearance" not in entry:
        return made
    return tuple(replace(each, clearance=entry.number("clearance")) for each in made)


def _included(name: str, entry: Entry) -> tuple[Obstacle, ...]:
    entry.require(("include",), (*_OPTIONAL, "joints", "convex"))
    joints = entry.inside(entry.get("joints"), f"joints of {entry.where}").content
    values = {joint: numbers(value, 1, f"joint {joint!r} of {entry.where}")[0] for joint, value in joints.items()}
    bodies, frame = objects_of(entry.file("include"), values, convex=entry.yes("convex")), entry.pose()
    names = {part: f"{name}/{part}" if len(bodies) > 1 else name for part in bodies}
    return tuple(
        Obstacle(names[part], replace(body, pose=frame @ body.pose), entry.yes("cell")) for part, body in bodies.items()
    )


def obstacle_of(name: str, entry: Entry, optional: tuple[str, ...] = _OPTIONAL) -> Obstacle:
    """Return the obstacle of an entry; `optional` are keys that any shape may have."""
    where, shape = entry.where, entry.get("shape")
    if "quaternion" in entry:
        raise UnknownName(f"{where} must have its quaternion as xyzw: [x, y, z, w], in this order, not as quaternion")
    if "shape" not in entry:
        raise BrokenFile(f"{where} lacks its shape, one of {', '.join(sorted(_KINDS))}")
    if isinstance(shape, str) and shape in _MEANT:
        raise UnknownName(f"unknown shape of {where}: {shown(shape)}; {_MEANT[shape]}")
    if not isinstance(shape, str) or shape not in _KINDS:
        raise UnknownName.among(f"shape of {where}:", shape, _KINDS)
    cell = entry.yes("cell")
    if shape == PointCloud.kind:
        return _cloud(name, entry, cell)
    if shape == PLANE:
        entry.require(("shape",), optional)
        pose = entry.pose()
        return Obstacle(name, Plane(name, pose.xyz, pose.rotation).body, cell=cell)
    if shape == HEIGHTS:
        entry.require(("shape", "file", "spacing"), ("depth", *optional))
        return Obstacle(name, Mesh(_heights(entry), pose=entry.pose()), cell)
    if shape == Mesh.kind:
        entry.require(("shape", "file"), (*optional, "scale", "convex"))
        scale = entry.get("scale", 1)
        x, y, z = numbers(scale if isinstance(scale, list) else [scale] * 3, 3, f"scale of {where}")
        mesh = Mesh(entry.file(), (x, y, z), pose=entry.pose())
        if entry.yes("convex"):
            mesh = Mesh(convex_hull(mesh.triangles.vertices, mesh.source.name), pose=mesh.pose)
        return Obstacle(name, mesh, cell)
    dimensions = PRIMITIVES[shape].dimensions
    entry.require(("shape", *(key for key, _ in dimensions)), optional)
    size = tuple(value for key, count in dimensions for value in entry.row(key, count))
    for value in size:
        require_positive(f"the size of {where}", value)
    return Obstacle(name, shape_of(shape, size, entry.pose()), cell)


def _cloud(name: str, entry: Entry, cell: bool) -> Obstacle:
    where, seen_at = entry.where, entry.get("seen_at")
    entry.require(("shape", "file"), ("radius", *_OPTIONAL, *_OF_A_CLOUD))
    if not isinstance(seen_at, str | None):
        raise InvalidValue(f"seen_at of {where} must be the name of a state or a text as for --start, got {seen_at!r}")
    if seen_at is None and "margin" in entry:
        raise InvalidValue(f"margin of {where} goes with seen_at: where the robot stood")
    seen = None if seen_at is None else Seen(seen_at, entry.number("margin", MARGIN))
    radius = entry.length("radius", CLOUD_RADIUS)
    body = PointCloud(load_cloud(entry.file()), radius, pose=entry.pose())
    cuts = []
    for row in entry.entries("cut"):
        cut = entry.inside(row, f"cut of {where}")
        if "attached" in cut:
            cut.require(("attached", "at"), ("grow",))
            cuts.append(Cut(str(cut.get("attached")), str(cut.get("at")), cut.number("grow", MARGIN)))
            continue
        left = without_shapes(body, [region_of(cut.without("grow"))], cut.length("grow", 0.0, or_zero=True))
        if left is None:
            raise InvalidValue(f"cut of {where} leaves nothing of the cloud")
        body = left
    return Obstacle(name, body, cell, seen, tuple(cuts))


def region_of(entry: Entry) -> Shape:
    """Return the shape of a region."""
    require_known(f"shape of {entry.where}:", str(entry.get("shape")), PRIMITIVES)
    return obstacle_of("region", entry, POSE).body


def _heights(entry: Entry) -> TriangleMesh:
    """Return the ground under the heights of a .npy, (x, y): as deep as the map is wide, or as the entry says."""
    file, spacing = entry.file(), entry.length("spacing")
    with reading(file, ".npy of heights", b"\x93NUMPY"), open_file(file) as stream:
        heights = read_array(stream, file.stat().st_size)
    widest = spacing * max(np.shape(heights), default=0)
    return height_map(heights, spacing, depth=entry.length("depth", widest, or_zero=True))
