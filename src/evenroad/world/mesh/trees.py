"""Meshes as coal has them: trees of bounding boxes over triangles."""

from __future__ import annotations

from typing import Any

from evenroad.errors import NotAvailable
from evenroad.world.mesh.triangle_mesh import TriangleMesh


def require_coal() -> Any:
    """Return the module coal.

    Raises
    ------
    NotAvailable
        If it is not installed.
    """
    try:
        import coal
    except ImportError as error:
        raise NotAvailable(f"meshes need the extra: pip install 'evenroad[mesh]' ({error})") from error
    return coal


def tree_of(coal: Any, mesh: TriangleMesh) -> Any:
    """Return coal's tree of oriented boxes over the triangles of a mesh; its surface as it is, nothing made convex."""
    tree = coal.BVHModelOBBRSS()
    tree.beginModel(len(mesh.triangles), len(mesh.vertices))
    tree.addVertices(mesh.vertices)
    tree.addTriangles(mesh.triangles)
    tree.endModel()
    assert tree.num_tris == len(mesh.triangles) > 0, "a tree without triangles would never collide"
    return tree
