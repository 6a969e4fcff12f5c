"""Damped least squares in compiled code: configurations that bring a tip to a pose."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from evenroad._njit import njit
from evenroad.robot.kernel.layout import quick

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

AXIS, DIRECTION, PLACED, TURNED, NEAR, TILT, GOAL = 12, 15, 18, 19, 20, 21, 22
"""Where a goal's parts begin after rotation (9) and place (3): the tip's axis (3) and where it is to point (3); whether
the place counts; what counts of the rotation (below); how far off they may be [m, rad]; a goal's length."""

NOT, BY_AXIS, ALL = range(3)
"""What counts of the rotation: nothing, where one axis points, all."""

EXACT = 1e-10
"""A configuration is as good as can be that is no farther off [m, rad]."""

_LONGEST = 0.8
"""No joint moves by more in a step [rad or m]."""
_LOOK = 8
"""After so many steps the error must have halved."""
_DAMPING = 0.03


@quick
def _place_tip(q: Floats, ints: Ints, rows: Floats, joints: Floats, tip: Floats) -> None:
    """Write axis and origin of each frame of a chain, (k, 6), and where the tip is: rotation, origin (12)."""
    for entry in range(12):
        tip[entry] = 1.0 if entry in (0, 4, 8) else 0.0
    for i in range(len(ints) + 1):
        value, sine, cosine, slide = 0.0, 0.0, 1.0, 0.0
        if i < len(ints):
            value = rows[i, 12] * q[ints[i, 0]] + rows[i, 13]
            if ints[i, 1]:
                slide = value
            else:
                sine, cosine = math.sin(value), math.cos(value)
        for axis in range(3):
            p0, p1, p2 = tip[3 * axis], tip[3 * axis + 1], tip[3 * axis + 2]
            x = p0 * rows[i, 0] + p1 * rows[i, 3] + p2 * rows[i, 6]
            y = p0 * rows[i, 1] + p1 * rows[i, 4] + p2 * rows[i, 7]
            z = p0 * rows[i, 2] + p1 * rows[i, 5] + p2 * rows[i, 8]
            moved = p0 * rows[i, 9] + p1 * rows[i, 10] + p2 * rows[i, 11]
            tip[3 * axis] = x * cosine + y * sine
            tip[3 * axis + 1] = y * cosine - x * sine
            tip[3 * axis + 2] = z
            tip[9 + axis] += moved + z * slide
            if i < len(ints):
                joints[i, axis], joints[i, 3 + axis] = z, tip[9 + axis]


@quick
def _error(tip: Floats, goal: Floats, error: Floats) -> None:
    """Write by how much the tip has to move and to turn, (6,), in the frame of the root."""
    for axis in range(6):
        error[axis] = 0.0
    if goal[PLACED] > 0.0:
        for axis in range(3):
            error[axis] = goal[9 + axis] - tip[9 + axis]
    if goal[TURNED] == BY_AXIS:
        ax = tip[0] * goal[AXIS] + tip[1] * goal[AXIS + 1] + tip[2] * goal[AXIS + 2]
        ay = tip[3] * goal[AXIS] + tip[4] * goal[AXIS + 1] + tip[5] * goal[AXIS + 2]
        az = tip[6] * goal[AXIS] + tip[7] * goal[AXIS + 1] + tip[8] * goal[AXIS + 2]
        bx, by, bz = goal[DIRECTION], goal[DIRECTION + 1], goal[DIRECTION + 2]
        x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        sine, cosine = math.sqrt(x * x + y * y + z * z), ax * bx + ay * by + az * bz
        if sine < 1e-12 and cosine < 0.0:
            # Opposite: any axis across will do.
            x, y, z = (0.0, az, -ay) if abs(ax) < 0.9 else (-az, 0.0, ax)
            sine = 1e-12
            length = math.sqrt(x * x + y * y + z * z)
            x, y, z = x * sine / length, y * sine / length, z * sine / length
        scale = math.atan2(sine, cosine) / sine if sine > 1e-12 else 1.0
        error[3], error[4], error[5] = x * scale, y * scale, z * scale
    elif goal[TURNED] == ALL:
        # Of goal times the tip's inverse: twice the axis times the sine, and one plus twice the cosine.
        x, y, z, trace = 0.0, 0.0, 0.0, 0.0
        for k in range(3):
            x += goal[6 + k] * tip[3 + k] - goal[3 + k] * tip[6 + k]
            y += goal[k] * tip[6 + k] - goal[6 + k] * tip[k]
            z += goal[3 + k] * tip[k] - goal[k] * tip[3 + k]
            trace += goal[k] * tip[k] + goal[3 + k] * tip[3 + k] + goal[6 + k] * tip[6 + k]
        sine = 0.5 * math.sqrt(x * x + y * y + z * z)
        angle = math.atan2(sine, 0.5 * (trace - 1.0))
        if sine > 1e-9:
            scale = 0.5 * angle / sine
        else:
            # Half a turn has no axis here: one is as good as another, and the next step will see it.
            scale = 0.5
            x += 2.0 * angle if angle > 1.0 else 0.0
        error[3], error[4], error[5] = x * scale, y * scale, z * scale


@quick
def _wanted(error: Floats, goal: Floats) -> float:
    """Leave of an error what its tolerance does not cover, aiming a little inside; return its square, 0 if covered."""
    total = 0.0
    for part in range(2):
        squared = 0.0
        for axis in range(3):
            squared += error[3 * part + axis] ** 2
        size, allowed = math.sqrt(squared), goal[NEAR + part]
        if size <= max(allowed, EXACT):
            scale = 0.0
        else:
            scale = 1.0 - 0.5 * allowed / size
            total += squared * scale * scale
        for axis in range(3):
            error[3 * part + axis] *= scale
    return total


@quick
def _jacobian(ints: Ints, rows: Floats, goal: Floats, joints: Floats, tip: Floats, columns: Floats) -> None:
    """Write how the tip moves and turns with each coordinate, (dim, 6), as far as the goal says what it should."""
    for k in range(len(columns)):
        for axis in range(6):
            columns[k, axis] = 0.0
    for i in range(len(ints)):
        column, factor = ints[i, 0], rows[i, 12]
        zx, zy, zz = joints[i, 0] * factor, joints[i, 1] * factor, joints[i, 2] * factor
        if ints[i, 1]:
            if goal[PLACED] > 0.0:
                columns[column, 0] += zx
                columns[column, 1] += zy
                columns[column, 2] += zz
            continue
        x, y, z = tip[9] - joints[i, 3], tip[10] - joints[i, 4], tip[11] - joints[i, 5]
        if goal[PLACED] > 0.0:
            columns[column, 0] += zy * z - zz * y
            columns[column, 1] += zz * x - zx * z
            columns[column, 2] += zx * y - zy * x
        if goal[TURNED] == NOT:
            continue
        along = 0.0
        if goal[TURNED] == BY_AXIS:
            along = zx * goal[DIRECTION] + zy * goal[DIRECTION + 1] + zz * goal[DIRECTION + 2]
        columns[column, 3] += zx - along * goal[DIRECTION]
        columns[column, 4] += zy - along * goal[DIRECTION + 1]
        columns[column, 5] += zz - along * goal[DIRECTION + 2]


@quick
def _step(columns: Floats, used: Floats, error: Floats, damping: float, square: Floats, step: Floats) -> None:
    """Write the damped least-squares step: J' (J J' + damping)^-1 error, of the coordinates that are used."""
    for i in range(6):
        for j in range(i + 1):
            total = damping if i == j else 0.0
            for k in range(len(columns)):
                total += used[k] * columns[k, i] * columns[k, j]
            # Cholesky's factor, row by row.
            for m in range(j):
                total -= square[i, m] * square[j, m]
            square[i, j] = math.sqrt(max(total, 1e-300)) if i == j else total / square[j, j]
    for i in range(6):
        total = error[i]
        for m in range(i):
            total -= square[i, m] * square[6, m]
        square[6, i] = total / square[i, i]
    for i in range(5, -1, -1):
        total = square[6, i]
        for m in range(i + 1, 6):
            total -= square[m, i] * square[6, m]
        square[6, i] = total / square[i, i]
    for k in range(len(columns)):
        total = 0.0
        for i in range(6):
            total += columns[k, i] * square[6, i]
        step[k] = used[k] * total


@quick
def _solve(
    q: Floats, ints: Ints, rows: Floats, low: Floats, high: Floats, goal: Floats, most: int, memory: Floats
) -> float:
    """Move a configuration, in place, until its tip is where it is wanted; return what is missing (0: nothing)."""
    dim, frames = len(q), len(ints)
    tip, error = memory[:12], memory[12:18]
    used, step = memory[18 : 18 + dim], memory[18 + dim : 18 + 2 * dim]
    at = 18 + 2 * dim
    square = memory[at : at + 42].reshape(7, 6)
    columns = memory[at + 42 : at + 42 + 6 * dim].reshape(dim, 6)
    joints = memory[at + 42 + 6 * dim : at + 42 + 6 * dim + 6 * frames].reshape(frames, 6)
    before = math.inf
    missing = math.inf
    for count in range(most + 1):
        _place_tip(q, ints, rows, joints, tip)
        _error(tip, goal, error)
        missing = _wanted(error, goal)
        if missing == 0.0 or count == most:
            break
        if count % _LOOK == 0:
            if missing > 0.25 * before:
                break
            before = missing
        _jacobian(ints, rows, goal, joints, tip, columns)
        for k in range(dim):
            used[k] = 1.0
        damping = _DAMPING * missing + 1e-16
        for _ in range(dim):
            _step(columns, used, error, damping, square, step)
            stuck = False
            for k in range(dim):
                if (q[k] >= high[k] and step[k] > 0.0) or (q[k] <= low[k] and step[k] < 0.0):
                    used[k], stuck = 0.0, True
            if not stuck:
                break
        largest = _LONGEST
        for k in range(dim):
            largest = max(largest, abs(step[k]))
        for k in range(dim):
            q[k] = min(max(q[k] + step[k] * (_LONGEST / largest), low[k]), high[k])
    return missing


@njit(cache=True, nogil=True, error_model="numpy")
def solve(
    q: Floats,
    chain: tuple[Ints, Floats],
    bounds: tuple[Floats, Floats],
    goals: Floats,
    most: int,
    enough: int,
    longest: float,
    missing: Floats,
) -> int:
    """Move configurations, (n, dim), in place, each by at most so many steps, until `enough` are where they should be.

    Of fewer goals than configurations the last serves the rest.  Where `longest` is not 0, each begins where the one
    before has ended, and the first that is not reached, or only by a joint's step over `longest`, is the end.  Writes
    what each lacks, squared; returns how many were moved, or follow one another.
    """
    dim = q.shape[1]
    ints, rows = chain
    low, high = bounds
    memory = np.empty(60 + 8 * dim + 6 * len(ints))
    found = 0
    for i in range(len(q)):
        if longest > 0.0 and i > 0:
            q[i] = q[i - 1]
        missing[i] = _solve(q[i], ints, rows, low, high, goals[min(i, len(goals) - 1)], most, memory)
        if longest > 0.0:
            far = 0.0
            for k in range(dim):
                far = max(far, abs(q[i, k] - q[max(i - 1, 0), k]))
            if missing[i] > 0.0 or far > longest:
                return i
        found += missing[i] == 0.0
        if found >= enough:
            return i + 1
    return len(q)


@njit(cache=True, nogil=True, error_model="numpy")
def tip_poses(q: Floats, ints: Ints, rows: Floats, out: Floats) -> None:
    """Write where configurations, (n, dim), have the tip: rotation row by row, and origin, (n, 12)."""
    joints = np.empty((len(ints), 6))
    for i in range(len(q)):
        _place_tip(q[i], ints, rows, joints, out[i])
