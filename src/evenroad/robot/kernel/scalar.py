"""Checks of one configuration in double precision: the fallback of the lanes, and the reasons and proofs.

Every test is whether two bodies come nearer than a margin, so that one function serves all: margin 0 tells
contact, and a margin as large as what a stretch of motion can move proves the whole stretch free.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from evenroad._njit import njit
from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.addresses import call_at
from evenroad.robot.kernel.hull_contact import bodies_meet
from evenroad.robot.kernel.layout import inner, quick
from evenroad.robot.kernel.motion import enter, span
from evenroad.world.bisection import next_between

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

SEPARATE, MEETS_OBSTACLE, MEETS_SURFACE, MEETS_ITSELF = range(4)
"""What `first_contact` finds."""


@njit(cache=True, nogil=True)
def first_contact(
    q: Floats,
    ints: Ints,
    floats: Floats,
    margins: Floats,
    pair_margins: Floats,
    frames: Floats,
    capsules: Floats,
) -> tuple[int, int, int]:
    """Return what comes nearer than its margin first: which of the kinds above, a capsule, its counterpart.

    The counterpart is an obstacle (for MEETS_SURFACE, one of all the scene's), or for MEETS_ITSELF the pair's number
    (and then the capsule is -1).  There is a margin for each capsule against obstacles, and one for each pair of
    capsules [m].  The last two, (frames + 1, 12) and (capsules, 6), are room for places: rotation and origin of a
    frame, centre and half segment of a capsule.
    """
    _place_frames(q, ints, floats, frames)
    _place_capsules(ints, floats, frames, capsules)
    capsule, obstacle = _meets_obstacle(ints, floats, margins, capsules)
    if capsule >= 0:
        return MEETS_OBSTACLE, capsule, obstacle
    if ints[at.SURFACES] != 0:
        both = call_at(ints[at.SURFACE_CHECK], (capsules, margins, ints, floats, 0))
        if both >= 0:
            return MEETS_SURFACE, both >> 32, both & 0xFFFFFFFF
    pair = _meets_itself(ints, floats, pair_margins, frames, capsules)
    if pair >= 0:
        return MEETS_ITSELF, -1, pair
    return SEPARATE, -1, -1


@inner
def _place_frames(q: Floats, ints: Ints, floats: Floats, frames: Floats) -> None:
    for entry in range(12):
        frames[0, entry] = 1.0 if entry in (0, 4, 8) else 0.0
    for i in range(ints[at.FRAMES]):
        row, data = ints[at.FRAME_INTS] + at.FRAME_INT_ROW * i, ints[at.FRAME_FLOATS] + at.FRAME_FLOAT_ROW * i
        parent, coordinate, slides = ints[row], ints[row + 1], ints[row + 2]
        value = floats[data + 12] * q[coordinate] + floats[data + 13]
        sine, cosine, slide = 0.0, 1.0, value
        if not slides:
            sine, cosine, slide = math.sin(value), math.cos(value), 0.0
        for axis in range(3):
            p0, p1, p2 = frames[parent, 3 * axis], frames[parent, 3 * axis + 1], frames[parent, 3 * axis + 2]
            x = p0 * floats[data] + p1 * floats[data + 3] + p2 * floats[data + 6]
            y = p0 * floats[data + 1] + p1 * floats[data + 4] + p2 * floats[data + 7]
            z = p0 * floats[data + 2] + p1 * floats[data + 5] + p2 * floats[data + 8]
            moved = p0 * floats[data + 9] + p1 * floats[data + 10] + p2 * floats[data + 11]
            frames[i + 1, 3 * axis] = x * cosine + y * sine
            frames[i + 1, 3 * axis + 1] = y * cosine - x * sine
            frames[i + 1, 3 * axis + 2] = z
            frames[i + 1, 9 + axis] = frames[parent, 9 + axis] + moved + z * slide


@inner
def _place_capsules(ints: Ints, floats: Floats, frames: Floats, capsules: Floats) -> None:
    for i in range(ints[at.CAPSULES]):
        frame = ints[ints[at.CAPSULE_INTS] + at.CAPSULE_INT_ROW * i]
        data = ints[at.CAPSULE_FLOATS] + at.CAPSULE_FLOAT_ROW * i
        for axis in range(3):
            p0, p1, p2 = frames[frame, 3 * axis], frames[frame, 3 * axis + 1], frames[frame, 3 * axis + 2]
            centre = p0 * floats[data] + p1 * floats[data + 1] + p2 * floats[data + 2]
            capsules[i, axis] = centre + frames[frame, 9 + axis]
            capsules[i, 3 + axis] = p0 * floats[data + 3] + p1 * floats[data + 4] + p2 * floats[data + 5]


@inner
def _meets_obstacle(ints: Ints, floats: Floats, margins: Floats, capsules: Floats) -> tuple[int, int]:
    """Return a moving capsule and an obstacle nearer than the margin, or -1, -1; outer capsules come first."""
    blocks = ints[at.BLOCKS]
    for i in range(ints[at.CAPSULES] - 1, ints[at.FIXED_CAPSULES] - 1, -1):
        row = ints[at.CAPSULE_INTS] + at.CAPSULE_INT_ROW * i
        radius = floats[ints[at.CAPSULE_FLOATS] + at.CAPSULE_FLOAT_ROW * i + 6]
        for k in range(ints[at.OBSTACLES]):
            lane, block = k % at.LANES, k // at.LANES
            if not (ints[ints[at.TESTED] + i * blocks + block] >> lane) & 1:
                continue
            box = ints[at.BLOCK_FLOATS] + block * at.BLOCK_FLOAT_ROW + lane
            gap = -np.inf
            for axis in range(3):
                away = abs(capsules[i, axis] - floats[box + axis * at.LANES])
                widths = abs(capsules[i, 3 + axis]) + floats[box + (3 + axis) * at.LANES]
                gap = max(gap, away - widths)
            if gap >= radius + margins[i]:
                continue
            form, data = (
                ints[ints[at.OBSTACLE_INTS] + k],
                ints[at.OBSTACLE_FLOATS] + at.OBSTACLE_FLOAT_ROW * k,
            )
            reach = radius + margins[i] + floats[data + 15]
            for sample in range(ints[row + 1], ints[row + 2]):
                along = floats[ints[at.SAMPLES] + sample]
                x = capsules[i, 0] + along * capsules[i, 3]
                y = capsules[i, 1] + along * capsules[i, 4]
                z = capsules[i, 2] + along * capsules[i, 5]
                if squared_distance_to_obstacle(x, y, z, form, floats, data) < reach * reach:
                    return i, k
    return -1, -1


@quick
def squared_distance_to_obstacle(x: float, y: float, z: float, form: int, floats: Floats, data: int) -> float:
    """Return the squared distance of a point from an obstacle, without the rounding of its edges [m^2].

    `form` says which kind it is (ALIGNED, ROTATED or CYLINDER), `data` where its row begins in `floats`.
    """
    dx, dy, dz = x - floats[data], y - floats[data + 1], z - floats[data + 2]
    u = abs(dx * floats[data + 6] + dy * floats[data + 9] + dz * floats[data + 12])
    v = abs(dx * floats[data + 7] + dy * floats[data + 10] + dz * floats[data + 13])
    w = abs(dx * floats[data + 8] + dy * floats[data + 11] + dz * floats[data + 14])
    w = max(w - floats[data + 5], 0.0)
    if form == at.CYLINDER:
        aside = max(math.sqrt(u * u + v * v) - floats[data + 3], 0.0)
        return aside * aside + w * w
    u, v = max(u - floats[data + 3], 0.0), max(v - floats[data + 4], 0.0)
    return u * u + v * v + w * w


@inner
def _meets_itself(ints: Ints, floats: Floats, pair_margins: Floats, frames: Floats, capsules: Floats) -> int:
    """Return the number of a pair of capsules nearer than its margin, or -1."""
    for p in range(ints[at.BODY_PAIRS]):
        row = ints[at.BODY_PAIR_INTS] + at.BODY_PAIR_INT_ROW * p
        first, end = ints[row + 2], ints[row + 3]
        margin = 0.0
        for pair in range(first, end):
            margin = max(margin, pair_margins[pair])
        near = floats[ints[at.BODY_PAIR_FLOATS] + p] + margin
        if _squared_distance_of_bodies(ints[row], ints[row + 1], ints, floats, frames) >= near * near:
            continue
        for pair in range(first, end):
            data = ints[at.PAIR_FLOATS] + at.PAIR_FLOAT_ROW * pair
            reach = floats[data + 1] + pair_margins[pair]
            if _squared_distance_of_pair(pair, ints, floats, capsules) < reach * reach:
                by_hulls = p - (ints[at.BODY_PAIRS] - ints[at.HULL_PAIRS])
                if by_hulls < 0:
                    return pair
                margin = pair_margins[len(pair_margins) - ints[at.HULL_PAIRS] + by_hulls]
                if bodies_meet(frames.reshape(-1), 0, 1, margin, p, ints, floats):
                    return pair
                break
    return -1


@inner
def _squared_distance_of_bodies(a: int, b: int, ints: Ints, floats: Floats, frames: Floats) -> float:
    """Return the squared distance between the middles of two bodies' balls [m^2]."""
    first = ints[ints[at.BODY_INTS] + at.BODY_INT_ROW * a]
    second = ints[ints[at.BODY_INTS] + at.BODY_INT_ROW * b]
    data = ints[at.BODY_FLOATS] + at.BODY_FLOAT_ROW * a
    other = ints[at.BODY_FLOATS] + at.BODY_FLOAT_ROW * b
    squared = 0.0
    for axis in range(3):
        gap = frames[first, 9 + axis] - frames[second, 9 + axis]
        for entry in range(3):
            gap += frames[first, 3 * axis + entry] * floats[data + entry]
            gap -= frames[second, 3 * axis + entry] * floats[other + entry]
        squared += gap * gap
    return squared


@inner
def _squared_distance_of_pair(pair: int, ints: Ints, floats: Floats, capsules: Floats) -> float:
    """Return the squared distance between the segments of a pair of capsules [m^2].

    With segments ``centre + s half``, s from -1 to 1, the best t for all s, cut to the range, then the best s
    for that t, cut, then the best t for that s, cut again.  Without the last step contacts can be missed by
    millimetres where s was cut (after V. Lumelsky, 1985, and C. Ericson, Real-Time Collision Detection,
    2005, section 5.1.9).  The first t is that of the parts across the first segment.  Written with products of
    lengths alone, as usual, it loses twice the digits where segments are nearly parallel; so, the distance errs by
    about the rounding of the half lengths, whatever the angle.
    """
    row, data = ints[at.PAIR_INTS] + at.PAIR_INT_ROW * pair, ints[at.PAIR_FLOATS] + at.PAIR_FLOAT_ROW * pair
    i, k = ints[row], ints[row + 1]
    one_by_ee, one_by_ff = floats[data + 2], floats[data + 3]
    ef, er, fr = 0.0, 0.0, 0.0
    for axis in range(3):
        r = capsules[i, axis] - capsules[k, axis]
        e, f = capsules[i, 3 + axis], capsules[k, 3 + axis]
        ef += e * f
        er += e * r
        fr += f * r
    along_f, along_r = ef * one_by_ee, er * one_by_ee
    across_ff, across_fr = 0.0, 0.0
    for axis in range(3):
        e = capsules[i, 3 + axis]
        across_f = capsules[k, 3 + axis] - along_f * e
        across_ff += across_f * across_f
        across_fr += across_f * (capsules[i, axis] - capsules[k, axis] - along_r * e)
    t = min(max(across_fr / max(across_ff, at.LEAST_SQUARE), -1.0), 1.0)
    s = min(max(along_f * t - along_r, -1.0), 1.0)
    t = min(max((ef * s + fr) * one_by_ff, -1.0), 1.0)
    squared = 0.0
    for axis in range(3):
        gap = capsules[i, axis] - capsules[k, axis] + s * capsules[i, 3 + axis] - t * capsules[k, 3 + axis]
        squared += gap * gap
    return squared


@njit(cache=True, nogil=True)
def configurations_free(q: Floats, bounds: Floats, ints: Ints, floats: Floats) -> npt.NDArray[np.bool_]:
    """Return which rows of `q`, (n, dim), are within `bounds`, (3, dim), and free: (n,)."""
    no_margins = np.zeros(1 + ints[at.CAPSULES] ** 2)
    frames, capsules = np.empty((ints[at.FRAMES] + 1, 12)), np.empty((ints[at.CAPSULES], 6))
    state = np.empty(q.shape[1])
    free = np.empty(len(q), dtype=np.bool_)
    for row in range(len(q)):
        free[row] = (
            enter(q[row], bounds, state)
            and first_contact(state, ints, floats, no_margins, no_margins, frames, capsules)[0] == SEPARATE
        )
    return free


@njit(cache=True, nogil=True)
def motions_free(
    a: Floats, b: Floats, resolution: float, bounds: Floats, ints: Ints, floats: Floats
) -> npt.NDArray[np.bool_]:
    """Return which motions, from rows of `a` to those of `b`, are free at both ends and at states between.

    The states are ``k / n`` of the way, n the number of segments of at most `resolution`, in the order of
    ``evenroad.world.bisection``.
    """
    no_margins = np.zeros(1 + ints[at.CAPSULES] ** 2)
    frames, capsules = np.empty((ints[at.FRAMES] + 1, 12)), np.empty((ints[at.CAPSULES], 6))
    dim = a.shape[1]
    start, end, direction, state = np.empty(dim), np.empty(dim), np.empty(dim), np.empty(dim)
    free = np.empty(len(a), dtype=np.bool_)
    for row in range(len(a)):
        free[row] = False
        if not (enter(a[row], bounds, start) and enter(b[row], bounds, end)):
            continue
        segments = span(start, end, bounds, resolution, direction)
        if first_contact(start, ints, floats, no_margins, no_margins, frames, capsules)[0] != SEPARATE:
            continue
        if first_contact(end, ints, floats, no_margins, no_margins, frames, capsules)[0] != SEPARATE:
            continue
        level, multiple, number = next_between(1, -1, segments)
        while number > 0:
            for k in range(dim):
                state[k] = start[k] + number / segments * direction[k]
            if first_contact(state, ints, floats, no_margins, no_margins, frames, capsules)[0] != SEPARATE:
                break
            level, multiple, number = next_between(level, multiple, segments)
        free[row] = number == 0
    return free
