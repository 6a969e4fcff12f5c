"""Bodies of links: the shapes of a robot's file, or the capsules that the user gives, and what stands for them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from evenroad.geometry.fit import fit_capsules, union_volume
from evenroad.geometry.hulls import Piece, piece_of
from evenroad.geometry.kept import is_new
from evenroad.geometry.mesh import TriangleMesh
from evenroad.geometry.shapes import Capsule, Mesh, Shape
from evenroad.robot.joint import Joint
from evenroad.robot.robot_model import LinkBody
from evenroad.robot.urdf import Urdf

_LARGE, _UNLIKE = 20.0, 500.0
"""Size of a link or joint [m], and how many times the median, beyond which a file seems to have another unit.

Many robots have links of 1 mm in place of sensors.
"""


def opened(shapes: Sequence[Shape]) -> tuple[Shape, ...]:
    """Return shapes with their meshes read, each file once."""
    meshes: dict[object, TriangleMesh] = {}
    opened = []
    for shape in shapes:
        if isinstance(shape, Mesh):
            key = shape.source, shape.scale
            meshes[key] = meshes.get(key) or shape.triangles
            shape = replace(shape, source=meshes[key], scale=(1.0, 1.0, 1.0))
        opened.append(shape)
    return tuple(opened)


def capsules_of(
    urdf: Urdf, given: dict[str, tuple[Capsule, ...]], progress: Callable[[int, int, str], None] | None
) -> dict[str, tuple[Capsule, ...]]:
    """Return the capsules of every link with a body: those given, or fitted ones."""
    found: dict[str, tuple[Capsule, ...]] = {}
    fitted = [shape for shape in urdf.shapes if shape.link not in given]
    for i, shape in enumerate(fitted):
        if progress is not None and isinstance(shape, Mesh) and is_new("around", shape.triangles):
            progress(i, len(fitted), f"{shape} of {shape.link}")
        found[shape.link] = found.get(shape.link, ()) + fit_capsules(shape)
    found |= given
    return {link: found[link] for link in urdf.links if link in found}


def pieces_of(urdf: Urdf, given: dict[str, tuple[Capsule, ...]]) -> dict[str, list[Piece]]:
    """Return the shapes of every link with a body: the capsules given, or the shapes of the URDF."""
    pieces: dict[str, list[Piece]] = {}
    for shape in shapes_of(urdf, given):
        pieces.setdefault(shape.link, []).append(piece_of(shape))
    return pieces


def shapes_of(urdf: Urdf, given: dict[str, tuple[Capsule, ...]]) -> list[Shape]:
    """Return the shapes of all links: the capsules given, or those of the URDF."""
    shapes = [shape for shape in urdf.shapes if shape.link not in given]
    return [*shapes, *(capsule for capsules in given.values() for capsule in capsules)]


def link_body(urdf: Urdf, link: str, capsules: tuple[Capsule, ...], given: bool) -> LinkBody:
    """Return what the capsules of a link stand for."""
    shapes = [shape for shape in urdf.shapes if shape.link == link]
    return LinkBody(
        link=link,
        shapes=tuple(map(str, shapes)),
        shape_volume=sum(shape.volume for shape in shapes),
        capsules=len(capsules),
        capsule_volume=union_volume(capsules),
        given=given,
    )


def size_notes(capsules: Mapping[str, Sequence[Capsule]], joints: Iterable[Joint]) -> tuple[str, ...]:
    """Return a note where links or joints are so large, or links so unlike, that a file seems to have another unit."""
    sizes = {link: _size(parts) for link, parts in capsules.items()}
    largest, smallest = max(sizes, key=sizes.__getitem__), min(sizes, key=sizes.__getitem__)
    far = max(joints, key=lambda joint: np.linalg.norm(joint.xyz), default=None)
    away = 0.0 if far is None else float(np.linalg.norm(far.xyz))
    hint = "metres are expected; a mesh in millimetres has scale 0.001 0.001 0.001"
    middle = float(np.median(list(sizes.values())))
    if sizes[largest] > min(_LARGE, _UNLIKE * middle) or middle > _UNLIKE * sizes[smallest]:
        both = f"link {largest!r} is {sizes[largest]:.3g} m long, {smallest!r} {sizes[smallest]:.3g} m"
        return (f"{both}: {hint}",)
    if far is not None and (away > _LARGE or away > _UNLIKE * sizes[largest]):
        return (f"joint {far.name!r} is {away:.3g} m away from the one before: {hint}",)
    return ()


def _size(parts: Sequence[Capsule]) -> float:
    """Return the longest side of the box around capsules [m]."""
    points = np.array([(part.a, part.b) for part in parts])
    radii = np.array([part.radius for part in parts])[:, np.newaxis, np.newaxis]
    return float(((points + radii).max(axis=(0, 1)) - (points - radii).min(axis=(0, 1))).max())
