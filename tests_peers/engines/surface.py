"""Surfaces: triangles of the shapes that links and obstacles are made of."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from evenroad.geometry import TriangleMesh
from evenroad.geometry.mesh import merged
from evenroad.geometry.shapes import Mesh, Shape
from evenroad_studies.worlds.rigid import OrientedBox, surface_of

AROUND = 24
"""Corners of a circle; a round body loses less than 0.9 % of its radius, which stays inside of the true one."""


def link_surfaces(shapes: Sequence[Shape]) -> dict[str, TriangleMesh]:
    """Return the shapes of every link as one surface in the link's frame: link -> surface."""
    links = dict.fromkeys(shape.link for shape in shapes)
    return {link: merged(tuple(shape_surface(shape) for shape in shapes if shape.link == link)) for link in links}


def shape_surface(shape: Shape) -> TriangleMesh:
    """Return the surface of a shape, in the frame that it is placed in.

    Of meshes and boxes it is exact; of round shapes it lies within them.
    """
    if isinstance(shape, Mesh):
        local = shape.triangles
    elif shape.kind == "box":
        local = surface_of(OrientedBox((0.0, 0.0, 0.0), tuple(0.5 * side for side in shape.size)))
    elif shape.kind == "cylinder":
        radius, length = shape.size
        local = _lathe([(-0.5 * length, radius), (0.5 * length, radius)])
    else:
        radius, length = (*shape.size, 0.0)[:2]
        local = _lathe(_round_profile(radius, length))
    return TriangleMesh(shape.pose.apply(local.vertices), local.triangles)


def _round_profile(radius: float, length: float) -> list[tuple[float, float]]:
    """Return heights and radii of the rings of a capsule that stands on the z axis, poles included."""
    quarter = AROUND // 4
    angles = [0.5 * math.pi * k / quarter for k in range(quarter + 1)]
    lower = [(-radius * math.cos(angle), radius * math.sin(angle)) for angle in angles]
    lower[0] = (-radius, 0.0)
    upper = [(-height, ring) for height, ring in reversed(lower)]
    # A ball has its equator once.
    upper = upper if length > 0.0 else upper[1:]
    half = 0.5 * length
    return [(height - half, ring) for height, ring in lower] + [(height + half, ring) for height, ring in upper]


def _lathe(profile: Sequence[tuple[float, float]]) -> TriangleMesh:
    """Return the surface that a profile of (height, radius) sweeps about the z axis, closed by its ends' middles."""
    rings = [(height, radius) for height, radius in profile if radius > 0.0]
    angles = 2.0 * math.pi * np.arange(AROUND) / AROUND
    corners = [
        np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.full(AROUND, height)])
        for height, radius in rings
    ]
    poles = np.array([[0.0, 0.0, profile[0][0]], [0.0, 0.0, profile[-1][0]]])
    here, after = np.arange(AROUND), (np.arange(AROUND) + 1) % AROUND
    triangles = []
    for k in range(len(rings) - 1):
        low, high = k * AROUND, (k + 1) * AROUND
        triangles += [np.column_stack([low + here, low + after, high + after])]
        triangles += [np.column_stack([low + here, high + after, high + here])]
    south, last = len(rings) * AROUND, (len(rings) - 1) * AROUND
    triangles += [np.column_stack([after, here, np.full(AROUND, south)])]
    triangles += [np.column_stack([last + here, last + after, np.full(AROUND, south + 1)])]
    return TriangleMesh(np.concatenate([*corners, poles]), np.concatenate(triangles))
