"""Slow checks of a footprint among polygons: separating axes from each side, and the winding of borders at a corner."""

import math

import numpy as np

from tests.driving.oracle import Oracle, placed


def normals_of(corners):
    """Normals of the sides of polygons or segments, (..., n, 2), of length 1."""
    along = np.roll(corners, -1, axis=-2) - corners
    out = np.stack([along[..., 1], -along[..., 0]], axis=-1)
    return out / np.linalg.norm(out, axis=-1, keepdims=True)


def separations(polygon, sides):
    """The largest gap of a convex polygon from each segment, (k, 2, 2), along a normal of either, < 0: overlap."""
    of_polygon = normals_of(polygon)
    largest = ((sides @ of_polygon.T).min(axis=1) - (polygon @ of_polygon.T).max(axis=0)).max(axis=1)
    of_sides = normals_of(sides)
    seen = np.einsum("kij,nj->kin", of_sides, polygon).max(axis=2)
    return np.maximum(largest, (np.einsum("kij,kj->ki", of_sides, sides[:, 0]) - seen).max(axis=1))


def windings(border, point):
    """How often a border goes around a point."""
    seen = (border - point) @ [1.0, 1j]
    return round(np.angle(np.roll(seen, -1) / seen).sum() / (2.0 * math.pi))


class PolygonOracle(Oracle):
    """A footprint, as convex polygons, among the polygons of a map and around its border."""

    def __init__(self, polygon_map, parts):
        self.parts, self.polygons = [np.asarray(part, dtype=float) for part in parts], polygon_map.polygons
        (left, low), (right, high) = polygon_map.bounds
        outside = np.array([(left, low), (right, low), (right, high), (left, high)])
        borders = [outside, *(border for polygon in self.polygons for border in polygon)]
        self.sides = np.concatenate([np.stack([each, np.roll(each, -1, axis=0)], axis=1) for each in borders])
        self.outside = outside

    def is_inside(self, point):
        """Whether a point lies in a polygon, or outside of the map."""
        held = (sum(windings(border, point) % 2 for border in polygon) % 2 for polygon in self.polygons)
        return any(held) or windings(self.outside, point) == 0

    def gap(self, pose):
        """The least separation from all sides; below 0 in a polygon."""
        least = math.inf
        for part in self.parts:
            polygon = placed(part, pose)
            own = separations(polygon, self.sides).min()
            least = min(least, -own if own > 0 and self.is_inside(polygon[0]) else own)
        return least

    def distance(self, pose):
        """The distance from all sides, by the distances of corners from segments."""

        least = math.inf
        for part in self.parts:
            polygon = placed(part, pose)
            own = np.stack([polygon, np.roll(polygon, -1, axis=0)], axis=1)
            least = min(least, away(polygon, self.sides), away(self.sides.reshape(-1, 2), own))
        return least


def away(points, sides):
    """The least distance of points, (n, 2), from segments, (k, 2, 2)."""
    by = sides[:, 1] - sides[:, 0]
    from_first = points[:, np.newaxis] - sides[:, 0]
    t = np.clip(np.einsum("nki,ki->nk", from_first, by) / (by**2).sum(axis=1), 0.0, 1.0)
    return np.linalg.norm(from_first - t[:, :, np.newaxis] * by, axis=2).min()
