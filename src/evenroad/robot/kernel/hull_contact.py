"""Contact of two bodies of convex hulls: a tree of balls over the hulls of each, and GJK below.

Apart is only what a plane separates: its gap is computed from all corners, so no rounding, and no search that ends too
soon, calls bodies free that touch.  The search is that of E. Gilbert, D. Johnson and S. Keerthi (1988).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.addresses import doubles_at, integers_at, stack_memory
from evenroad.robot.kernel.layout import quick

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

APART = -1
_MOST_STEPS = 40
DEEPEST = 96
"""Pairs of nodes that may wait: at most the depths of both trees together."""
_SAME = 1e-9
"""Lengths that differ by less are one [m]."""


@quick
def hulls_meet(first: int, second: int, pose: Floats, margin: float, ints: Ints, table: Any) -> int:
    """Return two hulls of two bodies that come nearer than `margin`, as ``node << 32 | node``, or APART.

    `first` and `second` are the roots of their trees, numbers of nodes; `pose` is that of the second body in the
    frame of the first, (12,): rotation row by row, translation.
    """
    waiting, direction = integers_at(stack_memory(DEEPEST), (DEEPEST,)), doubles_at(stack_memory(3), (3,))
    waiting[0], count = first << 32 | second, 1
    while count > 0:
        count -= 1
        a, b = waiting[count] >> 32, waiting[count] & 0xFFFFFFFF
        ball, other = (
            ints[at.NODE_FLOATS] + at.NODE_FLOAT_ROW * a,
            ints[at.NODE_FLOATS] + at.NODE_FLOAT_ROW * b,
        )
        squared = _write_direction(ball, other, pose, direction, table)
        near, next_near = table[ball + 6] + margin, table[other + 6] + margin
        if squared > (near + table[other + 6]) ** 2:
            continue
        # The box of the one and the ball of the other.
        aside, next_aside = 0.0, 0.0
        for axis in range(3):
            turned = pose[axis] * direction[0] + pose[3 + axis] * direction[1] + pose[6 + axis] * direction[2]
            aside += max(abs(direction[axis]) - table[ball + 3 + axis], 0.0) ** 2
            next_aside += max(abs(turned) - table[other + 3 + axis], 0.0) ** 2
        if aside > next_near * next_near or next_aside > near * near:
            continue
        row, next_row = ints[at.NODE_INTS] + at.NODE_INT_ROW * a, ints[at.NODE_INTS] + at.NODE_INT_ROW * b
        if ints[row] < 0 and ints[next_row] < 0:
            if leaves_near(a, b, pose, margin, ints, table):
                return a << 32 | b
        elif ints[next_row] < 0 or (ints[row] >= 0 and table[ball + 6] >= table[other + 6]):
            for child in range(2):
                waiting[count] = ints[row + child] << 32 | b
                count += 1
        else:
            for child in range(2):
                waiting[count] = a << 32 | ints[next_row + child]
                count += 1
    return APART


@quick
def leaves_near(a: int, b: int, pose: Floats, margin: float, ints: Ints, table: Any) -> bool:
    """Return whether the hulls of two leaves come within a margin; the pose is that of the second body in the first."""
    ball, other = ints[at.NODE_FLOATS] + at.NODE_FLOAT_ROW * a, ints[at.NODE_FLOATS] + at.NODE_FLOAT_ROW * b
    direction = doubles_at(stack_memory(3), (3,))
    if _write_direction(ball, other, pose, direction, table) == 0.0:
        return True
    row, other_row = ints[at.NODE_INTS] + at.NODE_INT_ROW * a, ints[at.NODE_INTS] + at.NODE_INT_ROW * b
    return _hulls_near(row, other_row, direction, pose, table[ball + 7] + table[other + 7] + margin, ints, table)


@quick
def _write_direction(ball: int, other: int, pose: Floats, direction: Floats, table: Any) -> float:
    """Write the way from the middle of a node, whose row is at `other`, to that of another; return its square."""
    squared = 0.0
    for axis in range(3):
        direction[axis] = table[ball + axis] - pose[9 + axis]
        for entry in range(3):
            direction[axis] -= pose[3 * axis + entry] * table[other + entry]
        squared += direction[axis] * direction[axis]
    return squared


@quick
def _hulls_near(
    row: int, other_row: int, direction: Floats, pose: Floats, margin: float, ints: Ints, table: Any
) -> bool:
    """Return whether two hulls, nodes at these rows, come within `margin`; False only where a plane says so.

    `direction` is a direction from the second to the first, not of length 0, that the search begins with.
    """
    p, p_end, q, q_end = ints[row + 2], ints[row + 3], ints[other_row + 2], ints[other_row + 3]
    simplex, v = doubles_at(stack_memory(12), (12,)), doubles_at(stack_memory(3), (3,))
    corner, other, size = p, q, 0
    length = math.sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2])
    x, y, z = direction[0] / length, direction[1] / length, direction[2] / length
    for _ in range(_MOST_STEPS):
        least, most = np.inf, -np.inf
        for i in range(p, p_end):
            along = table[3 * i] * x + table[3 * i + 1] * y + table[3 * i + 2] * z
            if along < least:
                least, corner = along, i
        u = pose[0] * x + pose[3] * y + pose[6] * z
        w = pose[1] * x + pose[4] * y + pose[7] * z
        t = pose[2] * x + pose[5] * y + pose[8] * z
        for i in range(q, q_end):
            along = table[3 * i] * u + table[3 * i + 1] * w + table[3 * i + 2] * t
            if along > most:
                most, other = along, i
        gap = least - most - (pose[9] * x + pose[10] * y + pose[11] * z)
        if gap > margin:
            return False
        if size > 0 and length - gap < 1e-6 * length + _SAME:
            return True
        for axis in range(3):
            simplex[3 * size + axis] = _difference(corner, other, axis, pose, table)
        size = _nearest(simplex, size + 1, v)
        length = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
        if size == 0 or length <= max(margin, _SAME):
            return True
        x, y, z = v[0] / length, v[1] / length, v[2] / length
    return True


@quick
def _difference(i: int, k: int, axis: int, pose: Floats, table: Any) -> float:
    """Return a coordinate of a corner of the first body as seen from one of the second."""
    turned = (
        pose[3 * axis] * table[3 * k] + pose[3 * axis + 1] * table[3 * k + 1] + pose[3 * axis + 2] * table[3 * k + 2]
    )
    return table[3 * i + axis] - turned - pose[9 + axis]


@quick
def _nearest(simplex: Floats, size: int, v: Floats) -> int:
    """Write the point of a simplex nearest to the origin, keep the corners that it is between, return their number.

    0 where the origin is inside of four.  Else it is in a corner, an edge or a side; few enough to try them all.
    """
    if size == 4 and _is_inside(simplex):
        return 0
    weights, nearest_point = doubles_at(stack_memory(4), (4,)), doubles_at(stack_memory(3), (3,))
    kept, least = 0, np.inf
    for face in range(1, min(1 << size, 15)):
        if not _projects_into(simplex, face, weights):
            continue
        squared = 0.0
        for axis in range(3):
            nearest_point[axis] = 0.0
            for i in range(size):
                if (face >> i) & 1:
                    nearest_point[axis] += weights[i] * simplex[3 * i + axis]
            squared += nearest_point[axis] * nearest_point[axis]
        if squared < least:
            least, kept = squared, face
            for axis in range(3):
                v[axis] = nearest_point[axis]
    count = 0
    for i in range(size):
        if (kept >> i) & 1:
            for axis in range(3):
                simplex[3 * count + axis] = simplex[3 * i + axis]
            count += 1
    return count


@quick
def _projects_into(simplex: Floats, face: int, weights: Floats) -> bool:
    """Return whether the origin projects into a face, bits of its corners; write the corners' weights."""
    a, b, c = -1, -1, -1
    for i in range(4):
        if (face >> i) & 1:
            a, b, c = (i, -1, -1) if a < 0 else (a, i, -1) if b < 0 else (a, b, i)
    weights[a] = 1.0
    if b < 0:
        return True
    ee, ef, ff, ae, af = 0.0, 0.0, 0.0, 0.0, 0.0
    for axis in range(3):
        origin = simplex[3 * a + axis]
        e, f = simplex[3 * b + axis] - origin, simplex[3 * max(c, 0) + axis] - origin
        ee, ef, ff, ae, af = ee + e * e, ef + e * f, ff + f * f, ae - origin * e, af - origin * f
    if c < 0:
        if not 0.0 < ae < ee:
            return False
        weights[b] = ae / ee
        weights[a] = 1.0 - weights[b]
        return True
    determinant = ee * ff - ef * ef
    second, third = ae * ff - af * ef, af * ee - ae * ef
    if not (second > 0.0 and third > 0.0 and second + third < determinant):
        return False
    weights[b], weights[c] = second / determinant, third / determinant
    weights[a] = 1.0 - weights[b] - weights[c]
    return True


@quick
def _is_inside(simplex: Floats) -> bool:
    """Return whether the origin is inside of four corners: their weights in it, up to a factor, have one sign."""
    a, b = _determinant(simplex, 1, 2, 3), -_determinant(simplex, 0, 2, 3)
    c, d = _determinant(simplex, 0, 1, 3), -_determinant(simplex, 0, 1, 2)
    return min(a, b, c, d) > 0.0 or max(a, b, c, d) < 0.0


@quick
def _determinant(simplex: Floats, i: int, k: int, m: int) -> float:
    """Return six times the signed volume between the origin and three corners."""
    i, k, m = 3 * i, 3 * k, 3 * m
    x = simplex[k + 1] * simplex[m + 2] - simplex[k + 2] * simplex[m + 1]
    y = simplex[k + 2] * simplex[m] - simplex[k] * simplex[m + 2]
    z = simplex[k] * simplex[m + 1] - simplex[k + 1] * simplex[m]
    return simplex[i] * x + simplex[i + 1] * y + simplex[i + 2] * z
