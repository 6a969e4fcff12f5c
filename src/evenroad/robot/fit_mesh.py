"""Few capsules around a mesh: every triangle lies within one of them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

MOST_CAPSULES = 4
"""Most capsules of a mesh."""
WORTHWHILE = 0.85
"""A split must bring the sum of volumes below this share."""
_CUTS = (0.2, 0.35, 0.5, 0.65, 0.8)

Fitted = tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], float]


def capsules_around_mesh(vertices: npt.NDArray[np.float64], triangles: npt.NDArray[np.int64]) -> list[Fitted]:
    """Return up to 4 capsules (a, b, radius) such that every triangle lies within one of them.

    One capsule is fitted around everything; then the one whose split saves most is split, as long as that saves a
    sixth of its volume.  A split shares its triangles out by where along the capsule's axis, or along one of the two
    principal axes across it, their centres lie.  A capsule is convex, so it contains the triangles whose corners it
    contains: what touches the surface of the mesh touches a capsule.
    """
    corners = vertices[triangles]
    parts = [(np.arange(len(triangles)), capsule_around(vertices[np.unique(triangles)]))]
    while len(parts) < MOST_CAPSULES:
        splits = [_best_split(corners, triangles_of) for triangles_of, _ in parts]
        gains = [
            volume(whole) - sum(volume(capsule) for _, capsule in split)
            if split and sum(volume(capsule) for _, capsule in split) < WORTHWHILE * volume(whole)
            else 0.0
            for (_, whole), split in zip(parts, splits, strict=True)
        ]
        best = int(np.argmax(gains))
        if gains[best] <= 0.0:
            break
        parts[best : best + 1] = splits[best]
    return [capsule for _, capsule in parts]


def capsule_around(points: npt.NDArray[np.float64], *, refine: bool = True) -> Fitted:
    """Return a small capsule (a, b, radius) that contains all points, (n, 3), to rounding.

    The axis starts as each of the principal axes; the best is refined by Nelder and Mead's simplex over
    its direction and place.  The radius is the least that the axis allows, or more where shorter caps save volume.
    """
    centre = points.mean(axis=0)
    _, _, axes = np.linalg.svd(points - centre, full_matrices=len(points) < 3)
    starts = [_frame(axis) for axis in axes]
    best = min((_capsule_on(points, centre, frame) for frame in starts), key=volume)
    if not refine:
        return best
    from scipy.optimize import minimize

    size = float(np.ptp(points, axis=0).max()) or 1.0
    frame = min(starts, key=lambda start: volume(_capsule_on(points, centre, start)))

    def moved(x: npt.NDArray[np.float64]) -> Fitted:
        tilted = _frame(frame[0] + x[0] * frame[1] + x[1] * frame[2])
        return _capsule_on(points, centre + size * (x[2] * frame[1] + x[3] * frame[2]), tilted)

    steps = np.vstack([np.zeros(4), 0.1 * np.eye(4)])
    options: Any = {"maxiter": 200, "xatol": 1e-4, "fatol": 1e-4 * volume(best), "initial_simplex": steps}
    found = minimize(lambda x: volume(moved(x)), np.zeros(4), method="Nelder-Mead", options=options)
    return min((best, moved(found.x)), key=volume)


def volume(capsule: Fitted) -> float:
    """Return the volume of a capsule (a, b, radius)."""
    a, b, radius = capsule
    return math.pi * radius**2 * (math.dist(a, b) + 4.0 / 3.0 * radius)


def _capsule_on(
    points: npt.NDArray[np.float64], place: npt.NDArray[np.float64], frame: npt.NDArray[np.float64]
) -> Fitted:
    """Return the smallest of six capsules around the points on the line through `place` along ``frame[0]``."""
    relative = points - place
    along = relative @ frame[0]
    squared = np.maximum((relative**2).sum(axis=1) - along**2, 0.0)
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
        candidates.append((place + low * frame[0], place + high * frame[0], max(radius, 1e-6)))
    return min(candidates, key=volume)


def _frame(axis: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return three unit vectors as rows, the first along `axis`."""
    first = axis / np.linalg.norm(axis)
    helper = np.eye(3)[np.abs(first).argmin()]
    second = np.cross(first, helper)
    second /= np.linalg.norm(second)
    return np.stack([first, second, np.cross(first, second)])


def _best_split(
    corners: npt.NDArray[np.float64], chosen: npt.NDArray[np.int64]
) -> list[tuple[npt.NDArray[np.int64], Fitted]]:
    """Return the two parts of the best split of the chosen triangles; empty if there is none."""
    centres = corners[chosen].mean(axis=1)
    _, _, axes = np.linalg.svd(centres - centres.mean(axis=0), full_matrices=len(centres) < 3)
    best: tuple[float, list[npt.NDArray[np.int64]]] = (math.inf, [])
    for axis in axes:
        along = centres @ axis
        low, width = float(along.min()), float(np.ptp(along))
        for cut in _CUTS:
            below = along < low + cut * width
            if below.all() or not below.any():
                continue
            parts = [chosen[below], chosen[~below]]
            total = sum(volume(capsule_around(_distinct(corners[part]), refine=False)) for part in parts)
            if total < best[0]:
                best = (total, parts)
    return [(part, capsule_around(_distinct(corners[part]))) for part in best[1]]


def _distinct(corners: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return np.unique(corners.reshape(-1, 3), axis=0)
