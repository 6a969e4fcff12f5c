"""Whether boxes overlap, by separating axes, compiled."""

from __future__ import annotations

from numba import njit

from evenroad._arrays import Floats, Ints
from evenroad.world.solids.oriented_box import BoxTable

_PARALLEL = 1e-14
"""Squared sine below which two edges count as parallel: an axis across both would be rounding alone, and the
faces' axes separate boxes with such edges as well, but for gaps of 1e-7 of their size."""


@njit(cache=True, nogil=True)
def first_contact(
    pose: Floats, body: BoxTable, obstacles: BoxTable, near: Ints, planar: bool, work: Floats
) -> int:
    """Return the first obstacle among `near` that a box of the body meets at a pose, (7,), or -1.

    Boxes are closed: touching is meeting.  `planar` says that all boxes stand along z, where the axes across pairs
    of edges give nothing new.  `work`, (4, 3, 3), is overwritten.
    """
    rotation, axes, products, vectors = work[0], work[1], work[2], work[3]
    centre, reach = vectors[0], vectors[1]
    _put_rotation(pose, rotation)
    for part in range(len(body.centre)):
        for i in range(3):
            for j in range(3):
                axes[i, j] = (
                    rotation[i, 0] * body.axes[part, 0, j]
                    + rotation[i, 1] * body.axes[part, 1, j]
                    + rotation[i, 2] * body.axes[part, 2, j]
                )
            centre[i] = pose[i] + (
                rotation[i, 0] * body.centre[part, 0]
                + rotation[i, 1] * body.centre[part, 1]
                + rotation[i, 2] * body.centre[part, 2]
            )
            reach[i] = (
                abs(axes[i, 0]) * body.half[part, 0]
                + abs(axes[i, 1]) * body.half[part, 1]
                + abs(axes[i, 2]) * body.half[part, 2]
            )
        for obstacle in near:
            separated = False
            for k in range(3):
                separated |= centre[k] + reach[k] < obstacles.low[obstacle, k]
                separated |= obstacles.high[obstacle, k] < centre[k] - reach[k]
            if not separated and _overlap(
                centre, axes, body.half[part], obstacles, obstacle, planar, products, vectors[2]
            ):
                return obstacle
    return -1


@njit(cache=True, nogil=True)
def _overlap(centre, axes, half, obstacles, obstacle, planar, products, offset):  # type: ignore[no-untyped-def]
    """Test a box against an obstacle by separating axes (Gottschalk, Lin and Manocha, SIGGRAPH 1996, section 5)."""
    other_axes, other_half = obstacles.axes[obstacle], obstacles.half[obstacle]
    offset_x = obstacles.centre[obstacle, 0] - centre[0]
    offset_y = obstacles.centre[obstacle, 1] - centre[1]
    offset_z = obstacles.centre[obstacle, 2] - centre[2]
    for i in range(3):
        for j in range(3):
            products[i, j] = (
                axes[0, i] * other_axes[0, j] + axes[1, i] * other_axes[1, j] + axes[2, i] * other_axes[2, j]
            )
        # The offset in the box's own axes.
        offset[i] = axes[0, i] * offset_x + axes[1, i] * offset_y + axes[2, i] * offset_z
    for i in range(3):
        other_reach = (
            abs(products[i, 0]) * other_half[0]
            + abs(products[i, 1]) * other_half[1]
            + abs(products[i, 2]) * other_half[2]
        )
        if abs(offset[i]) > half[i] + other_reach:
            return False
    for j in range(3):
        own_reach = (
            half[0] * abs(products[0, j]) + half[1] * abs(products[1, j]) + half[2] * abs(products[2, j])
        )
        along = offset[0] * products[0, j] + offset[1] * products[1, j] + offset[2] * products[2, j]
        if abs(along) > other_half[j] + own_reach:
            return False
    if planar:
        return True
    for i in range(3):
        i1, i2 = (i + 1) % 3, (i + 2) % 3
        for j in range(3):
            if 1.0 - products[i, j] * products[i, j] < _PARALLEL:
                continue
            j1, j2 = (j + 1) % 3, (j + 2) % 3
            own_reach = half[i1] * abs(products[i2, j]) + half[i2] * abs(products[i1, j])
            other_reach = other_half[j1] * abs(products[i, j2]) + other_half[j2] * abs(products[i, j1])
            along = offset[i2] * products[i1, j] - offset[i1] * products[i2, j]
            if abs(along) > own_reach + other_reach:
                return False
    return True


@njit(cache=True, nogil=True)
def _put_rotation(pose, rotation):  # type: ignore[no-untyped-def]
    """Write the rotation matrix of the pose's quaternion, whatever its norm."""
    w, x, y, z = pose[3], pose[4], pose[5], pose[6]
    s = 2.0 / (w * w + x * x + y * y + z * z)
    rotation[0, 0], rotation[0, 1], rotation[0, 2] = (
        1.0 - s * (y * y + z * z),
        s * (x * y - w * z),
        s * (x * z + w * y),
    )
    rotation[1, 0], rotation[1, 1], rotation[1, 2] = (
        s * (x * y + w * z),
        1.0 - s * (x * x + z * z),
        s * (y * z - w * x),
    )
    rotation[2, 0], rotation[2, 1], rotation[2, 2] = (
        s * (x * z - w * y),
        s * (y * z + w * x),
        1.0 - s * (x * x + y * y),
    )
