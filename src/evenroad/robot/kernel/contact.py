"""Contact of sixteen configurations with obstacles or themselves, as a mask: bit w stands for lane w.

Lanes that are known to be blocked are not looked at again; a test is left out only where no lane needs it,
and every test that may be left out is a little wider than the one that it saves.  So the answer for a lane
does not depend on its neighbours.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.addresses import call_at
from evenroad.robot.kernel.forward_kinematics import scratch_offsets
from evenroad.robot.kernel.lane_memory import column, load_vector, row, store_vector
from evenroad.robot.kernel.lanes import (
    ONE,
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
    square_root,
    times,
)
from evenroad.robot.kernel.layout import BOX, HALF, LANES, PLACED, inlined, inner

ALL = (1 << LANES) - 1
_LEAST = np.float32(at.LEAST_SQUARE)

Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]


@inner
def blocked_lanes(scratch: Singles, ints: Ints, table: Singles, enough: int, hulls: int) -> int:
    """Return the mask of the configurations placed in `scratch` that touch something.

    `enough` is 1 to stop at the first lane that is blocked, 16 to find all; at `hulls` is what decides pairs by hulls.
    """
    blocked = _meeting_obstacles(scratch, ints, table, enough)
    if ints[at.SURFACES] != 0 and not (blocked == ALL or (blocked != 0 and enough == 1)):
        blocked |= call_at(ints[at.SURFACE_CHECK], (scratch, ints, table, blocked, enough))
    if blocked == ALL or (blocked != 0 and enough == 1):
        return blocked
    return _meeting_themselves(scratch, ints, table, blocked, enough, hulls)


@inner
def _meeting_obstacles(scratch: Singles, ints: Ints, table: Singles, enough: int) -> int:
    """Return the mask of lanes in which a capsule meets an obstacle.

    Sixteen obstacles at once are tested against the box around all lanes of a body, if it has many capsules, and then
    of a capsule; those that are near one by one.
    """
    bodies, capsules = scratch_offsets(ints)
    blocks, blocked = ints[at.BLOCKS], 0
    # From the outermost bodies inwards: those meet obstacles most often.
    for body in range(ints[at.BODIES] - 1, ints[at.FIXED_BODIES] - 1, -1):
        _, first, end = row(ints, ints[at.BODY_INTS] + at.BODY_INT_ROW * body, 3)
        many = end - first > at.FEW
        for block in range(blocks):
            near_body = ALL
            if many:
                here = bodies + PLACED * body
                near = _near_obstacles(scratch, here, ZERO, block, block == 0, ints, table)
                near_body = 0
                while near != 0:
                    lane = lowest_bit(near)
                    near &= near - 1
                    if _near_one(scratch, here, ZERO, block, lane, ints, table) & ~blocked:
                        near_body |= 1 << lane
                if near_body == 0:
                    continue
            for i in range(end - 1, first - 1, -1):
                here = capsules + PLACED * i
                (near,) = row(ints, ints[at.TESTED] + i * blocks + block, 1)
                (radius,) = row(table, ints[at.CAPSULE_FLOATS] + at.CAPSULE_FLOAT_ROW * i + 6, 1)
                near &= near_body
                if not many or _more_than_two(near):
                    near &= _near_obstacles(scratch, here, radius, block, many or block == 0, ints, table)
                while near != 0:
                    lane = lowest_bit(near)
                    near &= near - 1
                    if _near_one(scratch, here, radius, block, lane, ints, table) & ~blocked:
                        blocked |= _meeting_one(scratch, here, i, radius, block * LANES + lane, ints, table)
                        if blocked == ALL or (blocked != 0 and enough == 1):
                            return blocked
    return blocked


@inlined
def _more_than_two(bits: int) -> bool:
    """Return whether more than two bits are set."""
    bits &= bits - 1
    return bits & (bits - 1) != 0


@inlined
def _near_obstacles(
    scratch: Singles, here: int, radius: Any, block: int, first: bool, ints: Ints, table: Singles
) -> int:
    """Return which of the sixteen obstacles of a block are near the box around a body or a capsule in all lanes.

    The first time the box is made, and kept where there are more blocks.
    """
    if first:
        extents = plus(absolute(load_vector(scratch, here + HALF)), radius)
        centre, half = box_of_lanes(load_vector(scratch, here), extents)
        if ints[at.BLOCKS] > 1:
            store_vector(scratch, here + BOX, centre)
            store_vector(scratch, here + BOX + HALF, half)
    else:
        centre, half = load_vector(scratch, here + BOX), load_vector(scratch, here + BOX + HALF)
    box = ints[at.BLOCK_FLOATS] + at.BLOCK_FLOAT_ROW * block
    apart = absolute(minus(load_vector(table, box), centre))
    x, y, z = minus(minus(apart, load_vector(table, box + HALF)), half)
    return below_zero(larger(larger(x, y), z))


@inlined
def _near_one(
    scratch: Singles, here: int, radius: Any, block: int, obstacle: int, ints: Ints, table: Singles
) -> int:
    """Return the mask of lanes in which the box around a body or a capsule meets that of an obstacle of a block."""
    box = ints[at.BLOCK_FLOATS] + at.BLOCK_FLOAT_ROW * block + obstacle
    x, y, z, a, b, c = column(table, box, 6)
    apart = absolute(minus(load_vector(scratch, here), (x, y, z)))
    extents = absolute(load_vector(scratch, here + HALF))
    x, y, z = minus(minus(apart, extents), (radius + a, radius + b, radius + c))
    return below_zero(larger(larger(x, y), z))


@inlined
def _meeting_one(
    scratch: Singles, here: int, capsule: int, radius: Any, obstacle: int, ints: Ints, table: Singles
) -> int:
    """Return the mask of lanes in which a sphere along a capsule reaches into an obstacle."""
    data = ints[at.OBSTACLE_FLOATS] + at.OBSTACLE_FLOAT_ROW * obstacle
    (kind,) = row(ints, ints[at.OBSTACLE_INTS] + obstacle, 1)
    x, y, z, width_x, width_y, width_z, a, b, c, d, e, f, g, h, i, rounding = row(table, data, 16)
    # Centre and half segment as the obstacle sees them.
    centre, half = minus(load_vector(scratch, here), (x, y, z)), load_vector(scratch, here + HALF)
    if kind != at.ALIGNED:
        centre = dot(centre, (a, d, g)), dot(centre, (b, e, h)), dot(centre, (c, f, i))
        half = dot(half, (a, d, g)), dot(half, (b, e, h)), dot(half, (c, f, i))
    reach = radius + rounding
    _, first, end = row(ints, ints[at.CAPSULE_INTS] + at.CAPSULE_INT_ROW * capsule, 3)
    meeting = 0
    for sample in range(first, end):
        (along,) = row(table, ints[at.SAMPLES] + sample, 1)
        x, y, z = plus(centre, times(half, along))
        z = larger(absolute(z) - width_z, ZERO)
        if kind == at.CYLINDER:
            aside = larger(square_root(x * x + y * y) - width_x, ZERO)
            squared = aside * aside + z * z
        else:
            x, y = larger(absolute(x) - width_x, ZERO), larger(absolute(y) - width_y, ZERO)
            squared = x * x + y * y + z * z
        meeting |= below_zero(squared - reach * reach)
    return meeting


@inner
def _meeting_themselves(
    scratch: Singles, ints: Ints, table: Singles, blocked: int, enough: int, hulls: int
) -> int:
    """Return `blocked` and the mask of lanes in which two bodies of a pair touch."""
    bodies, capsules = scratch_offsets(ints)
    by_hulls = ints[at.BODY_PAIRS] - ints[at.HULL_PAIRS]
    margins = ints[at.HULL_MARGINS] - by_hulls
    for p in range(ints[at.BODY_PAIRS]):
        a, b, begin, end = row(ints, ints[at.BODY_PAIR_INTS] + at.BODY_PAIR_INT_ROW * p, 4)
        (near,) = row(table, ints[at.BODY_PAIR_FLOATS] + p, 1)
        if _within(scratch, bodies + PLACED * a, bodies + PLACED * b, near) & ~blocked == 0:
            continue
        _, low, high = row(ints, ints[at.BODY_INTS] + at.BODY_INT_ROW * b, 3)
        undecided = 0
        # Pairs of one capsule of the first body with all of the other body follow each other.
        for first in range(begin, end, high - low):
            if high - low > at.FEW:
                # A ball that is far from the ball around the whole body is far from its capsules.
                (i,) = row(ints, ints[at.PAIR_INTS] + at.PAIR_INT_ROW * first, 1)
                x, y, z, radius = row(table, ints[at.CAPSULE_FLOATS] + at.CAPSULE_FLOAT_ROW * i + 3, 4)
                (other,) = row(table, ints[at.BODY_FLOATS] + at.BODY_FLOAT_ROW * b + 3, 1)
                if x == ZERO and y == ZERO and z == ZERO:
                    ball, body = capsules + PLACED * i, bodies + PLACED * b
                    if _within(scratch, ball, body, radius + other) & ~blocked == 0:
                        continue
            for pair in range(first, first + high - low):
                i, k = row(ints, ints[at.PAIR_INTS] + at.PAIR_INT_ROW * pair, 2)
                near, reach, one_by_ee, one_by_ff = row(
                    table, ints[at.PAIR_FLOATS] + at.PAIR_FLOAT_ROW * pair, 4
                )
                i, k = capsules + PLACED * i, capsules + PLACED * k
                in_touch = _within(scratch, i, k, near)
                if in_touch & ~blocked == 0:
                    continue
                if one_by_ee + one_by_ff > ZERO:
                    # Not both are balls.
                    in_touch = _touching(scratch, i, k, reach, one_by_ee, one_by_ff)
                if p >= by_hulls:
                    undecided |= in_touch
                    continue
                blocked |= in_touch
                if blocked == ALL or (blocked != 0 and enough == 1):
                    return blocked
        undecided &= ~blocked
        if undecided != 0:
            margin = np.float64(table[margins + p])
            blocked |= call_at(hulls, (scratch, undecided, enough, margin, p, ints, table))
            if blocked == ALL or (blocked != 0 and enough == 1):
                return blocked
    return blocked


@inlined
def _within(scratch: Singles, a: int, b: int, near: Any) -> int:
    """Return the mask of lanes in which two centres are nearer to each other than `near`."""
    apart = minus(load_vector(scratch, a), load_vector(scratch, b))
    return below_zero(dot(apart, apart) - near * near)


@inlined
def _touching(scratch: Singles, a: int, b: int, reach: Any, one_by_ee: Any, one_by_ff: Any) -> int:
    """Return the mask of lanes in which two capsules touch whose segments are nearer to each other than `reach`.

    The steps are those of the double-precision ``scalar._squared_distance_of_pair``.
    """
    r = minus(load_vector(scratch, a), load_vector(scratch, b))
    e, f = load_vector(scratch, a + HALF), load_vector(scratch, b + HALF)
    ef, er, fr = dot(e, f), dot(e, r), dot(f, r)
    along_f, along_r = ef * one_by_ee, er * one_by_ee
    # What of f and r is across e.
    g, q = minus(f, times(e, along_f)), minus(r, times(e, along_r))
    t = _cut(dot(g, q) / larger(dot(g, g), _LEAST))
    s = _cut(along_f * t - along_r)
    t = _cut((ef * s + fr) * one_by_ff)
    apart = minus(plus(r, times(e, s)), times(f, t))
    return below_zero(dot(apart, apart) - reach * reach)


@inlined
def _cut(value: Any) -> Any:
    """Return `value` cut to [-1, 1]."""
    return larger(smaller(value, ONE), -ONE)
