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
VECTOR = ir.VectorType(_FLOAT, LANES)
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
        super().__init__(manager, kind, VECTOR)


def spread_over(builder: ir.IRBuilder, number: ir.Value, kind: ir.Type = VECTOR) -> ir.Value:
    """Return `number` in all lanes."""
    undefined = ir.Constant(kind, ir.Undefined)
    one = builder.insert_element(undefined, number, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(one, undefined, ir.Constant(_BITS, [0] * LANES))


def _as_vectors(builder: ir.IRBuilder, sig: Any, args: Any) -> list[ir.Value]:
    return [
        arg if kind == LANES_TYPE else spread_over(builder, arg)
        for kind, arg in zip(sig.args, args, strict=True)
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
            results = [_call(builder, f"llvm.{name}.v{LANES}f32", VECTOR, value) for value in values]
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
    return [each if each.type == VECTOR else spread_over(builder, each) for each in values]


absolute = _elementwise("fabs")
square_root = _elementwise("sqrt")
smaller = _choice("<")
larger = _choice(">")
plus, minus, times = _by_axis("fadd"), _by_axis("fsub"), _by_axis("fmul")


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
        half = spread_over(builder, ir.Constant(_FLOAT, 0.5))
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
        return spread_over(builder, args[0])

    return LANES_TYPE(types.float32), lower


@intrinsic
def with_sign_of(typing_context: Any, size: Any, sign: Any) -> Any:
    """Return the numbers `size` >= 0 with the signs of `sign`."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        return _call(builder, f"llvm.copysign.v{LANES}f32", VECTOR, *args)

    return LANES_TYPE(size, sign), lower


@intrinsic
def below_zero(typing_context: Any, a: Any) -> Any:
    """Return an int64 whose bit w is set where lane w is below zero."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        below = builder.fcmp_ordered("<", args[0], ir.Constant(VECTOR, [0.0] * LANES), flags=_FLAGS)
        return builder.zext(builder.bitcast(below, ir.IntType(LANES)), ir.IntType(64))

    return types.int64(a), lower


@intrinsic
def lowest_bit(typing_context: Any, bits: Any) -> Any:
    """Return the number of the lowest bit that is set in an int64, which must not be 0."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        return builder.cttz(args[0], ir.Constant(ir.IntType(1), 1))

    return types.int64(types.int64), lower


ZERO = np.float32(0.0)
ONE = np.float32(1.0)
