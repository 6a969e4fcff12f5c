"""Meshes: surfaces of triangles, as values."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats, Ints, set_fields, unique_rows
from evenroad._checks import as_batch, as_row, require_positive
from evenroad._native import robot as native
from evenroad._shared import state_without
from evenroad.errors import InvalidValue

_AS_LARGE = 1e-4
"""Largest difference in volume between a convex mesh and its hull, as a share of the hull's."""
_GAPS = 0.02
"""Largest share of edges missing from a solid with gaps. A surface that is meant to be open may lack as few."""
_MISSING = 0.01
"""Largest share of area missing from a solid with gaps."""
_MOST_HEIGHTS = 1_000_000
"""Largest number of heights of a map: its triangles then take 1 GB and some seconds."""
_FLAT = 5e-7
"""Half of the thickness that a flat mesh gets for its hull [m]."""


@dataclass(frozen=True, eq=False)
class TriangleMesh:
    """Triangles between vertices; a surface.  Equal by value.

    Parameters
    ----------
    vertices : array_like, shape (v, 3)
        Finite coordinates, stored as read-only float64.
    triangles : array_like of int, shape (t, 3)
        Rows of `vertices`, at least one triangle; stored as read-only int64.
    name : str
        Its name in messages.

    Raises
    ------
    InvalidValue
        If the arrays have another shape or dtype, or a triangle names a missing vertex.
    """

    vertices: Floats
    triangles: Ints
    name: str = ""

    def __post_init__(self) -> None:
        vertices = np.array(as_batch("vertices", self.vertices, 3))
        wanted = "triangles must be a (t, 3) array of integers"
        try:
            triangles = np.array(self.triangles)
        except ValueError as error:
            raise InvalidValue(f"{wanted}: {error}") from None
        if triangles.ndim != 2 or triangles.shape[1] != 3 or not np.issubdtype(triangles.dtype, np.integer):
            raise InvalidValue(f"{wanted}, got {triangles.dtype} of shape {triangles.shape}")
        if len(triangles) == 0:
            raise InvalidValue("a mesh must have one triangle or more: one without would never collide")
        if triangles.min() < 0 or triangles.max() >= len(vertices):
            raise InvalidValue(
                f"triangles must name rows of the {len(vertices)} vertices, got {triangles.min()} .. {triangles.max()}"
            )
        set_fields(self, vertices=vertices, triangles=triangles.astype(np.int64))

    @cached_property
    def digest(self) -> str:
        """A hash of vertices and triangles."""
        return "".join(sha256(array.tobytes()).hexdigest() for array in (self.vertices, self.triangles))

    @cached_property
    def compact(self) -> TriangleMesh:
        """The same triangles, with equal corners merged and unused vertices removed."""
        used = np.zeros(len(self.vertices), dtype=np.bool_)
        used[self.triangles] = True
        corners, number = unique_rows(self.vertices[used])
        found = TriangleMesh(corners, number[(np.cumsum(used) - 1)[self.triangles]], self.name)
        set_fields(found, compact=found)
        return found

    @property
    def welded(self) -> Ints:
        """The triangles, (t, 3), by indices of distinct positions: equal corners have one index."""
        return self.compact.triangles

    @cached_property
    def closed_parts(self) -> native.ClosedParts:
        """The triangles that bound closed parts, and whether `facing` distinguishes inside from outside there.

        A part is a set of triangles that share corners; equal corners count as one.  It is closed if every edge belongs
        to an even number of triangles.  A repeated triangle does not count if the part is closed without it; nor does
        one without area.  The inside of closed surfaces is solid, however they face, except for hollows.  A hollow is a
        surface within another that faces the other way, or to both sides, and crosses no larger one.
        """
        return native.closed_parts(self.vertices, self.triangles)

    def __getstate__(self) -> dict[str, object]:
        return state_without(self, ["closed_parts"])

    @cached_property
    def facing(self) -> Ints:
        """The triangles; those of closed parts are oriented so that the parts are solid inside."""
        turned = self.closed_parts.turned
        if not turned.any():
            return self.triangles
        return np.where(turned[:, np.newaxis], self.triangles[:, ::-1], self.triangles)

    @cached_property
    def is_nearly_closed(self) -> bool:
        """Whether its open parts seem to be solids with gaps: little area and few edges are missing."""
        is_open = ~self.closed_parts.closed
        a, b, c = self.vertices[self.triangles[is_open]].swapaxes(0, 1)
        areas = np.cross(b - a, c - a)
        # Area vectors of a closed surface sum to zero. This test is fast, and few meshes need one of their edges.
        if not np.linalg.norm(areas.sum(axis=0)) <= _MISSING * np.linalg.norm(areas, axis=1).sum():
            return False
        return bool(is_open.any()) and 0.0 < float(np.mean(_times_of_edges(self, is_open) % 2)) <= _GAPS

    @cached_property
    def outer(self) -> Floats:
        """The corners of the convex hull, (k, 3)."""
        return extreme(self.compact.vertices)

    @cached_property
    def sides(self) -> Floats:
        """The sides of the box around the corners, (3,)."""
        sides: Floats = np.ptp(self.vertices, axis=0)
        return sides

    @cached_property
    def is_convex(self) -> bool:
        """Whether it is closed and fills its hull up to a ten-thousandth of the volume."""
        from scipy.spatial import ConvexHull, QhullError

        try:
            whole = float(ConvexHull(self.outer).volume)
        except QhullError:
            return False
        corners = self.vertices[self.triangles]
        own = abs(float(np.linalg.det(corners - corners.mean(axis=(0, 1))).sum())) / 6.0
        return abs(own - whole) <= _AS_LARGE * whole and bool(self.closed_parts.closed.all())

    def __hash__(self) -> int:
        return hash((self.name, self.digest))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, TriangleMesh):
            return NotImplemented
        return self is other or (self.name, self.digest) == (other.name, other.digest)


def extreme(points: Floats) -> Floats:
    """Return the corners of the convex hull of points, (n, 3): a convex body that contains these contains all."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        corners: Ints = np.sort(ConvexHull(points).vertices)
    except QhullError:
        # The points lie in one plane, or are fewer than four.
        return np.unique(points, axis=0)
    return points[corners]


def merged(meshes: tuple[TriangleMesh, ...]) -> TriangleMesh:
    """Return one mesh with the triangles of one or more."""
    firsts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    return TriangleMesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.triangles + first for mesh, first in zip(meshes, firsts, strict=True)]),
    )


def scaled(mesh: TriangleMesh, factors: Sequence[float]) -> TriangleMesh:
    """Return a mesh with its coordinates multiplied by one factor per axis, (3,)."""
    return TriangleMesh(mesh.vertices * np.array(factors), mesh.triangles, mesh.name)


def volume_of(mesh: TriangleMesh) -> float:
    """Return the volume of a mesh; if it is not closed, that of its convex hull."""
    corners = mesh.vertices[mesh.triangles]
    if (_times_of_edges(mesh) == 2).all():
        # The volume of a closed surface is the sum of signed tetrahedra from the origin to each triangle.
        return abs(float(np.linalg.det(corners).sum())) / 6.0
    from scipy.spatial import ConvexHull, QhullError

    try:
        return float(ConvexHull(mesh.outer).volume)
    except QhullError:
        return 0.0


def _times_of_edges(mesh: TriangleMesh, of: Bools | slice = slice(None)) -> Ints:
    """Return the number of triangles, of those selected, to which each edge belongs."""
    sides = np.sort(mesh.welded[of][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    times: Ints = np.unique(sides[:, 0] * len(mesh.vertices) + sides[:, 1], return_counts=True)[1]
    return times


def convex_hull(points: npt.ArrayLike, name: str = "hull", grown: float = 0.0) -> TriangleMesh:
    """Return the surface of the convex hull of points; ``Mesh(convex_hull(points))`` is a solid obstacle.

    Triangles face outward.  Coplanar points are grown by half a micrometre.

    Parameters
    ----------
    points : array_like, shape (n, 3)
        Points [m], n >= 1.
    name : str
        Its name in errors.
    grown : float
        Half size of the cube that replaces each point, >= 0 [m].

    Raises InvalidValue if they are not such numbers, or there is no hull.
    """
    from scipy.spatial import ConvexHull, QhullError

    points = as_batch("points", points, 3)
    corners = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    for reach in (grown, max(grown, _FLAT)):
        every = (points[:, np.newaxis] + reach * corners[: 8 if reach else 1]).reshape(-1, 3)
        with suppress(QhullError, ValueError):
            hull = ConvexHull(every)
            break
    else:
        raise InvalidValue(f"the mesh {name} has no convex hull: {len(points)} points, all at about one place")
    number = np.zeros(len(every), dtype=np.int64)
    number[hull.vertices] = np.arange(len(hull.vertices))
    a, b, c = every[hull.simplices].swapaxes(0, 1)
    inward = np.einsum("ti,ti->t", np.cross(b - a, c - a), hull.equations[:, :3]) < 0.0
    triangles = np.where(inward[:, np.newaxis], hull.simplices[:, ::-1], hull.simplices)
    return TriangleMesh(every[hull.vertices], number[triangles], name)


def height_map(
    heights: npt.ArrayLike, spacing: float, low: Sequence[float] = (0.0, 0.0), depth: float = 0.0
) -> TriangleMesh:
    """Return the surface over a grid of heights: two triangles between four neighbours.

    Parameters
    ----------
    heights : array_like, shape (x, y), both >= 2
        z over ``low + spacing * (i, j)`` [m], at most 1 000 000 values; there is no surface around NaN.
    spacing : float
        Distance of neighbours, > 0 [m].
    low : sequence of 2 floats
        x and y of the first [m].
    depth : float
        Depth of solid ground below the lowest height, >= 0 [m].  Walls and a bottom enclose the ground.  A depth of 0
        gives the surface alone, and the space below it is free.

    Raises InvalidValue if they are not such numbers, or no triangle is left.
    """
    z, step = np.asarray(heights, dtype=np.float64), require_positive("spacing", spacing)
    deep = require_positive("depth", depth, or_zero=True)
    if z.ndim != 2 or min(z.shape) < 2 or np.isinf(z).any():
        raise InvalidValue(f"heights must be an (x, y) array of 2 or more along both, none inf, got {z.shape}")
    x, y = (first + step * np.arange(count) for first, count in zip(as_row("low", low, 2), z.shape, strict=True))
    if z.size > _MOST_HEIGHTS:
        raise InvalidValue(
            f"heights must be at most {_MOST_HEIGHTS}, got {z.shape[0]} x {z.shape[1]}: give those within the robot's"
            " reach, or every second, heights[::2, ::2] with twice the spacing"
        )
    number = np.arange(z.size).reshape(z.shape)
    a, b, c, d = (part.ravel() for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    known = ~np.isnan(z.ravel())
    vertices = np.stack([*(each.ravel() for each in np.meshgrid(x, y, indexing="ij")), np.where(known, z.ravel(), 0.0)])
    surface = TriangleMesh(vertices.T, triangles[known[triangles].all(axis=1)], "height map")
    return _ground_below(surface, deep) if deep else surface


def _ground_below(surface: TriangleMesh, depth: float) -> TriangleMesh:
    """Return the closed body between a surface and a level below its lowest point."""
    top, count = surface.triangles, len(surface.vertices)
    bottom = surface.vertices.copy()
    bottom[:, 2] = surface.vertices[top, 2].min() - depth
    sides = top[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    _, edge = unique_rows(np.sort(sides, axis=1))
    a, b = sides[np.bincount(edge)[edge] == 1].T
    walls = np.concatenate([np.stack([b, a, a + count], axis=1), np.stack([b, a + count, b + count], axis=1)])
    triangles = np.concatenate([top, top[:, ::-1] + count, walls])
    return TriangleMesh(np.concatenate([surface.vertices, bottom]), triangles, surface.name)
