"""Separation: the smallest distance between two points."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from evenroad.errors import InvalidValue
from evenroad.points.pointset import as_unit_points


def separation(points: object, periodic: bool = False) -> float:
    """Return the smallest Euclidean distance between two of the points; large is spread out.

    Parameters
    ----------
    points : array_like or PointSet, shape (n, d)
        Coordinates in [0, 1), n >= 2.
    periodic : bool
        Whether distances are those of the torus, each coordinate wrapping modulo 1.

    Raises
    ------
    InvalidValue
        For fewer than two points or bad coordinates.
    """
    coordinates = as_unit_points(points)
    n, d = coordinates.shape
    if n < 2:
        raise InvalidValue(f"separation needs at least 2 points, got {n}")
    if np.unique(coordinates, axis=0).shape[0] < n:
        return 0.0
    tree = cKDTree(coordinates, boxsize=np.ones(d)) if periodic else cKDTree(coordinates)
    distances = np.asarray(tree.query(coordinates, k=2)[0])
    return float(distances[:, 1].min())
