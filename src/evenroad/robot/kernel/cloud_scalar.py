"""Which capsule comes near a cloud first, one configuration at a time: the fallback of the lanes, and what explains."""

from __future__ import annotations

from functools import cache

import numpy as np
import numpy.typing as npt
from numba import cfunc, types

from evenroad.robot.kernel import cloud_tree as tree
from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.addresses import ANY_LENGTH, doubles_at, integers_at, matrix_at, singles_at
from evenroad.robot.kernel.layout import LANES, quick
from evenroad.robot.kernel.scene_clouds import CAPSULE_ROW, CLOUD_ROW, DESK

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]


@cache
def scalar_check_address() -> int:
    """Return the address, good for this process, of the check; compiled when first asked.

    It takes the addresses of places of capsules, (capsules, 6), of their margins, and of integers and floats of the
    tables; it returns ``capsule << 32 | obstacle`` of a capsule that moves, or may be fixed where the last argument is
    1, and comes nearer to a cloud than its margin, or -1.
    """
    kind = types.int64(*[types.int64] * 5)
    return int(cfunc(kind, cache=True, error_model="numpy", _nrt=False)(_first_meeting).address)


def _first_meeting(capsules: int, margins: int, ints: int, floats: int, fixed: int) -> int:
    integers, table = integers_at(ints, (ANY_LENGTH,)), doubles_at(floats, (ANY_LENGTH,))
    places, extra = (
        matrix_at(capsules, (integers[at.CAPSULES], 6)),
        doubles_at(margins, (integers[at.CAPSULES],)),
    )
    desk = integers_at(integers[at.CLOUDS], (ANY_LENGTH,))
    of_capsules = singles_at(desk[1], (ANY_LENGTH,))
    for number in range(desk[0]):
        cloud = DESK + CLOUD_ROW * number
        tested = integers_at(desk[cloud + 1], (ANY_LENGTH,))
        for i in range(integers[at.CAPSULES] - 1, -1 if fixed else integers[at.FIXED_CAPSULES] - 1, -1):
            if tested[i] == 0:
                continue
            radius = table[integers[at.CAPSULE_FLOATS] + at.CAPSULE_FLOAT_ROW * i + 6]
            reach = radius - of_capsules[CAPSULE_ROW * i] + extra[i]
            if is_near(places[i], reach, desk[cloud]):
                return i << 32 | desk[cloud + 2]
    return -1


@quick
def is_near(capsule: Floats, reach: float, place: int) -> bool:
    """Return whether a point of a cloud, with its radius, is within `reach` of a segment: centre and half of it, (6,).

    Groups of leaves, leaves and points, one after the other; rarely asked, so what is simple will do.
    """
    header = integers_at(place, (tree.HEADER,))
    table = singles_at(place + tree.BYTES_OF_HEADER, (ANY_LENGTH,))
    reach += table[tree.RADIUS]
    first = header[tree.FIRST_NODES]
    nodes = (first - tree.LEAVES) // (LANES * tree.LEAF_ROW)
    for node in range(nodes):
        for lane in range(LANES):
            child = first + tree.NODE_ROW * node + lane
            near = reach + table[child + 6 * LANES]
            if _squared(capsule, table, child) >= near * near:
                continue
            leaf = tree.LEAVES + tree.LEAF_ROW * (LANES * node + lane)
            for entry in range(LANES):
                if _squared(capsule, table, leaf + entry) < reach * reach:
                    return True
    return False


@quick
def _squared(capsule: Floats, table: Singles, place: int) -> float:
    """Return the squared distance of a segment from a point, whose coordinates are sixteen places apart [m^2]."""
    x, y, z = (
        np.float64(table[place]) - capsule[0],
        np.float64(table[place + LANES]) - capsule[1],
        np.float64(table[place + 2 * LANES]) - capsule[2],
    )
    i, j, k = capsule[3], capsule[4], capsule[5]
    along = (x * i + y * j + z * k) / max(i * i + j * j + k * k, at.LEAST_SQUARE)
    along = min(max(along, -1.0), 1.0)
    x, y, z = x - along * i, y - along * j, z - along * k
    return x * x + y * y + z * z
