"""The vector type and its sine: sixteen results that sixteen single computations give."""

import numpy as np
from numba import njit

from evenroad.robot.kernel.lanes import (
    absolute,
    below_zero,
    larger,
    largest_lane,
    load,
    lowest_bit,
    sine_and_cosine,
    smaller,
    smallest_lane,
    square_root,
    store,
    with_sign_of,
)


@njit(cache=True)
def _sines(angles, sines, cosines):
    for place in range(0, len(angles), 16):
        sine, cosine = sine_and_cosine(load(angles, place))
        store(sines, place, sine)
        store(cosines, place, cosine)


@njit(cache=True)
def _every_operation(a, b, number, out):
    x, y = load(a, 0), load(b, 0)
    store(out, 0, x + y)
    store(out, 16, x - number)
    store(out, 32, number * y)
    store(out, 48, x / y)
    store(out, 64, smaller(x, y))
    store(out, 80, larger(x, number))
    store(out, 96, absolute(x))
    store(out, 112, square_root(absolute(x)))
    store(out, 128, with_sign_of(absolute(y), x))
    return smallest_lane(x), largest_lane(x), below_zero(x), lowest_bit(below_zero(x))


def test_sine_and_cosine_err_by_little_more_than_rounding():
    angles = np.concatenate([np.linspace(-np.pi, np.pi, 99_995), np.pi * np.arange(-2, 3) / 2.0]).astype(
        np.float32
    )
    sines, cosines = np.empty_like(angles), np.empty_like(angles)
    _sines(angles, sines, cosines)
    exact = angles.astype(np.float64)
    assert np.abs(sines - np.sin(exact)).max() < 1.5e-7
    assert np.abs(cosines - np.cos(exact)).max() < 1.5e-7


def test_operations_are_those_of_sixteen_numbers():
    rng = np.random.default_rng(1)
    a, b = rng.normal(size=(2, 16)).astype(np.float32)
    number = np.float32(0.3)
    out = np.empty(144, dtype=np.float32)
    low, high, below, first = _every_operation(a, b, number, out)
    expected = [
        a + b, a - number, number * b, a / b, np.minimum(a, b), np.maximum(a, number), np.abs(a),
        np.sqrt(np.abs(a)), np.copysign(b, a),
    ]  # fmt: skip
    np.testing.assert_allclose(out.reshape(9, 16), expected, rtol=2e-7)
    assert (low, high) == (a.min(), a.max())
    assert below == sum(1 << lane for lane in range(16) if a[lane] < 0.0)
    assert first == np.flatnonzero(a < 0.0)[0]


def test_zero_is_not_below_zero():
    out = np.empty(144, dtype=np.float32)
    zeros, ones = np.zeros(16, dtype=np.float32), np.ones(16, dtype=np.float32)
    ones[3] = zeros[3] = -1.0
    assert _every_operation(zeros, ones, np.float32(1.0), out)[2] == 1 << 3
