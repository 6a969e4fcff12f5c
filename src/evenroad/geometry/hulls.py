"""Convex hulls that contain a shape, and their splits where they contain too much."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from evenroad._arrays import Bools, Floats, Ints, set_fields
from evenroad.errors import InvalidValue
from evenroad.geometry.fit import best_cut, divided, farthest, used
from evenroad.geometry.mesh import TriangleMesh, extreme
from evenroad.geometry.shapes import Box, Capsule, Cylinder, Mesh, Shape, Sphere

SIDES = 32
"""Number of sides of the prism around a cylinder; it reaches half a per cent of the radius beyond the cylinder."""
_FEW = 64
"""Largest number of corners of a hull that is not thinned."""
_THINNED, _SHARE = 3e-4, 5e-3
"""Largest height of a corner that thinning removes [m], and in parts of the hull's extent."""
_MOST_CORNERS = 2048
"""Largest number of corners of a convex mesh that gets a closer hull; for more corners it would take gigabytes."""
_SIDES_TRIED = 4
_ROUNDING = 1e-9
_AT_ONCE = 1 << 16
"""Number of products of points and directions that are made together."""
_DEEP = 1e-6
"""Depth in a hull below which its convex mesh fills it [m]; a proof keeps a hundred times that."""
_MOST_COMPARED = 10_000_000
"""Largest number of pairs of a triangle and a side of the hull; a mesh with more is not called solid."""


@dataclass(frozen=True, eq=False)
class Hull:
    """All points within `radius` of the convex hull of `points`, (n, 3), in the frame of a link [m]; equal by value.

    `solid` says that the convex hull of the points, not widened, lies within the link's true shape.
    """

    points: Floats
    radius: float
    link: str
    solid: bool = field(default=False, compare=False)

    def __post_init__(self) -> None:
        set_fields(self, points=np.array(self.points, dtype=np.float64).reshape(-1, 3))

    @cached_property
    def _hash(self) -> int:
        return hash((self.points.tobytes(), self.radius, self.link, self.solid))

    def __hash__(self) -> int:
        return self._hash

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Hull):
            return NotImplemented
        same = (self.link, self.radius, self.solid) == (other.link, other.radius, other.solid)
        return self is other or (same and np.array_equal(self.points, other.points))

    @property
    def is_round(self) -> bool:
        """Whether it is a ball or a capsule."""
        return len(self.points) <= 2


def hull_around(points: Floats, radius: float, link: str, *, solid: bool = False) -> Hull:
    """Return the hull of points, (n, 3), widened by `radius` and by a margin for rounding."""
    return Hull(points, radius + _ROUNDING * (1.0 + float(np.abs(points).max())), link, solid)


def thinned(corners: Floats, little: float) -> tuple[Floats, float]:
    """Return some of a hull's corners, (n, 3), and an upper bound of the distance of the others from their hull [m].

    No other corner is more than `little` [m] beyond a side of that hull.
    """
    from scipy.spatial import ConvexHull, QhullError

    few, out = farthest(corners, _FEW // 2), corners
    while True:
        try:
            hull = ConvexHull(few)
        except QhullError:
            return corners, 0.0
        beyond = products(out, hull.equations[:, :3]) + hull.equations[:, 3]
        # The hull only grows, so points inside stay inside.
        is_out = beyond.max(axis=1) > _ROUNDING
        out, beyond = out[is_out], beyond[is_out]
        most = beyond.max(axis=0, initial=0.0)
        if most.max() <= little:
            break
        added = beyond[:, most > max(0.7 * most.max(), little)].argmax(axis=0)
        few = np.concatenate([few, out[np.unique(added)]])
    # The distance to any side that a point is farthest beyond bounds its distance from the hull.
    tried = np.argpartition(-beyond, _SIDES_TRIED - 1, axis=1)[:, :_SIDES_TRIED] if len(out) else np.zeros((0, 1), int)
    sides = few[hull.simplices[tried]]
    nearest = [distances(out, sides[:, k]) for k in range(sides.shape[1])]
    return few, float(np.min(nearest, axis=0).max(initial=_ROUNDING))


def products(points: Floats, directions: Floats) -> Floats:
    """Return the products of points, (n, 3), and directions, (d, 3), as (n, d).

    They are made of few points at a time, so that no threads wait for each other: waiting costs more than the products.
    """
    made, some = np.empty((len(points), len(directions))), max(1, _AT_ONCE // len(directions))
    for first in range(0, len(points), some):
        np.matmul(points[first : first + some], directions.T, out=made[first : first + some])
    return made


def distances(points: Floats, sides: Floats) -> Floats:
    """Return the distances of points, (n, 3), from triangles, (n, 3, 3)."""
    normal = np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    least, inside = np.full(len(points), np.inf), np.ones(len(points), dtype=np.bool_)
    for i in range(3):
        along, from_corner = sides[:, (i + 1) % 3] - sides[:, i], points - sides[:, i]
        share = np.einsum("ni,ni->n", from_corner, along) / np.einsum("ni,ni->n", along, along)
        apart = from_corner - np.clip(share, 0.0, 1.0)[:, np.newaxis] * along
        least = np.minimum(least, np.linalg.norm(apart, axis=1))
        inside &= np.einsum("ni,ni->n", np.cross(along, from_corner), normal) > 0.0
    return np.where(inside, np.abs(np.einsum("ni,ni->n", points - sides[:, 0], normal)), least)


@dataclass(frozen=True, eq=False)
class Piece:
    """A hull around convex `parts`, (k, corners, 3) [m], widened by `radius`.

    Parts are the triangles of a mesh; a closed convex mesh, or any other shape, is one part.  A cylinder's part is a
    prism inside it, and its hull a prism around it.  The parts' corners are `points`, (n, 3), by their `rows`, (k, c).
    """

    hull: Hull
    points: Floats
    rows: Ints
    radius: float = 0.0

    @classmethod
    def solid(cls, hull: Hull, points: Floats, radius: float = 0.0) -> Piece:
        """Return a piece of one part."""
        return cls(hull, points, np.arange(len(points))[np.newaxis], radius)

    @cached_property
    def parts(self) -> Floats:
        """The corners of all parts."""
        return self.points[self.rows]


def piece_of(shape: Shape) -> Piece:
    """Return a shape's hull and its parts; raises as :func:`evenroad.geometry.fit_capsules`."""
    radius, outward = 0.0, 1.0
    if isinstance(shape, Sphere):
        points, radius = np.zeros((1, 3)), shape.radius
    elif isinstance(shape, Capsule):
        points, radius = np.array(sorted({shape.a, shape.b})), shape.radius
    elif isinstance(shape, Box):
        points = 0.5 * np.array(shape.size) * np.array(list(itertools.product((-1, 1), repeat=3)))
    elif isinstance(shape, Cylinder):
        turn, outward = np.arange(SIDES) * 2.0 * np.pi / SIDES, 1.0 / np.cos(np.pi / SIDES)
        ring = shape.radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        caps = (-0.5, 0.5) * np.array(shape.length)
        points = np.concatenate([np.c_[ring, np.full(SIDES, end)] for end in caps])
    elif isinstance(shape, Mesh):
        mesh = shape.triangles.compact
        hull = _hull_around(shape.pose.apply(mesh.outer), shape.link)
        if not mesh.is_convex:
            return Piece(hull, shape.pose.apply(mesh.vertices), mesh.triangles)
        # A split would lose the inside, and gain nothing.
        return Piece.solid(replace(hull, solid=_is_on_its_hull(mesh)), shape.pose.apply(mesh.outer))
    else:
        raise InvalidValue(f"no hull is made around a {shape}")
    corners = shape.pose.apply(points * (outward, outward, 1.0))
    hull = hull_around(corners, radius, shape.link, solid=isinstance(shape, Box))
    return Piece.solid(hull, shape.pose.apply(points), radius)


def _is_on_its_hull(mesh: TriangleMesh) -> bool:
    """Return whether a convex mesh contains all points that are a micrometre deep in its hull.

    It does if every triangle is that near to a side of the hull.  Then the mesh winds around all deeper points equally
    often, and exactly once, since its volume is the hull's.
    """
    from scipy.spatial import ConvexHull

    corners = mesh.vertices[mesh.triangles]
    sides = np.unique(ConvexHull(mesh.outer).equations.round(12), axis=0)
    if len(corners) * len(sides) > _MOST_COMPARED or not mesh.closed_parts.oriented:
        return False
    return all(float((-sides[:, :3] @ triangle.T - sides[:, 3:]).max(axis=1).min()) <= _DEEP for triangle in corners)


def halves(piece: Piece) -> tuple[Piece, ...]:
    """Return two pieces in place of one of a mesh, or for a convex mesh a piece with more of its corners.

    If neither is possible, return the piece itself.
    """
    if len(piece.parts) == 1 and len(piece.hull.points) < len(piece.parts[0]) <= _MOST_CORNERS:
        points, beyond = thinned(piece.parts[0], 0.25 * piece.hull.radius)
        hull = hull_around(points, beyond, piece.hull.link, solid=piece.hull.solid)
        return (Piece.solid(hull, piece.points),)
    if piece.rows.shape[1] != 3:
        return (piece,)
    points, rows = divided(piece.points, piece.rows)
    below = best_cut(points[rows], _box_volume) if len(rows) > 1 else None
    if below is None:
        return (piece,)
    link = piece.hull.link
    sides = (rows[below], rows[~below])
    return tuple(Piece(_hull_around(extreme(used(points, side)), link), points, side) for side in sides)


def _hull_around(points: Floats, link: str) -> Hull:
    """Return a hull around the corners of another, with fewer corners if that one has many."""
    beyond = 0.0
    if len(points) > _FEW:
        points, beyond = thinned(points, max(_THINNED, _SHARE * float(np.ptp(points, axis=0).max())))
    return hull_around(points, beyond, link)


def _box_volume(corners: Floats) -> float:
    """Return the volume of a box around triangles, along the coordinate axes or the triangles' own [m^3]."""
    points = corners.reshape(-1, 3)
    _, _, axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    # The margin gives flat boxes a volume.
    return min(float(np.prod(np.ptp(points @ turned.T, axis=0) + 1e-4)) for turned in (np.eye(3), axes))


_ACROSS = 8
"""Number of points along each side of the box around a body."""


def share_inside(body: Sequence[Piece], other: Sequence[Piece], poses: Floats) -> Floats:
    """Return the share of a body's volume inside another, by a grid of points, for poses (n, 4, 4) in its frame: (n,).

    It is 0 for a body without an inside, such as an open surface.
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
    shares: Floats = _inside(other, placed.reshape(-1, 3)).reshape(len(poses), -1).mean(axis=1)
    return shares


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
        return np.array([abs(winding_number(parts, point)) > 0.5 for point in points], dtype=np.bool_)
    if parts.shape[1] <= 2:
        a, along = parts[0, 0], parts[0, -1] - parts[0, 0]
        share = np.clip((points - a) @ along / max(float(along @ along), 1e-300), 0.0, 1.0)
        near: Bools = np.linalg.norm(points - a - share[:, np.newaxis] * along, axis=1) <= piece.radius
        return near
    try:
        sides = ConvexHull(parts[0]).equations
    except QhullError:
        return np.zeros(len(points), dtype=np.bool_)
    inside: Bools = (points @ sides[:, :3].T + sides[:, 3]).max(axis=1) <= piece.radius
    return inside


def winding_number(triangles: Floats, point: Floats) -> float:
    """Return how many times a surface, (t, 3, 3), goes around a point, (3,) (Van Oosterom and Strackee 1983)."""
    # Coordinates are in rows, so that operations on all triangles run along memory.
    a, b, c = np.ascontiguousarray((triangles - point).transpose(1, 2, 0))
    la, lb, lc = (np.sqrt(_dots(each, each)) for each in (a, b, c))
    over = _dots(a, np.cross(b, c, axis=0))
    under = la * lb * lc + _dots(a, b) * lc + _dots(b, c) * la + _dots(c, a) * lb
    return float(np.arctan2(over, under).sum()) / (2.0 * np.pi)


def _dots(u: Floats, v: Floats) -> Floats:
    return np.asarray(u[0] * v[0] + u[1] * v[1] + u[2] * v[2])
