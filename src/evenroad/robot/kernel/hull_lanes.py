"""Which of sixteen placed configurations have two bodies of convex hulls in touch.

Boxes and planes in single precision rule out nearly all pairs of hulls, for all lanes at once and by more than rounding
can be; of what is left `hull_contact` decides, lane by lane in double precision.  So the answer for a lane does not
depend on its neighbours.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
from numba import types
from numba.extending import intrinsic

from evenroad._njit import cfunc
from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.addresses import ANY_LENGTH, doubles_at, integers_at, room_for, singles_at
from evenroad.robot.kernel.hull_contact import DEEPEST, leaves_near, write_relative
from evenroad.robot.kernel.lanes import (
    LANES_TYPE,
    ONE,
    ZERO,
    absolute,
    below_zero,
    dot,
    larger,
    load_vector,
    lowest_bit,
    minus,
    plus,
    row,
    smaller,
    spread,
    square_root,
    store_vector,
    times,
)
from evenroad.robot.kernel.layout import LANES, inlined, inner

PLANES = 12
"""So many planes are tried for each two hulls before they are left to double precision."""
_SLACK = np.float32(2e-6)
"""By how much, of the lengths that they come of, single precision may have distances wrong: thirty roundings."""
_FAR = np.float32(1e30)
_LEAST = np.float32(at.LEAST_SQUARE)

Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]


@cache
def meeting_address() -> int:
    """Return the address, good for this process, of `bodies_meeting`; compiled when first asked.

    Few robots have hulls: those without do not wait for this to be compiled.
    """
    kind = types.int64(*[types.int64] * 3, types.float64, *[types.int64] * 3)
    return int(cfunc(kind, cache=True, error_model="numpy", _nrt=False)(_meeting).address)


def _meeting(scratch: int, asked: int, enough: int, margin: float, pair: int, ints: int, table: int) -> int:
    places, floats = singles_at(scratch, (ANY_LENGTH,)), singles_at(table, (ANY_LENGTH,))
    return bodies_meeting(places, asked, enough, margin, pair, integers_at(ints, (ANY_LENGTH,)), floats)


@inner
def bodies_meeting(
    places: Singles, asked: int, enough: int, margin: float, pair: int, ints: Ints, table: Singles
) -> int:
    """Return the mask of those lanes asked for in which hulls of a pair of bodies come within a margin.

    `enough` is 1 to stop at the first, 16 to find all.
    """
    of_pair = ints[at.BODY_PAIR_INTS] + at.BODY_PAIR_INT_ROW * pair
    a, b = row(ints, of_pair, 2)
    frame, _, _, first = row(ints, ints[at.BODY_INTS] + at.BODY_INT_ROW * a, 4)
    other_frame, _, _, second = row(ints, ints[at.BODY_INTS] + at.BODY_INT_ROW * b, 4)
    frame, other_frame = at.FRAME * frame, at.FRAME * other_frame
    pose = singles_at((room_for(104) + 63) // 64 * 64, (at.FRAME,))
    size = _reach(first, ints, table) + _reach(second, ints, table)
    near = spread(np.float32(margin)) + _write_relative(places, frame, other_frame, size, pose)
    waiting, lanes = integers_at(room_for(DEEPEST), (DEEPEST,)), integers_at(room_for(DEEPEST), (DEEPEST,))
    relative = doubles_at(room_for(12), (12,))
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
                write_relative(places, frame + lane, other_frame + lane, LANES, relative)
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
def _write_relative(places: Singles, a: int, b: int, size: Any, pose: Singles) -> Any:
    """Write the poses of one frame in another, and return by how much distances may be wrong for it.

    `size` is how far both bodies reach from their frames' origins.
    """
    px, py, pz = load_vector(places, a)
    qx, qy, qz = load_vector(places, a + 3 * LANES)
    rx, ry, rz = load_vector(places, a + 6 * LANES)
    apart = minus(load_vector(places, b + 9 * LANES), load_vector(places, a + 9 * LANES))
    p, q, r = load_vector(places, b), load_vector(places, b + 3 * LANES), load_vector(places, b + 6 * LANES)
    x, y, z = (px, qx, rx), (py, qy, ry), (pz, qz, rz)
    store_vector(pose, 0, plus(plus(times(p, px), times(q, qx)), times(r, rx)))
    store_vector(pose, 3 * LANES, plus(plus(times(p, py), times(q, qy)), times(r, ry)))
    store_vector(pose, 6 * LANES, plus(plus(times(p, pz), times(q, qz)), times(r, rz)))
    store_vector(pose, 9 * LANES, (dot(x, apart), dot(y, apart), dot(z, apart)))
    x, y, z = absolute(apart)
    return (x + y + z + size) * _SLACK


@inlined
def _boxes_near(pose: Singles, ball: int, other: int, near: Any, table: Singles) -> int:
    """Return the mask of lanes in which no side of two boxes separates them."""
    x, y, z, e, f, g = row(table, ball, 6)
    u, v, w, h, k, m = row(table, other, 6)
    a, b = load_vector(pose, 0), load_vector(pose, 3 * LANES)
    c, t = load_vector(pose, 6 * LANES), load_vector(pose, 9 * LANES)
    there, half, next_half = (u, v, w), (e, f, g), (h, k, m)
    i, j, n = minus(minus((x, y, z), t), (dot(a, there), dot(b, there), dot(c, there)))
    way = i, j, n
    a_size, b_size, c_size = absolute(a), absolute(b), absolute(c)
    x, y, z = minus(minus(absolute(way), half), (dot(a_size, next_half), dot(b_size, next_half), dot(c_size, next_half)))
    u, v, w = minus(absolute(plus(plus(times(a, i), times(b, j)), times(c, n))), next_half)
    more = plus(plus(times(a_size, spread(e)), times(b_size, spread(f))), times(c_size, spread(g)))
    u, v, w = minus((u, v, w), more)
    return below_zero(larger(larger(larger(x, y), larger(z, u)), larger(v, w)) - near)


@inlined
def _not_apart(pose: Singles, a: int, b: int, near: Any, asked: int, ints: Ints, table: Singles) -> int:
    """Return the mask of those lanes asked for in which none of some planes separates two hulls."""
    ball, other = ints[at.NODE_FLOATS] + at.NODE_FLOAT_ROW * a, ints[at.NODE_FLOATS] + at.NODE_FLOAT_ROW * b
    x, y, z, _, _, _, _, wide = row(table, ball, 8)
    u, v, w, _, _, _, _, other_wide = row(table, other, 8)
    _, _, p, p_end = row(ints, ints[at.NODE_INTS] + at.NODE_INT_ROW * a, 4)
    _, _, q, q_end = row(ints, ints[at.NODE_INTS] + at.NODE_INT_ROW * b, 4)
    near = near + (wide + other_wide)
    first, second = load_vector(pose, 0), load_vector(pose, 3 * LANES)
    third, shift = load_vector(pose, 6 * LANES), load_vector(pose, 9 * LANES)
    there = u, v, w
    way = minus(minus((x, y, z), shift), (dot(first, there), dot(second, there), dot(third, there)))
    _, _, _, e, f, g = row(table, ball, 6)
    half = row(table, other + 3, 3)
    i, j, n = way
    x, y, z = dot(absolute(first), half) + e, dot(absolute(second), half) + f, dot(absolute(third), half) + g
    i, j, n = i / x, j / y, n / z
    way = i * i * i / x, j * j * j / y, n * n * n / z
    last, touching = way, 0
    for step in range(PLANES):
        i, j, n = times(way, spread(ONE) / square_root(larger(dot(way, way), _LEAST)))
        along = i, j, n
        least, most = spread(_FAR), spread(-_FAR)
        x, y, z = spread(ZERO), spread(ZERO), spread(ZERO)
        u, v, w = spread(ZERO), spread(ZERO), spread(ZERO)
        for corner in range(p, p_end):
            d, e, f = row(table, 3 * corner, 3)
            here = dot(along, (d, e, f))
            x, y, z = taken(here, least, spread(d), x), taken(here, least, spread(e), y), taken(here, least, spread(f), z)
            least = smaller(here, least)
        turned = plus(plus(times(first, i), times(second, j)), times(third, n))
        for corner in range(q, q_end):
            d, e, f = row(table, 3 * corner, 3)
            here = dot(turned, (d, e, f))
            u, v, w = taken(most, here, spread(d), u), taken(most, here, spread(e), v), taken(most, here, spread(f), w)
            most = larger(here, most)
        asked &= ~below_zero(near - (least - most - dot(along, shift)))
        if asked == 0:
            break
        there = u, v, w
        corner_way = minus(minus((x, y, z), shift), (dot(first, there), dot(second, there), dot(third, there)))
        # The first corner; then the nearest to the origin between what was the nearest so far and the last two corners.
        if step == 0:
            way = corner_way
        else:
            way = _nearest_of_three(way, last, corner_way)
        last = corner_way
        close = asked & below_zero(dot(way, way) - near * near)
        touching |= close
        asked &= ~close
        if asked == 0:
            break
    return asked | touching


@inlined
def _nearest_of_three(a: Any, b: Any, c: Any) -> Any:
    """Return points of triangles near the origin: the nearest of them all but for those between the first two."""
    first, second = _nearest_of_two(a, c), _nearest_of_two(b, c)
    x, y, z = first
    u, v, w = second
    d, e = dot(first, first), dot(second, second)
    x, y, z = taken(e, d, u, x), taken(e, d, v, y), taken(e, d, w, z)
    e, f = minus(b, a), minus(c, a)
    ee, ef, ff, ae, af = dot(e, e), dot(e, f), dot(f, f), dot(a, e), dot(a, f)
    one_by = spread(ONE) / larger(ee * ff - ef * ef, _LEAST)
    s, t = (af * ef - ae * ff) * one_by, (ae * ef - af * ee) * one_by
    inside = smaller(smaller(s, t), spread(ONE) - s - t)
    u, v, w = plus(a, plus(times(e, s), times(f, t)))
    zero = spread(ZERO)
    return taken(zero, inside, u, x), taken(zero, inside, v, y), taken(zero, inside, w, z)


@inlined
def _nearest_of_two(a: Any, b: Any) -> Any:
    """Return the points of segments that are nearest to the origin."""
    edge = minus(a, b)
    share = dot(a, edge) / larger(dot(edge, edge), _LEAST)
    return minus(a, times(edge, larger(smaller(share, ONE), ZERO)))


@intrinsic
def taken(typing_context: Any, a: Any, b: Any, first: Any, second: Any) -> Any:
    """Return the numbers of `first` where `a` is less than `b`, else those of `second`."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.select(builder.fcmp_ordered("<", *args[:2]), *args[2:])

    return LANES_TYPE(a, b, first, second), lower
