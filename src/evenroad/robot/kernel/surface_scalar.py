"""Contact of one configuration with surfaces: the fallback of the lanes, and the reasons.

Rarely asked, so what is simple will do: leaves one after the other, and a line through all of a mesh for its inside.
"""

from __future__ import annotations

from ctypes import CFUNCTYPE, c_int64
from functools import lru_cache

import numpy as np
import numpy.typing as npt
from numba import types

from evenroad._njit import cfunc
from evenroad._shared import once
from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel import surface_tree as tree
from evenroad.robot.kernel.addresses import (
    ANY_LENGTH,
    address,
    bytes_at,
    doubles_at,
    integers_at,
    matrix_at,
    singles_at,
)
from evenroad.robot.kernel.layout import LANES, quick
from evenroad.robot.kernel.robot_tables import RobotTables
from evenroad.robot.kernel.scene_surfaces import CAPSULE_ROW, SURFACE_ROW, WORKSPACE, SceneSurfaces

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

_CHECK = CFUNCTYPE(c_int64, *[c_int64] * 5)


@lru_cache(maxsize=16)
def fixed_contact(surfaces: SceneSurfaces, robot: RobotTables) -> tuple[int, int] | None:
    """Return a capsule that does not move and an obstacle, a cloud or mesh, that it touches."""
    if not any(surfaces.tested[:, i].any() for i, each in enumerate(robot.capsules) if each.frame == 0):
        return None
    segments = np.array([[*capsule.centre, *capsule.half] for capsule in robot.capsules])
    check = scalar_check_address()
    ints = surfaces.added_to(robot.ints, check)
    no_margins = np.zeros(len(segments))
    found = _CHECK(check)(*map(address, (segments, no_margins, ints, robot.floats)), 1)
    return None if found < 0 else (found >> 32, found & 0xFFFFFFFF)


@once
def scalar_check_address() -> int:
    """Return the address, good for this process, of the check; compiled when first asked.

    It takes the addresses of places of capsules, (capsules, 6), of their margins, and of integers and floats of the
    tables; and whether capsules that do not move are tested, 1, or those that do, 0.  It returns ``capsule << 32 |
    obstacle`` of one that comes nearer to a surface than its margin, or -1.
    """
    kind = types.int64(*[types.int64] * 5)
    return int(cfunc(kind, cache=True, error_model="numpy", _nrt=False)(_first_meeting).address)


def _first_meeting(capsules: int, margins: int, ints: int, floats: int, fixed: int) -> int:
    integers, table = integers_at(ints, (ANY_LENGTH,)), doubles_at(floats, (ANY_LENGTH,))
    count, still = integers[at.CAPSULES], integers[at.FIXED_CAPSULES]
    segments, extra = matrix_at(capsules, (count, 6)), doubles_at(margins, (count,))
    workspace = integers_at(integers[at.SURFACES], (ANY_LENGTH,))
    of_capsules = singles_at(workspace[1], (ANY_LENGTH,))
    for number in range(workspace[0]):
        surface = WORKSPACE + SURFACE_ROW * number
        tested = integers_at(workspace[surface + 1], (ANY_LENGTH,))
        for i in range((still if fixed else count) - 1, (0 if fixed else still) - 1, -1):
            if tested[i] == 0:
                continue
            radius = table[integers[at.CAPSULE_FLOATS] + at.CAPSULE_FLOAT_ROW * i + 6]
            reach = radius - of_capsules[CAPSULE_ROW * i] + extra[i]
            if is_near(segments[i], reach, workspace[surface]):
                return i << 32 | workspace[surface + 2]
    return -1


@quick
def is_near(capsule: Floats, reach: float, base: int) -> bool:
    """Return whether a segment, centre and half of it, (6,), is within `reach` of a surface, or inside."""
    header = integers_at(base, (tree.HEADER,))
    table = singles_at(base + tree.BYTES_OF_HEADER, (ANY_LENGTH,))
    reach += table[tree.RADIUS]
    row = tree.TRIANGLE_ROW if header[tree.IS_MESH] != 0 else tree.POINT_ROW
    first = header[tree.FIRST_NODES]
    for node in range((first - tree.LEAVES) // (LANES * row)):
        for lane in range(LANES):
            child = first + tree.NODE_ROW * node + lane
            near = reach + table[child + 6 * LANES]
            if _squared(capsule, table, child) >= near * near:
                continue
            leaf = tree.LEAVES + row * (LANES * node + lane)
            for entry in range(LANES):
                if header[tree.IS_MESH] != 0:
                    if table[leaf + entry] < tree.NOWHERE and _triangle_near(capsule, reach, table, leaf + entry):
                        return True
                elif _squared(capsule, table, leaf + entry) < reach * reach:
                    return True
    return header[tree.WINDINGS] != 0 and _is_inside(capsule, base)


@quick
def _squared(capsule: Floats, table: Singles, base: int) -> float:
    """Return the squared distance of a segment from a point, whose coordinates are sixteen places apart [m^2]."""
    squared, along, length = 0.0, 0.0, 0.0
    for axis in range(3):
        apart = table[base + LANES * axis] - capsule[axis]
        squared += apart * apart
        along += apart * capsule[3 + axis]
        length += capsule[3 + axis] ** 2
    share = min(max(along / max(length, at.LEAST_SQUARE), -1.0), 1.0)
    return max(squared + share * (share * length - 2.0 * along), 0.0)


@quick
def _triangle_near(capsule: Floats, reach: float, table: Singles, base: int) -> bool:
    """Return whether a triangle is within `reach` of a segment; as ``mesh_contact.near_triangles`` finds it."""
    for side in range(3):
        if _squared_of_side(capsule, table, base, side) < reach * reach:
            return True
    middle, slope = 0.0, 0.0
    for axis in range(3):
        normal = table[base + LANES * (9 + axis)]
        middle += normal * (capsule[axis] - table[base + LANES * axis])
        slope += normal * capsule[3 + axis]
    share = min(max(-(middle * slope) / max(slope * slope, at.LEAST_SQUARE), -1.0), 1.0)
    if abs(middle + slope * share) >= reach:
        return False
    x, y, z = (
        capsule[0] + share * capsule[3],
        capsule[1] + share * capsule[4],
        capsule[2] + share * capsule[5],
    )
    return _is_above(x, y, z, table, base)


@quick
def _is_above(x: float, y: float, z: float, table: Singles, base: int) -> bool:
    """Return whether a place is above a triangle, on either side of it."""
    i, j, k = table[base + 9 * LANES], table[base + 10 * LANES], table[base + 11 * LANES]
    if i * i + j * j + k * k < 0.5:
        return False
    for side in range(3):
        u = x - _coordinate(table, base, side, 0)
        v = y - _coordinate(table, base, side, 1)
        w = z - _coordinate(table, base, side, 2)
        a = _coordinate(table, base, side + 1, 0) - _coordinate(table, base, side, 0)
        b = _coordinate(table, base, side + 1, 1) - _coordinate(table, base, side, 1)
        c = _coordinate(table, base, side + 1, 2) - _coordinate(table, base, side, 2)
        if i * (b * w - c * v) + j * (c * u - a * w) + k * (a * v - b * u) < 0.0:
            return False
    return True


@quick
def _coordinate(table: Singles, base: int, corner: int, axis: int) -> float:
    """Return a coordinate of a corner of a triangle; the fourth is the first."""
    own = np.float64(table[base + LANES * axis])
    if corner == 1 or corner == 2:
        own += table[base + LANES * (3 * corner + axis)]
    return own


@quick
def _squared_of_side(capsule: Floats, table: Singles, base: int, side: int) -> float:
    """Return the squared distance of a segment from a side of a triangle, see ``scalar._squared_distance_of_pair``."""
    ef, er, fr, ff, ee = 0.0, 0.0, 0.0, 0.0, 0.0
    for axis in range(3):
        start = _coordinate(table, base, side, axis)
        edge = _coordinate(table, base, side + 1, axis) - start
        start -= capsule[axis]
        along = capsule[3 + axis]
        ef, er, fr = ef + edge * along, er + start * along, fr + edge * start
        ff, ee = ff + edge * edge, ee + along * along
    one_by_ee = 1.0 / max(ee, at.LEAST_SQUARE)
    across, aside = 0.0, 0.0
    for axis in range(3):
        start = _coordinate(table, base, side, axis)
        edge = _coordinate(table, base, side + 1, axis) - start
        start -= capsule[axis]
        across_edge = edge - ef * one_by_ee * capsule[3 + axis]
        across += across_edge * across_edge
        aside += across_edge * (start - er * one_by_ee * capsule[3 + axis])
    share = min(max(-aside / max(across, at.LEAST_SQUARE), 0.0), 1.0)
    along = min(max((er + ef * share) * one_by_ee, -1.0), 1.0)
    share = min(max((ef * along - fr) / max(ff, at.LEAST_SQUARE), 0.0), 1.0)
    along = min(max((er + ef * share) * one_by_ee, -1.0), 1.0)
    squared = 0.0
    for axis in range(3):
        start = _coordinate(table, base, side, axis)
        edge = _coordinate(table, base, side + 1, axis) - start
        squared += (start - capsule[axis] + share * edge - along * capsule[3 + axis]) ** 2
    return squared


@quick
def _is_inside(capsule: Floats, base: int) -> bool:
    """Return whether the middle of a segment is inside of a mesh, as ``mesh_contact.is_inside`` finds it."""
    header = integers_at(base, (tree.HEADER,))
    table = singles_at(base + tree.BYTES_OF_HEADER, (ANY_LENGTH,))
    cell = 1.0 / table[tree.ONE_BY_CELL]
    number = 0
    for axis in range(3):
        along = capsule[axis] - table[tree.LOW + axis]
        if along < 0.0 or along > table[tree.SIZE + axis]:
            return False
        number = number * header[tree.CELLS_X + axis] + int(along / cell)
    if bytes_at(base + header[tree.GRID], (ANY_LENGTH,))[number] != 0:
        return False
    winding = np.int64(bytes_at(base + header[tree.WINDINGS], (ANY_LENGTH,))[number])
    winding -= 256 * (winding > 127)
    first = header[tree.FIRST_NODES]
    for leaf in range((first - tree.LEAVES) // tree.TRIANGLE_ROW):
        for entry in range(LANES):
            triangle = tree.LEAVES + tree.TRIANGLE_ROW * leaf + entry
            if table[triangle] >= tree.NOWHERE:
                continue
            before, after = 0.0, 0.0
            for axis in range(3):
                normal = table[triangle + LANES * (9 + axis)]
                low = table[tree.LOW + axis]
                middle = low + (int((capsule[axis] - low) / cell) + 0.5) * cell
                before += normal * (capsule[axis] - table[triangle + LANES * axis])
                after += normal * (middle - table[triangle + LANES * axis])
            if (before < 0.0) == (after < 0.0):
                continue
            share = before / (before - after)
            low_x, low_y, low_z = table[tree.LOW], table[tree.LOW + 1], table[tree.LOW + 2]
            x = low_x + (int((capsule[0] - low_x) / cell) + 0.5) * cell
            y = low_y + (int((capsule[1] - low_y) / cell) + 0.5) * cell
            z = low_z + (int((capsule[2] - low_z) / cell) + 0.5) * cell
            x, y, z = (
                capsule[0] + share * (x - capsule[0]),
                capsule[1] + share * (y - capsule[1]),
                capsule[2] + share * (z - capsule[2]),
            )
            if _is_above(x, y, z, table, triangle):
                winding -= 1 if before < 0.0 else -1
    return winding != 0 if header[tree.TURNED] != 0 else winding & 1 != 0
