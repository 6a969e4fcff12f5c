"""Collider: two meshes in coal, one of which is put at poses."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.world.mesh.trees import require_coal, tree_of
from evenroad.world.mesh.triangle_mesh import TriangleMesh


class Collider:
    """A body and obstacles as trees of bounding boxes over their triangles.

    Parameters
    ----------
    body, obstacles : TriangleMesh
        Surfaces: a body inside of a closed obstacle meets nothing.

    Raises
    ------
    NotAvailable
        If coal is not installed.
    """

    def __init__(self, body: TriangleMesh, obstacles: TriangleMesh) -> None:
        coal = self._coal = require_coal()
        self._body, self._obstacles = tree_of(coal, body), tree_of(coal, obstacles)

    def first_triangles(self, poses: npt.NDArray[np.float64]) -> npt.NDArray[np.int64]:
        """Return for each pose of the body, (n, 7), a triangle of the obstacles that it meets, or -1."""
        coal = self._coal
        here, there = coal.Transform3s.Identity(), coal.Transform3s.Identity()
        request, result = coal.CollisionRequest(), coal.CollisionResult()
        found = np.full(len(poses), -1, dtype=np.int64)
        for row, (pose, turn) in enumerate(zip(poses, turn_matrices(poses), strict=True)):
            here.setTranslation(pose[:3])
            here.setRotation(turn)
            result.clear()
            if coal.collide(self._body, here, self._obstacles, there, request, result):
                found[row] = result.getContact(0).b2
        return found


def turn_matrices(poses: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the rotation matrices, (n, 3, 3), of poses (n, 7) that end with quaternions w, x, y, z."""
    w, x, y, z = (poses[:, 3:] / np.linalg.norm(poses[:, 3:], axis=1, keepdims=True)).T
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0).copy()
