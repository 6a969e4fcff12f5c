"""Addresses in compiled code: of functions, to call them, and of arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

DOUBLES = types.CPointer(types.float64)
SINGLES = types.CPointer(types.float32)
INTEGERS = types.CPointer(types.int64)


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


def _pointer(kind: types.CPointer) -> Callable[..., Any]:
    """Return an intrinsic that takes an address for a pointer of this kind."""

    @intrinsic
    def pointer(typing_context: Any, address: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
            return builder.inttoptr(args[0], context.get_value_type(kind))

        return kind(types.int64), lower

    return pointer


doubles_at, singles_at, integers_at = _pointer(DOUBLES), _pointer(SINGLES), _pointer(INTEGERS)


@intrinsic
def address_of(typing_context: Any, array: Any) -> Any:
    """Return where an array begins in memory."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        return builder.ptrtoint(data, ir.IntType(64))

    return types.int64(array), lower
