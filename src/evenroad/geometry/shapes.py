"""Shapes: what links, obstacles and rigid bodies are made of.

A shape is a frozen value with its dimensions, the pose that it has, and the link that it is fixed to (or the
world).  A new one is a class here, with its distance (``distance.py``) and its capsules (``fit.py``).
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from typing import Any, ClassVar, Unpack, overload

import numpy as np

from evenroad._arrays import Floats, set_fields
from evenroad._call import explains_calls
from evenroad._checks import FARTHEST, as_batch, as_row, require_known, require_positive
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.cloud_file import load_cloud
from evenroad.geometry.mesh import TriangleMesh, load_mesh, scaled, volume_of
from evenroad.geometry.pose import IDENTITY, Pose, Vector, rotation_from_z
from evenroad.geometry.shape import WORLD as WORLD
from evenroad.geometry.shape import Placed as Placed
from evenroad.geometry.shape import Shape as Shape

CLOUD_RADIUS = 0.01
"""Default radius of the balls of a point cloud [m]."""


@explains_calls
@dataclass(frozen=True, init=False, repr=False)
class Box(Shape):
    """A box around the origin of its frame: `size` are its full extents (x, y, z), > 0 [m].

    Examples
    --------
    >>> import evenroad as er
    >>> er.Box((0.8, 1.2, 0.04), xyz=(0.5, 0, -0.02), name="table")
    Box((0.8, 1.2, 0.04), pose=Pose((0.5, 0, -0.02)), name='table')
    """

    kind: ClassVar[str] = "box"
    dimensions: ClassVar[tuple[tuple[str, int], ...]] = (("size", 3),)

    size: Vector

    def __init__(self, size: Sequence[float], **placed: Unpack[Placed]) -> None:
        set_fields(self, size=as_row("the size of a box", size, 3))
        for extent in self.size:
            require_positive("the size of a box", extent, at_most=FARTHEST)
        self._place(placed)

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return math.prod(self.size)

    def _written(self) -> str:
        return f"({', '.join(f'{extent:g}' for extent in self.size)})"


@explains_calls
@dataclass(frozen=True, init=False, repr=False)
class Sphere(Shape):
    """All points within `radius`, > 0 [m], of the origin of its frame."""

    kind: ClassVar[str] = "sphere"
    dimensions: ClassVar[tuple[tuple[str, int], ...]] = (("radius", 1),)

    radius: float

    def __init__(self, radius: float, **placed: Unpack[Placed]) -> None:
        self._lengths(radius=radius)
        self._place(placed)

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return _ball(self.radius)


@explains_calls
@dataclass(frozen=True, init=False, repr=False)
class Cylinder(Shape):
    """A cylinder along the z axis of its frame, its middle in the origin: `radius` and `length`, > 0 [m]."""

    kind: ClassVar[str] = "cylinder"
    dimensions: ClassVar[tuple[tuple[str, int], ...]] = (("radius", 1), ("length", 1))

    radius: float
    length: float

    def __init__(self, radius: float, length: float, **placed: Unpack[Placed]) -> None:
        self._lengths(radius=radius, length=length)
        self._place(placed)

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return math.pi * self.radius**2 * self.length


@dataclass(frozen=True, init=False, repr=False)
class Capsule(Shape):
    """All points within `radius`, > 0 [m], of a segment: a cylinder with half balls on its ends.

    ``Capsule(radius, length)`` lies along the z axis of its frame, its middle in the origin; `length`, > 0 [m], is
    without the half balls.  ``Capsule(a, b, radius)`` has its segment from `a` to `b`, and is a ball where the two are
    one point.  A robot's bodies are capsules with `a` and `b` in their link's frame, in no pose of their own.
    """

    kind: ClassVar[str] = "capsule"
    dimensions: ClassVar[tuple[tuple[str, int], ...]] = (("radius", 1), ("length", 1))

    a: Vector
    b: Vector
    radius: float

    @overload
    def __init__(self, radius: float, length: float, **placed: Unpack[Placed]) -> None: ...
    @overload
    def __init__(
        self, a: Sequence[float], b: Sequence[float], radius: float, **placed: Unpack[Placed]
    ) -> None: ...
    def __init__(self, *given: Any, **named: Any) -> None:
        along_z = len(given) == 2 and np.ndim(given[0]) == 0
        names = ("radius", "length") if along_z or "length" in named else ("a", "b", "radius")
        if len(given) > len(names) or set(names[: len(given)]) & set(named):
            raise InvalidValue(
                f"a capsule must be made of {' and '.join(names)}, each once, got {shown(given)}"
            )
        named.update(zip(names, given, strict=False))
        if missing := [name for name in names if name not in named]:
            raise InvalidValue(
                f"a capsule must have {' and '.join(missing)}: it is Capsule(radius, length) or Capsule(a, b, radius)"
            )
        values = {name: named.pop(name) for name in names}
        if "length" in values:
            half = 0.5 * require_positive("the length of a capsule", values["length"], at_most=FARTHEST)
            values.update(a=(0.0, 0.0, -half), b=(0.0, 0.0, half))
        for name in ("a", "b"):
            end = as_row(f"the end {name} of a capsule", values[name], 3, within=FARTHEST)
            set_fields(self, **{name: end})
        self._lengths(radius=values["radius"])
        self._place(named)  # type: ignore[arg-type]

    @classmethod
    def along_z(cls, radius: float, length: float, pose: Pose = IDENTITY, link: str = WORLD) -> Capsule:
        """Return the capsule along the z axis of its frame: a cylinder of `length` [m] and half balls on its ends."""
        return cls(radius, length, pose=pose, link=link)

    @property
    def length(self) -> float:
        """Length of the segment, without the caps [m]."""
        return math.dist(self.a, self.b)

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return math.pi * self.radius**2 * self.length + _ball(self.radius)

    def _written(self) -> str:
        return f"{self.a!r}, {self.b!r}, {self.radius!r}"


@explains_calls
@dataclass(frozen=True, init=False, repr=False)
class Mesh(Shape):
    """A surface of triangles.

    Parameters
    ----------
    source : str, path-like, TriangleMesh, or a pair of arrays
        A file, which is opened when it is needed; or the triangles themselves: vertices, (v, 3) [m], and rows of these,
        (t, 3).  What has `vertices` and `faces`, as a mesh of trimesh, will do.
    scale : float or sequence of 3 floats
        The factors that its coordinates are multiplied with, none of them 0.
    """

    kind: ClassVar[str] = "mesh"

    source: Path | TriangleMesh
    scale: Vector

    def __init__(
        self, source: Any, scale: float | Sequence[float] = (1.0, 1.0, 1.0), **placed: Unpack[Placed]
    ) -> None:
        row = as_row("the scale of a mesh", [scale] * 3 if np.ndim(scale) == 0 else scale, 3)  # type: ignore
        source = _surface(source)
        if 0.0 in row:
            raise InvalidValue(f"the scale of mesh {source.name} must not be 0, got {row}: it would be flat")
        set_fields(self, scale=row, source=source)
        self._place(placed)

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
        return f"mesh {self.source.name}"

    def _written(self) -> str:
        if isinstance(self.source, TriangleMesh):
            return f"{len(self.source.triangles)} triangles"
        return repr(str(self.source))


def _surface(source: Any) -> Path | TriangleMesh:
    """Return the file or the triangles that the source of a mesh stands for."""
    if isinstance(source, TriangleMesh):
        return source
    if isinstance(source, str | os.PathLike):
        return Path(source)
    if hasattr(source, "vertices") and hasattr(source, "faces"):
        source = source.vertices, source.faces
    if isinstance(source, tuple | list) and len(source) == 2:
        return TriangleMesh(*source)
    raise InvalidValue(
        f"a mesh must be a file, or its vertices (v, 3) and triangles (t, 3) as a pair, got {shown(source)}"
    )


@explains_calls
@dataclass(frozen=True, eq=False, init=False, repr=False)
class PointCloud(Shape):
    """Balls of one radius around points, (n, 3) [m], as a depth camera sees them.

    `points` may be a file, too, see :func:`evenroad.geometry.load_cloud`.  The default radius, 0.01 m, suits a camera
    whose points lie at most 0.02 m apart: a robot may pass between points that lie further apart.  Equal
    by value.

    Examples
    --------
    >>> import evenroad as er
    >>> er.PointCloud([(0.5, 0, 0.1), (0.5, 0.01, 0.1)])
    PointCloud(2 points, radius=0.01)
    """

    kind: ClassVar[str] = "cloud"

    points: Floats
    radius: float

    def __init__(self, points: Any, radius: float = CLOUD_RADIUS, **placed: Unpack[Placed]) -> None:
        points = load_cloud(points) if isinstance(points, str | os.PathLike) else points
        points = np.array(as_batch("points of a cloud", points, 3))
        if len(points) == 0:
            raise InvalidValue("a cloud must have one point or more: one without would never collide")
        if np.abs(points).max() > FARTHEST:
            raise InvalidValue(
                f"points of a cloud must lie within {FARTHEST:g} m, got {np.abs(points).max():g}"
            )
        radius = require_positive("the radius of a cloud", radius, at_most=FARTHEST)
        set_fields(self, points=points, radius=radius)
        self._place(placed)

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

    def _written(self) -> str:
        return f"{len(self.points)} points, radius={self.radius!r}"


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
    make: Callable[..., Shape] = PRIMITIVES[kind]
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
