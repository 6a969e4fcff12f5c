"""The share of one body inside another, for robots drawn with one link inside the other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad.geometry.hulls import Piece

_ACROSS = 8
"""Number of points along each side of the box around a body."""


def share_inside(body: Sequence[Piece], other: Sequence[Piece], poses: Floats) -> Floats:
    """Return which share of a body, by volume, is inside of another, for its poses, (n, 4, 4), in that one's frame.

    It is estimated by a grid of points; 0 of a body that has no inside, as an open surface has none.
    """
    corners = np.concatenate([piece.parts.reshape(-1, 3) for piece in body])
    widest = max(piece.radius for piece in body)
    low, high = corners.min(axis=0) - widest, corners.max(axis=0) + widest
    steps = (np.arange(_ACROSS) + 0.5) / _ACROSS
    grid = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
    points = low + grid * (high - low)
    points = points[_inside(body, points)]
    if len(points) == 0:
        return np.zeros(len(poses))
    placed = np.einsum("nij,pj->npi", poses[:, :3, :3], points) + poses[:, np.newaxis, :3, 3]
    return _inside(other, placed.reshape(-1, 3)).reshape(len(poses), -1).mean(axis=1)


def _inside(pieces: Sequence[Piece], points: Floats) -> Bools:
    inside = np.zeros(len(points), dtype=np.bool_)
    for piece in pieces:
        corners = piece.parts.reshape(-1, 3)
        low, high = corners.min(axis=0) - piece.radius, corners.max(axis=0) + piece.radius
        near = np.flatnonzero(~inside & (points >= low).all(axis=1) & (points <= high).all(axis=1))
        inside[near] = _inside_piece(piece, points[near])
    return inside


def _inside_piece(piece: Piece, points: Floats) -> Bools:
    from scipy.spatial import ConvexHull, QhullError

    parts = piece.parts
    if len(parts) > 1 or parts.shape[1] == 3:
        return np.array([abs(_turns(parts, point)) > 0.5 for point in points], dtype=np.bool_)
    if parts.shape[1] <= 2:
        a, along = parts[0, 0], parts[0, -1] - parts[0, 0]
        share = np.clip((points - a) @ along / max(float(along @ along), 1e-300), 0.0, 1.0)
        return np.linalg.norm(points - a - share[:, np.newaxis] * along, axis=1) <= piece.radius
    try:
        sides = ConvexHull(parts[0]).equations
    except QhullError:
        return np.zeros(len(points), dtype=np.bool_)
    return (points @ sides[:, :3].T + sides[:, 3]).max(axis=1) <= piece.radius


def _turns(triangles: Floats, point: Floats) -> float:
    """Return how many times a surface, (t, 3, 3), goes around a point (Van Oosterom and Strackee 1983)."""
    a, b, c = (triangles - point).swapaxes(0, 1)
    la, lb, lc = (np.linalg.norm(each, axis=1) for each in (a, b, c))
    over = np.einsum("ti,ti->t", a, np.cross(b, c))
    dots = [np.einsum("ti,ti->t", *pair) for pair in ((a, b), (b, c), (c, a))]
    under = la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb
    return float(np.arctan2(over, under).sum()) / (2.0 * np.pi)
