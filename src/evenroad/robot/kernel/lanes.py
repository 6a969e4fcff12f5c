"""Sixteen single-precision numbers as one value in compiled code: an LLVM vector with operators and a sine of its own.

Loops over lanes are left to a compiler's guess; a vector type is not, and runs several times faster here.
Additions and multiplications may be fused, and no operation expects NaN or infinities: callers refuse
them.  Results do not depend on the other lanes, nor are sums ever reordered.  They are the same bits on one kind of
processor: another may fuse other operations.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

from evenroad.robot.kernel.layout import LANES

_FLOAT = ir.FloatType()
_VECTOR = ir.VectorType(_FLOAT, LANES)
_WIDE = ir.VectorType(ir.DoubleType(), LANES)
_BITS = ir.VectorType(ir.IntType(32), LANES)
_FLAGS = ("nnan", "ninf", "nsz", "contract")


class LanesType(types.Type):
    """The type of sixteen float32 numbers in compiled code."""

    def __init__(self) -> None:
        super().__init__(name=f"float32x{LANES}")


LANES_TYPE = LanesType()
VECTOR_TYPE = types.UniTuple(LANES_TYPE, 3)


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: LanesType) -> None:
        super().__init__(manager, kind, _VECTOR)


def _spread(builder: ir.IRBuilder, number: ir.Value, kind: ir.Type = _VECTOR) -> ir.Value:
    """Return `number` in all lanes."""
    undefined = ir.Constant(kind, ir.Undefined)
    one = builder.insert_element(undefined, number, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(one, undefined, ir.Constant(_BITS, [0] * LANES))


def _as_vectors(builder: ir.IRBuilder, sig: Any, args: Any) -> list[ir.Value]:
    return [
        arg if kind == LANES_TYPE else _spread(builder, arg) for kind, arg in zip(sig.args, args, strict=True)
    ]


def _register_operator(key: Any, instruction: str) -> None:
    """Let `key` take two lanes values, or one and a number that stands for all lanes."""

    class _Template(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            first, second = args
            if LANES_TYPE not in (first, second):
                return None
            kinds = [kind if kind == LANES_TYPE else types.float32 for kind in (first, second)]
            return signature(LANES_TYPE, *kinds)

    _Template.key = key
    infer_global(key)(_Template)

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        return getattr(builder, instruction)(*_as_vectors(builder, sig, args), flags=_FLAGS)

    for kinds in ((LANES_TYPE, LANES_TYPE), (LANES_TYPE, types.float32), (types.float32, LANES_TYPE)):
        lower_builtin(key, *kinds)(lower)


for _key, _instruction in (
    (operator.add, "fadd"),
    (operator.sub, "fsub"),
    (operator.mul, "fmul"),
    (operator.truediv, "fdiv"),
):
    _register_operator(_key, _instruction)


def _is_lanes(*kinds: Any) -> bool:
    return all(kind == LANES_TYPE for kind in kinds)


def _call(builder: ir.IRBuilder, name: str, result: ir.Type, *args: ir.Value) -> ir.Value:
    kind = ir.FunctionType(result, [arg.type for arg in args])
    return builder.call(cgutils.get_or_insert_function(builder.module, kind, name), args, fastmath=_FLAGS)


def _chosen(builder: ir.IRBuilder, comparison: str, first: ir.Value, second: ir.Value) -> ir.Value:
    return builder.select(builder.fcmp_ordered(comparison, first, second, flags=_FLAGS), first, second)


def _shuffled(builder: ir.IRBuilder, first: ir.Value, second: ir.Value, lanes: list[int]) -> ir.Value:
    return builder.shuffle_vector(first, second, ir.Constant(_BITS, lanes))


def _elementwise(name: str) -> Callable[..., Any]:
    """Return an intrinsic that applies one of LLVM's to each lane of one value, or of each axis."""

    @intrinsic
    def apply(typing_context: Any, a: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
            values = [args[0]] if _is_lanes(a) else cgutils.unpack_tuple(builder, args[0])
            results = [_call(builder, f"llvm.{name}.v{LANES}f32", _VECTOR, value) for value in values]
            return results[0] if _is_lanes(a) else context.make_tuple(builder, a, results)

        return a(a), lower

    return apply


def _choice(comparison: str) -> Callable[..., Any]:
    """Return an intrinsic that takes in each lane the one of two numbers for which the comparison holds."""

    @intrinsic
    def choose(typing_context: Any, a: Any, b: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
            return _chosen(builder, comparison, *_as_vectors(builder, sig, args))

        return LANES_TYPE(a, b if _is_lanes(b) else types.float32), lower

    return choose


def _by_axis(instruction: str) -> Callable[..., Any]:
    """Return an intrinsic of two vectors, each a tuple of three, or of one and what holds for every axis."""

    @intrinsic
    def apply(typing_context: Any, a: Any, b: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
            results = [
                getattr(builder, instruction)(x, y, flags=_FLAGS)
                for x, y in zip(
                    *(_axes(builder, *each) for each in zip(args, sig.args, strict=True)), strict=True
                )
            ]
            return context.make_tuple(builder, VECTOR_TYPE, results)

        return VECTOR_TYPE(a, b), lower

    return apply


def _axes(builder: ir.IRBuilder, value: ir.Value, kind: Any) -> list[ir.Value]:
    """Return the three lanes values of a vector, of three numbers, or three times one of either."""
    values = cgutils.unpack_tuple(builder, value) if isinstance(kind, types.UniTuple) else [value] * 3
    return [each if each.type == _VECTOR else _spread(builder, each) for each in values]


absolute = _elementwise("fabs")
square_root = _elementwise("sqrt")
smaller = _choice("<")
larger = _choice(">")
plus, minus, times = _by_axis("fadd"), _by_axis("fsub"), _by_axis("fmul")


@intrinsic
def smallest_lane(typing_context: Any, a: Any) -> Any:
    """Return the least of sixteen numbers."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        return _call(builder, f"llvm.vector.reduce.fmin.v{LANES}f32", _FLOAT, args[0])

    return types.float32(a), lower


@intrinsic
def dot(typing_context: Any, a: Any, b: Any) -> Any:
    """Return the inner product of two vectors, of which one may be three float32 numbers."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        a_axes, b_axes = (_axes(builder, *each) for each in zip(args, sig.args, strict=True))
        x, y, z = (builder.fmul(*pair, flags=_FLAGS) for pair in zip(a_axes, b_axes, strict=True))
        return builder.fadd(builder.fadd(x, y, flags=_FLAGS), z, flags=_FLAGS)

    return LANES_TYPE(a, b), lower


@intrinsic
def box_of_lanes(typing_context: Any, centre: Any, extents: Any) -> Any:
    """Return centre and half extents, each number in all lanes, of the box around sixteen boxes."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        half = _spread(builder, ir.Constant(_FLOAT, 0.5))
        lows, highs = [], []
        for c, u in zip(*(cgutils.unpack_tuple(builder, arg) for arg in args), strict=True):
            lows.append(builder.fsub(c, u, flags=_FLAGS))
            highs.append(builder.fneg(builder.fadd(c, u, flags=_FLAGS), flags=_FLAGS))
        # Pairs of values share a vector, then four, then all six: a quarter of the steps of six sums over lanes.
        values = [*lows, *highs, *lows[:2]]
        for width in (8, 4, 2, 1):
            evens = [lane for lane in range(2 * LANES) if lane // width % 2 == 0]
            odds = [lane + width for lane in evens]
            values = [
                _chosen(builder, "<", _shuffled(builder, a, b, evens), _shuffled(builder, a, b, odds))
                for a, b in zip(values[0::2], values[1::2] or values, strict=True)
            ]
        low = values[0]
        minus_high = _shuffled(builder, low, low, [3, 4, 5, *range(3, LANES)])
        middle = builder.fmul(half, builder.fsub(low, minus_high, flags=_FLAGS), flags=_FLAGS)
        wide = builder.fmul(
            half, builder.fneg(builder.fadd(low, minus_high, flags=_FLAGS), flags=_FLAGS), flags=_FLAGS
        )
        results = [
            context.make_tuple(
                builder, VECTOR_TYPE, [_shuffled(builder, each, each, [axis] * LANES) for axis in range(3)]
            )
            for each in (middle, wide)
        ]
        return context.make_tuple(builder, sig.return_type, results)

    return types.UniTuple(VECTOR_TYPE, 2)(centre, extents), lower


@intrinsic
def spread(typing_context: Any, number: Any) -> Any:
    """Return a float32 number in all lanes."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        return _spread(builder, args[0])

    return LANES_TYPE(types.float32), lower


@intrinsic
def with_sign_of(typing_context: Any, size: Any, sign: Any) -> Any:
    """Return the numbers `size` >= 0 with the signs of `sign`."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        return _call(builder, f"llvm.copysign.v{LANES}f32", _VECTOR, *args)

    return LANES_TYPE(size, sign), lower


@intrinsic
def below_zero(typing_context: Any, a: Any) -> Any:
    """Return an int64 whose bit w is set where lane w is below zero."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        below = builder.fcmp_ordered("<", args[0], ir.Constant(_VECTOR, [0.0] * LANES), flags=_FLAGS)
        return builder.zext(builder.bitcast(below, ir.IntType(LANES)), ir.IntType(64))

    return types.int64(a), lower


@intrinsic
def lowest_bit(typing_context: Any, bits: Any) -> Any:
    """Return the number of the lowest bit that is set in an int64, which must not be 0."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        return builder.cttz(args[0], ir.Constant(ir.IntType(1), 1))

    return types.int64(types.int64), lower


def _pointer(context: Any, builder: Any, kind: Any, array: Any, place: Any, *, number: ir.Type) -> ir.Value:
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [place], inbounds=True), number.as_pointer())


def _loaded(builder: ir.IRBuilder, pointer: ir.Value, axis: int = 0) -> ir.Value:
    value = builder.load(builder.gep(pointer, [ir.Constant(ir.IntType(64), axis)]) if axis else pointer)
    # Any place will do: where it is a multiple of 64 bytes, as in scratch memory, that costs nothing.
    value.align = 4
    return value


def _stored(builder: ir.IRBuilder, pointer: ir.Value, value: ir.Value, axis: int = 0) -> None:
    place = builder.gep(pointer, [ir.Constant(ir.IntType(64), axis)]) if axis else pointer
    builder.store(value, place).align = 4


@intrinsic
def load(typing_context: Any, array: Any, place: Any) -> Any:
    """Return the sixteen numbers of a float32 array from `place` on."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        return _loaded(builder, _pointer(context, builder, array, *args, number=_VECTOR))

    return LANES_TYPE(array, types.intp), lower


@intrinsic
def store(typing_context: Any, array: Any, place: Any, lanes: Any) -> Any:
    """Write sixteen numbers to a float32 array from `place` on."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        _stored(builder, _pointer(context, builder, array, *args[:2], number=_VECTOR), args[2])
        return context.get_dummy_value()

    return types.void(array, types.intp, lanes), lower


@intrinsic
def load_vector(typing_context: Any, array: Any, place: Any) -> Any:
    """Return three times sixteen numbers of a float32 array from `place` on: x, y, z."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        pointer = _pointer(context, builder, array, *args, number=_VECTOR)
        return context.make_tuple(
            builder, VECTOR_TYPE, [_loaded(builder, pointer, axis) for axis in range(3)]
        )

    return VECTOR_TYPE(array, types.intp), lower


@intrinsic
def store_vector(typing_context: Any, array: Any, place: Any, vector: Any) -> Any:
    """Write a vector to a float32 array from `place` on, as `load_vector` reads it."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        pointer = _pointer(context, builder, array, *args[:2], number=_VECTOR)
        for axis, value in enumerate(cgutils.unpack_tuple(builder, args[2])):
            _stored(builder, pointer, value, axis)
        return context.get_dummy_value()

    return types.void(array, types.intp, vector), lower


def _numbers(stride: int) -> Callable[..., Any]:
    """Return an intrinsic that gives so many numbers of an array, a literal, from a place on, `stride` apart.

    Indexing would first look whether the place is below 0, and would be compiled by numba number by number.
    """

    @intrinsic(prefer_literal=True)
    def numbers(typing_context: Any, array: Any, place: Any, count: Any) -> Any:
        kind = types.UniTuple(array.dtype, count.literal_value)

        def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
            pointer = _pointer(context, builder, array, *args[:2], number=context.get_data_type(array.dtype))
            places = (
                builder.gep(pointer, [ir.Constant(ir.IntType(64), i * stride)]) for i in range(kind.count)
            )
            return context.make_tuple(builder, kind, [builder.load(each) for each in places])

        return kind(array, types.intp, count), lower

    return numbers


row, column = _numbers(1), _numbers(LANES)


@intrinsic
def store_along(typing_context: Any, array: Any, place: Any, begin: Any, shares: Any, way: Any) -> Any:
    """Write ``begin + share * way`` to a float64 array from `place` on, for the sixteen shares of another."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        first = ir.Constant(ir.IntType(64), 0)
        share = _loaded(builder, _pointer(context, builder, shares, args[3], first, number=_WIDE))
        done = builder.fmul(share, _spread(builder, args[4], _WIDE))
        value = builder.fadd(_spread(builder, args[2], _WIDE), done)
        _stored(builder, _pointer(context, builder, array, *args[:2], number=_WIDE), value)
        return context.get_dummy_value()

    return types.void(array, types.intp, types.float64, shares, types.float64), lower


@intrinsic
def load_angles(typing_context: Any, array: Any, place: Any, multiplier: Any, offset: Any, turn: Any) -> Any:
    """Return multiples and more of sixteen numbers of a float64 array, less whole turns, unless a turn is 0.

    Computed in double precision: single precision has no digits for a large angle.
    """

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        values = _loaded(builder, _pointer(context, builder, array, *args[:2], number=_WIDE))
        factor, summand, period = (_spread(builder, arg, _WIDE) for arg in args[2:])
        values = builder.fadd(builder.fmul(values, factor), summand)
        turns = builder.fmul(values, ir.Constant(_WIDE, [0.5 / np.pi] * LANES))
        rint = cgutils.get_or_insert_function(
            builder.module, ir.FunctionType(_WIDE, [_WIDE]), f"llvm.rint.v{LANES}f64"
        )
        return builder.fptrunc(
            builder.fsub(values, builder.fmul(period, builder.call(rint, [turns]))), _VECTOR
        )

    return LANES_TYPE(array, types.intp, types.float64, types.float64, types.float64), lower


ZERO = np.float32(0.0)
ONE = np.float32(1.0)
