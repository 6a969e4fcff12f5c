"""The robot's own shapes, checked by coal where its capsules touch: capsules contain the shapes and refuse more."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar, NamedTuple

import numpy as np

from evenroad._arrays import Bools, Floats, Ints, set_fields
from evenroad.geometry.shapes import Mesh, PointCloud, Shape
from evenroad.robot import ArmWorld
from evenroad.robot.arm_world import VALIDATION_TOLERANCE
from evenroad.robot.reference.coal_world import CoalWorld
from evenroad.robot.reference.validate import FINER
from evenroad.space import JointSpace

RAY = np.array([0.35921, 0.48217, 0.79904])
"""Direction of rays, which no edge of a drawing has."""


@dataclass(frozen=True, eq=False)
class OwnShapesWorld:
    """A robot that is free where its capsules are or, else, its own shapes are.

    Motions that the capsules prove free need no coal.  Other motions are checked at states a tenth of the resolution
    apart, by coal where the capsules touch.  A body wholly inside a mesh touches it.  `shapes` are as of
    :func:`evenroad.robot.reference.coal_world.original_shapes`.  Raises what CoalWorld does.  Clouds block as they do
    for capsules alone: coal knows none.
    """

    backend: ClassVar[str] = "coal"
    proof: ClassVar[str] = "resolution"
    """The proof of a path whose motions the capsules do not all prove."""

    capsules: ArmWorld
    shapes: Sequence[Shape]
    _coal: CoalWorld = field(init=False, repr=False)
    _clouds: ArmWorld | None = field(init=False, repr=False)

    def __post_init__(self) -> None:
        world = self.capsules
        scene, resolution = world.scene, world.resolution
        names = [each.name for each in scene.obstacles if isinstance(each.body, PointCloud)]
        others = [each.name for each in scene.obstacles if each.name not in names]
        # Self-collision is decided by the shapes.
        bare = replace(world.robot, pairs=())
        clouds = ArmWorld(bare, scene.without(*others), resolution=resolution) if names else None
        capsules = ArmWorld(world.robot, scene.without(*names), resolution=resolution) if names else world
        coal = WithinCapsules(world.robot, scene.without(*names), self.shapes, resolution / FINER, capsules=capsules)
        set_fields(self, _coal=coal, _clouds=clouds)

    @property
    def space(self) -> JointSpace:
        """The joints' ranges."""
        return self.capsules.space

    def valid(self, q: Floats) -> Bools:
        """Return which configurations, (n, dim), are free: (n,)."""
        free = self.capsules.valid(q)
        left = np.flatnonzero(~free)
        if self._clouds is not None:
            left = left[self._clouds.valid(q[left])]
        free[left] = self._coal.valid(q[left])
        return free

    def proved(self, q: Floats) -> Bools:
        """Return which configurations, (n, dim), are free for the capsules: (n,)."""
        return self.capsules.valid(q)

    def motion_proved(self, a: Floats, b: Floats) -> Bools:
        """Return which motions, (m, dim) each, the capsules prove free: (m,); coal is not called."""
        return self.capsules.motion_certified(a, b, VALIDATION_TOLERANCE)

    def motion_certified(self, a: Floats, b: Floats, tolerance: float) -> Bools:
        """Return which motions, (m, dim) each, are proved free for the capsules, or free at states for the shapes."""
        free = self.capsules.motion_certified(a, b, tolerance)
        left = np.flatnonzero(~free)
        if self._clouds is not None:
            left = left[self._clouds.motion_certified(a[left], b[left], tolerance)]
        free[left] = self._coal.motion_valid(a[left], b[left])
        return free

    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """Return which motions, (m, dim) each, are free: (m,)."""
        return self.motion_certified(a, b, VALIDATION_TOLERANCE)

    def explain(self, q: Floats) -> str:
        """Return in words why one configuration, (dim,), is not free."""
        if self._clouds is not None and not self._clouds.valid(q[np.newaxis])[0]:
            return self._clouds.explain(q)
        return self._coal.explain(q)


class SolidMeshes(CoalWorld):
    """A CoalWorld in which a body wholly inside a mesh touches it: a link in an obstacle, or the other way round."""

    def _contacts(self, poses: Floats, near: Bools) -> Iterator[tuple[str, str]]:
        yield from super()._contacts(poses, near)
        inner = self._inner
        inner = _Inner(*(column[near[inner.test]] for column in inner))  # type: ignore[arg-type]
        if not len(inner.mesh):
            return
        fixed = [obstacle.body.pose.matrix for obstacle in self.scene.obstacles]
        placed = np.concatenate([poses, np.reshape(fixed, (-1, 4, 4))])
        at, frame = placed[inner.body], placed[inner.mesh]
        away = (at[:, :3, :3] @ inner.point[:, :, np.newaxis])[:, :, 0] + at[:, :3, 3] - frame[:, :3, 3]
        point = (away[:, np.newaxis] @ frame[:, :3, :3])[:, 0]
        for row in np.flatnonzero(((inner.low <= point) & (point <= inner.high)).all(axis=1)).tolist():
            if is_inside(self._corners[int(inner.mesh[row])], point[row]):
                shape, other = sorted((int(inner.mesh[row]), int(inner.body[row])))
                yield self._shapes[shape].link, self.scene.obstacles[other - len(self._shapes)].name

    @cached_property
    def _corners(self) -> dict[int, Floats]:
        """The corners of the triangles of each mesh, (t, 3, 3), by its number; obstacles come after shapes."""
        bodies = [*self._shapes, *(obstacle.body for obstacle in self.scene.obstacles)]
        meshes = {i: body.triangles for i, body in enumerate(bodies) if isinstance(body, Mesh)}
        return {i: mesh.vertices[mesh.triangles] for i, mesh in meshes.items()}

    @cached_property
    def _inner(self) -> _Inner:
        rows = []
        for test, (shape, number, is_obstacle) in enumerate(self._tests):
            other = number + len(self._shapes)
            for mesh, body in ((shape, other), (other, shape)) if is_obstacle else ():
                if mesh in self._corners:
                    # Surfaces that do not meet are inside each other piece by piece: one point of each decides.
                    points = points_in_pieces(self._corners[body]) if body in self._corners else np.zeros((1, 3))
                    corners = self._corners[mesh].reshape(-1, 3)
                    box = corners.min(axis=0), corners.max(axis=0)
                    rows += [(test, mesh, body, point, *box) for point in points]
        numbers = np.array([row[:3] for row in rows], dtype=np.int64).reshape(-1, 3)
        placed = np.array([row[3:] for row in rows]).reshape(-1, 3, 3)
        return _Inner(*numbers.T, *np.moveaxis(placed, 1, 0))


@dataclass(frozen=True, eq=False, kw_only=True)
class WithinCapsules(SolidMeshes):
    """SolidMeshes of shapes that lie within a robot's capsules: where these touch nothing, the shapes
    are not checked.
    """

    capsules: ArmWorld

    def _free(self, q: Floats) -> Bools:
        free = self.capsules.valid(q)
        left = np.flatnonzero(~free)
        if len(left):
            free[left] = super()._free(q[left])
        return free


class _Inner(NamedTuple):
    """What may be inside which mesh, and the number of the test of both, (m,) each; a point of it, in its frame; the
    mesh's box in its own frame, (m, 3).
    """

    test: Ints
    mesh: Ints
    body: Ints
    point: Floats
    low: Floats
    high: Floats


def points_in_pieces(corners: Floats) -> Floats:
    """Return a corner of each connected piece of a surface of triangles, (t, 3, 3): (p, 3)."""
    # Imported late: it loads linear algebra, which a plan without meshes does not need.
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    points, corner = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    a, b, c = corner.reshape(-1, 3).T
    pairs = np.append(a, b), np.append(b, c)
    joined = coo_array((np.ones(len(pairs[0])), pairs), shape=(len(points), len(points)))
    _, first = np.unique(connected_components(joined, directed=False)[1], return_index=True)
    return np.asarray(points[first])


def is_inside(corners: Floats, point: Floats) -> bool:
    """Return whether a point, (3,), is inside the surface of triangles, (t, 3, 3), as nearly as it is closed.

    The solid angles of its triangles decide (van Oosterom and Strackee 1983), or the parity of a ray, which does not
    depend on the orientation of triangles.
    """
    a, b, c = np.moveaxis(corners - point, 1, 0)
    one, two, three = (np.linalg.norm(each, axis=1) for each in (a, b, c))
    rest = one * two * three + (a * b).sum(axis=1) * three
    rest += (b * c).sum(axis=1) * one + (c * a).sum(axis=1) * two
    if abs(np.arctan2((a * np.cross(b, c)).sum(axis=1), rest).sum()) > np.pi:
        return True
    # The ray's coordinates in each triangle's cone: all of one sign where it goes through.
    through = np.stack([np.cross(b, c) @ RAY, np.cross(c, a) @ RAY, np.cross(a, b) @ RAY])
    ahead = through.sum(axis=0) * (a * np.cross(b, c)).sum(axis=1) > 0.0
    hit = ((through > 0.0).all(axis=0) | (through < 0.0).all(axis=0)) & ahead
    return bool(np.count_nonzero(hit) % 2)
