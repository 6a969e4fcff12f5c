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

from evenroad.robot.kernel.layout import LANES, inlined

_FLOAT = ir.FloatType()
_VECTOR = ir.VectorType(_FLOAT, LANES)
_BITS = ir.VectorType(ir.IntType(32), LANES)
_FLAGS = ("nnan", "ninf", "nsz", "contract")


class LanesType(types.Type):
    """The type of sixteen float32 numbers in compiled code."""

    def __init__(self) -> None:
        super().__init__(name=f"float32x{LANES}")


LANES_TYPE = LanesType()


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: LanesType) -> None:
        super().__init__(manager, kind, _VECTOR)


def _spread(builder: ir.IRBuilder, number: ir.Value) -> ir.Value:
    """Return `number` in all lanes."""
    undefined = ir.Constant(_VECTOR, ir.Undefined)
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


def _elementwise(name: str) -> Callable[..., Any]:
    """Return an intrinsic that applies one of LLVM's to each lane."""

    @intrinsic
    def apply(typing_context: Any, a: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
            return _call(builder, f"llvm.{name}.v{LANES}f32", _VECTOR, args[0])

        return (LANES_TYPE(a), lower) if _is_lanes(a) else None

    return apply


def _choice(comparison: str) -> Callable[..., Any]:
    """Return an intrinsic that takes in each lane the one of two numbers for which the comparison holds."""

    @intrinsic
    def choose(typing_context: Any, a: Any, b: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
            first, second = _as_vectors(builder, sig, args)
            return builder.select(
                builder.fcmp_ordered(comparison, first, second, flags=_FLAGS), first, second
            )

        return LANES_TYPE(a, b if _is_lanes(b) else types.float32), lower

    return choose


def _over_lanes(name: str) -> Callable[..., Any]:
    """Return an intrinsic that makes one number of all lanes."""

    @intrinsic
    def reduce(typing_context: Any, a: Any) -> Any:
        def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
            return _call(builder, f"llvm.vector.reduce.{name}.v{LANES}f32", _FLOAT, args[0])

        return (types.float32(a), lower) if _is_lanes(a) else None

    return reduce


absolute = _elementwise("fabs")
square_root = _elementwise("sqrt")
smaller = _choice("<")
larger = _choice(">")
smallest_lane = _over_lanes("fmin")
largest_lane = _over_lanes("fmax")


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


def _pointer(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
    array = context.make_array(sig.args[0])(context, builder, args[0])
    place = builder.gep(array.data, [args[1]], inbounds=True)
    return builder.bitcast(place, _VECTOR.as_pointer())


@intrinsic
def load(typing_context: Any, array: Any, place: Any) -> Any:
    """Return the sixteen numbers of a float32 array from `place` on."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        loaded = builder.load(_pointer(context, builder, sig, args))
        # Any place will do: where it is a multiple of 64 bytes, as in scratch memory, that costs nothing.
        loaded.align = 4
        return loaded

    return LANES_TYPE(array, types.intp), lower


@intrinsic
def store(typing_context: Any, array: Any, place: Any, lanes: Any) -> Any:
    """Write sixteen numbers to a float32 array from `place` on."""

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> ir.Value:
        stored = builder.store(args[2], _pointer(context, builder, sig, args))
        stored.align = 4
        return context.get_dummy_value()

    return types.void(array, types.intp, lanes), lower


ZERO = np.float32(0.0)
ONE = np.float32(1.0)

_PI = np.float32(np.pi)
_HALF_PI = np.float32(0.5 * np.pi)

# x + S3 x^3 + S5 x^5 + S7 x^7 + S9 x^9 nearest to sin x on [-pi/2, pi/2] in the largest error (by Lawson's
# reweighted least squares, 1961): 4.6e-9, or 1.7e-8 with coefficients of single precision.  Taylor's series, or
# one made for pi/4, errs by 1e-4 there.
_S3 = np.float32(-0.16666657096)
_S5 = np.float32(0.0083330172914)
_S7 = np.float32(-0.00019806615190)
_S9 = np.float32(2.6000547418e-06)


@inlined
def sine_and_cosine(angle: Any) -> Any:
    """Return the sines and cosines of sixteen angles from -pi to pi [rad], to 2e-7."""
    size = absolute(angle)
    # sin x = sin(pi - x); cos x = sin(pi/2 - |x|).
    sine = with_sign_of(_sine_within_a_quarter(smaller(_PI - size, size)), angle)
    return sine, _sine_within_a_quarter(_HALF_PI - size)


@inlined
def _sine_within_a_quarter(angle: Any) -> Any:
    square = angle * angle
    return angle + angle * square * (_S3 + square * (_S5 + square * (_S7 + square * _S9)))
