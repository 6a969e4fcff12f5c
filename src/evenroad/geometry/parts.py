"""Parts: a link's true shape as convex parts. They decide if its capsules touch an obstacle."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from evenroad._arrays import Floats, set_fields
from evenroad.geometry.hulls import piece_of, thinned
from evenroad.geometry.pose import Vector
from evenroad.geometry.shapes import Capsule, Cylinder, Mesh, Shape, Sphere

LITTLE = 1e-4
"""Largest height of a corner that is removed from a convex mesh, for speed [m]; the hull is widened to compensate."""


@dataclass(frozen=True, eq=False)
class Parts:
    """All points within `radius`, and within a disc, of the convex hull of each part's corners; equal by value.

    `corners`, (parts, corners, 3), are in the frame of the link [m].  The disc is perpendicular to its axis, whose
    length is the disc's radius; with it a segment becomes a cylinder.  `of` is the kind of the shape, ``hull`` for a
    convex mesh, and ``mesh`` for any other, whose triangles the parts are.  Surfaces that are `closed` have an inside.
    All parts lie within `beyond` of the hull of the points `around`, (n, 3); for few parts these are their corners.
    """

    corners: Floats
    link: str
    of: str
    radius: float = 0.0
    disc: Vector = (0.0, 0.0, 0.0)
    closed: bool = False
    around: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    beyond: float = 0.0

    def __post_init__(self) -> None:
        set_fields(self, corners=np.array(self.corners, dtype=np.float64), disc=tuple(self.disc))
        set_fields(self, around=np.array(self.around, dtype=np.float64).reshape(-1, 3))

    @cached_property
    def _key(self) -> tuple[object, ...]:
        return self.corners.shape, self.corners.tobytes(), self.link, self.of, self.radius, self.disc, self.closed

    @cached_property
    def _hash(self) -> int:
        return hash(self._key)

    def __hash__(self) -> int:
        return self._hash

    def __eq__(self, other: object) -> bool:
        return NotImplemented if not isinstance(other, Parts) else self is other or self._key == other._key


def parts_of(shapes: Iterable[Shape]) -> tuple[Parts, ...]:
    """Return the parts of shapes, for links whose capsules are not the shapes themselves."""
    every = tuple(shapes)
    sharp = {shape.link for shape in every if not isinstance(shape, Sphere | Capsule)}
    return tuple(parts for shape in every if shape.link in sharp for parts in _parts(shape))


def kinds_in_words(robot_parts: Iterable[Parts], capsules: Iterable[Capsule]) -> str:
    """Return the kinds of a robot's bodies as text, such as ``hulls, meshes and capsules``.

    They are the kinds of its parts, and the capsules of other links.  A convex mesh is a hull.
    """
    parts = tuple(robot_parts)
    links = {each.link for each in parts}
    kinds = {{"mesh": "meshes", "box": "boxes"}.get(each.of, f"{each.of}s") for each in parts}
    alone = {"capsules"} if any(each.link not in links for each in capsules) else set()
    words = [*sorted(kinds - {"capsules"}), *(kinds & {"capsules"} | alone)]
    return " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))


def _parts(shape: Shape) -> tuple[Parts, ...]:
    if isinstance(shape, Cylinder):
        axis = shape.pose.rotation_matrix[:, 2]
        endpoints = np.array(shape.pose.xyz) + np.outer((-0.5 * shape.length, 0.5 * shape.length), axis)
        x, y, z = (shape.radius * axis).tolist()
        return (Parts(endpoints[np.newaxis], shape.link, shape.kind, disc=(x, y, z)),)
    if not isinstance(shape, Mesh):
        piece = piece_of(shape)
        return (Parts(piece.parts, shape.link, shape.kind, piece.radius),)
    mesh = shape.triangles.compact
    around, beyond = thinned(shape.pose.apply(mesh.outer), LITTLE)
    if mesh.is_convex:
        return (Parts(around[np.newaxis], shape.link, "hull", beyond),)
    corners = shape.pose.apply(mesh.vertices)[mesh.facing]
    # If the triangles do not show which side is inside, no part is known to be solid.
    closed = mesh.closed_parts.closed & mesh.closed_parts.oriented
    return tuple(
        Parts(_single(corners[these]), shape.link, "mesh", closed=bool(inside), around=around, beyond=beyond)
        for these, inside in ((closed, True), (~closed, False))
        if these.any()
    )


def _single(corners: Floats) -> Floats:
    """Return corners rounded to single precision, as in the native kernel."""
    return corners.astype(np.float32).astype(np.float64)


def spread(parts: Parts) -> Floats:
    """Return points, (n, 3), whose hull contains all parts before they are widened by the radius."""
    points, axis = parts.corners.reshape(-1, 3), np.array(parts.disc)
    radius = float(np.linalg.norm(axis))
    if radius == 0.0:
        return points
    # Eight corners around the disc.
    across = np.linalg.svd(axis[np.newaxis])[2][1:]
    turn = np.arange(8) * (np.pi / 4.0)
    ring = (
        radius
        / np.cos(np.pi / 8.0)
        * (np.cos(turn)[:, np.newaxis] * across[0] + np.sin(turn)[:, np.newaxis] * across[1])
    )
    ringed: Floats = (points[:, np.newaxis] + ring).reshape(-1, 3)
    return ringed
