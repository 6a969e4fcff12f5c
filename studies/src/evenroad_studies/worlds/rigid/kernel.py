"""Compiled checks of a body of boxes among boxes, for poses and for the states of motions."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from evenroad._arrays import Bools, Floats, Ints
from evenroad.space.so3 import SMALL_ANGLE
from evenroad_studies.worlds.bisection import next_between
from evenroad_studies.worlds.rigid.oriented_box import BoxTable, SolidTables

_ROUNDING = 4e-6
"""In a proof boxes are enlarged by this share of their points' ways more: quaternions are of norm 1 up to 1e-6."""


_PARALLEL = 1e-14
"""Squared sine below which two edges count as parallel: an axis across both would be rounding alone, and the
faces' axes separate boxes with such edges as well, but for gaps of 1e-7 of their size."""


@njit(cache=True, nogil=True)
def contacts(poses: Floats, solids: SolidTables) -> Ints:
    """Return for each pose, (n, 7), the first obstacle that the body meets, or -1."""
    found = np.empty(len(poses), dtype=np.int64)
    near = np.empty(len(solids.obstacles.centre), dtype=np.int64)
    work, farthest = np.empty((4, 3, 3)), solids.reaches.max()
    for row in range(len(poses)):
        count = _obstacles_near(poses[row], poses[row], farthest, solids.obstacles, near)
        found[row] = _first_contact(poses[row], solids.body, solids, near[:count], work)
    return found


@njit(cache=True, nogil=True)
def motions_are_free(a: Floats, b: Floats, step: float, rotation_step: float, solids: SolidTables) -> Bools:
    """Return which motions between poses, (m, 7), are free at both ends and at states between, in bisection order.

    Neighbouring states are at most `step` and, as quaternions, `rotation_step` radians apart.
    """
    free = np.empty(len(a), dtype=np.bool_)
    near = np.empty(len(solids.obstacles.centre), dtype=np.int64)
    state, work, farthest = np.empty(7), np.empty((4, 3, 3)), solids.reaches.max()
    for row in range(len(a)):
        # What is far from the whole motion is far from all of its states.
        count = _obstacles_near(a[row], b[row], farthest, solids.obstacles, near)
        free[row] = count == 0 or (
            _first_contact(a[row], solids.body, solids, near[:count], work) < 0
            and _first_contact(b[row], solids.body, solids, near[:count], work) < 0
            and _motion_is_free(a[row], b[row], step, rotation_step, solids, near[:count], state, work)
        )
    return free


@njit(cache=True, nogil=True)
def _motion_is_free(a, b, step, rotation_step, solids, near, state, work):  # type: ignore[no-untyped-def]
    length, angle = _length(a, b), _angle(a, b)
    segments = max(math.ceil(length / step), math.ceil(angle / rotation_step))
    level, multiple, number = next_between(1, -1, segments)
    while number > 0:
        # Two weights, not one fraction: a motion and its reverse then have the same states.
        _put_between(a, b, (segments - number) / segments, number / segments, angle, state)
        if _first_contact(state, solids.body, solids, near, work) >= 0:
            return False
        level, multiple, number = next_between(level, multiple, segments)
    return True


@njit(cache=True, nogil=True)
def motions_are_proved(a: Floats, b: Floats, tolerance: float, solids: SolidTables) -> Bools:
    """Return which motions between poses, (m, 7), are proved free, with no gap between states.

    If boxes enlarged on all sides by what half an interval moves their points meet nothing at its middle, the boxes
    meet nothing in the whole interval; else both halves are looked at, until an interval moves points by less than
    `tolerance`.
    """
    body, reaches = solids.body, solids.reaches
    proved = np.empty(len(a), dtype=np.bool_)
    near = np.empty(len(solids.obstacles.centre), dtype=np.int64)
    state, work = np.empty(7), np.empty((4, 3, 3))
    enlarged = BoxTable(body.centre, body.half.copy(), body.axes, body.low, body.high)
    farthest = reaches.max()
    for row in range(len(a)):
        count = _obstacles_near(a[row], b[row], farthest, solids.obstacles, near)
        if count == 0:
            proved[row] = True
            continue
        length, angle = _length(a[row], b[row]), _angle(a[row], b[row])
        most = length + 2.0 * angle * farthest
        # The interval numbered `number` of the 2^level equal ones; a proved one is followed by the next to its right.
        level, number = 0, 0
        proved[row] = True
        while number < 1 << level:
            share = 1.0 / (1 << level)
            at = (number + 0.5) * share
            _put_between(a[row], b[row], 1.0 - at, at, angle, state)
            for box in range(len(reaches)):
                moved = (0.5 + _ROUNDING) * share * (length + 2.0 * angle * reaches[box])
                for k in range(3):
                    enlarged.half[box, k] = body.half[box, k] + moved
            if _first_contact(state, enlarged, solids, near[:count], work) < 0:
                number += 1
                while level > 0 and number % 2 == 0:
                    level, number = level - 1, number // 2
            elif share * most < tolerance or _first_contact(state, body, solids, near[:count], work) >= 0:
                proved[row] = False
                break
            else:
                level, number = level + 1, 2 * number
    return proved


@njit(cache=True, nogil=True)
def _length(a, b):  # type: ignore[no-untyped-def]
    return math.sqrt((b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2 + (b[2] - a[2]) ** 2)


@njit(cache=True, nogil=True)
def _put_between(a, b, from_a, from_b, angle, state):  # type: ignore[no-untyped-def]
    """Write the pose with the weights `from_a` and `from_b`: straight, and by slerp (Shoemake 1985)."""
    for k in range(3):
        state[k] = from_a * a[k] + from_b * b[k]
    if angle >= SMALL_ANGLE:
        sine = math.sin(angle)
        from_a, from_b = math.sin(from_a * angle) / sine, math.sin(from_b * angle) / sine
    for k in range(3, 7):
        state[k] = from_a * a[k] + from_b * b[k]


@njit(cache=True, nogil=True)
def _angle(a, b):  # type: ignore[no-untyped-def]
    """Return the angle between the quaternions; unlike arccos it keeps all digits of small angles (Kahan)."""
    difference, together = 0.0, 0.0
    for k in range(3, 7):
        difference += (a[k] - b[k]) ** 2
        together += (a[k] + b[k]) ** 2
    return 2.0 * math.atan2(math.sqrt(difference), math.sqrt(together))


@njit(cache=True, nogil=True)
def _obstacles_near(a, b, reach, obstacles, near):  # type: ignore[no-untyped-def]
    """Write the obstacles that balls of radius `reach` on the motion from a to b might meet; return their number."""
    count = 0
    for i in range(len(obstacles.centre)):
        is_near = True
        for k in range(3):
            is_near &= obstacles.low[i, k] - reach <= max(a[k], b[k])
            is_near &= min(a[k], b[k]) <= obstacles.high[i, k] + reach
        if is_near:
            near[count] = i
            count += 1
    return count


@njit(cache=True, nogil=True)
def _first_contact(pose: Floats, body: BoxTable, solids: SolidTables, near: Ints, work: Floats) -> int:
    """Return the first obstacle among `near` that a box of the `body`, perhaps enlarged, meets at a pose, (7,), or -1.

    Boxes are closed: touching is meeting.  `work`, (4, 3, 3), is overwritten.
    """
    obstacles, planar = solids.obstacles, solids.planar
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
        own_reach = half[0] * abs(products[0, j]) + half[1] * abs(products[1, j]) + half[2] * abs(products[2, j])
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
    rotation[0, 0] = 1.0 - s * (y * y + z * z)
    rotation[0, 1] = s * (x * y - w * z)
    rotation[0, 2] = s * (x * z + w * y)
    rotation[1, 0] = s * (x * y + w * z)
    rotation[1, 1] = 1.0 - s * (x * x + z * z)
    rotation[1, 2] = s * (y * z - w * x)
    rotation[2, 0] = s * (x * z - w * y)
    rotation[2, 1] = s * (y * z + w * x)
    rotation[2, 2] = 1.0 - s * (x * x + y * y)
