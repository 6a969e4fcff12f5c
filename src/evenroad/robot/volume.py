"""Volumes of bodies: what a fit adds to the shapes that it contains."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from evenroad._rng import generator
from evenroad.robot.capsule import Capsule
from evenroad.robot.geometry import Geometry
from evenroad.robot.meshes import load_triangles

SAMPLES = 1 << 15
"""Points that estimate the volume of a union: a standard error of about half a per cent."""


def shape_volume(geometry: Geometry) -> float:
    """Return the volume of a collision shape [m^3]; of a mesh that is not closed, that of its convex hull."""
    if geometry.file is not None:
        return _mesh_volume(geometry)
    if geometry.shape == "box":
        return math.prod(geometry.size)
    radius = geometry.size[0]
    ball = 4.0 / 3.0 * math.pi * radius**3
    if geometry.shape == "sphere":
        return ball
    return math.pi * radius**2 * geometry.size[1] + (ball if geometry.shape == "capsule" else 0.0)


def union_volume(capsules: Sequence[Capsule]) -> float:
    """Return the volume of the union of capsules in one frame [m^3], by 32768 fixed random points."""
    a, b = (np.array([getattr(capsule, end) for capsule in capsules]) for end in ("a", "b"))
    radius = np.array([capsule.radius for capsule in capsules])
    low = (np.minimum(a, b) - radius[:, np.newaxis]).min(axis=0)
    high = (np.maximum(a, b) + radius[:, np.newaxis]).max(axis=0)
    points = low + generator(0).random((SAMPLES, 3)) * (high - low)
    inside = np.zeros(SAMPLES, dtype=np.bool_)
    for start, end, reach in zip(a, b, radius, strict=True):
        axis = end - start
        along = np.clip((points - start) @ axis / max(float(axis @ axis), 1e-300), 0.0, 1.0)
        inside |= ((points - start - along[:, np.newaxis] * axis) ** 2).sum(axis=1) <= reach**2
    return float(inside.mean() * np.prod(high - low))


def _mesh_volume(geometry: Geometry) -> float:
    assert geometry.file is not None
    vertices, triangles = load_triangles(geometry.file)
    _, number = np.unique(vertices, axis=0, return_inverse=True)
    sides = np.sort(number.reshape(-1)[triangles][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    _, times = np.unique(sides, axis=0, return_counts=True)
    corners = (vertices * np.array(geometry.size))[triangles]
    if (times == 2).all():
        # Of a closed surface: tetrahedra from the origin to every triangle, with signs.
        return abs(float(np.linalg.det(corners).sum())) / 6.0
    from scipy.spatial import ConvexHull, QhullError

    try:
        return float(ConvexHull(corners.reshape(-1, 3)).volume)
    except QhullError:
        return 0.0
