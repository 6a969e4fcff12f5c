"""Capsules inside a shape: if one of them touches a body, the shape touches it, too."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad.geometry.fit import divided
from evenroad.geometry.hulls import distances, winding_number
from evenroad.geometry.kept import Fitted, fitted_once
from evenroad.geometry.mesh import TriangleMesh
from evenroad.geometry.shapes import Box, Capsule, Cylinder, Mesh, Shape, Sphere

MOST_SIDE_BY_SIDE = 8
"""Largest number of capsules of a box; a wider box has gaps between them."""
MOST_BALLS = 12
"""Largest number of balls of a mesh."""
_ACROSS = 20
"""Number of planes along each axis between which centres of balls are sought."""
_SMALLEST = 0.25
"""Least radius of a ball, as a share of the largest one's."""
_APART = 0.9
"""Factor on the radii of balls; further centres lie outside of the balls so scaled."""
_FINE = 1.0 / 24.0
"""Longest side of the triangles whose corners guide the choice of centres, in parts of the mesh's extent."""
_SHRUNK = 1e-9
"""Share of a length by which capsules shrink, so that rounding does not carry one out of its shape."""


def capsules_inside(shape: Shape) -> tuple[Capsule, ...]:
    """Return capsules inside a shape, in the frame of its link; empty if none are known.

    A sphere or capsule stays as it is.  A cylinder gets a capsule on its axis, a flat one several across.  A box gets
    capsules along its longest edge, side by side.  A closed mesh gets balls.  An open mesh and a point cloud get
    none.  Raises the errors of :func:`evenroad.geometry.load_mesh` for a mesh.
    """
    rotation, xyz = shape.pose.rotation_matrix, np.array(shape.pose.xyz)
    exact = isinstance(shape, Sphere | Capsule)
    placed = []
    for a, b, radius in _inside(shape):
        (ax, ay, az), (bx, by, bz) = ((rotation @ end + xyz).tolist() for end in (a, b))
        radius -= 0.0 if exact else _SHRUNK * (radius + float(np.abs([ax, ay, az, bx, by, bz]).max()))
        if radius > 0.0:
            placed.append(Capsule((ax, ay, az), (bx, by, bz), float(radius), link=shape.link))
    return tuple(placed)


def inner_of(shapes: Iterable[Shape]) -> tuple[Capsule, ...] | None:
    """Return capsules inside shapes; None if the capsules fitted to them are the shapes themselves."""
    every = tuple(shapes)
    if all(isinstance(shape, Sphere | Capsule) for shape in every):
        return None
    return tuple(capsule for shape in every for capsule in capsules_inside(shape))


def _inside(shape: Shape) -> list[Fitted]:
    if isinstance(shape, Mesh):
        return fitted_once("inside", shape.triangles, _in_mesh)
    if isinstance(shape, Box):
        return _in_box(np.array(shape.size))
    if isinstance(shape, Cylinder):
        return _in_cylinder(shape.radius, 0.5 * shape.length)
    if isinstance(shape, Sphere):
        return [(np.zeros(3), np.zeros(3), shape.radius)]
    if isinstance(shape, Capsule):
        return [(np.array(shape.a), np.array(shape.b), shape.radius)]
    return []


def _in_box(size: Floats) -> list[Fitted]:
    thin, middle, long = np.argsort(size, kind="stable")
    radius, axes = 0.5 * size[thin], np.eye(3)
    aside, along = 0.5 * size[middle] - radius, (0.5 * size[long] - radius) * axes[long]
    # Axes are at most a radius apart, unless that takes too many.
    count = min(1 + math.ceil(aside / radius - 1e-9), MOST_SIDE_BY_SIDE)
    centres = [offset * axes[middle] for offset in (np.linspace(-aside, aside, count) if count > 1 else [0.0])]
    return [(centre - along, centre + along, float(radius)) for centre in centres]


def _in_cylinder(radius: float, half: float) -> list[Fitted]:
    if half >= radius:
        end = np.array([0.0, 0.0, half - radius])
        return [(-end, end, radius)]
    turns = np.arange(MOST_SIDE_BY_SIDE) * np.pi / MOST_SIDE_BY_SIDE
    endpoints = (radius - half) * np.stack([np.cos(turns), np.sin(turns), np.zeros_like(turns)], axis=1)
    return [(-end, end, half) for end in endpoints]


def _in_mesh(mesh: TriangleMesh) -> list[Fitted]:
    """Return balls inside the closed parts of a mesh; none if the triangles do not show which side is inside."""
    from scipy.spatial import cKDTree

    closed = mesh.closed_parts.closed
    # If the triangles do not show which side is inside, no part is known to be solid.
    if not mesh.closed_parts.oriented or not closed.any():
        return []
    mesh = mesh.compact
    proper = (mesh.triangles != np.roll(mesh.triangles, 1, axis=1)).all(axis=1)
    rows = mesh.facing[closed & proper]
    corners = mesh.vertices[rows]
    middles = _points_inside(corners)
    if not len(middles):
        return []
    points, rows = divided(mesh.vertices, rows, _FINE)
    points = np.concatenate([points, points[rows].mean(axis=1)])
    away = cKDTree(points, balanced_tree=False, compact_nodes=False).query(middles)[0]
    centroids = corners.mean(axis=1)
    reach = 1e-9 + np.linalg.norm(corners - centroids[:, np.newaxis], axis=2).max(axis=1)
    along, farthest = np.ascontiguousarray(centroids[:, 0]), float(reach.max())
    balls: list[Fitted] = []
    left, largest = np.ones(len(middles), dtype=np.bool_), 0.0
    while left.any() and len(balls) < MOST_BALLS:
        k = int(np.where(left, away, -1.0).argmax())
        if away[k] < _SMALLEST * largest:
            break
        centre = middles[k]
        left[k] = False
        # Grid and tree only propose a ball; all triangles decide whether it is inside.
        if not is_inside(corners, centre):
            continue
        # The corners of other triangles are farther away than the nearest point of the surface.
        some = np.flatnonzero(np.abs(along - centre[0]) <= away[k] + farthest)
        near = corners[some[np.linalg.norm(centroids[some] - centre, axis=1) <= away[k] + reach[some]]]
        radius = float(distances(np.broadcast_to(centre, (len(near), 3)), near).min())
        left &= np.linalg.norm(middles - centre, axis=1) > _APART * radius
        largest = max(largest, radius)
        balls.append((centre, centre, radius))
    return [ball for ball in balls if ball[2] >= 0.5 * _SMALLEST * largest]


def is_inside(corners: Floats, point: Floats) -> bool:
    """Return whether closed surfaces, triangles (t, 3, 3), go around a point, (3,), exactly once.

    A point that they go around twice, as in a hollow of wrong orientation, is not inside.
    """
    return abs(abs(winding_number(corners, point)) - 1.0) < 1e-3


def _points_inside(corners: Floats) -> Floats:
    """Return points of a grid, (n, 3), that closed surfaces seem to go around, by lines along z."""
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    if not (high > low).all():
        return np.empty((0, 3))
    # Lines avoid the middle, where edges often are.
    steps = (np.arange(_ACROSS) + 0.4837) / _ACROSS
    x, y, z = (low[axis] + (high[axis] - low[axis]) * steps for axis in range(3))
    first = np.searchsorted(x, corners[:, :, 0].min(axis=1)), np.searchsorted(y, corners[:, :, 1].min(axis=1))
    end = np.searchsorted(x, corners[:, :, 0].max(axis=1)), np.searchsorted(y, corners[:, :, 1].max(axis=1))
    turns = np.zeros((_ACROSS, _ACROSS, _ACROSS + 1))
    wide, deep = end[0] - first[0], end[1] - first[1]
    # Each triangle is tested against all lines of its own rectangle.
    count = wide * deep
    row = np.repeat(np.arange(len(corners)), count)
    rank = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    i, j = first[0][row] + rank // np.maximum(deep[row], 1), first[1][row] + rank % np.maximum(deep[row], 1)
    hit, height, sign = _crossed(corners[row], x[i], y[j])
    np.add.at(turns, (i[hit], j[hit], np.searchsorted(z, height[hit])), sign[hit])
    # Points above a crossing are on its other side.
    around = np.cumsum(turns, axis=2)
    at_cap = np.abs(around[:, :, -1:]) < 0.5
    inside = (np.abs(np.abs(around[:, :, :-1]) - 1.0) < 0.5) & at_cap
    at = np.nonzero(inside)
    return np.stack([x[at[0]], y[at[1]], z[at[2]]], axis=1)


def _crossed(corners: Floats, x: Floats, y: Floats) -> tuple[Bools, Floats, Floats]:
    """Return which triangles, (n, 3, 3), lines along z at x, y, (n,), cross, and the heights and sides of crossings."""
    flat = corners[:, :, :2] - np.stack([x, y], axis=1)[:, np.newaxis]
    areas = np.stack(
        [flat[:, k, 0] * flat[:, (k + 1) % 3, 1] - flat[:, k, 1] * flat[:, (k + 1) % 3, 0] for k in range(3)],
        axis=1,
    )
    whole = areas.sum(axis=1)
    hit = ((areas > 0.0).all(axis=1) | (areas < 0.0).all(axis=1)) & (whole != 0.0)
    safe = np.where(hit, whole, 1.0)
    height = (areas[:, 1] * corners[:, 0, 2] + areas[:, 2] * corners[:, 1, 2] + areas[:, 0] * corners[:, 2, 2]) / safe
    return hit, height, np.sign(whole)
