"""The check of sixteen configurations as a function that is called by its address.

Compiled code that calls another function is compiled together with it, and the check is large: each planner, and every
function of it that checks something, would cost seconds.  Called by its address the check is compiled once.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import cfunc, types

from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.addresses import address_of, call_at, doubles_at, integers_at, singles_at
from evenroad.robot.kernel.contact import blocked_lanes
from evenroad.robot.kernel.forward_kinematics import place_fixed, place_moving, scratch_places
from evenroad.robot.kernel.layout import LANES, inner

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

ANY_LENGTH = 1 << 40
"""The arrays' lengths are not passed on: nothing reads beyond what the tables say."""


@cfunc(types.int64(*[types.int64] * 5), cache=True, error_model="numpy", _nrt=False)
def _blocked(scratch: int, states: int, ints: int, table: int, enough: int) -> int:
    memory, integers = singles_at(scratch, (ANY_LENGTH,)), integers_at(ints, (ANY_LENGTH,))
    floats = singles_at(table, (ANY_LENGTH,))
    if enough == 0:
        place_fixed(memory, integers, floats)
        return 0
    place_moving(memory, doubles_at(states, (ANY_LENGTH,)), integers, floats)
    return blocked_lanes(memory, integers, floats, enough)


def check_address() -> int:
    """Return the address, good for this process, of the check of sixteen configurations.

    `call_at` takes with it: scratch memory, where a first call with `enough` 0 has put what does not move; states,
    sixteen numbers a coordinate; integers and floats of the tables; 1 to stop at the first state that is blocked, 16
    to find all.  It returns the mask of those that touch something, as ``contact.blocked_lanes`` does.
    """
    return int(_blocked.address)


@inner
def unpacked(tables: Ints) -> tuple[Ints, Singles]:
    """Return the integers and the floats of ``ArmTables.lanes``; the floats keep nothing alive."""
    integers = tables[at.INTEGERS]
    return tables[:integers], singles_at(address_of(tables) + 8 * integers, (2 * (len(tables) - integers),))


@inner
def scratch_memory(address: int, dim: int, ints: Ints, table: Singles) -> tuple[Floats, Singles]:
    """Return room for sixteen states of `dim` coordinates, and scratch memory that lives as long as it.

    The scratch memory begins on a cache line, and what does not move is in its place.
    """
    doubles, length = dim * LANES, scratch_places(ints)[2]
    raw = np.empty(doubles + length // 2 + 8)
    skip = (64 - address_of(raw) % 64) % 64 // 8
    states = raw[skip : skip + doubles]
    scratch = singles_at(address_of(states) + 8 * doubles, (length,))
    call_at(address, (scratch, states, ints, table, 0))
    return states, scratch
