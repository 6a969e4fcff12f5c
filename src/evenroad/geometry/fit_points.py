"""Small capsules around points, and the volume of capsules."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from evenroad._arrays import Floats
from evenroad._rng import generator
from evenroad.geometry.shapes import Capsule

Fitted = tuple[Floats, Floats, float]
"""Endpoints a and b, each (3,), and radius of a capsule."""
SAMPLES = 1 << 15
"""Number of points that estimate the volume of a union: a standard error of about half a per cent."""
_LEAST_RADIUS = 1e-6
"""Radius around points in a line [m]."""


def capsule_around(points: Floats) -> Fitted:
    """Return a small capsule that contains all points, (n, 3), to rounding.

    :func:`rough_capsule_around`, refined over the axis by the simplex of Nelder and Mead (1965).
    """
    from scipy.optimize import minimize

    points = extreme(points)
    centre, frames = _starts(points)
    frame = min(frames, key=lambda start: volume(_capsule_on(points, centre, start)))
    best = _capsule_on(points, centre, frame)
    size = float(np.ptp(points, axis=0).max()) or 1.0

    def moved(x: Floats) -> Fitted:
        tilted = _frame(frame[0] + x[0] * frame[1] + x[1] * frame[2])
        return _capsule_on(points, centre + size * (x[2] * frame[1] + x[3] * frame[2]), tilted)

    steps = np.vstack([np.zeros(4), 0.1 * np.eye(4)])
    options = dict(maxiter=200, xatol=1e-4, fatol=1e-4 * volume(best), initial_simplex=steps)
    search: Any = minimize
    found = search(lambda x: volume(moved(x)), np.zeros(4), method="Nelder-Mead", options=options)
    return min((best, moved(found.x)), key=volume)


def rough_capsule_around(points: Floats) -> Fitted:
    """Return the smallest capsule around points, (n, 3), through the middle along a principal or coordinate axis."""
    centre, frames = _starts(points)
    return min((_capsule_on(points, centre, frame) for frame in frames), key=volume)


def volume(capsule: Fitted) -> float:
    """Return the volume of a capsule."""
    a, b, radius = capsule
    return math.pi * radius**2 * (math.dist(a, b) + 4.0 / 3.0 * radius)


def _starts(points: Floats) -> tuple[Floats, list[Floats]]:
    """Return the middle of the points' bounding box, and frames along principal and coordinate axes."""
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    _, _, axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=len(points) < 3)
    return centre, [_frame(axis) for axis in (*np.eye(3), *axes)]


def _capsule_on(points: Floats, origin: Floats, frame: Floats) -> Fitted:
    """Return the smallest of six capsules around the points on the line through `origin` along ``frame[0]``.

    The radius is the least that the line allows, or more where the shorter caps save volume.
    """
    relative = points - origin
    along = relative @ frame[0]
    squared = np.maximum(np.einsum("ni,ni->n", relative, relative) - along**2, 0.0)
    least = math.sqrt(float(squared.max()))
    span = 0.5 * float(np.ptp(along))
    candidates = []
    for share in (0.0, 0.1, 0.2, 0.35, 0.6, 1.0):
        radius = math.hypot(least, share * span) * (1.0 + 1e-12) + 1e-12 * span
        reach = np.sqrt(np.maximum(radius**2 - squared, 0.0))
        # A point is within the cap of an end that is no further than `reach` from it along the axis.
        low, high = float((along + reach).min()), float((along - reach).max())
        if low > high:
            low = high = 0.5 * (low + high)
        endpoints = (origin + low * frame[0], origin + high * frame[0])
        candidates.append((*endpoints, max(radius, _LEAST_RADIUS)))
    return min(candidates, key=volume)


def _frame(axis: Floats) -> Floats:
    """Return three unit vectors as rows, the first along `axis`."""
    first = axis / np.linalg.norm(axis)
    helper = np.eye(3)[np.abs(first).argmin()]
    second = np.cross(first, helper)
    second /= np.linalg.norm(second)
    return np.stack([first, second, np.cross(first, second)])


def extreme(points: Floats) -> Floats:
    """Return the corners of the convex hull: a capsule that contains those contains all points."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return points[np.sort(ConvexHull(points).vertices)]
    except QhullError:
        # All in one plane, or fewer than four.
        return np.unique(points, axis=0)


def union_volume(capsules: Sequence[Capsule]) -> float:
    """Return the volume of the union of capsules in one frame [m^3], by 32768 fixed random points."""
    a, b = (np.array([getattr(capsule, end) for capsule in capsules]) for end in ("a", "b"))
    radius = np.array([capsule.radius for capsule in capsules])
    low = (np.minimum(a, b) - radius[:, np.newaxis]).min(axis=0)
    high = (np.maximum(a, b) + radius[:, np.newaxis]).max(axis=0)
    points = low + generator(0).random((SAMPLES, 3)) * (high - low)
    inside = np.zeros(SAMPLES, dtype=np.bool_)
    for start, end, reach in zip(a, b, radius, strict=True):
        axis = end - start
        along = np.clip((points - start) @ axis / max(float(axis @ axis), 1e-300), 0.0, 1.0)
        inside |= ((points - start - along[:, np.newaxis] * axis) ** 2).sum(axis=1) <= reach**2
    return float(inside.mean() * np.prod(high - low))
