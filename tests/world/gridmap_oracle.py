"""The distance from a straight way to the obstacles of a bare map, by the definition: slow and readable."""

from __future__ import annotations

import math

import numpy as np

Point = tuple[float, float]


def distance_to_obstacles(a: Point, b: Point, occupied: np.ndarray) -> float:
    """Return the distance of segment ab from all closed occupied squares and from outside the map."""
    rows, cols = occupied.shape
    nearest = min(distance_to_outside(a, rows, cols), distance_to_outside(b, rows, cols))
    for row in range(rows):
        for col in range(cols):
            if occupied[row, col]:
                nearest = min(nearest, distance_to_square(a, b, col, row))
    return nearest


def points_to_obstacles(points: np.ndarray, occupied: np.ndarray) -> np.ndarray:
    """Return the distance of (n, 2) points from all closed occupied squares and from outside the map, (n,)."""
    rows, columns = np.nonzero(occupied)
    height, width = occupied.shape
    x, y = points[:, :1], points[:, 1:]
    aside = np.maximum(np.maximum(columns - x, x - columns - 1), 0.0)
    above = np.maximum(np.maximum(rows - y, y - rows - 1), 0.0)
    outside = np.min(np.concatenate([x, y, width - x, height - y], axis=1), axis=1)
    return np.minimum(np.hypot(aside, above).min(axis=1, initial=np.inf), np.maximum(outside, 0.0))


def distance_to_outside(p: Point, rows: int, cols: int) -> float:
    """Return how far inside the map p is; the map is convex, so of a segment only its ends count."""
    return max(0.0, min(p[0], p[1], cols - p[0], rows - p[1]))


def distance_to_square(a: Point, b: Point, col: int, row: int) -> float:
    """Return the distance of segment ab from [col, col+1] x [row, row+1].

    Unless they meet, it is attained at an end of the segment or at a corner of the square.
    """
    if meets_square(a, b, col, row):
        return 0.0
    corners = [(x, y) for x in (col, col + 1) for y in (row, row + 1)]
    to_corners = min(distance_from_point(corner, a, b) for corner in corners)
    to_ends = min(math.hypot(max(col - x, 0.0, x - col - 1), max(row - y, 0.0, y - row - 1)) for x, y in (a, b))
    return min(to_corners, to_ends)


def distance_from_point(p: Point, a: Point, b: Point) -> float:
    dx, dy = b[0] - a[0], b[1] - a[1]
    squared_length = dx * dx + dy * dy
    t = 0.0
    if squared_length > 0.0:
        t = min(1.0, max(0.0, ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / squared_length))
    return math.hypot(a[0] + t * dx - p[0], a[1] + t * dy - p[1])


def meets_square(a: Point, b: Point, col: int, row: int) -> bool:
    """Clip the segment by the square's two slabs and see whether anything is left."""
    first, last = 0.0, 1.0
    for start, end, low in ((a[0], b[0], col), (a[1], b[1], row)):
        if start == end:
            if not low <= start <= low + 1:
                return False
            continue
        t, u = (low - start) / (end - start), (low + 1 - start) / (end - start)
        first, last = max(first, min(t, u)), min(last, max(t, u))
    return first <= last
