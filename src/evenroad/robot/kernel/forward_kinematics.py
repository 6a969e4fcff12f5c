"""Frames, bodies and capsules of a robot at sixteen configurations."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.lane_memory import load, load_angles, load_vector, row, store, store_vector
from evenroad.robot.kernel.lanes import ONE, ZERO, absolute, dot, plus, smaller, spread, with_sign_of
from evenroad.robot.kernel.layout import FRAME, HALF, LANES, PLACED, inlined, inner

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

_FULL_TURN = 2.0 * np.pi
_PI = np.float32(np.pi)
_HALF_PI = np.float32(0.5 * np.pi)

# x + S3 x^3 + S5 x^5 + S7 x^7 + S9 x^9 nearest to sin x on [-pi/2, pi/2] in the largest error (by Lawson's
# reweighted least squares, 1961): 4.6e-9, or 1.7e-8 with coefficients of single precision.  Taylor's series, or
# one made for pi/4, errs by 1e-4 there.
_S3 = np.float32(-0.16666657096)
_S5 = np.float32(0.0083330172914)
_S7 = np.float32(-0.00019806615190)
_S9 = np.float32(2.6000547418e-06)


@inlined
def scratch_offsets(ints: Ints) -> tuple[int, int]:
    """Return where bodies and capsules begin in the scratch memory, after the frames."""
    bodies = FRAME * (ints[at.FRAMES] + 1)
    return bodies, bodies + PLACED * ints[at.BODIES]


@inner
def place_fixed(scratch: Singles, ints: Ints, table: Singles) -> None:
    """Write what no joint moves, and the half segments, zeros, of the balls among the capsules."""
    _, capsules = scratch_offsets(ints)
    for entry in range(12):
        store(scratch, entry * LANES, spread(ONE if entry in (0, 4, 8) else ZERO))
    for index in range(capsules + HALF, ints[at.SCRATCH], PLACED):
        for axis in range(3):
            store(scratch, index + axis * LANES, spread(ZERO))
    # Not a plain 0: numba compiles a function once more for a literal.
    _place_bodies(scratch, np.int64(0), ints[at.FIXED_BODIES], ints, table)


@inner
def place_moving(scratch: Singles, states: Floats, ints: Ints, table: Singles) -> None:
    """Write what moves for sixteen configurations, `states`: sixteen numbers a coordinate."""
    _place_frames(scratch, states, ints, table)
    _place_bodies(scratch, ints[at.FIXED_BODIES], ints[at.BODIES], ints, table)


@inner
def _place_frames(scratch: Singles, states: Floats, ints: Ints, table: Singles) -> None:
    for i in range(ints[at.FRAMES]):
        parent, coordinate, slides = row(ints, ints[at.FRAME_INTS] + at.FRAME_INT_ROW * i, 3)
        a, b, c, d, e, f, g, h, i_, x, y, z, multiplier, offset, more, further = row(
            table, ints[at.FRAME_FLOATS] + at.FRAME_FLOAT_ROW * i, 16
        )
        value = load_angles(
            states,
            coordinate * LANES,
            np.float64(multiplier) + np.float64(more),
            np.float64(offset) + np.float64(further),
            0.0 if slides else _FULL_TURN,
        )
        sine, cosine = sine_and_cosine(value)
        if slides:
            sine, cosine = spread(ZERO), spread(ONE)
        here, below = FRAME * (i + 1), FRAME * parent
        for axis in range(3):
            turned = load_vector(scratch, below + 3 * axis * LANES)
            along_x, along_y = dot(turned, (a, d, g)), dot(turned, (b, e, h))
            along_z, origin = dot(turned, (c, f, i_)), dot(turned, (x, y, z))
            origin = load(scratch, below + (9 + axis) * LANES) + origin
            if slides:
                origin = origin + along_z * value
            store_vector(
                scratch,
                here + 3 * axis * LANES,
                (along_x * cosine + along_y * sine, along_y * cosine - along_x * sine, along_z),
            )
            store(scratch, here + (9 + axis) * LANES, origin)


@inner
def _place_bodies(scratch: Singles, first: int, end: int, ints: Ints, table: Singles) -> None:
    """Write bodies, the boxes around those of many capsules, and their capsules."""
    bodies, capsules = scratch_offsets(ints)
    for body in range(first, end):
        frame, first_capsule, end_capsule = row(ints, ints[at.BODY_INTS] + at.BODY_INT_ROW * body, 3)
        index = FRAME * frame
        rx, ry = load_vector(scratch, index), load_vector(scratch, index + 3 * LANES)
        rz, origin = load_vector(scratch, index + 6 * LANES), load_vector(scratch, index + 9 * LANES)
        x, y, z, _, a, b, c = row(table, ints[at.BODY_FLOATS] + at.BODY_FLOAT_ROW * body, 7)
        here, centre, half = bodies + PLACED * body, (x, y, z), (a, b, c)
        store_vector(scratch, here, plus(origin, (dot(rx, centre), dot(ry, centre), dot(rz, centre))))
        if end_capsule - first_capsule > at.FEW:
            extents = dot(absolute(rx), half), dot(absolute(ry), half), dot(absolute(rz), half)
            store_vector(scratch, here + HALF, extents)
        for i in range(first_capsule, end_capsule):
            x, y, z, a, b, c = row(table, ints[at.CAPSULE_FLOATS] + at.CAPSULE_FLOAT_ROW * i, 6)
            here, centre, half = capsules + PLACED * i, (x, y, z), (a, b, c)
            store_vector(scratch, here, plus(origin, (dot(rx, centre), dot(ry, centre), dot(rz, centre))))
            if a != ZERO or b != ZERO or c != ZERO:
                store_vector(scratch, here + HALF, (dot(rx, half), dot(ry, half), dot(rz, half)))


@inlined
def sine_and_cosine(angle: Any) -> Any:
    """Return the sines and cosines of sixteen angles from -pi to pi [rad], to 2e-7."""
    size = absolute(angle)
    # sin x = sin(pi - x); cos x = sin(pi/2 - |x|).
    sine = with_sign_of(_sine_within_a_quarter(smaller(_PI - size, size)), angle)
    return sine, _sine_within_a_quarter(_HALF_PI - size)


@inlined
def _sine_within_a_quarter(angle: Any) -> Any:
    square = angle * angle
    return angle + angle * square * (_S3 + square * (_S5 + square * (_S7 + square * _S9)))
