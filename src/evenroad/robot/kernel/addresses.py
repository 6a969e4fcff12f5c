"""Arrays at addresses, for compiled code that makes none."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import populate_array


@intrinsic
def stack_memory(typing_context: Any, count: Any) -> Any:
    """Return the address of so many doubles, a literal, that last as long as the calling function."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        kind = ir.ArrayType(ir.DoubleType(), sig.args[0].literal_value)
        # Not to be a part of its callers, which are fast and seldom come here.
        builder.function.attributes.add("noinline")
        return builder.ptrtoint(cgutils.alloca_once(builder, kind), ir.IntType(64))

    return (types.int64(count), lower) if isinstance(count, types.IntegerLiteral) else None


def _array(number: types.Type, dimensions: int) -> Callable[..., Any]:
    """Return an intrinsic that takes the memory at an address for an array of a shape, a tuple of integers."""
    kind = types.Array(number, dimensions, "C")

    @intrinsic
    def array(typing_context: Any, address: Any, shape: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
            made = context.make_array(kind)(context, builder)
            lengths = cgutils.unpack_tuple(builder, args[1], dimensions)
            size = context.get_constant(types.intp, np.dtype(number.name).itemsize)
            strides = [size]
            for length in lengths[:0:-1]:
                strides.insert(0, builder.mul(strides[0], length))
            # As numba's own carray: of no counted memory.
            populate_array(
                made,
                data=builder.inttoptr(args[0], context.get_data_type(number).as_pointer()),
                shape=lengths,
                strides=strides,
                itemsize=size,
                meminfo=None,
            )
            return made._getvalue()

        return kind(types.int64, types.UniTuple(types.int64, dimensions)), lower

    return array


doubles_at, integers_at = (_array(kind, 1) for kind in (types.float64, types.int64))
