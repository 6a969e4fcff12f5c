"""OrientedBox: a box or rectangle with any rotation, in the plane or in space; and tables of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Floats, set_fields
from evenroad._checks import as_row
from evenroad.errors import InvalidValue
from evenroad.geometry.mesh import TriangleMesh
from evenroad.geometry.rotation import as_rotation
from evenroad.geometry.shapes import Box

_FACES_OF_A_BOX = np.array(
    [
        (0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5),
        (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6),
        (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3),
    ]
)  # fmt: skip
"""Triangles of a box, two a face, whose corner number 4 i + 2 j + k is on the upper side of the axes with a 1."""


@dataclass(frozen=True)
class OrientedBox:
    """All points ``centre + rotation x`` with ``|x_i| <= half_extents_i``.

    `centre` are 2 or 3 numbers, `half_extents` as many, >= 0; one of zero makes a box in space a rectangle, a piece
    of a surface.  `rotation` is from the box's own axes, the rows of the matrix one after the other, as
    ``rotation_from_heading`` and ``rotation_from_quaternion`` of :mod:`evenroad.geometry` make them; by default the box
    is not rotated.  `name` is what explanations call it.  InvalidValue for other numbers.
    """

    centre: Sequence[float]
    half_extents: Sequence[float]
    rotation: Sequence[float] | None = None
    name: str = ""

    def __post_init__(self) -> None:
        centre = as_row("centre", self.centre)
        if len(centre) not in (2, 3):
            raise InvalidValue(f"centre must be 2 or 3 finite numbers, got {self.centre!r}")
        half_extents = as_row("half_extents", self.half_extents, len(centre))
        if min(half_extents) < 0.0:
            raise InvalidValue(f"half_extents must be >= 0, got {self.half_extents!r}")
        rotation = as_rotation(self.rotation, len(centre))
        set_fields(self, centre=centre, half_extents=half_extents, rotation=rotation)

    @classmethod
    def spanning(cls, low: Sequence[float], high: Sequence[float], name: str = "") -> OrientedBox:
        """Return the box, not rotated, that reaches from `low` to `high`; equal numbers make it flat.

        Raises InvalidValue if the two are not 2 or 3 finite numbers each with ``low <= high``.
        """
        lows = np.array(as_row("low", low))
        highs = np.array(as_row("high", high, len(lows)))
        if (lows > highs).any():
            raise InvalidValue(f"low must not exceed high, got {low!r} and {high!r}")
        return cls(((lows + highs) / 2.0).tolist(), ((highs - lows) / 2.0).tolist(), name=name)

    @classmethod
    def of(cls, box: Box) -> OrientedBox:
        """Return a box of :mod:`evenroad.geometry`, which is one in space, with its pose."""
        return cls(box.pose.xyz, [0.5 * extent for extent in box.size], box.pose.rotation)

    @property
    def dim(self) -> int:
        """2 in the plane, 3 in space."""
        return len(self.centre)

    @property
    def matrix(self) -> Floats:
        """The rotation as a matrix, (dim, dim)."""
        return np.array(self.rotation).reshape(self.dim, self.dim)

    @property
    def corners(self) -> Floats:
        """The corners, (2^dim, dim)."""
        signs = np.array(np.meshgrid(*[(-1.0, 1.0)] * self.dim, indexing="ij")).reshape(self.dim, -1).T
        return np.array(self.centre) + (signs * np.array(self.half_extents)) @ self.matrix.T


def shell(box: OrientedBox) -> tuple[OrientedBox, ...]:
    """Return the surface of a box in space, as six rectangles; InvalidValue if the box lies in the plane."""
    if box.dim != 3:
        raise InvalidValue("only boxes in space have a shell of rectangles")
    rectangles = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            centre = np.array(box.centre) + sign * box.half_extents[axis] * box.matrix[:, axis]
            half_extents = [0.0 if k == axis else extent for k, extent in enumerate(box.half_extents)]
            rectangles.append(OrientedBox(centre.tolist(), half_extents, box.rotation, box.name))
    return tuple(rectangles)


def surface_of(box: OrientedBox) -> TriangleMesh:
    """Return the surface of a box in space as 12 triangles; InvalidValue if the box lies in the plane."""
    if box.dim != 3:
        raise InvalidValue("only boxes in space have a surface of triangles")
    return TriangleMesh(box.corners, _FACES_OF_A_BOX, box.name)


class BoxTable(NamedTuple):
    """Boxes in space as arrays (n, 3), axes (n, 3, 3) with a column an axis of the box.

    `low` and `high` are corners of the boxes' bounding boxes.
    """

    centre: Floats
    half: Floats
    axes: Floats
    low: Floats
    high: Floats


class SolidTables(NamedTuple):
    """A body among obstacles; `reaches`, (n,), bound how far points of each of its boxes are from its frame's origin.

    `planar` says that all boxes stand along z, where the axes across pairs of edges give nothing new.
    """

    body: BoxTable
    obstacles: BoxTable
    reaches: Floats
    planar: bool


def box_table(boxes: Sequence[OrientedBox]) -> BoxTable:
    """Return the table of `boxes`, of one dimension; those of the plane become slabs of z from -1 to 1."""
    m = len(boxes)
    centre, half, axes = np.zeros((m, 3)), np.ones((m, 3)), np.tile(np.eye(3), (m, 1, 1))
    for row, box in enumerate(boxes):
        centre[row, : box.dim] = box.centre
        half[row, : box.dim] = box.half_extents
        axes[row, : box.dim, : box.dim] = box.matrix
    reach = (np.abs(axes) * half[:, np.newaxis, :]).sum(axis=2)
    table = BoxTable(centre, half, axes, centre - reach, centre + reach)
    for array in table:
        array.setflags(write=False)
    return table


def reaches_of(boxes: Sequence[OrientedBox]) -> Floats:
    """Return how far points of each box are at most from the origin of its frame, with room for rounding: (n,)."""
    return (1.0 + 1e-12) * np.array([np.linalg.norm(box.corners, axis=1).max() for box in boxes])
