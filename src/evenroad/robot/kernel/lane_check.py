"""The check of sixteen configurations as a function that is called by its address.

Compiled code that calls another function is compiled together with it, and the check is large: each planner, and every
function of it that checks something, would cost seconds.  Called by its address the check is compiled once.
"""

from __future__ import annotations

from numba import cfunc, types

from evenroad.robot.kernel.addresses import doubles_at, integers_at, singles_at
from evenroad.robot.kernel.contact import blocked_lanes
from evenroad.robot.kernel.forward_kinematics import write_values

ANY_LENGTH = 1 << 40
"""The arrays' lengths are not passed on: nothing reads beyond what the tables say."""


@cfunc(types.int64(*[types.int64] * 5), cache=True, error_model="numpy", _nrt=False)
def _blocked(scratch: int, states: int, ints: int, table: int, enough: int) -> int:
    memory, integers = singles_at(scratch, (ANY_LENGTH,)), integers_at(ints, (ANY_LENGTH,))
    floats = singles_at(table, (ANY_LENGTH,))
    write_values(memory, doubles_at(states, (ANY_LENGTH,)), integers, floats)
    return blocked_lanes(memory, integers, floats, enough)


def check_address() -> int:
    """Return the address, good for this process, of the check of sixteen configurations.

    `call_at` takes with it: scratch memory as ``forward_kinematics.scratch_memory`` makes it; states, sixteen numbers
    a coordinate; integers and floats of the tables; 1 to stop at the first state that is blocked, 16 to find all.  It
    returns the mask of those that touch something, as ``contact.blocked_lanes`` does.
    """
    return int(_blocked.address)
