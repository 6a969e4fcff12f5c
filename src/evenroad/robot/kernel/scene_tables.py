"""ArmTables: a robot's tables followed by the rows of a scene's obstacles; compiled, since scenes change often."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad._njit import njit
from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.layout import quick
from evenroad.robot.kernel.obstacles import BOX, CYLINDER, ROTATION, SIZE, SPHERE, TRANSLATION
from evenroad.robot.kernel.placed_capsules import FARTHEST
from evenroad.robot.kernel.robot_tables import PADDING, RobotTables
from evenroad.robot.kernel.scalar import squared_distance_to_obstacle

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]

OBSTACLE_PADDING = 2.5e-7
"""Single precision makes an obstacle uncertain by less than this share of its farthest point's distance from the
origin."""

_NEVER_HIT = -1e30
"""Half extent that fills unused places of a block of obstacles."""


@dataclass(frozen=True, eq=False)
class ArmTables:
    """What the compiled code reads of a robot in a scene; the order is that of ``layout.py``.

    Attributes
    ----------
    ints : int64 ndarray
        Header and integers.
    floats : float64 ndarray
        Robot and obstacles as they are.
    lanes : int64 ndarray
        For the lanes, in one piece: the integers, and behind them, as float32, robot and obstacles with larger radii,
        so that rounding never makes a verdict optimistic.
    margin : float
        A capsule and an obstacle nearer to each other than this may touch by `lanes` [m].
    kept : int64 ndarray
        Numbers of the obstacles that the robot can reach, in the order of the tables.
    fixed_contact : tuple of 2 int, or None
        A capsule that does not move and an obstacle, of all, that it touches.
    """

    ints: Ints
    floats: Floats
    lanes: Ints
    margin: float
    kept: Ints
    fixed_contact: tuple[int, int] | None


def arm_tables(robot: RobotTables, obstacles: Floats, tested: Bools) -> tuple[ArmTables, int, int]:
    """Return a robot's tables with those of obstacles, as `obstacle_rows` gives them, behind them.

    `tested` says which capsules are tested against which obstacles, (capsules, n).  The numbers are the address of
    `lanes`, and the first obstacle that is too far or too large for single precision, or -1.
    """
    ints, floats, lanes, added, kept, capsule, obstacle, index, too_far = _pack(
        robot.ints, robot.floats, robot.singles, robot.reach, obstacles, tested
    )
    for array in (ints, floats, lanes, kept):
        array.setflags(write=False)
    # Once for what is added, once more for what rounding may add to that.
    margin = 2.0 * (PADDING * max(1.0, robot.reach) + added)
    contact = None if capsule < 0 else (capsule, obstacle)
    return ArmTables(ints, floats, lanes, margin, kept, contact), index, too_far


@njit(cache=True, nogil=True, no_cfunc_wrapper=True, error_model="numpy")
def _pack(
    robot_ints: Ints,
    robot_floats: Floats,
    robot_singles: npt.NDArray[np.float32],
    reach: float,
    obstacles: Floats,
    tested: Bools,
) -> tuple[Ints, Floats, Ints, float, Ints, int, int, int, int]:
    """Return what `arm_tables` does, and by how much the lanes' obstacles are larger at most [m]."""
    # Rows of all obstacles, of which those that the robot can reach are kept.
    kept, forms = np.empty((2, len(obstacles)), dtype=np.int64)
    rows = np.empty((len(obstacles), at.OBSTACLE_FLOAT_ROW))
    count, too_far = _write_reached(obstacles, reach, kept, forms, rows)
    blocks = (count + at.LANES - 1) // at.LANES
    capsules = robot_ints[at.CAPSULES]
    first_int, first_float = len(robot_ints), len(robot_floats)
    block_floats = first_float + at.OBSTACLE_FLOAT_ROW * count
    length = first_int + count + capsules * blocks
    floats = np.empty(block_floats + at.BLOCK_FLOAT_ROW * blocks)
    lanes = np.zeros(length + (len(floats) + 1) // 2, dtype=np.int64)
    ints, singles = lanes[:length], lanes[length:].view(np.float32)
    for index in range(first_int):
        ints[index] = robot_ints[index]
    for index in range(first_float):
        floats[index], singles[index] = robot_floats[index], robot_singles[index]
    ints[at.OBSTACLES], ints[at.BLOCKS] = count, blocks
    ints[at.OBSTACLE_INTS], ints[at.TESTED] = first_int, first_int + count
    ints[at.OBSTACLE_FLOATS], ints[at.BLOCK_FLOATS] = first_float, block_floats
    ints[at.INTEGERS] = length
    added = 0.0
    for row in range(count):
        data = first_float + at.OBSTACLE_FLOAT_ROW * row
        ints[first_int + row] = forms[row]
        for entry in range(at.OBSTACLE_FLOAT_ROW):
            floats[data + entry] = singles[data + entry] = rows[row, entry]
        box = block_floats + row // at.LANES * at.BLOCK_FLOAT_ROW + row % at.LANES
        padding = _write_bounds(floats, data, box, ints[first_int + row])
        singles[data + 15] = floats[data + 15] + padding
        added = max(added, (floats[data + 15] + padding) - floats[data + 15])
        for axis in range(3):
            centre, half = box + axis * at.LANES, box + (3 + axis) * at.LANES
            singles[centre], singles[half] = floats[centre], floats[half] + padding
    for row in range(count, blocks * at.LANES):
        box = block_floats + row // at.LANES * at.BLOCK_FLOAT_ROW + row % at.LANES
        for axis in range(3):
            centre, half = box + axis * at.LANES, box + (3 + axis) * at.LANES
            floats[centre], floats[half] = 0.0, _NEVER_HIT
            singles[centre], singles[half] = 0.0, _NEVER_HIT
    for i in range(capsules):
        for row in range(count):
            if tested[i, kept[row]]:
                ints[first_int + count + i * blocks + row // at.LANES] |= 1 << (row % at.LANES)
    capsule, obstacle = _fixed_contact(ints, floats, kept, tested)
    return ints, floats, lanes, added, kept[:count], capsule, obstacle, lanes.ctypes.data, too_far


@quick
def _write_reached(obstacles: Floats, reach: float, kept: Ints, forms: Ints, rows: Floats) -> tuple[int, int]:
    """Write the obstacles in reach; return how many there are, and the first too far for single precision, or -1."""
    # Not a plain 0: numba compiles a function once more for a literal.
    count, first = 0, np.int64(0)
    too_far = -1
    for k in range(len(obstacles)):
        largest = 0.0
        for entry in range(1, obstacles.shape[1]):
            largest = max(largest, abs(obstacles[k, entry]))
        turned = obstacles[k, 0] != BOX or not _is_straight(obstacles[k, ROTATION:TRANSLATION])
        if largest > FARTHEST and turned and too_far < 0:
            too_far = k
        form = _write_obstacle(rows[count], obstacles[k], reach)
        far = reach + rows[count, 15]
        if squared_distance_to_obstacle(0.0, 0.0, 0.0, form, rows[count], first) <= far * far:
            kept[count], forms[count] = k, form
            count += 1
    return count, too_far


@quick
def _write_obstacle(row: Floats, obstacle: Floats, reach: float) -> int:
    """Write all points within a rounding of a box, or a cylinder, and return the kind that the kernels know.

    A box along the axes loses what lies far beyond `reach`, where the robot never comes: a floor of a hundred metres
    would else cost digits, of which single precision has seven.
    """
    kind, size = int(obstacle[0]), obstacle[SIZE:ROTATION]
    rotation, translation = obstacle[ROTATION:TRANSLATION], obstacle[TRANSLATION:]
    a, b, c, row[15] = 0.0, 0.0, 0.5 * size[1], 0.0
    if kind == BOX:
        a, b, c = 0.5 * size[0], 0.5 * size[1], 0.5 * size[2]
    elif kind == CYLINDER:
        a = b = size[0]
    else:
        row[15] = size[0]
    aligned = kind == SPHERE or (kind != CYLINDER and _is_straight(rotation))
    for axis in range(3):
        row[axis] = translation[axis]
        for entry in range(3):
            row[6 + 3 * axis + entry] = rotation[3 * axis + entry]
    row[3], row[4], row[5] = a, b, c
    if not aligned:
        return at.CYLINDER if kind == CYLINDER else at.ROTATED
    for axis in range(3):
        extent = abs(np.rint(rotation[3 * axis])) * a
        extent += abs(np.rint(rotation[3 * axis + 1])) * b
        extent += abs(np.rint(rotation[3 * axis + 2])) * c
        for entry in range(3):
            row[6 + 3 * axis + entry] = 1.0 if axis == entry else 0.0
        row[3 + axis] = extent if kind != SPHERE else 0.0
        if kind == BOX:
            low = max(translation[axis] - extent, -2.0 * reach)
            high = min(translation[axis] + extent, 2.0 * reach)
            row[axis], row[3 + axis] = 0.5 * (low + high), 0.5 * (high - low)
    return at.ALIGNED


@quick
def _is_straight(rotation: Floats) -> bool:
    """Return whether a rotation (9,) takes axes to axes, up to the rounding of sines of right angles."""
    # Loops here and elsewhere in place of array expressions: those take seconds to compile.
    farthest = 0.0
    for entry in range(9):
        farthest = max(farthest, abs(rotation[entry] - np.rint(rotation[entry])))
    return farthest < 1e-14


@quick
def _write_bounds(floats: Floats, data: int, box: int, kind: int) -> float:
    """Write the box around an obstacle whose row is at `data`, and return its padding in single precision [m]."""
    squared = 0.0
    for axis in range(3):
        extent = 0.0
        if kind == at.CYLINDER:
            upright = abs(floats[data + 6 + 3 * axis + 2])
            extent = upright * floats[data + 5] + math.sqrt(max(1.0 - upright**2, 0.0)) * floats[data + 3]
        else:
            for entry in range(3):
                extent += abs(floats[data + 6 + 3 * axis + entry]) * floats[data + 3 + entry]
            extent += floats[data + 15]
        floats[box + axis * at.LANES] = floats[data + axis]
        floats[box + (3 + axis) * at.LANES] = extent
        squared += (abs(floats[data + axis]) + extent) ** 2
    return OBSTACLE_PADDING * math.sqrt(squared)


@quick
def _fixed_contact(ints: Ints, floats: Floats, kept: Ints, tested: Bools) -> tuple[int, int]:
    """Return a capsule that does not move and an obstacle that a sphere of it touches, or -1, -1."""
    for i in range(ints[at.FIXED_CAPSULES]):
        row = ints[at.CAPSULE_INTS] + at.CAPSULE_INT_ROW * i
        data = ints[at.CAPSULE_FLOATS] + at.CAPSULE_FLOAT_ROW * i
        for k in range(ints[at.OBSTACLES]):
            if not tested[i, kept[k]]:
                continue
            form, index = (
                ints[ints[at.OBSTACLE_INTS] + k],
                ints[at.OBSTACLE_FLOATS] + at.OBSTACLE_FLOAT_ROW * k,
            )
            near = floats[data + 6] + floats[index + 15]
            for sample in range(ints[row + 1], ints[row + 2]):
                along = floats[ints[at.SAMPLES] + sample]
                x = floats[data] + along * floats[data + 3]
                y = floats[data + 1] + along * floats[data + 4]
                z = floats[data + 2] + along * floats[data + 5]
                if squared_distance_to_obstacle(x, y, z, form, floats, index) < near * near:
                    return i, kept[k]
    return -1, -1
