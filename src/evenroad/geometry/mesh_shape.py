"""Mesh and PointCloud: shapes of many triangles or points, from files or from arrays."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import ClassVar, Unpack

import numpy as np

from evenroad._arrays import Floats, set_fields
from evenroad._call import explains_calls
from evenroad._checks import FARTHEST, as_batch, as_row, require_positive
from evenroad.errors import InvalidValue, listed, shown
from evenroad.geometry.cloud_file import load_cloud
from evenroad.geometry.mesh import TriangleMesh, scaled, volume_of
from evenroad.geometry.mesh_file import GLTF, load_mesh, load_upright
from evenroad.geometry.pose import Vector
from evenroad.geometry.shape import Placed, Shape

CLOUD_RADIUS = 0.01
"""Default radius of the balls of a point cloud [m]."""


@explains_calls
@dataclass(frozen=True, init=False, repr=False)
class Mesh(Shape):
    """A surface of triangles.

    Parameters
    ----------
    source : str, path-like, TriangleMesh, or a pair of arrays
        A file, opened on first use; or vertices, (v, 3) [m], and triangles as rows of these, (t, 3); or an object with
        `vertices` and `faces`, such as a mesh of trimesh.  In a glTF y is up: it becomes z, except for the mesh of a
        `link`.
    scale : float or sequence of 3 floats
        Factors of the coordinates, z up, none of them 0.
    **placed
        ``xyz``, ``rpy`` or ``xyzw``, or ``pose`` [m, rad]; ``name`` in a scene; ``link``, default the world.

    Raises
    ------
    InvalidValue, UnknownName
        If a length is not a finite number > 0, or a keyword is unknown.

    Examples
    --------
    >>> import evenroad as er
    >>> er.Mesh(([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]), name="flag")
    Mesh(1 triangles, name='flag')
    """

    kind: ClassVar[str] = "mesh"

    source: Path | TriangleMesh
    scale: Vector

    def __init__(
        self, source: object, scale: float | Sequence[float] = (1.0, 1.0, 1.0), **placed: Unpack[Placed]
    ) -> None:
        row = as_row("the scale of a mesh", [scale] * 3 if np.ndim(scale) == 0 else scale, 3)  # type: ignore
        source = _surface(source)
        if isinstance(source, Path) and source.suffix.lower() in GLTF and "link" not in placed:
            source = load_upright(source)
        if 0.0 in row:
            raise InvalidValue(f"the scale of mesh {source.name} must not be 0, got {row}: it would be flat")
        set_fields(self, scale=row, source=source)
        self._set_pose(placed)

    @property
    def triangles(self) -> TriangleMesh:
        """Scaled triangles in the shape's frame; errors as :func:`evenroad.geometry.load_mesh`."""
        mesh = self.source if isinstance(self.source, TriangleMesh) else load_mesh(self.source)
        return mesh if self.scale == (1.0, 1.0, 1.0) else scaled(mesh, self.scale)

    @property
    def volume(self) -> float:
        """Volume [m^3]; if the mesh is not closed, that of its convex hull."""
        return volume_of(self.triangles)

    def __str__(self) -> str:
        return f"mesh {self.source.name}"

    def _written(self) -> str:
        if isinstance(self.source, TriangleMesh):
            return f"{len(self.source.triangles)} triangles"
        return repr(str(self.source))


def gap_notes(what: str, bodies: Iterable[tuple[str, Shape]]) -> tuple[str, ...]:
    """Return a note that names the links or obstacles whose meshes seem to be solids with gaps."""
    named = [(name, body) for name, body in bodies if isinstance(body, Mesh)]
    # A scale makes another mesh, but changes no gap.
    meshes = [(name, body.source if isinstance(body.source, TriangleMesh) else body.triangles) for name, body in named]
    names = listed(dict.fromkeys(name for name, mesh in meshes if mesh.is_nearly_closed))
    said = "is closed but for small gaps, so that it is a surface with nothing inside"
    return (f"the mesh of {what} {names} {said}: close it, or say that it is convex",) if names else ()


def _surface(source: object) -> Path | TriangleMesh:
    """Return the file or the triangles of a mesh's source."""
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
    """Balls of one radius around the points of a depth camera; equal by value.

    The default radius suits points at most 0.02 m apart: a robot may pass between points that lie further apart.

    Parameters
    ----------
    points : array_like, shape (n, 3), or a file
        At least one point [m]; of files see :func:`evenroad.geometry.load_cloud`.
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
    >>> er.PointCloud([(0.5, 0, 0.1), (0.5, 0.01, 0.1)])
    PointCloud(2 points, radius=0.01)
    """

    kind: ClassVar[str] = "cloud"

    points: Floats
    radius: float

    def __init__(self, points: object, radius: float = CLOUD_RADIUS, **placed: Unpack[Placed]) -> None:
        points = load_cloud(points) if isinstance(points, str | os.PathLike) else points
        points = np.array(as_batch("points of a cloud", points, 3))
        if len(points) == 0:
            raise InvalidValue("a cloud must have one point or more: one without would never collide")
        # Magnitudes would be one more array of a frame's size.
        if (most := max(points.max(), -points.min())) > FARTHEST:
            raise InvalidValue(f"points of a cloud must lie within {FARTHEST:g} m, got {most:g}")
        radius = require_positive("the radius of a cloud", radius, at_most=FARTHEST)
        set_fields(self, points=points, radius=radius)
        self._set_pose(placed)

    @property
    def volume(self) -> float:
        """Sum of the volumes of all balls, overlaps included [m^3]."""
        return len(self.points) * 4.0 / 3.0 * math.pi * self.radius**3

    @cached_property
    def _few(self) -> tuple[object, ...]:
        """A few values in which different clouds usually differ, so that equality rarely reads all points."""
        some = self.points[:: len(self.points) // 16 + 1].tobytes()
        return self.radius, self.pose, self.link, len(self.points), some

    def __hash__(self) -> int:
        return hash(self._few)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, PointCloud):
            return NotImplemented
        if self is other or self._few != other._few:
            return self is other
        # Compared as bits, so that 0.0 and -0.0 differ.
        return np.array_equal(self.points.view(np.uint64), other.points.view(np.uint64))

    def __str__(self) -> str:
        return f"cloud of {len(self.points)} points"

    def _written(self) -> str:
        return f"{len(self.points)} points, radius={self.radius!r}"
