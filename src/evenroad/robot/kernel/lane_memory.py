"""Lanes in memory: sixteen numbers, vectors of them, and rows of tables, read and written by compiled code."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from evenroad.robot.kernel.lanes import LANES_TYPE, VECTOR, VECTOR_TYPE, spread_over
from evenroad.robot.kernel.layout import LANES

_WIDE = ir.VectorType(ir.DoubleType(), LANES)


def _pointer(context: Any, builder: Any, kind: Any, array: Any, index: Any, *, number: ir.Type) -> ir.Value:
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [index], inbounds=True), number.as_pointer())


def _loaded(builder: ir.IRBuilder, pointer: ir.Value, axis: int = 0) -> ir.Value:
    value = builder.load(builder.gep(pointer, [ir.Constant(ir.IntType(64), axis)]) if axis else pointer)
    # Any place will do: where it is a multiple of 64 bytes, as in scratch memory, that costs nothing.
    value.align = 4
    return value


def _stored(builder: ir.IRBuilder, pointer: ir.Value, value: ir.Value, axis: int = 0) -> None:
    index = builder.gep(pointer, [ir.Constant(ir.IntType(64), axis)]) if axis else pointer
    builder.store(value, index).align = 4


@intrinsic
def load(typing_context: Any, array: Any, index: Any) -> Any:
    """Return the sixteen numbers of a float32 array from `index` on."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        return _loaded(builder, _pointer(context, builder, array, *args, number=VECTOR))

    return LANES_TYPE(array, types.intp), lower


@intrinsic
def store(typing_context: Any, array: Any, index: Any, lanes: Any) -> Any:
    """Write sixteen numbers to a float32 array from `index` on."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        _stored(builder, _pointer(context, builder, array, *args[:2], number=VECTOR), args[2])
        return context.get_dummy_value()

    return types.void(array, types.intp, lanes), lower


@intrinsic
def load_vector(typing_context: Any, array: Any, index: Any) -> Any:
    """Return three times sixteen numbers of a float32 array from `index` on: x, y, z."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        pointer = _pointer(context, builder, array, *args, number=VECTOR)
        return context.make_tuple(
            builder, VECTOR_TYPE, [_loaded(builder, pointer, axis) for axis in range(3)]
        )

    return VECTOR_TYPE(array, types.intp), lower


@intrinsic
def store_vector(typing_context: Any, array: Any, index: Any, vector: Any) -> Any:
    """Write a vector to a float32 array from `index` on, as `load_vector` reads it."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        pointer = _pointer(context, builder, array, *args[:2], number=VECTOR)
        for axis, value in enumerate(cgutils.unpack_tuple(builder, args[2])):
            _stored(builder, pointer, value, axis)
        return context.get_dummy_value()

    return types.void(array, types.intp, vector), lower


def _numbers(stride: int) -> Callable[..., Any]:
    """Return an intrinsic that gives so many numbers of an array, a literal, from a place on, `stride` apart.

    Indexing would first look whether the place is below 0, and would be compiled by numba number by number.
    """

    @intrinsic(prefer_literal=True)
    def numbers(typing_context: Any, array: Any, index: Any, count: Any) -> Any:
        kind = types.UniTuple(array.dtype, count.literal_value)

        def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
            pointer = _pointer(context, builder, array, *args[:2], number=context.get_data_type(array.dtype))
            fields = (
                builder.gep(pointer, [ir.Constant(ir.IntType(64), i * stride)]) for i in range(kind.count)
            )
            return context.make_tuple(builder, kind, [builder.load(each) for each in fields])

        return kind(array, types.intp, count), lower

    return numbers


row, column = _numbers(1), _numbers(LANES)


@intrinsic
def store_along(typing_context: Any, array: Any, index: Any, begin: Any, shares: Any, direction: Any) -> Any:
    """Write ``begin + share * direction`` to a float64 array from `index` on, for the sixteen shares of another."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        first = ir.Constant(ir.IntType(64), 0)
        share = _loaded(builder, _pointer(context, builder, shares, args[3], first, number=_WIDE))
        done = builder.fmul(share, spread_over(builder, args[4], _WIDE))
        value = builder.fadd(spread_over(builder, args[2], _WIDE), done)
        _stored(builder, _pointer(context, builder, array, *args[:2], number=_WIDE), value)
        return context.get_dummy_value()

    return types.void(array, types.intp, types.float64, shares, types.float64), lower


@intrinsic
def load_angles(typing_context: Any, array: Any, index: Any, multiplier: Any, offset: Any, turn: Any) -> Any:
    """Return multiples and more of sixteen numbers of a float64 array, less whole turns, unless a turn is 0.

    Computed in double precision: single precision has no digits for a large angle.
    """

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        values = _loaded(builder, _pointer(context, builder, array, *args[:2], number=_WIDE))
        factor, summand, period = (spread_over(builder, arg, _WIDE) for arg in args[2:])
        values = builder.fadd(builder.fmul(values, factor), summand)
        turns = builder.fmul(values, ir.Constant(_WIDE, [0.5 / np.pi] * LANES))
        rint = cgutils.get_or_insert_function(
            builder.module, ir.FunctionType(_WIDE, [_WIDE]), f"llvm.rint.v{LANES}f64"
        )
        return builder.fptrunc(
            builder.fsub(values, builder.fmul(period, builder.call(rint, [turns]))), VECTOR
        )

    return LANES_TYPE(array, types.intp, types.float64, types.float64, types.float64), lower
