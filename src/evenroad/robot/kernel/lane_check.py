"""The check of sixteen configurations as a function that is called by its address.

Compiled code that calls another function is compiled together with it, and the check is large: each planner, and every
function of it that checks something, would cost seconds.  Called by its address the check is compiled once.
"""

from __future__ import annotations

from typing import Any

from numba import carray, cfunc, types

from evenroad.robot.kernel.addresses import DOUBLES, INTEGERS, SINGLES
from evenroad.robot.kernel.contact import blocked_lanes
from evenroad.robot.kernel.forward_kinematics import write_values

ANY_LENGTH = 1 << 40
"""The arrays' lengths are not passed on: nothing reads beyond what the tables say."""


@cfunc(types.int64(SINGLES, DOUBLES, INTEGERS, SINGLES, types.int64), cache=True)
def _blocked(scratch: Any, states: Any, ints: Any, table: Any, enough: int) -> int:
    memory, integers = carray(scratch, ANY_LENGTH), carray(ints, ANY_LENGTH)
    floats = carray(table, ANY_LENGTH)
    write_values(memory, carray(states, ANY_LENGTH), integers, floats)
    return blocked_lanes(memory, integers, floats, enough)


def check_address() -> int:
    """Return the address, good for this process, of the check of sixteen configurations.

    `call_at` takes with it: scratch memory as ``forward_kinematics.scratch_memory`` makes it; states, sixteen numbers
    a coordinate; integers and floats of the tables; 1 to stop at the first state that is blocked, 16 to find all.  It
    returns the mask of those that touch something, as ``contact.blocked_lanes`` does.
    """
    return int(_blocked.address)
