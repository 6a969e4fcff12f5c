"""Shapes: sets of convex elements, each the hull of some corners, around which a ball or a disc is moved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from evenroad_verify.errors import Floats, Ints, Pose, number, numbers, require
from evenroad_verify.pieces import Pieces

DIMENSIONS = {
    "box": {"size": 3},
    "sphere": {"radius": 1},
    "cylinder": {"radius": 1, "length": 1},
    "capsule": {"radius": 1, "length": 1},
}
WIDEST = 1000.0
"""How far from its frame a shape may reach [m]."""


@dataclass(frozen=True)
class Shape:
    """Convex elements of one kind.

    `corners`, (n, c), are those of n elements, rows of `points`, (p, 3), in the frame of their body.  Each corner has a
    ball of `radius` and a disc of radius `disc` about `axis` around it.  A `surface` is made of triangles.
    """

    points: Floats
    corners: Ints
    radius: float = 0.0
    disc: float = 0.0
    axis: Floats = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    surface: bool = False
    is_box: bool = False

    def __post_init__(self) -> None:
        require(len(self.corners) and np.abs(self.points).max() < WIDEST, f"a shape is empty or beyond {WIDEST:g} m")

    @cached_property
    def spans(self) -> Floats:
        """Of each element the mean, the least and the largest of its corners, and the largest distance, (10, n)."""
        corners = np.ascontiguousarray(self.corners.T)
        places = np.ascontiguousarray(self.points.T).take(corners, axis=1)
        far = np.linalg.norm(self.points, axis=1).take(corners).max(0)
        return np.concatenate([places.mean(1), places.min(1), places.max(1), far[None]])

    @cached_property
    def pieces(self) -> Pieces:
        """The connected pieces of a surface."""
        return Pieces(self.points, self.corners)

    @property
    def reach(self) -> float:
        """Largest distance of a point from the frame's origin [m]."""
        return float(np.linalg.norm(self.points, axis=1).max()) + self.radius + self.disc

    def at(self, pose: Pose) -> Shape:
        """Return the shape moved by a pose."""
        rotation, shift = pose
        return replace(self, points=self.points @ rotation.T + shift, axis=rotation @ self.axis)


def rotation_about(axis: Floats, angles: Floats) -> Floats:
    """Return rotations about a unit axis by some angles, (n, 3, 3)."""
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angles)[:, None, None] * k + (1 - np.cos(angles))[:, None, None] * (k @ k))


def pose_of(xyz: Floats, rpy: Floats) -> Pose:
    """Return a pose whose rotation is Rz(yaw) Ry(pitch) Rx(roll)."""
    x, y, z = (rotation_about(axis, rpy[i : i + 1])[0] for i, axis in enumerate(np.eye(3)))
    return z @ y @ x, xyz


def rotation_of(xyzw: Floats) -> Floats:
    """Return the rotation of a quaternion of any length."""
    length = float(np.linalg.norm(xyzw))
    require(length > 1e-9, "a quaternion is zero")
    x, y, z, w = xyzw / length
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + 2 * w * cross + 2 * cross @ cross)


def times(first: Pose, second: Pose) -> Pose:
    """Return the product of two poses."""
    return first[0] @ second[0], first[0] @ second[1] + first[1]


def primitive(kind: str, entry: Mapping[str, object]) -> Shape | None:
    """Return a box, sphere, cylinder or capsule about the origin by its dimensions; None where all of these are 0."""
    sizes = []
    for key, count in DIMENSIONS[kind].items():
        require(key in entry, f"a {kind} lacks its {key}")
        value = entry[key]
        sizes += list(numbers(value, 3)) if count == 3 else [number(value)]
    require(min(sizes) >= 0.0, f"a {kind} has a negative size")
    if max(sizes) == 0.0 or (kind == "capsule" and sizes[0] == 0.0):
        return None
    if kind == "box":
        signs = np.stack(np.meshgrid(*[[-0.5, 0.5]] * 3, indexing="ij"), axis=-1).reshape(8, 3)
        return _element(signs * np.array(sizes), is_box=True)
    if kind == "sphere":
        return _element(np.zeros((1, 3)), radius=sizes[0])
    ends = sizes[1] * np.array([[0.0, 0.0, -0.5], [0.0, 0.0, 0.5]])
    return _element(ends, disc=sizes[0]) if kind == "cylinder" else _element(ends, radius=sizes[0])


def _element(points: Floats, **around: Any) -> Shape:
    return Shape(points, np.arange(len(points)).reshape(1, -1), **around)


def surface(triangles: Floats, at: Pose, scale: Floats) -> Shape:
    """Return triangles, (n, 3, 3), of a file, placed by `at` and then scaled; equal corners become one point."""
    require(np.isfinite(triangles).all() and len(triangles), "a mesh is empty, or has a corner that is no number")
    rows = ((triangles.reshape(-1, 3) @ at[0].T + at[1]) * scale) + 0.0
    order = np.lexsort(rows.T)
    is_new = np.ones(len(rows), bool)
    is_new[1:] = (rows[order[1:]] != rows[order[:-1]]).any(axis=1)
    number = np.empty(len(rows), np.int64)
    number[order] = np.cumsum(is_new) - 1
    return Shape(rows[order[is_new]], number.reshape(-1, 3), surface=True)


def hull(shapes: list[Shape]) -> Shape:
    """Return the hull of some shapes as one element, with each corner once."""
    return _element(np.unique(np.concatenate([each.points for each in shapes]), axis=0))


def balls(data: bytes, radius: float) -> Shape:
    """Return balls about the points of a text, three numbers a line, each a convex element."""
    rows = [numbers(line.split(), 3) for line in data.decode("utf-8", "replace").splitlines()]
    require(rows and radius > 0.0, "a cloud has no points, or its balls no radius")
    return Shape(np.array(rows), np.arange(len(rows)).reshape(-1, 1), radius)
