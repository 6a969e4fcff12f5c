"""Which of sixteen placed configurations touch an obstacle or themselves: bit w of a mask stands for lane w.

Lanes that are known to be blocked are not looked at again; a test is left out only where no lane needs it,
and every test that may be left out is a little wider than the one that it saves.  So the answer for a lane
does not depend on its neighbours.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.capsule_contact import meeting_one, touching
from evenroad.robot.kernel.forward_kinematics import (
    BODY,
    CAPSULE,
    FEW,
    place_frames,
    place_moving_bodies,
    place_moving_capsules,
    scratch_places,
)
from evenroad.robot.kernel.hull_contact import bodies_meet
from evenroad.robot.kernel.lanes import (
    ZERO,
    absolute,
    below_zero,
    larger,
    largest_lane,
    load,
    lowest_bit,
    smallest_lane,
)
from evenroad.robot.kernel.layout import inlined, inner

LANES = at.LANES
ALL = (1 << LANES) - 1
_HALF = np.float32(0.5)

Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]


@inner
def blocked_lanes(scratch: Singles, ints: Ints, table: Singles, enough: int) -> int:
    """Return the mask of the configurations, whose values are in `scratch`, that touch something.

    Parameters
    ----------
    scratch : float32 array
        As ``forward_kinematics.scratch_memory`` makes it, with the values of the frames in sixteen configurations.
    ints, table : arrays
        The tables.
    enough : int
        1 to stop at the first lane that is blocked, 16 to find all.
    """
    frames, capsules, bodies, _ = scratch_places(ints)
    place_frames(scratch, frames, ints, table)
    place_moving_capsules(scratch, frames, capsules, ints, table)
    place_moving_bodies(scratch, frames, bodies, ints, table)
    blocked = _meeting_obstacles(scratch, capsules, bodies, ints, table, enough)
    if blocked == ALL or (blocked != 0 and enough == 1):
        return blocked
    return _meeting_themselves(scratch, frames, capsules, bodies, ints, table, blocked, enough)


@inner
def _meeting_obstacles(
    scratch: Singles, capsules: int, bodies: int, ints: Ints, table: Singles, enough: int
) -> int:
    """Return the mask of lanes in which a capsule meets an obstacle.

    Sixteen obstacles at once are tested against the box around all lanes of a body, if it has many capsules, and then
    of a capsule; those that are near one by one.
    """
    blocks = ints[at.BLOCKS]
    blocked = 0
    # From the outermost bodies inwards: those meet obstacles most often.
    for body in range(ints[at.BODIES] - 1, ints[at.FIXED_BODIES] - 1, -1):
        row = ints[at.BODY_INTS] + at.BODY_INT_ROW * body
        first, last = ints[row + 1], ints[row + 2] - 1
        # Of many capsules, those of all are tested against sixteen obstacles that are near the body; of few, each
        # against all obstacles.
        many = last - first >= FEW
        around = ZERO, ZERO, ZERO, ZERO, ZERO, ZERO
        for group in range(blocks if many else last - first + 1):
            near_body = ALL
            if many:
                here = bodies + BODY * body
                if group == 0:
                    around = _box_around(scratch, here, 3 * LANES)
                near = _near_obstacles(around, group, ints, table)
                near_body = 0
                while near != 0:
                    lane = lowest_bit(near)
                    near &= near - 1
                    if _near_one(scratch, here, 3 * LANES, group, lane, ints, table) & ~blocked != 0:
                        near_body |= 1 << lane
                if near_body == 0:
                    continue
            else:
                around = _box_around(scratch, capsules + CAPSULE * (last - group), 6 * LANES)
            for item in range(last - first + 1 if many else blocks):
                i, block = (last - item, group) if many else (last - group, item)
                here = capsules + CAPSULE * i
                near = ints[ints[at.TESTED] + i * blocks + block]
                if not many:
                    near &= _near_obstacles(around, block, ints, table)
                else:
                    near &= near_body
                    if _more_than_two(near):
                        near &= _near_obstacles(_box_around(scratch, here, 6 * LANES), block, ints, table)
                while near != 0:
                    lane = lowest_bit(near)
                    near &= near - 1
                    if _near_one(scratch, here, 6 * LANES, block, lane, ints, table) & ~blocked != 0:
                        blocked |= meeting_one(scratch, here, i, block * LANES + lane, ints, table)
                        if blocked == ALL or (blocked != 0 and enough == 1):
                            return blocked
    return blocked


@inlined
def _near_one(
    scratch: Singles, here: int, extents: int, block: int, obstacle: int, ints: Ints, table: Singles
) -> int:
    """Return the mask of lanes in which the box around a body or a capsule meets that of an obstacle of a block."""
    box = ints[at.BLOCK_FLOATS] + at.BLOCK_FLOAT_ROW * block + obstacle
    gap_x = (
        absolute(load(scratch, here) - table[box]) - load(scratch, here + extents) - table[box + 3 * LANES]
    )
    gap_y = absolute(load(scratch, here + LANES) - table[box + LANES])
    gap_y = gap_y - load(scratch, here + extents + LANES) - table[box + 4 * LANES]
    gap_z = absolute(load(scratch, here + 2 * LANES) - table[box + 2 * LANES])
    gap_z = gap_z - load(scratch, here + extents + 2 * LANES) - table[box + 5 * LANES]
    return below_zero(larger(larger(gap_x, gap_y), gap_z))


@inlined
def _more_than_two(bits: int) -> bool:
    """Return whether more than two bits are set."""
    bits &= bits - 1
    return bits & (bits - 1) != 0


@inlined
def _box_around(scratch: Singles, here: int, extents: int) -> Any:
    """Return centre and half extents, six numbers, of the box around a body or a capsule in all lanes."""
    cx, cy, cz = load(scratch, here), load(scratch, here + LANES), load(scratch, here + 2 * LANES)
    ux = load(scratch, here + extents)
    uy = load(scratch, here + extents + LANES)
    uz = load(scratch, here + extents + 2 * LANES)
    low_x, high_x = smallest_lane(cx - ux), largest_lane(cx + ux)
    low_y, high_y = smallest_lane(cy - uy), largest_lane(cy + uy)
    low_z, high_z = smallest_lane(cz - uz), largest_lane(cz + uz)
    hx, hy, hz = _HALF * (high_x - low_x), _HALF * (high_y - low_y), _HALF * (high_z - low_z)
    return _HALF * (high_x + low_x), _HALF * (high_y + low_y), _HALF * (high_z + low_z), hx, hy, hz


@inlined
def _near_obstacles(around: Any, block: int, ints: Ints, table: Singles) -> int:
    """Return which of the sixteen obstacles of a block are near a box of `_box_around`."""
    mx, my, mz, hx, hy, hz = around
    box = ints[at.BLOCK_FLOATS] + at.BLOCK_FLOAT_ROW * block
    gap_x = absolute(load(table, box) - mx) - load(table, box + 3 * LANES) - hx
    gap_y = absolute(load(table, box + LANES) - my) - load(table, box + 4 * LANES) - hy
    gap_z = absolute(load(table, box + 2 * LANES) - mz) - load(table, box + 5 * LANES) - hz
    return below_zero(larger(larger(gap_x, gap_y), gap_z))


@inner
def _meeting_themselves(
    scratch: Singles,
    frames: int,
    capsules: int,
    bodies: int,
    ints: Ints,
    table: Singles,
    blocked: int,
    enough: int,
) -> int:
    """Return `blocked` and the mask of lanes in which two bodies of a pair touch."""
    by_hulls = ints[at.BODY_PAIRS] - ints[at.HULL_PAIRS]
    for p in range(ints[at.BODY_PAIRS]):
        row = ints[at.BODY_PAIR_INTS] + at.BODY_PAIR_INT_ROW * p
        a, b = bodies + BODY * ints[row], bodies + BODY * ints[row + 1]
        near = table[ints[at.BODY_PAIR_FLOATS] + p]
        x = load(scratch, a) - load(scratch, b)
        y = load(scratch, a + LANES) - load(scratch, b + LANES)
        z = load(scratch, a + 2 * LANES) - load(scratch, b + 2 * LANES)
        if below_zero(x * x + y * y + z * z - near * near) & ~blocked == 0:
            continue
        others = ints[at.BODY_INTS] + at.BODY_INT_ROW * ints[row + 1]
        count = ints[others + 2] - ints[others + 1]
        undecided = 0
        # Pairs of one capsule of the first body with all of the other body follow each other.
        for first in range(ints[row + 2], ints[row + 3], count):
            if count > FEW:
                i = ints[ints[at.PAIR_INTS] + at.PAIR_INT_ROW * first]
                if not _ball_near(scratch, capsules, i, bodies, ints[row + 1], ints, table, blocked):
                    continue
            for pair in range(first, first + count):
                # Here, and not in a function: of most pairs this is all.
                place = ints[at.PAIR_INTS] + at.PAIR_INT_ROW * pair
                data = ints[at.PAIR_FLOATS] + at.PAIR_FLOAT_ROW * pair
                a, b = capsules + CAPSULE * ints[place], capsules + CAPSULE * ints[place + 1]
                near = table[data]
                x = load(scratch, a) - load(scratch, b)
                y = load(scratch, a + LANES) - load(scratch, b + LANES)
                z = load(scratch, a + 2 * LANES) - load(scratch, b + 2 * LANES)
                in_touch = below_zero(x * x + y * y + z * z - near * near)
                if in_touch & ~blocked == 0:
                    continue
                if table[data + 2] + table[data + 3] > ZERO:
                    # Not both are balls.
                    in_touch = touching(scratch, a, b, data, table)
                if p >= by_hulls:
                    undecided |= in_touch
                    continue
                blocked |= in_touch
                if blocked == ALL or (blocked != 0 and enough == 1):
                    return blocked
        undecided &= ~blocked
        while undecided != 0:
            lane = lowest_bit(undecided)
            undecided &= undecided - 1
            if bodies_meet(scratch, frames, lane, p, ints, table):
                blocked |= 1 << lane
                if enough == 1:
                    return blocked
    return blocked


@inlined
def _ball_near(
    scratch: Singles, capsules: int, i: int, bodies: int, other: int, ints: Ints, table: Singles, blocked: int
) -> bool:
    """Return whether a capsule, if it is a ball, is near the ball around a body in a lane that is not blocked."""
    data = ints[at.CAPSULE_FLOATS] + at.CAPSULE_FLOAT_ROW * i
    if (
        table[data + 3] * table[data + 3]
        + table[data + 4] * table[data + 4]
        + table[data + 5] * table[data + 5]
        > ZERO
    ):
        return True
    a, b = capsules + CAPSULE * i, bodies + BODY * other
    near = table[data + 6] + table[ints[at.BODY_FLOATS] + at.BODY_FLOAT_ROW * other + 3]
    x = load(scratch, a) - load(scratch, b)
    y = load(scratch, a + LANES) - load(scratch, b + LANES)
    z = load(scratch, a + 2 * LANES) - load(scratch, b + 2 * LANES)
    return below_zero(x * x + y * y + z * z - near * near) & ~blocked != 0
