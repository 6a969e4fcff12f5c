"""Convex hulls that contain a shape, and how to split them where they contain too much."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field

import numpy as np

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue
from evenroad.geometry.fit import best_cut, divided
from evenroad.geometry.fit_points import extreme
from evenroad.geometry.shapes import Box, Capsule, Cylinder, Mesh, Shape, Sphere

SIDES = 32
"""Of the prism that stands for a cylinder: it reaches half a per cent of the radius beyond."""
_FEW = 64
"""A hull of more corners is thinned."""
_THINNED = 3e-4
"""A thinned hull is widened by no more [m]."""
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Hull:
    """All points within `radius` of the convex hull of `points`, (n, 3), in the frame of a link [m]; equal by value."""

    points: Floats
    radius: float
    link: str
    _hash: int = field(init=False, repr=False)

    def __post_init__(self) -> None:
        points = np.array(self.points, dtype=np.float64).reshape(-1, 3)
        points.setflags(write=False)
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "_hash", hash((points.tobytes(), self.radius, self.link)))

    def __hash__(self) -> int:
        return self._hash

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Hull):
            return NotImplemented
        same = self.link == other.link and self.radius == other.radius
        return self is other or (same and np.array_equal(self.points, other.points))

    @property
    def is_round(self) -> bool:
        """Whether it is a ball or a capsule."""
        return len(self.points) <= 2


def hull_around(points: Floats, radius: float, link: str) -> Hull:
    """Return the hull of points, (n, 3), widened by `radius`, and by what rounding may lose."""
    return Hull(points, radius + _ROUNDING * (1.0 + float(np.abs(points).max())), link)


def _thinned(corners: Floats) -> tuple[Floats, float]:
    """Return some of a hull's corners, (n, 3), and a length that no other is farther away from their hull [m]."""
    kept = np.unique((corners @ _directions(_FEW).T).argmax(axis=0))
    while True:
        away = _distances_from_hull(corners, corners[kept])
        if away is None or len(kept) == len(corners):
            return corners, 0.0
        away[kept] = 0.0
        if away.max() <= _THINNED:
            return corners[kept], float(away.max())
        kept = np.union1d(kept, np.argsort(-away)[: _FEW // 4])


def _directions(count: int) -> Floats:
    """Return unit vectors spread over the sphere, (count, 3): a spiral by the golden angle."""
    z = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(count)
    around = np.sqrt(1.0 - z**2)
    return np.stack([around * np.cos(turn), around * np.sin(turn), z], axis=1)


def _distances_from_hull(points: Floats, few: Floats) -> Floats | None:
    """Return lengths, (n,), than which points are no farther away from the hull of a few; None where these are flat."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(few)
    except QhullError:
        return None
    beyond = points @ hull.equations[:, :3].T + hull.equations[:, 3]
    side = beyond.argmax(axis=1)
    a, b, c = few[hull.simplices[side]].transpose(1, 0, 2)
    # A point of the side that it is farthest beyond: its weights by least squares, those below zero cut.
    e, f, r = b - a, c - a, points - a
    ee, ef, ff, er, fr = (np.einsum("ni,ni->n", u, v) for u, v in ((e, e), (e, f), (f, f), (e, r), (f, r)))
    area = np.maximum(ee * ff - ef * ef, 1e-300)
    second, third = (
        np.clip((ff * er - ef * fr) / area, 0.0, 1.0),
        np.clip((ee * fr - ef * er) / area, 0.0, 1.0),
    )
    most = np.maximum(second + third, 1.0)
    nearest = a + (second / most)[:, np.newaxis] * e + (third / most)[:, np.newaxis] * f
    return np.where(beyond.max(axis=1) <= _ROUNDING, _ROUNDING, np.linalg.norm(points - nearest, axis=1))


@dataclass(frozen=True, eq=False)
class Piece:
    """A hull, and what it is around: convex `parts`, (k, corners, 3) [m], widened by `radius`.

    Parts are the triangles of a mesh, or the one part that another shape is.  A cylinder's is a prism inside of it, its
    hull one around it.
    """

    hull: Hull
    parts: Floats
    radius: float = 0.0


def piece_of(shape: Shape) -> Piece:
    """Return a shape's hull and what it is around; raises as :func:`evenroad.geometry.fit_capsules`."""
    radius, outward = 0.0, 1.0
    if isinstance(shape, Sphere):
        points, radius = np.zeros((1, 3)), shape.radius
    elif isinstance(shape, Capsule):
        points, radius = np.unique([shape.a, shape.b], axis=0), shape.radius
    elif isinstance(shape, Box):
        points = 0.5 * np.array(shape.size) * np.array(list(itertools.product((-1, 1), repeat=3)))
    elif isinstance(shape, Cylinder):
        turn, outward = np.arange(SIDES) * 2.0 * np.pi / SIDES, 1.0 / np.cos(np.pi / SIDES)
        ring = shape.radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        points = np.concatenate(
            [np.c_[ring, np.full(SIDES, end)] for end in (-0.5, 0.5) * np.array(shape.length)]
        )
    elif isinstance(shape, Mesh):
        mesh = shape.triangles
        return _piece_around(shape.pose.apply(mesh.vertices)[mesh.triangles], shape.link)
    else:
        raise InvalidValue(f"no hull is made around a {shape}")
    hull = hull_around(shape.pose.apply(points * (outward, outward, 1.0)), radius, shape.link)
    return Piece(hull, shape.pose.apply(points)[np.newaxis], radius)


def halves(piece: Piece) -> tuple[Piece, ...]:
    """Return two pieces of a mesh in place of one; the piece itself where it cannot be split."""
    corners = divided(piece.parts) if piece.parts.shape[1] == 3 else piece.parts[:0]
    below = best_cut(corners, _box_volume) if len(corners) > 1 else None
    if below is None:
        return (piece,)
    return tuple(_piece_around(corners[side], piece.hull.link) for side in (below, ~below))


def _piece_around(corners: Floats, link: str) -> Piece:
    points, beyond = extreme(corners.reshape(-1, 3)), 0.0
    if len(points) > _FEW:
        points, beyond = _thinned(points)
    return Piece(hull_around(points, beyond, link), corners)


def _box_volume(corners: Floats) -> float:
    """Return the volume of a box around triangles, along the coordinate axes or the triangles' own [m^3]."""
    points = corners.reshape(-1, 3)
    _, _, axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    # Flat ones count, too: by what is around them.
    return min(float(np.prod(np.ptp(points @ turned.T, axis=0) + 1e-4)) for turned in (np.eye(3), axes))
