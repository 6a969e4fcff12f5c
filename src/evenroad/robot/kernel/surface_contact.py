"""Contact of sixteen configurations with points or meshes; capsules count as capsules, not as covering spheres.

A byte of a grid tells for most capsules, sixteen configurations at once, that nothing is near.  What is left is tested
one configuration after the other, against sixteen nodes, points or triangles of the tree at once.  Compiled when a
scene has a cloud or a mesh, and called by its address.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from evenroad._njit import cfunc
from evenroad._shared import once
from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel import surface_tree as tree
from evenroad.robot.kernel.addresses import ANY_LENGTH, integers_at, singles_at, stack_memory
from evenroad.robot.kernel.forward_kinematics import scratch_offsets
from evenroad.robot.kernel.lane_memory import column, load_vector, row
from evenroad.robot.kernel.lanes import (
    LANES_TYPE,
    ZERO,
    absolute,
    below_zero,
    box_of_lanes,
    dot,
    larger,
    lowest_bit,
    minus,
    plus,
    smaller,
    times,
)
from evenroad.robot.kernel.layout import HALF, LANES, PLACED, inlined, inner
from evenroad.robot.kernel.mesh_contact import is_inside, near_nodes, near_triangles, nearest_parameter
from evenroad.robot.kernel.scene_surfaces import CAPSULE_ROW, SURFACE_ROW, WORKSPACE

ALL = (1 << LANES) - 1
FEW = 2
"""Of capsules that at most so many spheres cover the grid is not asked as a whole: it would cost as much."""
_LARGEST_EXACT = np.float32(254.5)
_LEAST = np.float32(at.LEAST_SQUARE)

Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]


@once
def surface_check_address() -> int:
    """Return the address, good for this process, of the check against surfaces; compiled when first asked.

    It takes the addresses of scratch memory with sixteen placed configurations, of integers and floats of the tables,
    the mask of lanes that are known to be blocked, and `enough` as ``lane_check`` does; it returns the mask of those
    that touch a surface, or are inside of a closed one.
    """
    kind = types.int64(*[types.int64] * 5)
    return int(cfunc(kind, cache=True, error_model="numpy", _nrt=False)(_meeting_surfaces).address)


def _meeting_surfaces(scratch: int, ints: int, table: int, blocked: int, enough: int) -> int:
    return meeting_surfaces(
        singles_at(scratch, (ANY_LENGTH,)),
        integers_at(ints, (ANY_LENGTH,)),
        singles_at(table, (ANY_LENGTH,)),
        blocked,
        enough,
    )


@inner
def meeting_surfaces(scratch: Singles, ints: Ints, table: Singles, blocked: int, enough: int) -> int:
    """Return the mask of lanes, of those that are not blocked, in which a capsule touches a surface or is inside."""
    _, capsules = scratch_offsets(ints)
    workspace, meeting = integers_at(ints[at.SURFACES], (ANY_LENGTH,)), 0
    surfaces, of_capsules = workspace[0], singles_at(workspace[1], (ANY_LENGTH,))
    around, counts = workspace[2], integers_at(workspace[3], (ANY_LENGTH,))
    # From the outermost capsules inwards: those touch most often.
    for i in range(ints[at.CAPSULES] - 1, ints[at.FIXED_CAPSULES] - 1, -1):
        if counts[i] == 0:
            continue
        here, open_to = capsules + PLACED * i, ALL
        slack, half, one_by_squared = row(of_capsules, CAPSULE_ROW * i, 3)
        (covering,) = row(table, ints[at.CAPSULE_FLOATS] + at.CAPSULE_FLOAT_ROW * i + 6, 1)
        # First, for all of them, the grid around several.
        for number in range(-1 if around != 0 and counts[i] > 1 else 0, surfaces):
            base = workspace[WORKSPACE + SURFACE_ROW * number] if number >= 0 else around
            if (
                number >= 0
                and integers_at(workspace[WORKSPACE + SURFACE_ROW * number + 1], (ANY_LENGTH,))[i] == 0
            ):
                continue
            cloud = singles_at(base + tree.BYTES_OF_HEADER, (ANY_LENGTH,))
            windings = integers_at(base, (tree.HEADER,))[tree.WINDINGS]
            reach = covering - slack + cloud[tree.RADIUS]
            if surfaces > 1 and number >= 0 and _beside(scratch, here, half + reach, cloud) & open_to == 0:
                continue
            samples = row(ints, ints[at.CAPSULE_INTS] + at.CAPSULE_INT_ROW * i, 3)[1:]
            wide = covering + cloud[tree.RADIUS]
            lengths = half, wide, wide - slack
            near, sure = _near_and_touching(scratch, here, samples, lengths, base, cloud, ints, table)
            if number < 0:
                open_to = near & ~(blocked | meeting)
                if open_to == 0:
                    break
                continue
            near &= open_to & ~(blocked | meeting | sure)
            meeting |= sure & ~blocked
            if meeting != 0 and enough == 1:
                return meeting
            alone = near & (near - 1) == 0
            close = near != 0 and (alone or _reaches(scratch, here, reach, base, cloud))
            if not close and windings == 0:
                continue
            while near != 0:
                lane = lowest_bit(near)
                near &= near - 1
                if (close and _touches(scratch, here + lane, one_by_squared, reach, base, cloud)) or (
                    windings != 0 and is_inside(scratch, here + lane, base, cloud)
                ):
                    meeting |= 1 << lane
                    if enough == 1:
                        return meeting
        if blocked | meeting == ALL:
            return meeting
    return meeting


@inlined
def _near_and_touching(
    scratch: Singles,
    here: int,
    samples: tuple[int, int],
    lengths: tuple[Any, Any, Any],
    base: int,
    cloud: Singles,
    ints: Ints,
    table: Singles,
) -> tuple[int, int]:
    """Return the masks of lanes in which the grid leaves open whether a capsule touches, and in which it does for sure.

    It is asked about a long capsule as a whole first, then about the spheres that cover it, from a first sample to an
    end.  Lengths are the capsule's half, the radius of a sphere about which it is asked, and what is out of reach.
    """
    first, end = samples
    half, covering, reach = lengths
    centre, along = load_vector(scratch, here), load_vector(scratch, here + HALF)
    if end - first > FEW:
        near, _ = _asked(centre, half + reach, reach, base, cloud)
        if near == 0:
            return 0, 0
    near, sure = 0, 0
    for sample in range(first, end):
        (share,) = row(table, ints[at.SAMPLES] + sample, 1)
        near_here, sure_here = _asked(plus(centre, times(along, share)), covering, reach, base, cloud)
        near |= near_here
        sure |= sure_here
    return near, sure


@inner
def _asked(centre: Any, near: Any, touching: Any, base: int, cloud: Singles) -> tuple[int, int]:
    """Return the masks of lanes in which a point may be within `near` of a place, and is within `touching` for sure.

    Outside of the grid it is asked for the nearest place inside: what lies beyond that is farther by at least the third
    side of a triangle with an obtuse angle.
    """
    header = integers_at(base, (tree.HEADER,))
    x, y, z, one_by_cell, width, depth, height, step = row(cloud, tree.LOW, 8)
    u, v, w = minus(centre, (x, y, z))
    a, b, c = _cut(u, width), _cut(v, depth), _cut(w, height)
    u, v, w = u - a, v - b, w - c
    away = (
        bytes_of_cells(
            base + header[tree.GRID],
            a * one_by_cell,
            b * one_by_cell,
            c * one_by_cell,
            header[tree.CELLS_Y],
            header[tree.CELLS_Z],
        )
        * step
    )
    outside = u * u + v * v + w * w
    # Of the largest byte only a lower bound is known.
    sure = below_zero(larger(away + cloud[tree.EXCESS] - touching, away - step * _LARGEST_EXACT))
    sure &= below_zero(outside - _LEAST)
    return below_zero(outside + away * away - near * near), sure


@inner
def _beside(scratch: Singles, here: int, near: Any, cloud: Singles) -> int:
    """Return the mask of lanes in which a capsule's middle is within `near` of the box that a grid fills."""
    x, y, z, _, width, depth, height = row(cloud, tree.LOW, 7)
    u, v, w = minus(load_vector(scratch, here), (x, y, z))
    u, v, w = u - _cut(u, width), v - _cut(v, depth), w - _cut(w, height)
    return below_zero(u * u + v * v + w * w - near * near)


@inlined
def _cut(base: Any, most: Any) -> Any:
    return larger(smaller(base, most), ZERO)


@inner
def _reaches(scratch: Singles, here: int, reach: Any, base: int, cloud: Singles) -> bool:
    """Return whether the box around a capsule in all lanes meets that around a leaf."""
    header = integers_at(base, (tree.HEADER,))
    extents = plus(absolute(load_vector(scratch, here + HALF)), reach)
    centre, half = box_of_lanes(load_vector(scratch, here), extents)
    waiting = integers_at(stack_memory(32), (32,))
    top = header[tree.LEVELS] - 1
    level, node, fresh, inside = top, 0, True, 0
    while True:
        if fresh:
            first = header[tree.FIRST_NODES + level] + tree.NODE_ROW * node
            apart = absolute(minus(load_vector(cloud, first), centre))
            x, y, z = minus(minus(apart, load_vector(cloud, first + HALF)), half)
            inside = below_zero(larger(larger(x, y), z))
        if inside == 0:
            if level == top:
                return False
            level += 1
            inside, node, fresh = waiting[2 * level], waiting[2 * level + 1], False
            continue
        if level == 0:
            return True
        waiting[2 * level], waiting[2 * level + 1] = inside & (inside - 1), node
        node = LANES * node + lowest_bit(inside)
        level -= 1
        fresh = True


@inner
def _touches(scratch: Singles, here: int, one_by_squared: Any, reach: Any, base: int, cloud: Singles) -> bool:
    """Return whether a point or triangle is within `reach` of the segment of the capsule at a place, in one lane."""
    header = integers_at(base, (tree.HEADER,))
    x, y, z, i, j, k = column(scratch, here, 6)
    centre, along, extents = (x, y, z), (i, j, k), (abs(i) + reach, abs(j) + reach, abs(k) + reach)
    waiting = integers_at(stack_memory(32), (32,))
    top = header[tree.LEVELS] - 1
    level, node = top, 0
    inside = near_nodes(header, cloud, level, node, (centre, along, extents, one_by_squared), reach)
    while True:
        if inside == 0:
            if level == top:
                return False
            level += 1
            inside, node = waiting[2 * level], waiting[2 * level + 1]
            continue
        child = LANES * node + lowest_bit(inside)
        inside &= inside - 1
        if level == 0 and header[tree.IS_MESH] != 0:
            if near_triangles(cloud, child, centre, along, one_by_squared, reach) != 0:
                return True
            continue
        if level == 0:
            apart = minus(load_vector(cloud, tree.LEAVES + tree.POINT_ROW * child), centre)
            apart = minus(apart, times(along, nearest_parameter(apart, along, one_by_squared)))
            if below_zero(dot(apart, apart) - reach * reach) != 0:
                return True
            continue
        waiting[2 * level], waiting[2 * level + 1] = inside, node
        level -= 1
        node = child
        inside = near_nodes(header, cloud, level, node, (centre, along, extents, one_by_squared), reach)


@intrinsic
def bytes_of_cells(
    typing_context: Any, address: Any, x: Any, y: Any, z: Any, cells_y: Any, cells_z: Any
) -> Any:
    """Return the bytes of sixteen cells, whose numbers along three axes are given, all >= 0, and rounded down here."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        word, byte = ir.IntType(32), ir.IntType(8)
        words = ir.VectorType(word, LANES)
        cell_x, cell_y, cell_z = (builder.fptosi(arg, words) for arg in args[1:4])
        rows, cells = (
            builder.shuffle_vector(
                builder.insert_element(ir.Constant(words, ir.Undefined), builder.trunc(arg, word), word(0)),
                ir.Constant(words, ir.Undefined),
                ir.Constant(words, [0] * LANES),
            )
            for arg in args[4:]
        )
        number = builder.add(builder.mul(builder.add(builder.mul(cell_x, rows), cell_y), cells), cell_z)
        grid = builder.inttoptr(args[0], byte.as_pointer())
        found = ir.Constant(ir.VectorType(byte, LANES), ir.Undefined)
        for lane in range(LANES):
            base = builder.zext(builder.extract_element(number, word(lane)), ir.IntType(64))
            found = builder.insert_element(found, builder.load(builder.gep(grid, [base])), word(lane))
        return builder.uitofp(found, ir.VectorType(ir.FloatType(), LANES))

    return LANES_TYPE(types.int64, LANES_TYPE, LANES_TYPE, LANES_TYPE, types.int64, types.int64), lower
