"""Distances between bodies that do not move, in double precision and plain numpy: what tables are built with."""

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


def segment_to_segment(a: Vector, b: Vector, c: Vector, d: Vector) -> float:
    """Return the distance between the segments from `a` to `b` and from `c` to `d`, each (3,) [m].

    The nearest points are either an end of one segment and its nearest on the other, or inside both.
    """
    nearest = min(
        _point_to_segment(a, c, d),
        _point_to_segment(b, c, d),
        _point_to_segment(c, a, b),
        _point_to_segment(d, a, b),
    )
    system = np.column_stack([b - a, c - d])
    gram = system.T @ system
    if np.linalg.det(gram) <= 1e-14 * gram[0, 0] * gram[1, 1]:
        return nearest
    inside = np.linalg.solve(gram, system.T @ (c - a))
    if ((inside >= 0.0) & (inside <= 1.0)).all():
        nearest = min(nearest, float(np.linalg.norm(a - c + system @ inside)))
    return nearest


def _point_to_segment(point: Vector, a: Vector, b: Vector) -> float:
    along = b - a
    squared = float(along @ along)
    share = 0.0 if squared == 0.0 else min(max(float((point - a) @ along) / squared, 0.0), 1.0)
    return float(np.linalg.norm(point - a - share * along))
