"""Shapes of links, obstacles and rigid bodies: frozen values with dimensions, a pose, and the link they are fixed to.

A new shape is a class here, with its distance (``distance.py``) and its capsules (``fit.py``).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Unpack, overload

import numpy as np

from evenroad._arrays import set_fields
from evenroad._call import explains_calls
from evenroad._checks import FARTHEST, as_row, require_known, require_positive
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.mesh_shape import CLOUD_RADIUS as CLOUD_RADIUS
from evenroad.geometry.mesh_shape import Mesh as Mesh
from evenroad.geometry.mesh_shape import PointCloud as PointCloud
from evenroad.geometry.pose import IDENTITY, Pose, Vector
from evenroad.geometry.rotation import rotation_from_z
from evenroad.geometry.shape import WORLD as WORLD
from evenroad.geometry.shape import Placed as Placed
from evenroad.geometry.shape import Shape as Shape


@explains_calls
@dataclass(frozen=True, init=False, repr=False)
class Box(Shape):
    """A box around the origin of its frame.

    Parameters
    ----------
    size : sequence of 3 floats
        Full extents along x, y and z, > 0 [m].
    **placed
        ``xyz``, ``rpy`` or ``xyzw``, or ``pose`` [m, rad]; ``name`` in a scene; ``link``, default the world.

    Raises
    ------
    InvalidValue, UnknownName
        If a length is not a finite number > 0, or a keyword is unknown.

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
        extents = as_row("the size of a box", size, 3)
        for extent in extents:
            require_positive("the size of a box", extent, at_most=FARTHEST)
        set_fields(self, size=extents)
        self._set_pose(placed)

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return math.prod(self.size)

    def _written(self) -> str:
        return f"({', '.join(f'{extent:g}' for extent in self.size)})"


@explains_calls
@dataclass(frozen=True, init=False, repr=False)
class Sphere(Shape):
    """A ball around the origin of its frame.

    Parameters
    ----------
    radius : float
        > 0 [m].
    **placed
        ``xyz``, ``rpy`` or ``xyzw``, or ``pose`` [m, rad]; ``name`` in a scene; ``link``, default the world.

    Raises
    ------
    InvalidValue, UnknownName
        If a length is not a finite number > 0, or a keyword is unknown.

    Examples
    --------
    >>> import evenroad as er
    >>> er.Sphere(0.1, xyz=(0.5, 0, 0.4))
    Sphere(radius=0.1, pose=Pose((0.5, 0, 0.4)))
    """

    kind: ClassVar[str] = "sphere"
    dimensions: ClassVar[tuple[tuple[str, int], ...]] = (("radius", 1),)

    radius: float

    def __init__(self, radius: float, **placed: Unpack[Placed]) -> None:
        self._lengths(radius=radius)
        self._set_pose(placed)

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return _ball(self.radius)


@explains_calls
@dataclass(frozen=True, init=False, repr=False)
class Cylinder(Shape):
    """A cylinder along the z axis of its frame, its middle in the origin.

    Parameters
    ----------
    radius, length : float
        > 0 [m].
    **placed
        ``xyz``, ``rpy`` or ``xyzw``, or ``pose`` [m, rad]; ``name`` in a scene; ``link``, default the world.

    Raises
    ------
    InvalidValue, UnknownName
        If a length is not a finite number > 0, or a keyword is unknown.

    Examples
    --------
    >>> import evenroad as er
    >>> er.Cylinder(0.05, 1.0, xyz=(0, 0.6, 0.5), name="post")
    Cylinder(radius=0.05, length=1.0, pose=Pose((0, 0.6, 0.5)), name='post')
    """

    kind: ClassVar[str] = "cylinder"
    dimensions: ClassVar[tuple[tuple[str, int], ...]] = (("radius", 1), ("length", 1))

    radius: float
    length: float

    def __init__(self, radius: float, length: float, **placed: Unpack[Placed]) -> None:
        self._lengths(radius=radius, length=length)
        self._set_pose(placed)

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return math.pi * self.radius**2 * self.length


@dataclass(frozen=True, init=False, repr=False)
class Capsule(Shape):
    """All points within a radius of a segment: a cylinder with half balls as caps.

    ``Capsule(radius, length)`` lies along the z axis of its frame, its middle in the origin.  ``Capsule(a, b, radius)``
    has its segment from `a` to `b`, and is a ball if the two are one point.

    Parameters
    ----------
    radius, length : float
        > 0 [m]; the length is without the half balls.
    a, b : sequence of 3 floats
        Endpoints of the segment, in place of `length` [m].
    **placed
        ``xyz``, ``rpy`` or ``xyzw``, or ``pose`` [m, rad]; ``name`` in a scene; ``link``, default the world.

    Raises
    ------
    InvalidValue, UnknownName
        If a length is not a finite number > 0, or a keyword is unknown.

    Examples
    --------
    >>> import evenroad as er
    >>> er.Capsule(0.1, 0.4) == er.Capsule((0, 0, -0.2), (0, 0, 0.2), 0.1)
    True
    """

    kind: ClassVar[str] = "capsule"
    dimensions: ClassVar[tuple[tuple[str, int], ...]] = (("radius", 1), ("length", 1))

    a: Vector
    b: Vector
    radius: float

    @overload
    def __init__(self, radius: float, length: float, **placed: Unpack[Placed]) -> None: ...
    @overload
    def __init__(self, a: Sequence[float], b: Sequence[float], radius: float, **placed: Unpack[Placed]) -> None: ...
    def __init__(self, *given: Any, **named: Any) -> None:
        along_z = len(given) == 2 and np.ndim(given[0]) == 0
        names = ("radius", "length") if along_z or "length" in named else ("a", "b", "radius")
        if len(given) > len(names) or set(names[: len(given)]) & set(named):
            raise InvalidValue(f"a capsule must be made of {' and '.join(names)}, each once, got {shown(given)}")
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
        self._set_pose(named)  # type: ignore[arg-type]

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
    """Return the same body as a capsule along the z axis of its frame, or a sphere if it has no length."""
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
    return Capsule(capsule.radius, length, pose=pose, link=capsule.link)


def without_pose(capsule: Capsule) -> Capsule:
    """Return the same body with its endpoints in the parent frame of its pose."""
    if capsule.pose == IDENTITY:
        return capsule
    a, b = (tuple(capsule.pose.apply(end).tolist()) for end in (capsule.a, capsule.b))
    return replace(capsule, a=a, b=b, pose=IDENTITY)


def _ball(radius: float) -> float:
    return 4.0 / 3.0 * math.pi * radius**3
