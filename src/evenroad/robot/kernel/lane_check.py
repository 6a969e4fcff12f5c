"""The check of sixteen configurations as a function that is called by its address.

Compiled code that calls another function is compiled together with it, and the check is large: each planner, and every
function of it that checks something, would cost seconds.  Called by its address the check is compiled once.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from llvmlite import ir
from numba import carray, cfunc, types
from numba.extending import intrinsic

from evenroad.robot.kernel.contact import blocked_lanes
from evenroad.robot.kernel.forward_kinematics import write_values

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

_ANY_LENGTH = 1 << 40
"""The arrays' lengths are not passed on: nothing reads beyond what the tables say."""

_SIGNATURE = types.int64(
    types.CPointer(types.float32),
    types.CPointer(types.float64),
    types.CPointer(types.int64),
    types.CPointer(types.float32),
    types.int64,
)


@cfunc(_SIGNATURE, cache=True)
def _blocked(scratch: Any, states: Any, ints: Any, table: Any, enough: int) -> int:
    memory, integers = carray(scratch, _ANY_LENGTH), carray(ints, _ANY_LENGTH)
    floats = carray(table, _ANY_LENGTH)
    write_values(memory, carray(states, _ANY_LENGTH), integers, floats)
    return blocked_lanes(memory, integers, floats, enough)


def check_address() -> int:
    """Return the address that `blocked_states` takes: good for this process."""
    return int(_blocked.address)


@intrinsic
def blocked_states(
    typing_context: Any, address: Any, scratch: Any, states: Any, ints: Any, table: Any, enough: Any
) -> Any:
    """Return the mask of sixteen configurations that touch something; see ``contact.blocked_lanes``.

    Parameters
    ----------
    address : int
        What `check_address` returns.
    scratch : float32 array
        As ``place.scratch_memory`` makes it.
    states : float64 array
        Sixteen numbers a coordinate.
    ints, table : arrays
        The tables.
    enough : int
        1 to stop at the first that is blocked, 16 to find all.
    """

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        pointers = [
            context.make_array(kind)(context, builder, arg).data
            for kind, arg in zip(sig.args[1:5], args[1:5], strict=True)
        ]
        kind = ir.FunctionType(ir.IntType(64), [*(pointer.type for pointer in pointers), ir.IntType(64)])
        function = builder.inttoptr(args[0], kind.as_pointer())
        return builder.call(function, [*pointers, args[5]])

    return types.int64(types.int64, scratch, states, ints, table, types.int64), lower
