"""Surfaces of bodies as triangles, for pictures and viewers in three dimensions."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad.geometry.shapes import Box, Capsule, Cylinder, Mesh, PointCloud, Shape, Sphere, along_z

Surface = tuple[Floats, Ints]
"""Vertices, (v, 3) [m], and triangles, (t, 3), as rows of them."""
_SIDES = 24
"""Number of sides that a circle is drawn with."""
_ARC = np.linspace(0.0, 0.5 * math.pi, _SIDES // 4 + 1)
_CUBE = np.stack(np.meshgrid(*3 * [[-0.5, 0.5]], indexing="ij"), axis=-1).reshape(-1, 3)
_CUBE_TRIANGLES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
     [1, 5, 7], [1, 7, 3]]
)  # fmt: skip
"""Triangles of a cube, seen from outside against the clock."""
_LEAST, _MOST = 0.004, 20_000
"""Least half side of a cloud's cubes [m], and the largest number of them."""


def surface_of(shape: Shape) -> Surface:
    """Return the surface of a body in the frame of what carries it; of a cloud a cube for each point."""
    shape = along_z(shape) if isinstance(shape, Capsule) else shape
    if isinstance(shape, PointCloud):
        return _cubes(shape.pose.apply(shape.points), shape.radius)
    if isinstance(shape, Mesh):
        vertices, triangles = shape.triangles.vertices, shape.triangles.triangles
    elif isinstance(shape, Box):
        vertices, triangles = _CUBE * shape.size, _CUBE_TRIANGLES
    elif isinstance(shape, Cylinder):
        vertices, triangles = _turned(np.array([0.0, 1.0, 1.0, 0.0]) * shape.radius, _two(shape.length, [0.0, 0.0]))
    else:
        assert isinstance(shape, Sphere | Capsule)
        across, up = shape.radius * np.cos(_ARC), shape.radius * np.sin(_ARC)
        vertices, triangles = _turned(
            np.append(across[::-1], across), _two(shape.length if isinstance(shape, Capsule) else 0.0, up)
        )
    return shape.pose.apply(vertices), triangles


def tube(points: Floats, radius: float, sides: int = 8) -> Surface:
    """Return a tube around a line through points, (n, 3)."""
    along = np.gradient(points, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
    aside = np.cross(along, np.where(np.abs(along[:, 2:]) < 0.9, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]))
    aside /= np.maximum(np.linalg.norm(aside, axis=1, keepdims=True), 1e-12)
    angle = np.linspace(0.0, 2.0 * math.pi, sides, endpoint=False)[:, np.newaxis]
    rings = np.cos(angle) * aside[:, np.newaxis] + np.sin(angle) * np.cross(along, aside)[:, np.newaxis]
    return (points[:, np.newaxis] + radius * rings).reshape(-1, 3), _between_rings(len(points), sides)


def _two(length: float, up: Sequence[float] | Floats) -> Floats:
    """Return heights of a profile that goes up twice, in the mirror and as it is, with `length` between."""
    heights = 0.5 * length + np.array(up)
    return np.append(-heights[::-1], heights)


def _turned(across: Floats, up: Floats) -> Surface:
    """Return what a profile, (k,) each, makes when it turns about z."""
    angle = np.linspace(0.0, 2.0 * math.pi, _SIDES, endpoint=False)
    rings = np.empty((len(up), _SIDES, 3))
    rings[..., 0], rings[..., 1] = np.outer(across, np.cos(angle)), np.outer(across, np.sin(angle))
    rings[..., 2] = up[:, np.newaxis]
    return rings.reshape(-1, 3), _between_rings(len(up), _SIDES)


def _between_rings(rings: int, sides: int) -> Ints:
    """Return the triangles between rings of corners, seen from outside against the clock."""
    ring, side = (each.reshape(-1) for each in np.mgrid[0 : rings - 1, 0:sides])
    a, b = sides * ring + side, sides * ring + (side + 1) % sides
    return np.concatenate([np.stack([a, b, b + sides], axis=1), np.stack([a, b + sides, a + sides], axis=1)])


def _cubes(points: Floats, radius: float) -> Surface:
    points = points[:: len(points) // _MOST + 1]
    firsts = len(_CUBE) * np.arange(len(points))[:, np.newaxis, np.newaxis]
    corners = points[:, np.newaxis] + 2.0 * max(radius, _LEAST) * _CUBE
    return corners.reshape(-1, 3), (_CUBE_TRIANGLES + firsts).reshape(-1, 3)
