"""TriangleMesh: a surface of triangles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue
from evenroad.space.batch import as_batch
from evenroad.world.solids.oriented_box import OrientedBox

_FACES_OF_A_BOX = np.array(
    [
        (0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5),
        (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6),
        (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3),
    ]
)  # fmt: skip
"""Triangles of a box, two a face, whose corner number 4 i + 2 j + k is on the upper side of the axes with a 1."""


@dataclass(frozen=True, eq=False)
class TriangleMesh:
    """Triangles between vertices; a surface, with nothing inside.

    Parameters
    ----------
    vertices : array_like, shape (v, 3)
        Finite coordinates, stored as read-only float64.
    triangles : array_like of int, shape (t, 3)
        Rows of `vertices`, at least one triangle; stored as read-only int64.
    name : str
        What explanations call it.

    Raises
    ------
    InvalidValue
        If the two are not such arrays, or a triangle names a vertex that there is not.
    """

    vertices: npt.NDArray[np.float64]
    triangles: npt.NDArray[np.int64]
    name: str = ""

    def __post_init__(self) -> None:
        vertices = np.array(as_batch("vertices", self.vertices, 3))
        try:
            triangles = np.array(self.triangles)
        except ValueError as error:
            raise InvalidValue(f"triangles must be a (t, 3) array of integers: {error}") from None
        if triangles.ndim != 2 or triangles.shape[1] != 3 or not np.issubdtype(triangles.dtype, np.integer):
            raise InvalidValue(
                f"triangles must be a (t, 3) array of integers, got {triangles.dtype} of shape {triangles.shape}"
            )
        if len(triangles) == 0:
            raise InvalidValue("a mesh must have one triangle or more: one without would never collide")
        if triangles.min() < 0 or triangles.max() >= len(vertices):
            raise InvalidValue(
                f"triangles must name rows of the {len(vertices)} vertices, got {triangles.min()} .. {triangles.max()}"
            )
        triangles = triangles.astype(np.int64)
        for field, array in (("vertices", vertices), ("triangles", triangles)):
            array.setflags(write=False)
            object.__setattr__(self, field, array)


def surface_of(box: OrientedBox) -> TriangleMesh:
    """Return the surface of a box in space as 12 triangles.

    Raises
    ------
    InvalidValue
        If the box lies in the plane.
    """
    if box.dim != 3:
        raise InvalidValue("only boxes in space have a surface of triangles")
    return TriangleMesh(box.corners, _FACES_OF_A_BOX, box.name)


def merged(meshes: tuple[TriangleMesh, ...]) -> TriangleMesh:
    """Return several meshes, at least one, as one."""
    firsts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    return TriangleMesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.triangles + first for mesh, first in zip(meshes, firsts, strict=True)]),
    )
