"""The native kernel's surfaces: clouds and meshes, as far as a robot can reach them."""

from __future__ import annotations

import itertools
import math
from functools import lru_cache

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad._native import robot as native
from evenroad.geometry.shapes import Mesh, PointCloud

MANY = 8
"""Number of surfaces from which a grid around all of them makes motions faster."""

PADDING = 2.5e-7
"""Single precision makes a surface uncertain by less than this share of its farthest point's distance from the
origin."""

PIECE = 0.1
"""Triangles are cut until no side is longer than this share of the robot's reach: a box around a large one says
little."""

BEYOND, LEAST_BEYOND = 0.03, 0.005
"""Triangles count that are farther than the reach by this share of it and this length [m]: so wide is a cell of a
surface's grid at most, where crossings between its middle and a place are counted."""

FRAME = 50_000
"""Clouds of more points than this come anew from a camera: a few are kept, and not 64, which would fill the memory."""

_SIDES = (
    ((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)),
    (*((2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),),
)
_CUBE = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))[np.concatenate(_SIDES)]
"""Triangles of a cube around the origin, outside to the right of their turn."""


def surface_of(body: PointCloud | Mesh, reach: float, clearance: float = 0.0) -> native.Surface | None:
    """Return what a robot of this reach can touch of a body that is larger by a clearance, None where that is nothing;
    kept for the next scene.
    """
    is_frame = isinstance(body, PointCloud) and len(body.points) > FRAME
    return (_frames if is_frame else _surfaces)(body, reach, clearance)


def make_surface(body: PointCloud | Mesh, reach: float, clearance: float = 0.0) -> native.Surface | None:
    """Return the same, made anew."""
    reach += clearance
    if isinstance(body, PointCloud):
        pose = np.array(body.pose.rotation), np.array(body.pose.xyz)
        return native.Surface.of_cloud(body.points, *pose, body.radius, clearance, reach)
    mesh = body.triangles
    corners = body.pose.apply(mesh.vertices)[mesh.facing]
    parts = mesh.closed_parts
    closed, turned, first = parts.closed, parts.oriented, parts.first
    # A large mesh is not copied.
    solid = corners if closed.all() else corners[closed]
    found = [_within(solid, first[closed], reach), _within(corners[~closed], first[~closed], reach)]
    near, first = (np.concatenate(each) for each in zip(*found, strict=True))
    bounding = np.arange(len(near)) < len(found[0][0])
    if len(near) == 0:
        if not native.winding_at(np.zeros(3), solid, turned):
            return None
        # All that the robot can reach is inside.
        near, turned = reach * _CUBE, True
        solid, first, bounding = near, np.zeros(len(near), dtype=bool), np.ones(len(near), dtype=bool)
    padding = PADDING * math.sqrt(np.einsum("ijk,ijk->ij", near, near).max())
    return native.Surface(np.ascontiguousarray(near), clearance + padding, solid, turned, reach, first, bounding)


def _within(corners: Floats, first: Bools, reach: float) -> tuple[Floats, Bools]:
    """Return the pieces of triangles that a surface of this reach needs, (p, 3, 3), and whether each is of the first of
    a part.
    """
    farther = (1.0 + BEYOND) * reach + LEAST_BEYOND
    pieces, of_first = native.pieces_within(corners, first, farther, PIECE * farther)
    return pieces.reshape(-1, 3, 3), of_first


_surfaces = lru_cache(maxsize=64)(make_surface)
_frames = lru_cache(maxsize=4)(make_surface)


@lru_cache(maxsize=4)
def surfaces_around(bodies: tuple[tuple[PointCloud | Mesh, float], ...], reach: float) -> native.Surface:
    """Return the grid around several bodies that can be reached, each with its clearance; kept, as they are."""
    return native.Surface.around([surface_of(body, reach, clearance) for body, clearance in bodies])
