"""Readers of polygons: GeoJSON, and the parking cases of TPCAP."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import as_file, counted
from evenroad._files import Json, read_json_file, read_known
from evenroad.errors import BrokenFile, UnknownName, shown

GEOJSON, PARKING = (".geojson", ".json"), (".csv",)
SUFFIXES = (*GEOJSON, *PARKING)
"""Suffixes of files of polygons."""
_AREAS = {"Polygon": 0, "MultiPolygon": 1}
_LINES = {"LineString": 0, "MultiLineString": 1}
_POINTS = ("Point", "MultiPoint")
_GEOMETRIES = (*_AREAS, *_LINES, *_POINTS, "GeometryCollection")
_NAMES = ("name", "id")
"""Properties that name a feature, the first that there is."""
_DEEPEST = 20
"""Largest number of collections around each other."""


@dataclass(frozen=True)
class PolygonFile:
    """What a file says of obstacles: the borders of each, its name, points that belong on the map, notes, and bounds.

    Bounds are the least and the largest x and y of the map, (2, 2), where the file has some.
    """

    borders: tuple[tuple[Floats, ...], ...]
    names: tuple[str, ...]
    points: Floats
    notes: tuple[str, ...] = ()
    bounds: Floats | None = None


@dataclass(frozen=True)
class ParkingFile:
    """A parking case of TPCAP: start and goal of the middle of the rear axle, (3,) each, and polygons, (n, 2) each."""

    start: Floats
    goal: Floats
    polygons: tuple[Floats, ...]


def read_polygons(path: str | os.PathLike[str]) -> PolygonFile:
    """Return the polygons of a file, by its suffix; UnknownName for another one, BrokenFile for what it is not."""
    file = as_file("polygons", path, "polygons of arrays are PolygonMap([corners, ...])")
    suffix = file.suffix.lower()
    if suffix in GEOJSON:
        return _read_geojson(file)
    if suffix in PARKING:
        case = read_parking(file)
        names = tuple(f"polygon {number}" for number in range(len(case.polygons)))
        points = np.stack([case.start[:2], case.goal[:2]])
        return PolygonFile(tuple((polygon,) for polygon in case.polygons), names, points)
    raise UnknownName.among(f"kind of file of polygons {os.fspath(path)!r}: suffix", suffix, SUFFIXES)


def read_parking(file: Path) -> ParkingFile:
    """Return a parking case: start and goal, x y angle each, the number of polygons, their sizes, and all corners."""
    text = read_known(file, "parking case").decode(errors="replace").strip().rstrip(",")
    try:
        numbers = np.array([float(each) for each in text.replace("\n", ",").split(",")])
    except ValueError:
        raise BrokenFile(f"{file} is no parking case of TPCAP: it must be numbers alone, separated by commas") from None
    count = numbers[6] if len(numbers) > 6 else np.nan
    is_whole = np.isfinite(numbers).all() and count == np.floor(count) and 0 <= count <= len(numbers) - 7
    sizes = numbers[7 : 7 + int(count)] if is_whole else np.zeros(0)
    if not is_whole or (sizes != np.floor(sizes)).any() or (sizes < 2).any():
        raise BrokenFile(
            f"{file} is no parking case of TPCAP: start and goal must be followed by the number of polygons and their"
            " numbers of corners, finite and >= 2"
        )
    corners = numbers[7 + int(count) :]
    if len(corners) != 2 * sizes.sum():
        raise BrokenFile(f"{file} has {len(corners)} coordinates, but its polygons need {int(2 * sizes.sum())}")
    polygons = tuple(np.split(corners.reshape(-1, 2), np.cumsum(sizes.astype(int))))[:-1]
    return ParkingFile(numbers[:3], numbers[3:6], polygons)


def _read_geojson(file: Path) -> PolygonFile:
    document = read_json_file(file, "map of polygons")
    borders: list[tuple[Floats, ...]] = []
    names: list[str] = []
    points = 0
    for geometry, name in _geometries(document, file, "", 0):
        kind = geometry["type"]
        if kind in _POINTS:
            points += 1
            continue
        coordinates = geometry.get("coordinates")
        depth = _AREAS.get(str(kind), _LINES.get(str(kind), 0))
        shapes = _list_of(coordinates, file, str(kind)) if depth else [coordinates]
        for shape in shapes:
            found = _area(shape, file, str(kind)) if kind in _AREAS else _line(shape, file, str(kind))
            if found:
                borders.append(found)
                names.append(name or f"polygon {len(names)}")
    notes = (f"{counted(points, 'point')} of {file} are no obstacles",) if points else ()
    return PolygonFile(tuple(borders), tuple(names), np.empty((0, 2)), notes, _bounds_of(document, file))


def _bounds_of(document: Json, file: Path) -> Floats | None:
    """Return the `bbox` of a file as least and largest x and y, (2, 2): numbers for x and y, or for heights as well."""
    box = document.get("bbox") if isinstance(document, dict) else None
    if box is None:
        return None
    try:
        numbers = np.array(box, dtype=np.float64)
    except (TypeError, ValueError):
        numbers = np.zeros(0)
    if numbers.shape not in ((4,), (6,)) or not np.isfinite(numbers).all():
        raise BrokenFile(f"{file} is not GeoJSON: bbox must be four or six finite numbers, got {shown(box)}")
    bounds = numbers.reshape(2, -1)[:, :2]
    if not (bounds[0] < bounds[1]).all():
        raise BrokenFile(f"{file}: bbox must be the least x and y before the largest, got {shown(box)}")
    return bounds


def _geometries(node: Json, file: Path, name: str, depth: int) -> Iterator[tuple[Mapping[str, Json], str]]:
    """Yield each geometry of a GeoJSON value, and the name of its feature."""
    kind = node.get("type") if isinstance(node, dict) else None
    if not isinstance(node, dict) or not isinstance(kind, str) or depth > _DEEPEST:
        raise BrokenFile(f"{file} is not GeoJSON: an object with a type must be where {shown(node)} is")
    if kind == "FeatureCollection":
        for each in _list_of(node.get("features"), file, kind):
            yield from _geometries(each, file, "", depth + 1)
    elif kind == "GeometryCollection":
        for each in _list_of(node.get("geometries"), file, kind):
            yield from _geometries(each, file, name, depth + 1)
    elif kind == "Feature":
        if node.get("geometry") is not None:
            yield from _geometries(node["geometry"], file, _name_of(node), depth + 1)
    elif kind in _GEOMETRIES:
        yield node, name
    else:
        raise BrokenFile(str(UnknownName.among(f"type in {file}:", kind, (*_GEOMETRIES, "Feature"))))


def _name_of(feature: Mapping[str, Json]) -> str:
    properties = feature.get("properties")
    own = properties if isinstance(properties, dict) else {}
    found = next((own[key] for key in _NAMES if isinstance(own.get(key), str | int)), feature.get("id", ""))
    return str(found)


def _list_of(value: Json, file: Path, kind: str) -> Sequence[Json]:
    if not isinstance(value, list):
        raise BrokenFile(f"{file} is not GeoJSON: a {kind} must have a list where {shown(value)} is")
    return value


def _area(rings: Json, file: Path, kind: str) -> tuple[Floats, ...]:
    """Return the borders of a polygon: its outline and those of its holes."""
    return tuple(_positions(ring, file, kind) for ring in _list_of(rings, file, kind))


def _line(positions: Json, file: Path, kind: str) -> tuple[Floats, ...]:
    """Return the segments of a line, as borders without an area."""
    corners = _positions(positions, file, kind)
    return tuple(corners[i : i + 2] for i in range(len(corners) - 1) if (corners[i] != corners[i + 1]).any())


def _positions(value: Json, file: Path, kind: str) -> Floats:
    """Return positions as x and y, (n, 2); a height is left out."""
    try:
        rows = [(float(x), float(y)) for x, y, *_ in value]
    except (TypeError, ValueError):
        rows = []
    if not rows:
        raise BrokenFile(f"{file} is not GeoJSON: a {kind} must have positions [x, y] where {shown(value)} is")
    return np.array(rows)
