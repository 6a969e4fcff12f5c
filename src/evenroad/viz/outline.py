"""Outlines of bodies as they are seen along a coordinate axis."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from scipy.spatial import ConvexHull

from evenroad.robot.scene import Obstacle

_ROUND = 32
"""Corners that stand for a circle."""


def stadium(a: npt.NDArray[np.float64], b: npt.NDArray[np.float64], radius: float) -> npt.NDArray[np.float64]:
    """Return the outline, (c, 2), of all points within `radius` of the segment from `a` to `b`, both (2,)."""
    heading = math.atan2(b[1] - a[1], b[0] - a[0])
    half = np.linspace(-0.5 * math.pi, 0.5 * math.pi, _ROUND // 2 + 1)

    def cap(centre: npt.NDArray[np.float64], facing: float) -> npt.NDArray[np.float64]:
        return centre + radius * np.column_stack([np.cos(half + facing), np.sin(half + facing)])

    return np.concatenate([cap(b, heading), cap(a, heading + math.pi)])


def obstacle_outline(obstacle: Obstacle, axes: tuple[int, int]) -> npt.NDArray[np.float64]:
    """Return the outline, (c, 2), of an obstacle in the plane of two of the axes 0, 1, 2."""
    rotation, centre = np.reshape(obstacle.rotation, (3, 3)), np.array(obstacle.xyz)
    if obstacle.shape == "sphere":
        return stadium(centre[list(axes)], centre[list(axes)], obstacle.size[0])
    if obstacle.shape == "capsule":
        end = rotation @ np.array([0.0, 0.0, 0.5 * obstacle.size[1]])
        return stadium((centre - end)[list(axes)], (centre + end)[list(axes)], obstacle.size[0])
    corners = (rotation @ _corners(obstacle).T).T + centre
    flat = corners[:, axes]
    return flat[ConvexHull(flat).vertices]


def obstacle_bounds(obstacle: Obstacle) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return the lower and the upper corner, (3,) each, of an obstacle's bounding box."""
    top, side = obstacle_outline(obstacle, (0, 1)), obstacle_outline(obstacle, (0, 2))
    return (
        np.append(top.min(axis=0), side[:, 1].min()),
        np.append(top.max(axis=0), side[:, 1].max()),
    )


def _corners(obstacle: Obstacle) -> npt.NDArray[np.float64]:
    """Return points, (c, 3), in the body's frame whose convex hull a box or cylinder is."""
    if obstacle.shape == "box":
        signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        return 0.5 * signs * np.array(obstacle.size)
    radius, length = obstacle.size
    angle = np.linspace(0.0, 2.0 * math.pi, _ROUND, endpoint=False)
    rim = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    ends = [np.column_stack([rim, np.full(_ROUND, z)]) for z in (-0.5 * length, 0.5 * length)]
    return np.concatenate(ends)
