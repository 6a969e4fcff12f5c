"""Shapes: what links, obstacles and rigid bodies are made of.

A shape is a frozen value with its dimensions, the pose that it has, and the link that it is fixed to (or the
world).  A new one is a class here, with its distance (``distance.py``) and its capsules (``fit.py``).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from typing import ClassVar

import numpy as np

from evenroad._arrays import Floats, set_fields
from evenroad._checks import FARTHEST, as_batch, as_row, require_known, require_positive
from evenroad.errors import InvalidValue
from evenroad.geometry.mesh import TriangleMesh, load_mesh, scaled, volume_of
from evenroad.geometry.pose import IDENTITY, Pose, Vector, rotation_from_z

WORLD = ""
"""The `link` of a shape that is fixed to no link."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Shape:
    """What all shapes have: a pose, from the shape's own frame to that of its link, or of the world.

    `link` is the name of the link that it is fixed to; `WORLD`, an empty text, for the world.
    """

    kind: ClassVar[str]
    """What files call it."""
    dimensions: ClassVar[tuple[tuple[str, int], ...]] = ()
    """Names of its dimensions in files, and how many numbers each has."""

    pose: Pose = IDENTITY
    link: str = WORLD

    @property
    def size(self) -> tuple[float, ...]:
        """Its dimensions in a row, in the order of `dimensions` [m]."""
        return tuple(getattr(self, name) for name, _ in self.dimensions)

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        raise NotImplementedError

    def __str__(self) -> str:
        return self.kind

    def _require_lengths(self, *names: str) -> None:
        """Keep dimensions as floats; InvalidValue for one that is no length > 0 [m]."""
        for name in names:
            what = f"the {name} of a {self.kind}"
            set_fields(self, **{name: require_positive(what, getattr(self, name), at_most=FARTHEST)})


@dataclass(frozen=True)
class Box(Shape):
    """A box around the origin of its frame: full extents (x, y, z), > 0 [m]."""

    kind: ClassVar[str] = "box"
    dimensions: ClassVar[tuple[tuple[str, int], ...]] = (("size", 3),)

    extents: Vector

    def __post_init__(self) -> None:
        set_fields(self, extents=as_row("the size of a box", self.extents, 3))
        for extent in self.extents:
            require_positive("the size of a box", extent, at_most=FARTHEST)

    @property
    def size(self) -> tuple[float, ...]:
        """The extents [m]."""
        return self.extents

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return math.prod(self.extents)


@dataclass(frozen=True)
class Sphere(Shape):
    """All points within `radius`, > 0 [m], of the origin of its frame."""

    kind: ClassVar[str] = "sphere"
    dimensions: ClassVar[tuple[tuple[str, int], ...]] = (("radius", 1),)

    radius: float

    def __post_init__(self) -> None:
        self._require_lengths("radius")

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return _ball(self.radius)


@dataclass(frozen=True)
class Cylinder(Shape):
    """A cylinder along the z axis of its frame, its middle in the origin: `radius` and `length`, > 0 [m]."""

    kind: ClassVar[str] = "cylinder"
    dimensions: ClassVar[tuple[tuple[str, int], ...]] = (("radius", 1), ("length", 1))

    radius: float
    length: float

    def __post_init__(self) -> None:
        self._require_lengths("radius", "length")

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return math.pi * self.radius**2 * self.length


@dataclass(frozen=True)
class Capsule(Shape):
    """All points within `radius`, > 0 [m], of the segment from `a` to `b`; a ball where the two are one point.

    A robot's bodies are capsules with `a` and `b` in their link's frame, in no pose of their own.
    """

    kind: ClassVar[str] = "capsule"
    dimensions: ClassVar[tuple[tuple[str, int], ...]] = (("radius", 1), ("length", 1))

    a: Vector
    b: Vector
    radius: float

    def __post_init__(self) -> None:
        for name in ("a", "b"):
            end = as_row(f"the end {name} of a capsule", getattr(self, name), 3, within=FARTHEST)
            set_fields(self, **{name: end})
        self._require_lengths("radius")

    @classmethod
    def along_z(cls, radius: float, length: float, pose: Pose = IDENTITY, link: str = WORLD) -> Capsule:
        """Return the capsule along the z axis of its frame: a cylinder of `length` [m] and half balls on its ends."""
        half = 0.5 * require_positive("the length of a capsule", length)
        return cls((0.0, 0.0, -half), (0.0, 0.0, half), radius, pose=pose, link=link)

    @property
    def length(self) -> float:
        """Length of the segment, without the caps [m]."""
        return math.dist(self.a, self.b)

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return math.pi * self.radius**2 * self.length + _ball(self.radius)


@dataclass(frozen=True)
class Mesh(Shape):
    """A surface of triangles: a file, which is opened when it is needed, or the triangles themselves.

    `scale` are the factors that its coordinates are multiplied with, none of them 0; in files often one number.
    """

    kind: ClassVar[str] = "mesh"

    source: str | Path | TriangleMesh
    scale: Vector = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        scale = as_row("the scale of a mesh", self.scale, 3)
        if 0.0 in scale:
            raise InvalidValue(f"the scale of {self} must not be 0, got {scale}: it would be flat")
        source = self.source if isinstance(self.source, TriangleMesh) else Path(self.source)
        set_fields(self, scale=scale, source=source)

    @property
    def triangles(self) -> TriangleMesh:
        """Its triangles with their scale, in the shape's frame; errors as :func:`evenroad.geometry.load_mesh`."""
        mesh = self.source if isinstance(self.source, TriangleMesh) else load_mesh(self.source)
        return scaled(mesh, self.scale)

    @property
    def volume(self) -> float:
        """Volume [m^3]; of a mesh that is not closed, that of its convex hull."""
        return volume_of(self.triangles)

    def __str__(self) -> str:
        return f"mesh {self.source if isinstance(self.source, str) else self.source.name}"


@dataclass(frozen=True, eq=False)
class PointCloud(Shape):
    """Balls of one radius around points, (n, 3) [m], as a depth camera sees them; of radius 0: the points alone.

    Equal by value.
    """

    kind: ClassVar[str] = "cloud"

    points: Floats
    radius: float = 0.0

    def __post_init__(self) -> None:
        points = np.array(as_batch("points of a cloud", self.points, 3))
        if len(points) == 0:
            raise InvalidValue("a cloud must have one point or more: one without would never collide")
        if np.abs(points).max() > FARTHEST:
            raise InvalidValue(
                f"points of a cloud must lie within {FARTHEST:g} m, got {np.abs(points).max():g}"
            )
        radius = require_positive("the radius of a cloud", self.radius, or_zero=True, at_most=FARTHEST)
        set_fields(self, points=points, radius=radius)

    @property
    def volume(self) -> float:
        """Volume of a ball around every point, however they overlap [m^3]."""
        return len(self.points) * _ball(self.radius)

    @cached_property
    def _values(self) -> tuple[object, ...]:
        return self.radius, self.pose, self.link, sha256(self.points.tobytes()).digest()

    def __hash__(self) -> int:
        return hash(self._values)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, PointCloud):
            return NotImplemented
        return self is other or self._values == other._values

    def __str__(self) -> str:
        return f"cloud of {len(self.points)} points"


PRIMITIVES: dict[str, type[Shape]] = {shape.kind: shape for shape in (Box, Sphere, Cylinder, Capsule)}
"""Shapes that files describe by their dimensions alone."""


def shape_of(kind: str, size: Sequence[float], pose: Pose = IDENTITY, link: str = WORLD) -> Shape:
    """Return the box, sphere, cylinder or capsule that files describe by its dimensions.

    Parameters
    ----------
    kind : {"box", "sphere", "cylinder", "capsule"}
        Cylinders and capsules are along their own z axis.
    size : sequence of floats
        Box: full extents (x, y, z); sphere: (radius,); cylinder and capsule: (radius, length), without the caps [m].
    pose, link : Pose, str
        As for every :class:`Shape`.

    Raises
    ------
    UnknownName
        If there is no such shape.
    InvalidValue
        If it has other dimensions, or one that is not a finite number > 0.
    """
    require_known("shape", kind, PRIMITIVES)
    count = sum(count for _, count in PRIMITIVES[kind].dimensions)
    if len(size) != count:
        raise InvalidValue(f"a {kind} must have {count} size(s), got {size!r}")
    numbers = [tuple(size)] if kind == Box.kind else size
    make: Callable[..., Shape] = Capsule.along_z if kind == Capsule.kind else PRIMITIVES[kind]
    return make(*numbers, pose=pose, link=link)


def along_z(capsule: Capsule) -> Capsule | Sphere:
    """Return the same body as a capsule along the z axis of its frame; a sphere where it has no length."""
    if capsule.a[:2] == capsule.b[:2] == (0.0, 0.0) and capsule.b[2] == -capsule.a[2] > 0.0:
        return capsule
    a, b = np.array(capsule.a), np.array(capsule.b)
    length = float(np.linalg.norm(b - a))
    axis = (b - a) / length if length > 0.0 else (0.0, 0.0, 1.0)
    x, y, z = (0.5 * (a + b)).tolist()
    pose = Pose((x, y, z), tuple(rotation_from_z(axis).ravel().tolist()))
    if capsule.pose != IDENTITY:
        pose = capsule.pose @ pose
    if length == 0.0:
        return Sphere(capsule.radius, pose=pose, link=capsule.link)
    return Capsule.along_z(capsule.radius, length, pose, capsule.link)


def without_pose(capsule: Capsule) -> Capsule:
    """Return the same body with its ends in the frame that its pose is given in."""
    if capsule.pose == IDENTITY:
        return capsule
    a, b = (tuple(capsule.pose.apply(end).tolist()) for end in (capsule.a, capsule.b))
    return replace(capsule, a=a, b=b, pose=IDENTITY)


def _ball(radius: float) -> float:
    return 4.0 / 3.0 * math.pi * radius**3
