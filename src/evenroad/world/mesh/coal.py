"""Meshes in coal: trees of bounding boxes over triangles, and two of them one of which is put at poses."""

from __future__ import annotations

from typing import Any

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad._checks import require_extra
from evenroad.errors import BrokenFile
from evenroad.geometry.mesh import TriangleMesh
from evenroad.geometry.pose import rotations_from_quaternions


def require_coal() -> Any:
    """Return the module coal; NotAvailable if it is not installed."""
    return require_extra("coal", "mesh", "checking meshes")


def tree_of(coal: Any, mesh: TriangleMesh) -> Any:
    """Return coal's tree of oriented boxes over the triangles of a mesh; its surface as it is, nothing made convex.

    Raises BrokenFile if coal leaves triangles out.
    """
    tree = coal.BVHModelOBBRSS()
    tree.beginModel(len(mesh.triangles), len(mesh.vertices))
    tree.addVertices(mesh.vertices)
    tree.addTriangles(mesh.triangles)
    tree.endModel()
    if not tree.num_tris == len(mesh.triangles) > 0:
        raise BrokenFile(
            f"coal took {tree.num_tris} of {len(mesh.triangles)} triangles: the others would never collide"
        )
    return tree


class Collider:
    """A body and obstacles as trees of bounding boxes over their triangles: surfaces, which have no inside.

    Raises NotAvailable if coal is not installed.
    """

    def __init__(self, body: TriangleMesh, obstacles: TriangleMesh) -> None:
        coal = self._coal = require_coal()
        self._body, self._obstacles = tree_of(coal, body), tree_of(coal, obstacles)

    def first_triangles(self, poses: Floats) -> Ints:
        """Return for each pose of the body, (n, 7), a triangle of the obstacles that it meets, or -1."""
        coal = self._coal
        here, there = coal.Transform3s.Identity(), coal.Transform3s.Identity()
        request, result = coal.CollisionRequest(), coal.CollisionResult()
        found = np.full(len(poses), -1, dtype=np.int64)
        for row, (pose, rotation) in enumerate(
            zip(poses, rotations_from_quaternions(poses[:, 3:]), strict=True)
        ):
            here.setTranslation(pose[:3])
            here.setRotation(rotation)
            result.clear()
            if coal.collide(self._body, here, self._obstacles, there, request, result):
                found[row] = result.getContact(0).b2
        return found
