"""MeshWorld: a rigid body among obstacles, both of triangles from users' files, checked by coal (extra ``mesh``)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from evenroad._arrays import Bools, Floats, Ints, set_fields
from evenroad.errors import InvalidValue
from evenroad.geometry.mesh import TriangleMesh, merged
from evenroad.geometry.rotation import rotations_from_quaternions
from evenroad.robot.reference.coal_world import require_coal, tree_of
from evenroad.space.batch import as_batch
from evenroad.world.function import OUTSIDE, FunctionWorld, TestedAtStates
from evenroad_studies.worlds.rigid.solid_world import RigidSpace, as_poses, body_dimension, contact_with


class Collider:
    """A body and obstacles as trees over their triangles; NotAvailable if coal is not installed."""

    def __init__(self, body: TriangleMesh, obstacles: TriangleMesh) -> None:
        coal = self._coal = require_coal()
        self._body, self._obstacles = tree_of(coal, body), tree_of(coal, obstacles)

    def first_triangles(self, poses: Floats) -> Ints:
        """Return for each pose of the body, (n, 7), a triangle of the obstacles that it meets, or -1."""
        coal = self._coal
        here, there = coal.Transform3s.Identity(), coal.Transform3s.Identity()
        request, result = coal.CollisionRequest(), coal.CollisionResult()
        found = np.full(len(poses), -1, dtype=np.int64)
        for row, rotation in enumerate(rotations_from_quaternions(poses[:, 3:])):
            here.setTranslation(poses[row, :3])
            here.setRotation(rotation)
            result.clear()
            if coal.collide(self._body, here, self._obstacles, there, request, result):
                found[row] = result.getContact(0).b2
        return found


@dataclass(frozen=True, eq=False)
class MeshWorld(TestedAtStates):
    """A rigid body of triangles that moves among obstacles of triangles, checked by coal.

    A pose is free if it lies in the space and no triangle of the body meets one of an obstacle.  Meshes are
    surfaces: a body inside of a closed obstacle, or around one, is free.  Motions are tested at states, as
    :class:`FunctionWorld` does; some ten thousand states a second.  Where body and obstacles are boxes,
    :class:`SolidWorld` is tens of times faster.

    `space`, ``SE3(..)`` or a BoxSpace of 3 axes, `body` and `obstacles`, at least one, are as for :class:`SolidWorld`;
    `resolution` is the largest distance between neighbouring states, for SE3 also the largest rotation.  NotAvailable
    if coal is not installed (the extra ``mesh``), InvalidValue for anything else.
    """

    space: RigidSpace
    body: TriangleMesh
    obstacles: Sequence[TriangleMesh]
    resolution: float | Sequence[float]
    _collider: Collider = field(init=False, repr=False)
    _states: FunctionWorld = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if body_dimension(self.space) != 3:
            raise InvalidValue(f"space must be SE3(..) or a BoxSpace of 3 axes, got {self.space!r}")
        obstacles = tuple(self.obstacles)
        if not obstacles:
            raise InvalidValue("obstacles must be one mesh or more, got none")
        for name, mesh in (("body", self.body), *(("obstacles", mesh) for mesh in obstacles)):
            if not isinstance(mesh, TriangleMesh):
                raise InvalidValue(f"{name} must be TriangleMesh values, got {mesh!r}")
        states = FunctionWorld(self.space, self._is_free, self.resolution)
        set_fields(self, obstacles=obstacles, resolution=states.resolution)
        set_fields(self, _collider=Collider(self.body, merged(obstacles)), _states=states)

    def explain(self, q: Floats) -> str:
        """Return in words why the pose `q`, (dim,), is not free."""
        pose = as_batch("q", np.asarray(q, dtype=np.float64)[np.newaxis], self.space.dim)
        if not self.space.contains(pose)[0]:
            return OUTSIDE
        triangle = int(self._collider.first_triangles(as_poses(pose, self.space))[0])
        ends = np.cumsum([len(mesh.triangles) for mesh in self.obstacles])
        return contact_with(self.obstacles, int(np.searchsorted(ends, triangle, side="right")))

    def _is_free(self, q: Floats) -> Bools:
        return self._collider.first_triangles(as_poses(q, self.space)) < 0
