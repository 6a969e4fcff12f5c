"""The check of sixteen configurations as a function that is called by its address.

Compiled code that calls another function is compiled together with it, and the check is large: each planner, and every
function of it that checks something, would cost seconds.  Called by its address the check is compiled once.
"""

from __future__ import annotations

from numba import types

from evenroad._njit import cfunc
from evenroad._shared import once
from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.addresses import ANY_LENGTH, doubles_at, integers_at, singles_at
from evenroad.robot.kernel.contact import blocked_lanes
from evenroad.robot.kernel.forward_kinematics import place_fixed, place_moving


@once
def check_address() -> int:
    """Return the address, good for this process, of the check of sixteen configurations; compiled when first asked.

    It takes the addresses of scratch memory, where a first call with `enough` 0 has put what does not move, of states,
    sixteen numbers a coordinate, of integers and floats of the tables; and `enough`: 1 to stop at the first state that
    is blocked, 16 to find all.  It returns the mask of those that touch something, as ``contact.blocked_lanes`` does.
    In place of states the first call takes the address of ``hull_lanes.meeting_address``, 0 for robots without hulls.
    """
    compiled = cfunc(types.int64(*[types.int64] * 5), cache=True, error_model="numpy", _nrt=False)(_blocked)
    return int(compiled.address)


def _blocked(scratch: int, states: int, ints: int, table: int, enough: int) -> int:
    memory, integers = singles_at(scratch, (ANY_LENGTH,)), integers_at(ints, (ANY_LENGTH,))
    floats = singles_at(table, (ANY_LENGTH,))
    hulls = integers_at(scratch + 4 * integers[at.SCRATCH], (1,))
    if enough == 0:
        place_fixed(memory, integers, floats)
        hulls[0] = states
        return 0
    place_moving(memory, doubles_at(states, (ANY_LENGTH,)), integers, floats)
    return blocked_lanes(memory, integers, floats, enough, hulls[0])
