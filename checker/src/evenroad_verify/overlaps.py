"""Overlaps: a ball inside of one body meets another body throughout a cell."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from evenroad_verify.cells import Ranges
from evenroad_verify.claim import LEAST, Body
from evenroad_verify.errors import Floats, Ints, demand
from evenroad_verify.frames import Frames
from evenroad_verify.pieces import any_inside
from evenroad_verify.shapes import Shape


@dataclass(frozen=True)
class Solid:
    """A box, or what is within `radius` of a disc or segment; `axes`, (3, 3), are rows, `half` extents along them."""

    middle: Floats
    axes: Floats
    half: Floats
    radius: float
    is_box: bool

    def distances(self, points: Floats) -> Floats:
        """Return how far points, (n, 3), are from it at most; less than 0 inside, by no more than they are deep."""
        local = (points - self.middle) @ self.axes.T
        if self.is_box:
            out = np.abs(local) - self.half
        else:
            out = np.stack([np.hypot(local[:, 0], local[:, 1]), np.abs(local[:, 2])], axis=1) - self.half[1:]
        return np.asarray(np.linalg.norm(np.maximum(out, 0.0), axis=1) + np.minimum(out.max(axis=1), 0.0) - self.radius)


def solid_of(shape: Shape) -> Solid | None:
    """Return the solid that a shape is; None for meshes, clouds, and a box without a side."""
    corner = shape.points
    if shape.is_box:
        edges = 0.5 * np.stack([corner[4] - corner[0], corner[2] - corner[0], corner[1] - corner[0]])
        half = np.linalg.norm(edges, axis=1)
        if half.min() < LEAST:
            return None
        return Solid(0.5 * (corner[0] + corner[7]), edges / half[:, None], half, shape.radius, True)
    if shape.surface or len(shape.corners) > 1 or shape.corners.shape[1] > 2:
        return None
    across = np.cross(shape.axis, np.eye(3)[np.abs(shape.axis).argmin()])
    across /= np.linalg.norm(across)
    axes = np.stack([across, np.cross(shape.axis, across), shape.axis])
    half = np.array([0.0, shape.disc, 0.5 * np.linalg.norm(corner[-1] - corner[0])])
    return Solid(0.5 * (corner[0] + corner[-1]), axes, half, shape.radius, False)


def is_ball_inside(body: Body, centre: Floats, radius: float) -> bool:
    """Return whether a ball is inside of one of a body's shapes, or inside of a closed piece of its surfaces."""
    for shape in body.shapes:
        solid = solid_of(shape)
        if solid is not None and solid.distances(centre[None])[0] <= -radius - LEAST:
            return True
        for piece, point in shape.pieces.holding(centre[None]) if shape.surface else ():
            triangles = shape.pieces.closed(piece)
            if triangles is None or not any_inside(point, triangles):
                continue
            if _nearest(triangles, centre) >= radius + LEAST:
                return True
    return False


def _nearest(triangles: Floats, point: Floats) -> float:
    """Return how far a point is from some triangles, (t, 3, 3)."""
    a, b, c = np.moveaxis(triangles - point, 1, 0)
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1)
    over, least = length > 0.0, np.full(len(a), np.inf)
    for p, q in ((a, b), (b, c), (c, a)):
        way = q - p
        share = np.clip(-(p * way).sum(1) / np.maximum((way * way).sum(1), 1e-300), 0.0, 1.0)
        least = np.minimum(least, np.linalg.norm(p + share[:, None] * way, axis=1))
        over &= (np.cross(p, way) * normal).sum(1) >= 0.0
    height = np.abs((a * normal).sum(1)) / np.maximum(length, 1e-300)
    return float(np.where(over, np.minimum(height, least), least).min())


@dataclass(frozen=True)
class Spot:
    """A point of a frame, and by how much it is wider than a point [m]."""

    frame: int
    point: Floats
    radius: float


def between(frames: Frames, first: int, second: int) -> list[int]:
    """Return the joints that move one frame on another: from the first one to the root, then to the second one."""
    carries = frames.carries
    up = np.flatnonzero(carries[first] & ~carries[second])[::-1]
    return [*up.tolist(), *np.flatnonzero(carries[second] & ~carries[first]).tolist()]


class Places:
    """Frames in the middles of cells, (n, columns), of half sides that may differ."""

    def __init__(self, frames: Frames, ranges: Ranges, middles: Floats, half: Floats, dim: int) -> None:
        q, self._half = np.zeros((len(middles), dim)), np.zeros((len(middles), dim))
        q[:, ranges.columns], self._half[:, ranges.columns] = middles, half
        self._frames = frames
        self.rotation, self.origin, self._axes = frames.at(q)

    def of(self, spot: Spot, rows: Ints) -> Floats:
        """Return where a spot is, seen from the root."""
        return np.asarray(self.origin[rows, spot.frame] + self.rotation[rows, spot.frame] @ spot.point)

    def moved(self, points: Floats, chain: list[int], rows: Ints) -> Floats:
        """Return how far points are moved at most, in a cell, by the joints of a chain, the last one's frame at rest.

        The joint that is nearest to the point moves it first.  Each other joint then turns it about an axis that is
        still where it was in the middle, at a distance that has grown by what the point has moved.
        """
        far = np.zeros(len(rows))
        for k in chain:
            half = self._half[rows, self._frames.column[k]] * abs(float(self._frames.factor[k]))
            lever = 1.0
            if not self._frames.slides[k]:
                lever = far + np.linalg.norm(np.cross(self._axes[rows, k], points - self.origin[rows, k + 1]), axis=1)
            far = far + half * lever
        return np.asarray(far)

    def swept(self, points: Floats, spot: Spot, chain: list[int], rows: Ints) -> tuple[list[Floats], Floats]:
        """Return how half a side of each column moves points of a spot, to the first order, and how far they stray.

        A point that has moved by `far` is turned about an axis by a vector that is longer by as much, at most.
        """
        ways, far, stray = dict[int, Floats](), np.zeros(len(rows)), np.zeros(len(rows))
        for k in chain:
            column, factor = int(self._frames.column[k]), float(self._frames.factor[k])
            by, way = self._half[rows, column] * abs(factor), self._axes[rows, k]
            if not self._frames.slides[k]:
                way = np.cross(way, points - self.origin[rows, k + 1])
                stray = stray + by * (0.5 * by * np.linalg.norm(way, axis=1) + far)
            far = far + by * np.linalg.norm(way, axis=1)
            forward = self._frames.carries[spot.frame, k] == (factor > 0.0)
            ways[column] = ways.get(column, 0.0) + (by if forward else -by)[:, None] * way
        return list(ways.values()), stray


def overlap(places: Places, frames: Frames, ball: Spot, other: tuple[int, Solid | Spot], rows: Ints) -> Floats:
    """Return by how much a ball goes into a solid, or into another ball, throughout cells, (n,) [m].

    The distance is convex: it is largest where all columns are at an end.
    """
    frame, solid = other
    middles = places.of(ball, rows)
    ways, stray = places.swept(middles, ball, between(frames, ball.frame, frame), rows)
    most = np.full(len(rows), -np.inf)
    for signs in itertools.product((1.0, -1.0), repeat=len(ways)):
        points = middles + sum(sign * way for sign, way in zip(signs, ways, strict=True))
        if isinstance(solid, Spot):
            far = np.linalg.norm(points - places.of(solid, rows), axis=1) - solid.radius
        else:
            local = np.einsum("nji,nj->ni", places.rotation[rows, frame], points - places.origin[rows, frame])
            far = solid.distances(local)
        most = np.maximum(most, far)
    return np.asarray(ball.radius - most - stray)


def require_blocked(
    places: Places, frames: Frames, witness: Ints, table: list[tuple[Spot, tuple[int, Solid | Spot], float]]
) -> float:
    """Return the least overlap of the witnesses of cells, numbers in a table; Refused where one is not deep enough."""
    least, order = np.inf, np.argsort(witness, kind="stable")
    for rows in np.split(order, np.flatnonzero(np.diff(witness[order])) + 1) if len(order) else []:
        ball, other, keep = table[int(witness[rows[0]])]
        deep = float((overlap(places, frames, ball, other, rows) + keep).min())
        demand(deep > LEAST, "a cell is not blocked by its witness")
        least = min(least, deep)
    return least
