"""Bodies to draw: of shapes, several as one, and as the browser and the native kernel take them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from PIL import ImageColor

from evenroad._arrays import Floats, Ints, unique_rows
from evenroad.errors import EvenroadError
from evenroad.geometry.shapes import Capsule, Mesh, Shape, Sphere
from evenroad.viz.stage import Part, part_of
from evenroad.viz.surfaces import surface_of

PLAIN = (-1, -1, -1)
"""Colour of what has none in its file: pictures choose one for each link."""


def rgb(colour: str) -> tuple[int, int, int]:
    """Return a colour as three numbers up to 255."""
    red, green, blue = ImageColor.getrgb(colour)[:3]
    return red, green, blue


def part_of_shape(shape: Shape, colour: tuple[int, int, int]) -> Part:
    """Return a shape as a body; of a ball or capsule the normals are known: they lead away from its axis."""
    surface = surface_of(shape)
    if not isinstance(shape, Sphere | Capsule):
        return part_of(surface, colour, closed=not isinstance(shape, Mesh))
    (vertices, triangles), b = surface, np.zeros(3) if isinstance(shape, Sphere) else np.array(shape.b)
    own, a = shape.pose.local(vertices), b if isinstance(shape, Sphere) else np.array(shape.a)
    share = np.clip((own - a) @ (b - a) / max(float((b - a) @ (b - a)), 1e-18), 0.0, 1.0)
    away = (own - a - share[:, np.newaxis] * (b - a)) @ shape.pose.rotation_matrix.T / shape.radius
    return Part(vertices[triangles], away[triangles], colour, closed=True)


def parts_by_link(shapes: Iterable[Shape]) -> dict[str, Part]:
    """Return link -> the bodies that it carries, as one; nothing of a link whose mesh cannot be read."""
    of_link: dict[str, list[Part]] = {}
    for shape in shapes:
        try:
            of_link.setdefault(shape.link, []).append(part_of_shape(shape, PLAIN))
        except EvenroadError:
            of_link.pop(shape.link, None)
    return {link: joined(parts) for link, parts in of_link.items() if any(len(part.corners) for part in parts)}


def joined(parts: Sequence[Part]) -> Part:
    """Return several bodies as one, as opaque as the first of them."""
    corners, normals = (np.concatenate([getattr(part, name) for part in parts]) for name in ("corners", "normals"))
    colours = np.concatenate([part.colours for part in parts])
    closed = all(part.closed for part in parts)
    return replace(parts[0], corners=corners, normals=normals, colour=colours, closed=closed)


def most_common(parts: Iterable[Part]) -> tuple[int, int, int]:
    """Return the colour that most triangles of bodies have."""
    rows = np.concatenate([part.colours for part in parts])
    different, index = unique_rows(rows.astype(np.float64))
    red, green, blue = different[np.argmax(np.bincount(index))].astype(int).tolist()
    return red, green, blue


def by_colour(part: Part) -> list[Part]:
    """Return a body as one for each of its colours."""
    different, index = unique_rows(part.colours.astype(np.float64))
    return [_selected(part, index == i, colour) for i, colour in enumerate(different.astype(int).tolist())]


def _selected(part: Part, chosen: Ints, colour: list[int]) -> Part:
    red, green, blue = colour
    return replace(part, corners=part.corners[chosen], normals=part.normals[chosen], colour=(red, green, blue))


def indexed(part: Part) -> tuple[Floats, Floats, Ints]:
    """Return each different pair of a corner and its normal once, (v, 3) each, and triangles as rows of them."""
    rows = np.column_stack([
        np.round(part.corners.reshape(-1, 3), 5), np.round(127.0 * part.normals.reshape(-1, 3))
    ])  # fmt: skip
    different, index = unique_rows(rows)
    return different[:, :3], different[:, 3:] / 127.0, index.reshape(-1, 3)
