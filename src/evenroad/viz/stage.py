"""Pictures of bodies in three dimensions: what the native kernel is given to draw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
from PIL import Image

from evenroad._arrays import Floats, Ints, unique_rows
from evenroad._native.picture import paint
from evenroad.viz import style
from evenroad.viz.camera import Camera
from evenroad.viz.surfaces import Surface

Colour: TypeAlias = tuple[int, int, int] | npt.NDArray[np.int16]
"""Red, green and blue, up to 255: of a whole body, or of each of its triangles, (t, 3)."""
_CREASE = 0.75
"""Cosine of the angle between two faces beyond which their edge is sharp."""


@dataclass(frozen=True)
class Part:
    """A body to draw: corners of its triangles, (t, 3, 3) [m], their normals, its colour, and how opaque it is.

    A translucent body keeps the share `hidden` of its opacity where something hides it.  The faces of a `closed` body
    that look away are never seen.
    """

    corners: Floats
    normals: Floats
    colour: Colour
    opacity: float = 1.0
    hidden: float = 0.0
    closed: bool = False

    @property
    def colours(self) -> npt.NDArray[np.int16]:
        """The colour of each triangle, (t, 3)."""
        return np.broadcast_to(np.asarray(self.colour, dtype=np.int16), (len(self.corners), 3))

    def moved(self, pose: Floats) -> Part:
        """Return it moved by a transform, (4, 4)."""
        turned = pose[:3, :3].T
        # One product of many rows: a stack of small ones takes ten times as long.
        corners, normals = (each.reshape(-1, 3) @ turned for each in (self.corners, self.normals))
        corners += pose[:3, 3]
        shape = self.corners.shape
        return replace(self, corners=corners.reshape(shape), normals=normals.reshape(shape))


def part_of(surface: Surface, colour: Colour, *, closed: bool = False) -> Part:
    """Return a body of its surface, with normals that are smooth except at sharp edges."""
    vertices, triangles = surface
    corners = vertices[triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sizes = np.linalg.norm(faces, axis=1)
    # Triangles without an area, as at the pole of a ball, show nothing.
    is_seen = sizes > 0.0
    corners, faces, triangles = (each[is_seen] for each in (corners, faces, triangles))
    units = faces / sizes[is_seen, np.newaxis]
    _, same = unique_rows(np.round(vertices, 6))
    at = same[triangles].reshape(-1)
    # Corners in the order of their vertex: pairs of faces at one vertex are pairs within its run.
    order = np.argsort(at, kind="stable")
    firsts = np.searchsorted(at[order], np.arange(at.max() + 2 if len(at) else 1))
    count = (firsts[1:] - firsts[:-1])[at[order]]
    one = np.repeat(order, count)
    other = order[np.repeat(firsts[at[order]], count) + _within(count)]
    smooth = (units[one // 3] * units[other // 3]).sum(axis=1) > _CREASE
    normals = np.zeros((len(at), 3))
    for axis in range(3):
        normals[:, axis] = np.bincount(one[smooth], faces[other[smooth] // 3, axis], len(at))
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-15)
    colour = colour if isinstance(colour, tuple) else colour[is_seen]
    return Part(corners, normals.reshape(-1, 3, 3), colour, closed=closed)


class Stage:
    """A camera, and a floor at this height [m] below all that it sees."""

    def __init__(self, camera: Camera, floor: float) -> None:
        self._camera = camera
        # The light comes from behind the camera's left shoulder, high above.
        right, _, forward = camera.axes
        light = np.array([0.0, 0.0, 1.05]) - 0.55 * forward * [1.0, 1.0, 0.0] - 0.55 * right
        light /= np.linalg.norm(light)
        across = np.cross(light, right) / np.linalg.norm(np.cross(light, right))
        colours = (style.SKY, style.HORIZON, style.GROUND, style.LINES)
        at_floor = np.full(3, floor)
        self._studio = np.stack([at_floor, camera.look_at, *colours, np.cross(across, light), across, light])

    def picture(self, parts: Sequence[Part], see_through: int = 0) -> Image.Image:
        """Return a picture of bodies; translucent ones throw no shadow, and are drawn over all others, in order.

        They are seen through the solid bodies from number `see_through` on.
        """
        layers = [[part for part in parts if part.opacity == 1.0], *([part] for part in parts if part.opacity < 1.0)]
        drawn = [part for layer in layers for part in layer]
        counts = [len(part.corners) for part in drawn]
        looks = [(layer[0].opacity, layer[0].hidden) if layer else (1.0, 0.0) for layer in layers]
        counted = np.cumsum([sum(len(part.corners) for part in layer) for layer in layers])
        camera, (columns, rows) = self._camera, self._camera.size
        picture = paint(
            np.vstack([camera.eye, camera.axes]),
            camera.scale,
            columns,
            rows,
            self._studio,
            np.concatenate([np.zeros((0, 3, 3)), *(part.corners for part in drawn)]),
            np.concatenate([np.zeros((0, 3, 3)), *(part.normals for part in drawn)]),
            np.concatenate([np.zeros((0, 3)), *(part.colours for part in drawn)]),
            # Faces that look away are seen through nothing that is translucent, either.
            np.repeat(np.array([part.closed or part.opacity < 1.0 for part in drawn], dtype=np.bool_), counts),
            sum(len(part.corners) for part in layers[0][:see_through]),
            np.column_stack([counted, looks]),
        )
        return Image.fromarray(picture)


def _within(counts: Ints) -> Ints:
    """Return 0, 1, ... counts[0] - 1, 0, 1, ... counts[1] - 1 and so on."""
    sums = np.cumsum(counts, dtype=np.int32)
    within: Ints = np.arange(sums[-1] if len(sums) else 0, dtype=np.int32) - np.repeat(sums - counts, counts)
    return within
