"""Distances of points and segments, in double precision and plain numpy."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue
from evenroad.geometry.shapes import PRIMITIVES, Box, Capsule, Cylinder, Shape, Sphere


def point_distance(shape: Shape, points: Floats) -> Floats:
    """Return the distances of points, (n, 3), from a box, sphere, cylinder or capsule, 0 inside: (n,) [m].

    Raises InvalidValue for another shape.
    """
    own = shape.pose.local(points)
    match shape:
        case Box():
            return _length(np.maximum(np.abs(own) - 0.5 * np.array(shape.size), 0.0))
        case Sphere():
            return np.maximum(_length(own) - shape.radius, 0.0)
        case Cylinder():
            aside = np.maximum(np.hypot(own[:, 0], own[:, 1]) - shape.radius, 0.0)
            return np.hypot(aside, np.maximum(np.abs(own[:, 2]) - 0.5 * shape.length, 0.0))
        case Capsule():
            a, along = np.array(shape.a), np.subtract(shape.b, shape.a)
            share = _clamped((own - a) @ along, np.full(len(own), along @ along))
            return np.maximum(_length(own - a - share[:, np.newaxis] * along) - shape.radius, 0.0)
        case _:
            raise InvalidValue(f"a region must be one of {', '.join(PRIMITIVES)}, got a {shape}")


def segment_distance(first: Floats, second: Floats) -> Floats:
    """Return the distances of pairs of segments, (n, 2, 3) each, endpoints in the second axis: (n,).

    The method is that of C. Ericson, Real-Time Collision Detection (2005), section 5.1.9.  Components across the first
    segment keep it accurate for nearly parallel segments.  A segment may be a point.
    """
    along, other = first[:, 1] - first[:, 0], second[:, 1] - second[:, 0]
    between = first[:, 0] - second[:, 0]
    a, e, b = _dot(along, along), _dot(other, other), _dot(along, other)
    c, f = _dot(along, between), _dot(other, between)
    safe = np.where(a > 0.0, a, 1.0)
    across = other - (b / safe)[:, np.newaxis] * along
    between_across = between - (c / safe)[:, np.newaxis] * along
    squared = _dot(across, across)
    # For parallel segments any second parameter works: the next two steps find the closest points.
    t = _clamped(_dot(across, between_across), np.where(squared > 1e-30, squared, 0.0))
    s = _clamped(b * t - c, a)
    t = _clamped(b * s + f, e)
    gap = between + s[:, np.newaxis] * along - t[:, np.newaxis] * other
    return np.sqrt(_dot(gap, gap))


def _length(vectors: Floats) -> Floats:
    lengths: Floats = np.linalg.norm(vectors, axis=1)
    return lengths


def _dot(first: Floats, second: Floats) -> Floats:
    products: Floats = np.einsum("ni,ni->n", first, second)
    return products


def _clamped(numerator: Floats, denominator: Floats) -> Floats:
    """Return numerator / denominator, clipped to [0, 1]; 0 if the denominator is 0."""
    safe = np.where(denominator > 0.0, denominator, 1.0)
    return np.where(denominator > 0.0, np.clip(numerator / safe, 0.0, 1.0), 0.0)
