"""Distances of points from obstacles, in double precision and plain numpy: what tables are built with."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.geometry.distance import point_distance
from evenroad.robot.scene import Obstacle

Vector = npt.NDArray[np.float64]


def point_to_obstacle(point: Vector, obstacle: Obstacle) -> float:
    """Return the distance of a point (3,) from an obstacle, 0 inside [m]."""
    return point_distance(point, obstacle.body)
