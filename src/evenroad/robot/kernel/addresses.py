"""Addresses: of functions, to call them from compiled code, and of arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import populate_array


def address(array: npt.NDArray[Any]) -> int:
    """Return where an array, C-contiguous and of the kind that the caller takes it for, begins in memory."""
    return int(array.__array_interface__["data"][0])


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


ANY_LENGTH = 1 << 40
"""For arrays whose lengths are not passed on: nothing reads beyond what the tables say."""

doubles_at, matrix_at = (_array(types.float64, dimensions) for dimensions in (1, 2))
singles_at, integers_at, bytes_at = (_array(kind, 1) for kind in (types.float32, types.int64, types.uint8))
byte_table_at, small_table_at = (_array(kind, 2) for kind in (types.uint8, types.int32))
table_at = _array(types.int64, 2)
