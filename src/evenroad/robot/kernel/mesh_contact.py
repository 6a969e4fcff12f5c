"""Sixteen triangles at once against a segment, and whether a place is inside of a closed mesh."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel import surface_tree as tree
from evenroad.robot.kernel.addresses import ANY_LENGTH, bytes_at, integers_at, stack_memory
from evenroad.robot.kernel.lane_memory import column, load_vector, row
from evenroad.robot.kernel.lanes import (
    ONE,
    ZERO,
    absolute,
    below_zero,
    dot,
    larger,
    lowest_bit,
    minus,
    plus,
    smaller,
    times,
)
from evenroad.robot.kernel.layout import HALF, LANES, inlined, inner

Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

_LEAST = np.float32(at.LEAST_SQUARE)
_HALF = np.float32(0.5)
_UNSURE = np.float32(2e-6)
"""So near to a triangle's plane or side it is left open on which side of it a place is, in parts of a metre [m]."""


@inner
def near_nodes(header: Ints, cloud: Singles, level: int, node: int, capsule: Any, reach: Any) -> int:
    """Return which of a node's sixteen boxes meet that around a capsule, and with their balls the capsule itself.

    Of the capsule: its middle, half of its segment, half extents of its box, one over the squared half length.
    """
    centre, along, extents, one_by_squared = capsule
    first = header[tree.FIRST_NODES + level] + tree.NODE_ROW * node
    apart = minus(load_vector(cloud, first), centre)
    x, y, z = minus(minus(absolute(apart), load_vector(cloud, first + HALF)), extents)
    ball, _, _ = load_vector(cloud, first + 2 * HALF)
    near = ball + reach
    apart = minus(apart, times(along, nearest_parameter(apart, along, one_by_squared)))
    return below_zero(larger(larger(x, y), z)) & below_zero(dot(apart, apart) - near * near)


@inlined
def nearest_parameter(apart: Any, along: Any, one_by_squared: Any) -> Any:
    """Return where on a segment, from -1 to 1, the places `apart` from its middle are nearest."""
    return larger(smaller(dot(apart, along) * one_by_squared, ONE), -ONE)


@inner
def near_triangles(
    table: Singles, leaf: int, centre: Any, along: Any, one_by_squared: Any, reach: Any
) -> int:
    """Return which triangles of a leaf are within `reach` of a segment, given by its middle and half of it.

    Nearest are the segment and a side, or the place of the segment that is nearest to the plane, where it is above the
    triangle: from any other above it, one comes nearer on the way there, or to a side.
    """
    base = tree.LEAVES + tree.TRIANGLE_ROW * leaf
    corner = minus(load_vector(table, base), centre)
    first, second = load_vector(table, base + HALF), load_vector(table, base + 2 * HALF)
    normal, third = load_vector(table, base + 3 * HALF), minus(second, first)
    near = _near_side(corner, first, along, one_by_squared, reach)
    near |= _near_side(corner, second, along, one_by_squared, reach)
    near |= _near_side(plus(corner, first), third, along, one_by_squared, reach)
    slope, middle = dot(normal, along), ZERO - dot(normal, corner)
    share = _cut((ZERO - middle * slope) / larger(slope * slope, _LEAST))
    here = minus(times(along, share), corner)
    above = below_zero(absolute(middle + slope * share) - reach) & below_zero(_HALF - dot(normal, normal))
    return near | above & ~_outside(first, second, third, normal, here, ZERO)


@inner
def _outside(first: Any, second: Any, third: Any, normal: Any, here: Any, slack: Any) -> int:
    """Return for which triangles a place, seen from their corner, is not above them, by more than a slack [m^2]."""
    a, b = dot(_cross(first, here), normal), dot(_cross(here, second), normal)
    c = dot(_cross(third, minus(here, first)), normal)
    return below_zero(smaller(smaller(a, b), c) + slack)


@inner
def _near_side(start: Any, direction: Any, along: Any, one_by_squared: Any, reach: Any) -> int:
    """Return which sides are within `reach` of a segment, see ``scalar._squared_distance_of_pair``."""
    ef, er, fr, ff = (
        dot(direction, along),
        dot(start, along),
        dot(direction, start),
        dot(direction, direction),
    )
    across = minus(direction, times(along, ef * one_by_squared))
    aside = minus(start, times(along, er * one_by_squared))
    share = _part((ZERO - dot(across, aside)) / larger(dot(across, across), _LEAST))
    base = _cut((er + ef * share) * one_by_squared)
    share = _part((ef * base - fr) / larger(ff, _LEAST))
    base = _cut((er + ef * share) * one_by_squared)
    apart = minus(plus(start, times(direction, share)), times(along, base))
    return below_zero(dot(apart, apart) - reach * reach)


@inlined
def _cross(a: Any, b: Any) -> Any:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def _cut(base: Any) -> Any:
    return larger(smaller(base, ONE), -ONE)


@inlined
def _part(share: Any) -> Any:
    return larger(smaller(share, ONE), ZERO)


@inner
def is_inside(scratch: Singles, here: int, base: int, table: Singles) -> bool:
    """Return whether the middle of a capsule that touches no triangle is inside of a closed mesh, in one lane.

    How often the mesh winds around it is known for the middle of its cell, and changes where the way there crosses a
    triangle.  Where a crossing is too near to a side to tell, it counts as inside.
    """
    header = integers_at(base, (tree.HEADER,))
    x, y, z = column(scratch, here, 3)
    low_x, low_y, low_z, one_by_cell, width, depth, height = row(table, tree.LOW, 7)
    u, v, w = x - low_x, y - low_y, z - low_z
    if min(u, v, w) < ZERO or u > width or v > depth or w > height:
        return False
    i, j, k = int(u * one_by_cell), int(v * one_by_cell), int(w * one_by_cell)
    number = (i * header[tree.CELLS_Y] + j) * header[tree.CELLS_Z] + k
    if bytes_at(base + header[tree.GRID], (ANY_LENGTH,))[number] != 0:
        return False
    winding = np.int64(bytes_at(base + header[tree.WINDINGS], (ANY_LENGTH,))[number])
    winding -= 256 * (winding > 127)
    cell = ONE / one_by_cell
    a = _HALF * (low_x + (np.float32(i) + _HALF) * cell - x)
    b = _HALF * (low_y + (np.float32(j) + _HALF) * cell - y)
    c = _HALF * (low_z + (np.float32(k) + _HALF) * cell - z)
    centre, along = (x + a, y + b, z + c), (a, b, c)
    extents = abs(a) + _UNSURE, abs(b) + _UNSURE, abs(c) + _UNSURE
    one_by_squared = ONE / max(a * a + b * b + c * c, _LEAST)
    waiting = integers_at(stack_memory(32), (32,))
    top = header[tree.LEVELS] - 1
    level, node = top, 0
    near = near_nodes(header, table, level, node, (centre, along, extents, one_by_squared), _UNSURE)
    while True:
        if near == 0:
            if level == top:
                break
            level += 1
            near, node = waiting[2 * level], waiting[2 * level + 1]
            continue
        child = LANES * node + lowest_bit(near)
        near &= near - 1
        if level == 0:
            crossed = _crossings(table, child, (x, y, z), along)
            if crossed == _OPEN:
                return True
            winding -= crossed
            continue
        waiting[2 * level], waiting[2 * level + 1] = near, node
        level -= 1
        node = child
        near = near_nodes(header, table, level, node, (centre, along, extents, one_by_squared), _UNSURE)
    return winding != 0 if header[tree.TURNED] != 0 else winding & 1 != 0


_OPEN = 1 << 20


@inlined
def _crossings(table: Singles, leaf: int, begin: Any, along: Any) -> int:
    """Return how many triangles of a leaf are crossed by a segment along their normals, less those against them.

    `begin` is where it begins, `along` half of it.  _OPEN where that cannot be told.
    """
    base = tree.LEAVES + tree.TRIANGLE_ROW * leaf
    corner = minus(load_vector(table, base), begin)
    first, second = load_vector(table, base + HALF), load_vector(table, base + 2 * HALF)
    normal, third = load_vector(table, base + 3 * HALF), minus(second, first)
    before = ZERO - dot(normal, corner)
    after = before + dot(normal, along) + dot(normal, along)
    apart = larger(smaller(before, after), ZERO - larger(before, after))
    share = before / (before - after + _LEAST)
    here = minus(times(plus(along, along), _part(share)), corner)
    sized = below_zero(_HALF - dot(normal, normal))
    maybe = ~_outside(first, second, third, normal, here, _UNSURE) & ~below_zero(_UNSURE - apart) & sized
    if maybe & ((1 << LANES) - 1) == 0:
        return 0
    surely = below_zero(apart + _UNSURE)
    surely &= ~_outside(first, second, third, normal, here, -_UNSURE)
    if maybe & ~surely & ((1 << LANES) - 1) != 0:
        return _OPEN
    with_normal = below_zero(before) & maybe
    crossed = 0
    for lane in range(LANES):
        crossed += (with_normal >> lane) & 1
        crossed -= (maybe & ~with_normal) >> lane & 1
    return crossed
