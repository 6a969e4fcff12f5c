"""Where sixteen configurations put a robot's frames, capsules and bodies."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.addresses import address_of
from evenroad.robot.kernel.lanes import ONE, ZERO, absolute, load, sine_and_cosine, spread, store
from evenroad.robot.kernel.layout import inlined, inner

LANES = at.LANES
Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

FRAME = 12 * LANES
"""Numbers of a frame in the scratch memory: rotation row by row, origin."""

CAPSULE = 9 * LANES
"""Numbers of a capsule: centre, half segment, half extents of the box around its spheres."""

BODY = 6 * LANES
"""Numbers of a body: its centre, half extents of the box around it where it has more than `FEW` capsules."""

FEW = 3
"""Of bodies with at most so many capsules no box is tested before those of the capsules: it would cost more."""

_FULL_TURN = 2.0 * np.pi
_TURNS = 0.5 / np.pi


@inner
def scratch_places(ints: Ints) -> tuple[int, int, int, int]:
    """Return where frames, capsules and bodies begin in the scratch memory, and its length.

    The values of the frames come first, sixteen numbers each.
    """
    frames = LANES * ints[at.FRAMES]
    capsules = frames + FRAME * (ints[at.FRAMES] + 1)
    bodies = capsules + CAPSULE * ints[at.CAPSULES]
    return frames, capsules, bodies, bodies + BODY * ints[at.BODIES]


@inner
def unpacked(tables: Ints) -> tuple[Ints, Singles]:
    """Return the integers and the floats of ``ArmTables.lanes``."""
    integers = tables[at.INTEGERS]
    return tables[:integers], tables[integers:].view(np.float32)


@inner
def scratch_memory(dim: int, ints: Ints, table: Singles) -> tuple[Floats, Floats, Singles]:
    """Return room for sixteen states of `dim` coordinates, for one, and scratch memory, cut out of one array.

    The scratch memory begins on a cache line, and what does not move is in its place.
    """
    frames, capsules, bodies, length = scratch_places(ints)
    doubles = dim * LANES
    raw = np.empty(doubles + length // 2 + LANES + dim)
    skip = (64 - address_of(raw) % 64) % 64 // 8
    states, scratch = (
        raw[skip : skip + doubles],
        raw[skip + doubles : skip + doubles + length // 2].view(np.float32),
    )
    state = raw[len(raw) - dim :]
    for entry in range(12):
        store(scratch, frames + entry * LANES, spread(ONE if entry in (0, 4, 8) else ZERO))
    # Not a plain 0: numba compiles a function once more for a literal.
    first = np.int64(0)
    _place_capsules(scratch, frames, capsules, first, ints[at.FIXED_CAPSULES], ints, table)
    _place_bodies(scratch, frames, bodies, first, ints[at.FIXED_BODIES], ints, table)
    return states, state, scratch


@inner
def write_values(scratch: Singles, states: Floats, ints: Ints, table: Singles) -> None:
    """Write the values of the frames for sixteen configurations, `states`: sixteen numbers a coordinate.

    Angles lose their whole turns here, in double precision: single precision has no digits for a large angle.
    """
    for i in range(ints[at.FRAMES]):
        row = ints[at.FRAME_INTS] + at.FRAME_INT_ROW * i
        data = ints[at.FRAME_FLOATS] + at.FRAME_FLOAT_ROW * i
        multiplier = np.float64(table[data + 12]) + np.float64(table[data + 14])
        offset = np.float64(table[data + 13]) + np.float64(table[data + 15])
        turn = 0.0 if ints[row + 2] != 0 else _FULL_TURN
        coordinate = ints[row + 1] * LANES
        numbers, values = states[coordinate : coordinate + LANES], scratch[i * LANES : (i + 1) * LANES]
        # A length that the compiler does not know: it then makes vectors of the loop instead of unrolling it.
        for lane in range(len(numbers)):
            value = multiplier * numbers[lane] + offset
            values[lane] = value - turn * np.rint(value * _TURNS)


@inner
def place_frames(scratch: Singles, frames: int, ints: Ints, table: Singles) -> None:
    """Write the frames for the values at the beginning of `scratch`."""
    for i in range(ints[at.FRAMES]):
        row = ints[at.FRAME_INTS] + at.FRAME_INT_ROW * i
        data = ints[at.FRAME_FLOATS] + at.FRAME_FLOAT_ROW * i
        parent = ints[row]
        here, below = frames + FRAME * (i + 1), frames + FRAME * parent
        value = load(scratch, i * LANES)
        slides = ints[row + 2] != 0
        sine, cosine = spread(ZERO), spread(ONE)
        if not slides:
            sine, cosine = sine_and_cosine(value)
        for axis in range(3):
            if parent == 0:
                x = spread(table[data + 3 * axis])
                y = spread(table[data + 3 * axis + 1])
                z = spread(table[data + 3 * axis + 2])
                origin = spread(table[data + 9 + axis])
            else:
                p0 = load(scratch, below + 3 * axis * LANES)
                p1 = load(scratch, below + (3 * axis + 1) * LANES)
                p2 = load(scratch, below + (3 * axis + 2) * LANES)
                x = p0 * table[data] + p1 * table[data + 3] + p2 * table[data + 6]
                y = p0 * table[data + 1] + p1 * table[data + 4] + p2 * table[data + 7]
                z = p0 * table[data + 2] + p1 * table[data + 5] + p2 * table[data + 8]
                origin = _moved(scratch, below, axis, p0, p1, p2, data + 9, table)
            if slides:
                origin = origin + z * value
            store(scratch, here + 3 * axis * LANES, x * cosine + y * sine)
            store(scratch, here + (3 * axis + 1) * LANES, y * cosine - x * sine)
            store(scratch, here + (3 * axis + 2) * LANES, z)
            store(scratch, here + (9 + axis) * LANES, origin)


@inner
def place_moving_capsules(scratch: Singles, frames: int, capsules: int, ints: Ints, table: Singles) -> None:
    """Write the capsules that move."""
    _place_capsules(scratch, frames, capsules, ints[at.FIXED_CAPSULES], ints[at.CAPSULES], ints, table)


@inner
def place_moving_bodies(scratch: Singles, frames: int, bodies: int, ints: Ints, table: Singles) -> None:
    """Write the bodies that move."""
    _place_bodies(scratch, frames, bodies, ints[at.FIXED_BODIES], ints[at.BODIES], ints, table)


@inner
def _place_capsules(
    scratch: Singles, frames: int, capsules: int, first: int, end: int, ints: Ints, table: Singles
) -> None:
    for i in range(first, end):
        frame = frames + FRAME * ints[ints[at.CAPSULE_INTS] + at.CAPSULE_INT_ROW * i]
        data = ints[at.CAPSULE_FLOATS] + at.CAPSULE_FLOAT_ROW * i
        here = capsules + CAPSULE * i
        for axis in range(3):
            p0 = load(scratch, frame + 3 * axis * LANES)
            p1 = load(scratch, frame + (3 * axis + 1) * LANES)
            p2 = load(scratch, frame + (3 * axis + 2) * LANES)
            half = p0 * table[data + 3] + p1 * table[data + 4] + p2 * table[data + 5]
            store(scratch, here + axis * LANES, _moved(scratch, frame, axis, p0, p1, p2, data, table))
            store(scratch, here + (3 + axis) * LANES, half)
            store(scratch, here + (6 + axis) * LANES, absolute(half) + table[data + 6])


@inner
def _place_bodies(
    scratch: Singles, frames: int, bodies: int, first: int, end: int, ints: Ints, table: Singles
) -> None:
    for i in range(first, end):
        row = ints[at.BODY_INTS] + at.BODY_INT_ROW * i
        frame = frames + FRAME * ints[row]
        data = ints[at.BODY_FLOATS] + at.BODY_FLOAT_ROW * i
        here = bodies + BODY * i
        boxed = ints[row + 2] - ints[row + 1] > FEW
        for axis in range(3):
            p0 = load(scratch, frame + 3 * axis * LANES)
            p1 = load(scratch, frame + (3 * axis + 1) * LANES)
            p2 = load(scratch, frame + (3 * axis + 2) * LANES)
            store(scratch, here + axis * LANES, _moved(scratch, frame, axis, p0, p1, p2, data, table))
            if boxed:
                x, y, z = absolute(p0), absolute(p1), absolute(p2)
                half = x * table[data + 4] + y * table[data + 5] + z * table[data + 6]
                store(scratch, here + (3 + axis) * LANES, half)


@inlined
def _moved(
    scratch: Singles, frame: int, axis: int, p0: Any, p1: Any, p2: Any, data: int, table: Singles
) -> Any:
    """Return a coordinate, in the root's frame, of a point that the table has at `data` in a frame's own."""
    turned = p0 * table[data] + p1 * table[data + 1] + p2 * table[data + 2]
    return load(scratch, frame + (9 + axis) * LANES) + turned
