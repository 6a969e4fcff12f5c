"""Outlines of bodies along a coordinate axis."""

from __future__ import annotations

import math

import numpy as np

from evenroad._arrays import Floats
from evenroad.geometry.shapes import Mesh, PointCloud
from evenroad.robot.scene import Obstacle

_ROUND = 32
"""Number of corners of a circle's polygon."""


def stadium(a: Floats, b: Floats, radius: float) -> Floats:
    """Return the outline, (c, 2), of all points within `radius` of the segment from `a` to `b`, both (2,)."""
    heading = math.atan2(b[1] - a[1], b[0] - a[0])
    half = np.linspace(-0.5 * math.pi, 0.5 * math.pi, _ROUND // 2 + 1)

    def cap(centre: Floats, facing: float) -> Floats:
        return centre + radius * np.column_stack([np.cos(half + facing), np.sin(half + facing)])

    return np.concatenate([cap(b, heading), cap(a, heading + math.pi)])


def obstacle_outline(obstacle: Obstacle, axes: tuple[int, int]) -> Floats:
    """Return the outline, (c, 2), of an obstacle in the plane of two of the axes 0, 1, 2."""
    rotation, centre = np.reshape(obstacle.rotation, (3, 3)), np.array(obstacle.xyz)
    if obstacle.shape == "sphere":
        return stadium(centre[list(axes)], centre[list(axes)], obstacle.size[0])
    if obstacle.shape == "capsule":
        end = rotation @ np.array([0.0, 0.0, 0.5 * obstacle.size[1]])
        return stadium((centre - end)[list(axes)], (centre + end)[list(axes)], obstacle.size[0])
    return _sum_of_segments(centre[list(axes)], (rotation @ _sides(obstacle))[list(axes)].T)


def obstacle_bounds(obstacle: Obstacle) -> tuple[Floats, Floats]:
    """Return the lower and the upper corner, (3,) each, of an obstacle's bounding box."""
    body = obstacle.body
    if isinstance(body, PointCloud | Mesh):
        points, radius = (body.triangles.vertices, 0.0) if isinstance(body, Mesh) else (body.points, body.radius)
        points = body.pose.apply(points)
        return points.min(axis=0) - radius, points.max(axis=0) + radius
    top, side = obstacle_outline(obstacle, (0, 1)), obstacle_outline(obstacle, (0, 2))
    return (np.append(top.min(axis=0), side[:, 1].min()), np.append(top.max(axis=0), side[:, 1].max()))


def _sides(obstacle: Obstacle) -> Floats:
    """Return segments, as columns (3, s), whose Minkowski sum is a box or (nearly) a cylinder, in its frame."""
    if obstacle.shape == "box":
        return np.diag(obstacle.size)
    radius, length = obstacle.size
    # The sides of half a polygon; the other half has the same.
    angle = np.arange(_ROUND // 2 + 1) * (2.0 * math.pi / _ROUND)
    rim = np.diff(radius * np.stack([np.cos(angle), np.sin(angle), np.zeros(len(angle))]), axis=1)
    return np.column_stack([rim, [0.0, 0.0, length]])


def _sum_of_segments(centre: Floats, sides: Floats) -> Floats:
    """Return the outline, (2 s, 2), of a Minkowski sum of segments, (s, 2): each twice, in the order of angles."""
    upward = np.where((sides[:, 1:] < 0) | ((sides[:, 1:] == 0) & (sides[:, :1] < 0)), -sides, sides)
    upward = upward[np.argsort(np.arctan2(upward[:, 1], upward[:, 0]))]
    midpoints = np.cumsum(upward, axis=0) - 0.5 * upward.sum(axis=0)
    return np.concatenate([centre + midpoints, centre - midpoints])
