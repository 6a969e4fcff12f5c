"""Contact of two bodies of convex hulls at sixteen configurations.

Boxes and planes in single precision rule out nearly all pairs of hulls, for all lanes at once and by more than rounding
can be; of what is left `hull_contact` decides, lane by lane in double precision.  So the answer for a lane does not
depend on its neighbours.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from evenroad._njit import cfunc
from evenroad._shared import once
from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.addresses import ANY_LENGTH, doubles_at, integers_at, singles_at, stack_memory
from evenroad.robot.kernel.hull_contact import DEEPEST, leaves_near, write_relative
from evenroad.robot.kernel.lane_memory import load_vector, row, store_vector
from evenroad.robot.kernel.lanes import (
    ONE,
    VECTOR_TYPE,
    ZERO,
    absolute,
    below_zero,
    dot,
    larger,
    lowest_bit,
    minus,
    plus,
    smaller,
    spread,
    square_root,
    times,
)
from evenroad.robot.kernel.layout import LANES, inlined, inner

PLANES = 12
"""So many planes are tried for each two hulls before they are left to double precision."""
_SLACK = np.float32(2e-6)
"""By how much, of the lengths that they come of, single precision may have distances wrong: thirty roundings."""
_FAR = np.float32(1e30)
_THIN, _FLAT = np.float32(1e-4), np.float32(1e-7)
"""Half extents of boxes [m], and squares of sines in triangles, are taken for at least that: so all stays finite."""
_LEAST = np.float32(at.LEAST_SQUARE)

Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]


@once
def meeting_address() -> int:
    """Return the address, good for this process, of `bodies_meeting`; compiled when first asked.

    Few robots have hulls: those without do not wait for this to be compiled.
    """
    kind = types.int64(*[types.int64] * 3, types.float64, *[types.int64] * 3)
    return int(cfunc(kind, cache=True, error_model="numpy", _nrt=False)(_meeting).address)


def _meeting(scratch: int, asked: int, enough: int, margin: float, pair: int, ints: int, table: int) -> int:
    poses, floats = singles_at(scratch, (ANY_LENGTH,)), singles_at(table, (ANY_LENGTH,))
    return bodies_meeting(poses, asked, enough, margin, pair, integers_at(ints, (ANY_LENGTH,)), floats)


@inner
def bodies_meeting(
    poses: Singles, asked: int, enough: int, margin: float, pair: int, ints: Ints, table: Singles
) -> int:
    """Return the mask of those lanes asked for in which hulls of a pair of bodies come within a margin.

    `enough` is 1 to stop at the first, 16 to find all.
    """
    of_pair = ints[at.BODY_PAIR_INTS] + at.BODY_PAIR_INT_ROW * pair
    a, b = row(ints, of_pair, 2)
    frame, _, _, first = row(ints, ints[at.BODY_INTS] + at.BODY_INT_ROW * a, 4)
    other_frame, _, _, second = row(ints, ints[at.BODY_INTS] + at.BODY_INT_ROW * b, 4)
    frame, other_frame = at.FRAME * frame, at.FRAME * other_frame
    pose = singles_at((stack_memory(104) + 63) // 64 * 64, (at.FRAME,))
    size = _reach(first, ints, table) + _reach(second, ints, table)
    near = spread(np.float32(margin)) + _write_relative(poses, frame, other_frame, size, pose)
    waiting, lanes = (
        integers_at(stack_memory(DEEPEST), (DEEPEST,)),
        integers_at(stack_memory(DEEPEST), (DEEPEST,)),
    )
    relative = doubles_at(stack_memory(12), (12,))
    waiting[0], lanes[0], count = first << 32 | second, asked, 1
    meeting = 0
    while count > 0:
        count -= 1
        a, b = waiting[count] >> 32, waiting[count] & 0xFFFFFFFF
        left = lanes[count] & ~meeting
        if left == 0:
            continue
        ball, other = (
            ints[at.NODE_FLOATS] + at.NODE_FLOAT_ROW * a,
            ints[at.NODE_FLOATS] + at.NODE_FLOAT_ROW * b,
        )
        left &= _boxes_near(pose, ball, other, near, table)
        if left == 0:
            continue
        child, after, _, _ = row(ints, ints[at.NODE_INTS] + at.NODE_INT_ROW * a, 4)
        next_child, next_after, _, _ = row(ints, ints[at.NODE_INTS] + at.NODE_INT_ROW * b, 4)
        if child < 0 and next_child < 0:
            left = _not_apart(pose, a, b, near, left, ints, table)
            while left != 0:
                lane = lowest_bit(left)
                left &= left - 1
                write_relative(poses, frame + lane, other_frame + lane, LANES, relative)
                if leaves_near(a, b, relative, margin, ints, table):
                    meeting |= 1 << lane
                    if enough == 1:
                        return meeting
        elif next_child < 0 or (child >= 0 and table[ball + 6] >= table[other + 6]):
            waiting[count], lanes[count] = child << 32 | b, left
            waiting[count + 1], lanes[count + 1] = after << 32 | b, left
            count += 2
        else:
            waiting[count], lanes[count] = a << 32 | next_child, left
            waiting[count + 1], lanes[count + 1] = a << 32 | next_after, left
            count += 2
    return meeting


@inlined
def _reach(root: int, ints: Ints, table: Singles) -> Any:
    """Return how far a body reaches from the origin of its frame, at most."""
    x, y, z, _, _, _, radius = row(table, ints[at.NODE_FLOATS] + at.NODE_FLOAT_ROW * root, 7)
    return abs(x) + abs(y) + abs(z) + radius


@inlined
def _write_relative(poses: Singles, a: int, b: int, size: Any, pose: Singles) -> Any:
    """Write the poses of one frame in another, and return by how much distances may be wrong for it.

    `size` is how far both bodies reach from their frames' origins.
    """
    px, py, pz = load_vector(poses, a)
    qx, qy, qz = load_vector(poses, a + 3 * LANES)
    rx, ry, rz = load_vector(poses, a + 6 * LANES)
    apart = minus(load_vector(poses, b + 9 * LANES), load_vector(poses, a + 9 * LANES))
    p, q, r = load_vector(poses, b), load_vector(poses, b + 3 * LANES), load_vector(poses, b + 6 * LANES)
    x, y, z = (px, qx, rx), (py, qy, ry), (pz, qz, rz)
    store_vector(pose, 0, plus(plus(times(p, px), times(q, qx)), times(r, rx)))
    store_vector(pose, 3 * LANES, plus(plus(times(p, py), times(q, qy)), times(r, ry)))
    store_vector(pose, 6 * LANES, plus(plus(times(p, pz), times(q, qz)), times(r, rz)))
    store_vector(pose, 9 * LANES, (dot(x, apart), dot(y, apart), dot(z, apart)))
    x, y, z = absolute(apart)
    return (x + y + z + size) * _SLACK


@inlined
def _boxes_near(pose: Singles, ball: int, other: int, near: Any, table: Singles) -> int:
    """Return the mask of lanes in which no side of the boxes of two nodes, rows of floats, separates them."""
    direction, turned, sizes, other_sizes = _boxes(pose, ball, other, table)
    x, y, z = minus(absolute(direction), sizes)
    u, v, w = minus(absolute(turned), other_sizes)
    return below_zero(larger(larger(larger(x, y), larger(z, u)), larger(v, w)) - near)


@inlined
def _boxes(pose: Singles, ball: int, other: int, table: Singles) -> Any:
    """Return the way from the middle of the second node's box to that of the first, as the first and as the second body
    sees it, and the half extents of both boxes together along the axes of the first and of the second.
    """
    x, y, z, e, f, g = row(table, ball, 6)
    u, v, w, h, k, m = row(table, other, 6)
    half, other_half = (e, f, g), (h, k, m)
    direction = minus((x, y, z), _seen(pose, (u, v, w)))
    a, b, c = load_vector(pose, 0), load_vector(pose, 3 * LANES), load_vector(pose, 6 * LANES)
    a_size, b_size, c_size = absolute(a), absolute(b), absolute(c)
    sizes = plus((dot(a_size, other_half), dot(b_size, other_half), dot(c_size, other_half)), half)
    across = plus(plus(times(a_size, spread(e)), times(b_size, spread(f))), times(c_size, spread(g)))
    return direction, _turned_back(pose, direction), sizes, plus(across, other_half)


@inlined
def _seen(pose: Singles, point: Any) -> Any:
    """Return a place in the second body's frame as the first sees it."""
    a, b, c = load_vector(pose, 0), load_vector(pose, 3 * LANES), load_vector(pose, 6 * LANES)
    return plus(load_vector(pose, 9 * LANES), (dot(a, point), dot(b, point), dot(c, point)))


@inlined
def _turned_back(pose: Singles, direction: Any) -> Any:
    """Return a direction in the first body's frame as the second sees it."""
    x, y, z = direction
    along = plus(times(load_vector(pose, 0), x), times(load_vector(pose, 3 * LANES), y))
    return plus(along, times(load_vector(pose, 6 * LANES), z))


@inlined
def _not_apart(pose: Singles, a: int, b: int, near: Any, asked: int, ints: Ints, table: Singles) -> int:
    """Return the mask of those lanes asked for in which none of some planes separates the hulls of two leaves."""
    ball, other = ints[at.NODE_FLOATS] + at.NODE_FLOAT_ROW * a, ints[at.NODE_FLOATS] + at.NODE_FLOAT_ROW * b
    (wide,) = row(table, ball + 7, 1)
    (other_wide,) = row(table, other + 7, 1)
    _, _, p, p_end = row(ints, ints[at.NODE_INTS] + at.NODE_INT_ROW * a, 4)
    _, _, q, q_end = row(ints, ints[at.NODE_INTS] + at.NODE_INT_ROW * b, 4)
    near = near + (wide + other_wide)
    (x, y, z), _, (u, v, w), _ = _boxes(pose, ball, other, table)
    # First across where the boxes are thin; no step leaves the range of single precision.
    u, v, w = larger(u, _THIN), larger(v, _THIN), larger(w, _THIN)
    x, y, z = x / u, y / v, z / w
    most = larger(larger(absolute(x), absolute(y)), larger(absolute(z), _LEAST))
    x, y, z = x / most, y / most, z / most
    direction = x * x * x / u, y * y * y / v, z * z * z / w
    last, meeting = direction, 0
    for step in range(PLANES):
        along = times(direction, spread(ONE) / square_root(larger(dot(direction, direction), _LEAST)))
        back, corner = _farthest(minus(ZERO, along), p, p_end, table)
        on, other_corner = _farthest(_turned_back(pose, along), q, q_end, table)
        asked &= ~below_zero(near + (back + on + dot(along, load_vector(pose, 9 * LANES))))
        if asked == 0:
            break
        # On from the way between these corners; then from what of the last two and the way so far is nearest to 0.
        corner = minus(corner, _seen(pose, other_corner))
        direction = corner if step == 0 else _nearest_of_three(direction, last, corner)
        last = corner
        touching = asked & below_zero(dot(direction, direction) - near * near)
        meeting |= touching
        asked &= ~touching
        if asked == 0:
            break
    return asked | meeting


@inlined
def _farthest(along: Any, begin: int, end: int, table: Singles) -> Any:
    """Return how far a hull reaches along directions, and its farthest corners."""
    most, corner = spread(-_FAR), (spread(ZERO), spread(ZERO), spread(ZERO))
    for i in range(begin, end):
        x, y, z = row(table, 3 * i, 3)
        here = dot(along, (x, y, z))
        corner = taken(most, here, (spread(x), spread(y), spread(z)), corner)
        most = larger(here, most)
    return most, corner


@inlined
def _nearest_of_three(a: Any, b: Any, c: Any) -> Any:
    """Return what of triangles is nearest to the origin, but for what is between the first two corners."""
    first, second = _nearest_of_two(a, c), _nearest_of_two(b, c)
    nearest = taken(dot(second, second), dot(first, first), second, first)
    e, f = minus(b, a), minus(c, a)
    ee, ef, ff, ae, af = dot(e, e), dot(e, f), dot(f, f), dot(a, e), dot(a, f)
    one_by = spread(ONE) / larger(larger(ee * ff - ef * ef, ee * ff * _FLAT), _LEAST)
    s, t = (af * ef - ae * ff) * one_by, (ae * ef - af * ee) * one_by
    inside = smaller(smaller(s, t), ONE - s - t)
    return taken(spread(ZERO), inside, plus(a, plus(times(e, s), times(f, t))), nearest)


@inlined
def _nearest_of_two(a: Any, b: Any) -> Any:
    """Return the points of segments that are nearest to the origin."""
    edge = minus(a, b)
    share = dot(a, edge) / larger(dot(edge, edge), _LEAST)
    return minus(a, times(edge, larger(smaller(share, ONE), ZERO)))


@intrinsic
def taken(typing_context: Any, a: Any, b: Any, first: Any, second: Any) -> Any:
    """Return the vectors of `first` where `a` is less than `b`, else those of `second`."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        less = builder.fcmp_ordered("<", *args[:2])
        vectors = (cgutils.unpack_tuple(builder, vector) for vector in args[2:])
        axes = [builder.select(less, *axis) for axis in zip(*vectors, strict=True)]
        return context.make_tuple(builder, VECTOR_TYPE, axes)

    return VECTOR_TYPE(a, b, first, second), lower
