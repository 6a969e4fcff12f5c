"""What a robot's file draws of its links, as bodies in the colours of its materials; kept between runs."""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import NamedTuple

import numpy as np

from evenroad import __version__
from evenroad._arrays import unique_rows
from evenroad._files import atomic_write, cache_folder, read_known
from evenroad._fingerprint import fingerprint_of
from evenroad._seal import read_sealed, sealed
from evenroad.errors import BrokenFile, EvenroadError
from evenroad.geometry.mesh import TriangleMesh, scaled
from evenroad.geometry.mesh_file import load_coloured
from evenroad.geometry.shapes import Mesh
from evenroad.loading.drawn import Drawn, read_drawn
from evenroad.loading.load import read_robot
from evenroad.loading.robot_file import RobotFile
from evenroad.viz.parts import PLAIN, joined, part_of_shape
from evenroad.viz.stage import Part, part_of

_GRAIN = 0.003
"""Size of the smallest details that are shown of large meshes [m]."""
_MANY = 2000
"""Number of triangles beyond which a link is simplified."""
_FORMAT = 3
"""Version of the files that keep drawings."""


class Drawing(NamedTuple):
    """The bodies of a robot's links, in the links' frames; and why bodies of others cannot be read, "" if all can."""

    links: dict[str, Part]
    problem: str = ""


def visual_drawing(file: RobotFile) -> Drawing:
    """Return what a robot's file draws; of links without a drawing, what collides."""
    try:
        drawing = _drawing(read_drawn(file))
    except EvenroadError as error:
        drawing = Drawing({}, str(error))
    if not drawing.problem:
        return drawing
    said = f"collision bodies stand for visual geometry that cannot be read: {drawing.problem}"
    logging.getLogger("evenroad").warning("evenroad: %s", said)
    return drawing._replace(problem=said)


def collision_drawing(file: RobotFile) -> Drawing:
    """Return the collision geometry of a robot's file, none of links whose meshes cannot be read."""
    try:
        shapes = read_robot(replace(file, use_visuals=False, as_drawn=False)).shapes
    except EvenroadError as error:
        return Drawing({}, str(error))
    return _drawing([Drawn(shape.link, shape) for shape in shapes])


def _drawing(drawn: Sequence[Drawn]) -> Drawing:
    """Return bodies from the cache, or of their files; large meshes are kept, as they take seconds to read."""
    beside: set[Path] = set()
    if not any(isinstance(each.shape, Mesh) for each in drawn):
        return _read(drawn, beside)
    try:
        key = _key_of(drawn)
    except EvenroadError as error:
        return Drawing({}, str(error))
    path = cache_folder() / "pictures" / f"{key[:32]}.npz"
    content = read_sealed(path, key, "the drawing of a robot")
    if content is not None and (links := _restored(content)) is not None:
        return Drawing(links)
    whole = _read(drawn, beside)
    found = whole._replace(links={link: _simplified(part) for link, part in whole.links.items()})
    # What is missing now may be there next time, as an extra is installed.
    if not found.problem and any(len(part.corners) > _MANY for part in whole.links.values()):
        with suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            with atomic_write(path) as stream:
                stream.write(sealed(_written(found.links, beside), key))
    return found


def _key_of(drawn: Sequence[Drawn]) -> str:
    """Return the hash of all that drawings depend on, but for the files that meshes name."""
    digest = hashlib.sha256(f"{_FORMAT}|{__version__}".encode())
    for link, shape, colour in ((each.link, each.shape, each.colour) for each in drawn):
        if isinstance(shape, EvenroadError):
            digest.update(fingerprint_of(link, str(shape)).encode())
        elif isinstance(shape, Mesh) and isinstance(shape.source, Path):
            digest.update(fingerprint_of(link, colour, shape.scale, shape.pose, str(shape.source)).encode())
            digest.update(hashlib.sha256(read_known(shape.source, "mesh")).digest())
        else:
            digest.update(fingerprint_of(link, colour, shape).encode())
    return digest.hexdigest()


def _read(drawn: Sequence[Drawn], beside: set[Path]) -> Drawing:
    """Return bodies as their files have them, without the links of which one cannot be read.

    The files of materials and textures that meshes name are added to `beside`.
    """
    of_link: dict[str, list[Part]] = {}
    problems: dict[str, str] = {}
    for each in drawn:
        try:
            if isinstance(each.shape, EvenroadError):
                raise each.shape
            of_link.setdefault(each.link, []).extend(_parts_of(each, beside))
        except EvenroadError as error:
            problems.setdefault(each.link, str(error))
    shown = {link: parts for link, parts in of_link.items() if link not in problems}
    links = {link: joined(parts) for link, parts in shown.items() if any(len(part.corners) for part in parts)}
    return Drawing(links, next(iter(problems.values()), ""))


def _parts_of(drawn: Drawn, beside: set[Path]) -> list[Part]:
    """Return the bodies of a shape: a mesh has the colours of its own materials, if it has any."""
    shape, colour = drawn.shape, drawn.colour or PLAIN
    assert not isinstance(shape, EvenroadError)
    if not isinstance(shape, Mesh):
        return [part_of_shape(shape, colour)]
    if isinstance(shape.source, TriangleMesh):
        return [part_of((shape.pose.apply(shape.triangles.vertices), shape.source.triangles), colour)]
    return [
        part_of(
            (shape.pose.apply(scaled(mesh, shape.scale).vertices), mesh.triangles),
            colour if own is None else own.astype(np.int16),
        )
        for mesh, own in load_coloured(shape.source, beside)
    ]


def _written(parts: Mapping[str, Part], beside: set[Path]) -> bytes:
    out = BytesIO()
    named = sorted(map(str, beside))
    arrays = {
        "beside": np.array(named, dtype=np.str_),
        "contents": np.array([_content_of(name) for name in named], dtype=np.str_),
        "links": np.array(list(parts)),
        "cuts": np.cumsum([len(part.corners) for part in parts.values()])[:-1],
        "corners": np.concatenate([part.corners for part in parts.values()], dtype=np.float32),
        "normals": np.concatenate([part.normals for part in parts.values()]).astype(np.float16),
        "colours": np.concatenate([part.colours for part in parts.values()]),
    }
    np.savez(out, allow_pickle=False, **arrays)
    return out.getvalue()


def _restored(content: bytes) -> dict[str, Part] | None:
    """Return bodies that were kept; None if a file of materials or textures has changed since."""
    with np.load(BytesIO(content)) as kept:
        if [_content_of(name) for name in kept["beside"].tolist()] != kept["contents"].tolist():
            return None
        links, cuts = kept["links"].tolist(), kept["cuts"]
        corners, normals = (np.split(kept[name].astype(np.float64), cuts) for name in ("corners", "normals"))
        colours = np.split(kept["colours"], cuts)
    rows = zip(links, corners, normals, colours, strict=True)
    return {link: Part(corner, normal, colour) for link, corner, normal, colour in rows}


def _content_of(name: str) -> str:
    """Return the hash of a file's content; "" if it cannot be read."""
    try:
        return hashlib.sha256(read_known(name, "material")).hexdigest()
    except BrokenFile:
        return ""


def _simplified(part: Part) -> Part:
    """Return a body without details that no picture shows: corners within a grain of each other become one."""
    if len(part.corners) <= _MANY:
        return part
    corners = part.corners.reshape(-1, 3)
    cells = np.floor(corners / _GRAIN).astype(np.int64)
    _, cluster = unique_rows(cells)
    count = np.bincount(cluster)
    middle = np.stack([np.bincount(cluster, corners[:, k]) / count for k in range(3)], axis=1)
    cluster = cluster.reshape(-1, 3)
    kept = (cluster != np.roll(cluster, 1, axis=1)).all(axis=1)
    return replace(part, corners=middle[cluster[kept]], normals=part.normals[kept], colour=part.colours[kept])
