"""Meshes as coal has them: trees of bounding boxes over triangles."""

from __future__ import annotations

from typing import Any

from evenroad._extras import require_extra
from evenroad.errors import BrokenFile
from evenroad.world.mesh.triangle_mesh import TriangleMesh


def require_coal() -> Any:
    """Return the module coal.

    Raises
    ------
    NotAvailable
        If it is not installed.
    """
    return require_extra("coal", "mesh", "checking meshes")


def tree_of(coal: Any, mesh: TriangleMesh) -> Any:
    """Return coal's tree of oriented boxes over the triangles of a mesh; its surface as it is, nothing made convex.

    Raises
    ------
    BrokenFile
        If coal leaves triangles out.
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
