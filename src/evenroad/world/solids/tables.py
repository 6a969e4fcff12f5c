"""Boxes laid out for compiled code."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad.world.solids.oriented_box import OrientedBox


class BoxTable(NamedTuple):
    """Boxes in space, one a row; read-only.

    Attributes
    ----------
    centre : float64 array, shape (m, 3)
    half : float64 array, shape (m, 3)
        Half extents.
    axes : float64 array, shape (m, 3, 3)
        ``axes[i, :, k]`` is the direction of the k-th own axis of box i.
    low, high : float64 array, shape (m, 3)
        Corners of the smallest boxes that are not turned and hold them.
    """

    centre: npt.NDArray[np.float64]
    half: npt.NDArray[np.float64]
    axes: npt.NDArray[np.float64]
    low: npt.NDArray[np.float64]
    high: npt.NDArray[np.float64]


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


def reach_of(boxes: Sequence[OrientedBox]) -> float:
    """Return how far points of `boxes` are at most from the origin of their frame, with room for rounding."""
    return (1.0 + 1e-12) * max(float(np.linalg.norm(box.corners, axis=1).max()) for box in boxes)
