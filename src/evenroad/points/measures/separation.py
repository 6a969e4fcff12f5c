"""Separation of points, and the Riesz energy, which close pairs raise."""

from __future__ import annotations

import math

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_count
from evenroad._native.points import riesz_rows
from evenroad.errors import InvalidValue
from evenroad.points.pointset import as_unit_points


def separation(points: object, periodic: bool = False) -> float:
    """Return the smallest Euclidean distance of two points, (n, d) in [0, 1), n >= 2; `periodic`: on the torus."""
    coordinates = _checked(points, "separation")
    n, d = coordinates.shape
    if np.unique(coordinates, axis=0).shape[0] < n:
        return 0.0
    # Imported late: plans import the measures, and do not need SciPy.
    from scipy.spatial import cKDTree

    tree = cKDTree(coordinates, boxsize=np.ones(d)) if periodic else cKDTree(coordinates)
    distances = np.asarray(tree.query(coordinates, k=2)[0])
    return float(distances[:, 1].min())


def riesz_rooted(points: object, s: int | None = None, periodic: bool = True) -> float:
    """Return the Riesz s-energy to the power 1/s; for large s this is the spacing n^(-1/d) over the smallest distance.

    The energy is (1/n) sum over i and j != i of (spacing / distance_ij)^s, with distances >= 10^-100.  `points` and
    `periodic` are as for :func:`separation`; the exponent `s`, >= 1, is 2d by default.
    """
    coordinates = _checked(points, "an energy")
    exponent = 2 * coordinates.shape[1] if s is None else require_count("s", s)
    columns = np.ascontiguousarray(coordinates.T)
    return math.exp(log_riesz_of_columns(columns, exponent, periodic, want_gradient=False)[0] / exponent)


def log_riesz_of_columns(columns: Floats, s: int, periodic: bool, want_gradient: bool) -> tuple[float, Floats]:
    """Return the log of the Riesz energy and its gradient, (d, n), at checked points of shape (d, n).

    Powers are relative to the largest of a row, and logs of rows are added, so nothing overflows.  Coincident points
    have the distance 10^-100 and no gradient.
    """
    d, n = columns.shape
    rows = riesz_rows(columns, s, periodic, want_gradient)
    sum_logs, pushes = np.log(rows.sums), rows.pushes
    row_logs = sum_logs - (0.5 * s) * np.log(rows.nearest)
    largest = row_logs.max()
    total_log = largest + math.log(np.exp(row_logs - largest).sum())
    logarithm = total_log - math.log(n) - (s / d) * math.log(n)
    if want_gradient:
        # Each pair occurs twice in the sum, so a point's own row is half of its gradient.
        pushes *= -2.0 * s * np.exp(row_logs - sum_logs - total_log)
    return logarithm, pushes


def _checked(points: object, what: str) -> Floats:
    coordinates = as_unit_points(points)
    if len(coordinates) < 2:
        raise InvalidValue(f"{what} needs at least 2 points, got {len(coordinates)}")
    return coordinates
