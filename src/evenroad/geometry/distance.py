"""Distances of points and segments, in double precision and plain numpy."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue
from evenroad.geometry.shapes import Shape


def segment_distance(first: Floats, second: Floats) -> Floats:
    """Return the distances of pairs of segments, (n, 2, 3) each, end points in the second axis: (n,).

    Closest points of two segments after C. Ericson, Real-Time Collision Detection (2005), section 5.1.9: the
    parameter on the second is that of the two lines, clamped; that on the first follows, clamped; the second
    follows once more.  That of the lines comes from the parts across the first segment, which keeps its digits
    where the two are nearly parallel.  A segment may be a point.
    """
    along, other = first[:, 1] - first[:, 0], second[:, 1] - second[:, 0]
    between = first[:, 0] - second[:, 0]
    a, e, b = _dot(along, along), _dot(other, other), _dot(along, other)
    c, f = _dot(along, between), _dot(other, between)
    safe = np.where(a > 0.0, a, 1.0)
    across = other - (b / safe)[:, np.newaxis] * along
    between_across = between - (c / safe)[:, np.newaxis] * along
    squared = _dot(across, across)
    # Of parallel segments any second parameter does: the two steps after it find the closest ends.
    t = _clamped(_dot(across, between_across), np.where(squared > 1e-30, squared, 0.0))
    s = _clamped(b * t - c, a)
    t = _clamped(b * s + f, e)
    gap = between + s[:, np.newaxis] * along - t[:, np.newaxis] * other
    return np.sqrt(_dot(gap, gap))


def _dot(first: Floats, second: Floats) -> Floats:
    return np.einsum("ni,ni->n", first, second)


def _clamped(numerator: Floats, denominator: Floats) -> Floats:
    """Return numerator / denominator within [0, 1]; 0 where the denominator is."""
    safe = np.where(denominator > 0.0, denominator, 1.0)
    return np.where(denominator > 0.0, np.clip(numerator / safe, 0.0, 1.0), 0.0)


def point_distance(point: Floats, shape: Shape) -> float:
    """Return the distance of a point (3,) from a box, sphere, cylinder or capsule along z; 0 inside [m].

    Raises
    ------
    InvalidValue
        If the shape is a mesh or a point cloud.
    """
    local = shape.pose.local(point)
    if shape.kind == "box":
        return float(np.linalg.norm(np.maximum(np.abs(local) - 0.5 * np.array(shape.size), 0.0)))
    if shape.kind == "sphere":
        return max(float(np.linalg.norm(local)) - shape.size[0], 0.0)
    if shape.kind not in ("cylinder", "capsule"):
        raise InvalidValue(f"distances from a {shape.kind} are not known")
    radius, length = shape.size
    above = max(abs(local[2]) - 0.5 * length, 0.0)
    aside = float(np.hypot(local[0], local[1]))
    if shape.kind == "capsule":
        return max(float(np.hypot(aside, above)) - radius, 0.0)
    return float(np.hypot(max(aside - radius, 0.0), above))
