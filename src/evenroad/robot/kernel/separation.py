"""Distances of points from obstacles, in double precision and plain numpy: what tables are built with."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.robot.scene import Obstacle

Vector = npt.NDArray[np.float64]


def point_to_obstacle(point: Vector, obstacle: Obstacle) -> float:
    """Return the distance of a point (3,) from an obstacle, 0 inside [m]."""
    local = np.array(obstacle.rotation).reshape(3, 3).T @ (point - np.array(obstacle.xyz))
    if obstacle.shape == "box":
        return float(np.linalg.norm(np.maximum(np.abs(local) - 0.5 * np.array(obstacle.size), 0.0)))
    if obstacle.shape == "sphere":
        return max(float(np.linalg.norm(local)) - obstacle.size[0], 0.0)
    radius, length = obstacle.size
    above = max(abs(local[2]) - 0.5 * length, 0.0)
    aside = float(np.hypot(local[0], local[1]))
    if obstacle.shape == "capsule":
        return max(float(np.hypot(aside, above)) - radius, 0.0)
    return float(np.hypot(max(aside - radius, 0.0), above))
