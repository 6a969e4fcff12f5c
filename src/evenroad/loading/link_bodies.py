"""Bodies of links: shapes of the robot's file, or the user's capsules, and the capsules fitted to shapes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from evenroad.geometry.fit import fit_capsules, union_volume
from evenroad.geometry.hulls import Piece, piece_of
from evenroad.geometry.kept import is_new
from evenroad.geometry.mesh import TriangleMesh
from evenroad.geometry.shapes import Capsule, Mesh, Shape
from evenroad.loading.description import RobotDescription
from evenroad.loading.model import LinkBody


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
    description: RobotDescription,
    given: dict[str, tuple[Capsule, ...]],
    progress: Callable[[int, int, str], None] | None,
) -> dict[str, tuple[Capsule, ...]]:
    """Return the capsules of every link with a body: those given, or fitted ones."""
    found: dict[str, tuple[Capsule, ...]] = {}
    fitted = [shape for shape in description.shapes if shape.link not in given]
    for i, shape in enumerate(fitted):
        if progress is not None and isinstance(shape, Mesh) and is_new("around", shape.triangles):
            progress(i, len(fitted), f"{shape} of {shape.link}")
        found[shape.link] = found.get(shape.link, ()) + fit_capsules(shape)
    found |= given
    return {link: found[link] for link in description.links if link in found}


def pieces_of(shapes: Iterable[Shape]) -> dict[str, list[Piece]]:
    """Return shapes as convex pieces, by their links."""
    pieces: dict[str, list[Piece]] = {}
    for shape in shapes:
        pieces.setdefault(shape.link, []).append(piece_of(shape))
    return pieces


def shapes_of(description: RobotDescription, given: dict[str, tuple[Capsule, ...]]) -> list[Shape]:
    """Return the shapes of all links: the capsules given, or those of the URDF."""
    shapes = [shape for shape in description.shapes if shape.link not in given]
    return [*shapes, *(capsule for capsules in given.values() for capsule in capsules)]


def link_body(description: RobotDescription, link: str, capsules: tuple[Capsule, ...], given: bool) -> LinkBody:
    """Return what the capsules of a link stand for."""
    shapes = [shape for shape in description.shapes if shape.link == link]
    return LinkBody(
        link=link,
        shapes=tuple(map(str, shapes)),
        shape_volume=sum(shape.volume for shape in shapes),
        capsules=len(capsules),
        capsule_volume=union_volume(capsules),
        given=given,
    )
