"""The vector type and its sine: sixteen results that sixteen single computations give."""

import numpy as np
from numba import njit

from evenroad.robot.kernel.forward_kinematics import sine_and_cosine
from evenroad.robot.kernel.lane_memory import column, load, load_angles, load_vector, row, store, store_vector
from evenroad.robot.kernel.lanes import (
    absolute,
    below_zero,
    box_of_lanes,
    dot,
    larger,
    lowest_bit,
    minus,
    plus,
    smaller,
    square_root,
    times,
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
    return below_zero(x), lowest_bit(below_zero(x))


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
    below, first = _every_operation(a, b, number, out)
    expected = [
        a + b, a - number, number * b, a / b, np.minimum(a, b), np.maximum(a, number), np.abs(a),
        np.sqrt(np.abs(a)), np.copysign(b, a),
    ]  # fmt: skip
    np.testing.assert_allclose(out.reshape(9, 16), expected, rtol=2e-7)
    assert below == sum(1 << lane for lane in range(16) if a[lane] < 0.0)
    assert first == np.flatnonzero(a < 0.0)[0]


def test_zero_is_not_below_zero():
    out = np.empty(144, dtype=np.float32)
    zeros, ones = np.zeros(16, dtype=np.float32), np.ones(16, dtype=np.float32)
    ones[3] = zeros[3] = -1.0
    assert _every_operation(zeros, ones, np.float32(1.0), out)[0] == 1 << 3


@njit(cache=True)
def _every_operation_on_vectors(a, b, ints, angles, out):
    x, y = load_vector(a, 0), load_vector(b, 0)
    three, number = row(b, 16, 3), column(b, 1, 2)[1]
    store_vector(out, 0, plus(x, y))
    store_vector(out, 48, minus(x, three))
    store_vector(out, 96, times(x, load(b, 0)))
    store_vector(out, 144, absolute(x))
    store_vector(out, 192, plus(x, number))
    store(out, 240, dot(x, y))
    store(out, 256, dot(x, three))
    centre, half = box_of_lanes(x, absolute(y))
    store_vector(out, 272, centre)
    store_vector(out, 320, half)
    store(out, 368, load_angles(angles, 1, 3.0, 0.5, 2.0 * np.pi))
    store(out, 384, load_angles(angles, 1, 3.0, 0.5, 0.0))
    return row(ints, 1, 2)


def test_operations_on_vectors_are_those_of_three_times_sixteen_numbers():
    rng = np.random.default_rng(2)
    x, y = rng.normal(size=(2, 3, 16)).astype(np.float32)
    angles, out = 1e4 * rng.normal(size=17), np.empty(400, dtype=np.float32)
    ints = np.array([5, -6, 7])
    assert _every_operation_on_vectors(x.ravel(), y.ravel(), ints, angles, out) == (-6, 7)
    three, number = y.ravel()[16:19], y.ravel()[17]
    low, high = (x - np.abs(y)).min(axis=1), (x + np.abs(y)).max(axis=1)
    expected = [
        x + y, x - three[:, np.newaxis], x * y[0], np.abs(x), x + number,
        (x * y).sum(axis=0), three @ x, *(np.repeat(box, 16).reshape(3, 16) for box in (low + high, high - low)),
    ]  # fmt: skip
    expected[-2:] = [0.5 * box for box in expected[-2:]]
    np.testing.assert_allclose(
        out[:368], np.concatenate([each.ravel() for each in expected]), rtol=2e-6, atol=1e-6
    )
    values = 3.0 * angles[1:] + 0.5
    np.testing.assert_allclose(out[384:], values, rtol=1e-7)
    np.testing.assert_allclose(out[368:384], np.remainder(values + np.pi, 2.0 * np.pi) - np.pi, atol=1e-6)
