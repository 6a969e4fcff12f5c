"""Triangles of STL, OBJ and COLLADA files."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from evenroad_verify.errors import Floats, Ints, Pose, number, numbers, require
from evenroad_verify.files import attribute, only, parse_xml, required
from evenroad_verify.shapes import Shape, rotation_about, surface

_STL = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
_DEEPEST = 50


def read_mesh(data: bytes, name: str, scale: Floats) -> list[Shape]:
    """Return the surfaces of a file: one of an STL or OBJ, one for each mesh that stands in a COLLADA file."""
    suffix = Path(name).suffix.lower()
    require(suffix in (".stl", ".obj", ".dae"), f"meshes are STL, OBJ or DAE, not {name}")
    if suffix == ".dae":
        parts = [surface(triangles, at, scale) for triangles, at in _collada(data, name) if len(triangles)]
        require(parts, f"{name} has no triangles")
        return parts
    count = int.from_bytes(data[80:84], "little")
    if suffix == ".stl" and len(data) == 84 + 50 * count > 84:
        triangles = np.frombuffer(data[84:], _STL)["corners"].astype(float)
    else:
        lines = [line.split() for line in data.decode("utf-8", "replace").splitlines()]
        triangles = _obj(lines) if suffix == ".obj" else _text_stl(lines)
    return [surface(triangles, (np.eye(3), np.zeros(3)), scale)]


def _text_stl(lines: list[list[str]]) -> Floats:
    inside = [line for line in lines if line[:1] not in (["solid"], ["endsolid"])]
    require(all("vertex" not in line[1:] for line in inside), "an STL has more than a corner in one line")
    corners = [numbers(line[1:], 3) for line in inside if line[:1] == ["vertex"]]
    require(len(corners) % 3 == 0, "an STL has a triangle without three corners")
    return np.array(corners, float).reshape(-1, 3, 3)


def _obj(lines: list[list[str]]) -> Floats:
    corners = np.array([numbers(line[1:4], 3) for line in lines if line[:1] == ["v"]], float).reshape(-1, 3)
    faces, count = [], 0
    for line in lines:
        count += line[:1] == ["v"]
        if line[:1] == ["f"]:
            at = [int(number(each.split("/")[0])) for each in line[1:]]
            require(0 not in at, "an OBJ has a corner 0: they are counted from 1")
            faces.append([each - 1 if each > 0 else count + each for each in at])
    return corners[_fans(faces, len(corners))]


def _fans(faces: list[list[int]], corners: int) -> Ints:
    """Return the triangles of polygons, each as a fan about its first corner."""
    require(all(len(face) > 2 and min(face) >= 0 and max(face) < corners for face in faces), "a mesh has a broken face")
    fans = [(face[0], face[i], face[i + 1]) for face in faces for i in range(1, len(face) - 1)]
    return np.array(fans, np.int64).reshape(-1, 3)


def _collada(data: bytes, name: str) -> Iterator[tuple[Floats, Pose]]:
    """Yield the triangles of each mesh as the file has them, and the affine map, in metres, of the nodes above it."""
    root = parse_xml(data, name)
    ids = {each.get("id"): each for each in root.iter() if each.get("id")}
    asset = only(root, "asset")
    unit = None if asset is None else only(asset, "unit")
    metre = 1.0 if unit is None else number(unit.get("meter", "1"))
    require(1e-6 < metre < 1e6, f"{name} has an unknown unit")
    scene = root.find("scene/instance_visual_scene")
    budget = [len(data)]
    for node in _target(ids, attribute(scene, "url")).findall("node"):
        for geometry, (turn, shift) in _instances(ids, node, (np.eye(3), np.zeros(3)), 0):
            triangles = _triangles(ids, geometry)
            budget[0] -= len(triangles)
            require(budget[0] > 0, f"{name} has more triangles than bytes")
            yield triangles, (metre * turn, metre * shift)


def _target(ids: dict[str | None, ET.Element], url: str) -> ET.Element:
    require(url[:1] == "#" and url[1:] in ids, f"a mesh refers to {url[:60]!r}, which it lacks")
    return ids[url[1:]]


def _instances(
    ids: dict[str | None, ET.Element], node: ET.Element, at: Pose, depth: int
) -> Iterator[tuple[ET.Element, Pose]]:
    """Yield the geometries below a node, and the affine map of each."""
    require(depth < _DEEPEST, "a mesh has nodes in nodes without end")
    for step in node:
        if step.tag in ("matrix", "translate", "rotate", "scale"):
            turn, shift = _step(step.tag, str(step.text or ""))
            at = at[0] @ turn, at[0] @ shift + at[1]
        require(step.tag not in ("lookat", "skew", "instance_controller"), f"a mesh has a <{step.tag}>")
    for each in node:
        if each.tag == "node":
            yield from _instances(ids, each, at, depth + 1)
        elif each.tag == "instance_node":
            yield from _instances(ids, _target(ids, attribute(each, "url")), at, depth + 1)
        elif each.tag == "instance_geometry":
            yield _target(ids, attribute(each, "url")), at


def _step(kind: str, text: str) -> Pose:
    values = numbers(text, {"matrix": 16, "rotate": 4}.get(kind, 3))
    if kind == "matrix":
        return values.reshape(4, 4)[:3, :3], values.reshape(4, 4)[:3, 3]
    if kind == "rotate":
        axis = values[:3] / max(1e-300, float(np.linalg.norm(values[:3])))
        return rotation_about(axis, np.radians(values[3:]))[0], np.zeros(3)
    return (np.eye(3), values) if kind == "translate" else (np.diag(values), np.zeros(3))


def _triangles(ids: dict[str | None, ET.Element], geometry: ET.Element) -> Floats:
    """Return all triangles of a geometry: a closed surface may be of several parts, one for each material."""
    mesh = required(geometry, "mesh")
    unknown = {part.tag for part in mesh} & {"trifans", "tristrips"}
    require(not unknown, f"a mesh has {', '.join(unknown)}")
    parts = [_part(ids, part) for part in mesh if part.tag in ("triangles", "polylist", "polygons")]
    return np.concatenate([np.zeros((0, 3, 3)), *parts])


def _part(ids: dict[str | None, ET.Element], part: ET.Element) -> Floats:
    inputs = {each.get("semantic"): each for each in part.findall("input")}
    require(part.find("ph") is None, "a mesh has polygons with holes")
    # Several inputs may have one semantic, as sets of texture coordinates do.
    wide = 1 + max(int(number(each.get("offset", "0"))) for each in part.findall("input"))
    vertices = _target(ids, attribute(inputs.get("VERTEX"), "source"))
    position = next((each for each in vertices.findall("input") if each.get("semantic") == "POSITION"), None)
    source = _target(ids, attribute(position, "source"))
    accessor, array = source.find("technique_common/accessor"), source.find("float_array")
    require(accessor is None or accessor.get("stride", "3") == "3", "a mesh has corners of other than 3 numbers")
    words = str("" if array is None else array.text).split()
    corners = numbers(words, len(words) // 3 * 3).reshape(-1, 3)
    offset, rows = int(number(inputs["VERTEX"].get("offset", "0"))), []
    for p in part.findall("p"):
        rows.append(np.array([int(number(word)) for word in str(p.text or "").split()], np.int64)[offset::wide])
    if part.tag == "polygons":
        return corners[_fans([row.tolist() for row in rows], len(corners))]
    every = np.concatenate(rows) if rows else np.zeros(0, np.int64)
    counts = np.full(len(every) // 3, 3)
    if part.tag == "polylist":
        counts = np.array([int(number(word)) for word in str(part.findtext("vcount") or "").split()], np.int64)
    require(counts.sum() == len(every) and (counts > 2).all(), "a mesh has a broken face")
    return corners[_fans([face.tolist() for face in np.split(every, np.cumsum(counts)[:-1])], len(corners))]
