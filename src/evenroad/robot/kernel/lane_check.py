"""The check of sixteen configurations as a function that is called by its address.

Compiled code that calls another function is compiled together with it, and the check is large: each planner, and every
function of it that checks something, would cost seconds.  Called by its address the check is compiled once.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import carray, cfunc, types
from numba.core import cgutils
from numba.extending import intrinsic

from evenroad.robot.kernel.contact import blocked_lanes
from evenroad.robot.kernel.forward_kinematics import write_values

ANY_LENGTH = 1 << 40
"""The arrays' lengths are not passed on: nothing reads beyond what the tables say."""

DOUBLES = types.CPointer(types.float64)
SINGLES = types.CPointer(types.float32)
INTEGERS = types.CPointer(types.int64)


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


@intrinsic
def call_at(typing_context: Any, address: Any, arguments: Any) -> Any:
    """Return the integer that the function at an address gives for a tuple of arguments; of arrays it takes pointers.

    Nothing checks that the arguments are those of the function: integers are of 64 bits, floats double.
    """

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        values = [
            context.make_array(kind)(context, builder, value).data if isinstance(kind, types.Array) else value
            for kind, value in zip(sig.args[1], cgutils.unpack_tuple(builder, args[1]), strict=True)
        ]
        kind = ir.FunctionType(ir.IntType(64), [value.type for value in values])
        return builder.call(builder.inttoptr(args[0], kind.as_pointer()), values)

    return types.int64(types.int64, arguments), lower
