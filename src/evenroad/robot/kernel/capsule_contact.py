"""One capsule against one obstacle, or another capsule, in sixteen placed configurations: masks of lanes."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.lanes import ONE, ZERO, absolute, below_zero, larger, load, smaller, square_root
from evenroad.robot.kernel.layout import LANES, inlined

Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

_LEAST = np.float32(at.LEAST_SQUARE)


@inlined
def meeting_one(scratch: Singles, here: int, capsule: int, obstacle: int, ints: Ints, table: Singles) -> int:
    """Return the mask of lanes in which a sphere along a capsule reaches into an obstacle."""
    data = ints[at.OBSTACLE_FLOATS] + at.OBSTACLE_FLOAT_ROW * obstacle
    kind = ints[ints[at.OBSTACLE_INTS] + obstacle]
    # Centre and half segment as the obstacle sees them.
    cx = load(scratch, here) - table[data]
    cy = load(scratch, here + LANES) - table[data + 1]
    cz = load(scratch, here + 2 * LANES) - table[data + 2]
    ex, ey = load(scratch, here + 3 * LANES), load(scratch, here + 4 * LANES)
    ez = load(scratch, here + 5 * LANES)
    if kind != at.ALIGNED:
        cx, cy, cz = _in_frame_of(cx, cy, cz, data + 6, table)
        ex, ey, ez = _in_frame_of(ex, ey, ez, data + 6, table)
    width_x, width_y, width_z = table[data + 3], table[data + 4], table[data + 5]
    reach = table[ints[at.CAPSULE_FLOATS] + at.CAPSULE_FLOAT_ROW * capsule + 6] + table[data + 15]
    square_reach = reach * reach
    row = ints[at.CAPSULE_INTS] + at.CAPSULE_INT_ROW * capsule
    samples = ints[at.SAMPLES]
    meeting = 0
    for sample in range(ints[row + 1], ints[row + 2]):
        along = table[samples + sample]
        x, y, z = cx + ex * along, cy + ey * along, cz + ez * along
        dz = larger(absolute(z) - width_z, ZERO)
        if kind == at.CYLINDER:
            aside = larger(square_root(x * x + y * y) - width_x, ZERO)
            meeting |= below_zero(aside * aside + dz * dz - square_reach)
        else:
            dx = larger(absolute(x) - width_x, ZERO)
            dy = larger(absolute(y) - width_y, ZERO)
            meeting |= below_zero(dx * dx + dy * dy + dz * dz - square_reach)
    return meeting


@inlined
def _in_frame_of(x: Any, y: Any, z: Any, data: int, table: Singles) -> Any:
    """Return a vector in the frame whose rotation to the root's is at `data` of the table."""
    return (
        x * table[data] + y * table[data + 3] + z * table[data + 6],
        x * table[data + 1] + y * table[data + 4] + z * table[data + 7],
        x * table[data + 2] + y * table[data + 5] + z * table[data + 8],
    )


@inlined
def touching(scratch: Singles, a: int, b: int, data: int, table: Singles) -> int:
    """Return the mask of lanes in which two capsules touch, whose pair's row is at `data`.

    The steps are those of the double-precision ``scalar._squared_distance_of_pair``.
    """
    rx = load(scratch, a) - load(scratch, b)
    ry = load(scratch, a + LANES) - load(scratch, b + LANES)
    rz = load(scratch, a + 2 * LANES) - load(scratch, b + 2 * LANES)
    ex, fx = load(scratch, a + 3 * LANES), load(scratch, b + 3 * LANES)
    ey, fy = load(scratch, a + 4 * LANES), load(scratch, b + 4 * LANES)
    ez, fz = load(scratch, a + 5 * LANES), load(scratch, b + 5 * LANES)
    ef = ex * fx + ey * fy + ez * fz
    er = ex * rx + ey * ry + ez * rz
    fr = fx * rx + fy * ry + fz * rz
    reach, one_by_ee, one_by_ff = table[data + 1], table[data + 2], table[data + 3]
    along_f, along_r = ef * one_by_ee, er * one_by_ee
    # What of f and r is across e.
    gx, gy, gz = fx - ex * along_f, fy - ey * along_f, fz - ez * along_f
    qx, qy, qz = rx - ex * along_r, ry - ey * along_r, rz - ez * along_r
    t = _cut((gx * qx + gy * qy + gz * qz) / larger(gx * gx + gy * gy + gz * gz, _LEAST))
    s = _cut(along_f * t - along_r)
    t = _cut((ef * s + fr) * one_by_ff)
    x, y, z = rx + ex * s - fx * t, ry + ey * s - fy * t, rz + ez * s - fz * t
    return below_zero(x * x + y * y + z * z - reach * reach)


@inlined
def _cut(place: Any) -> Any:
    """Return `place` cut to [-1, 1]."""
    return larger(smaller(place, ONE), -ONE)
