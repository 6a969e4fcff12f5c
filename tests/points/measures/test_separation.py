"""Separation and the Riesz energy against double loops, and where floats end."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.errors import InvalidValue
from evenroad.points.measures.separation import log_riesz_of_columns, riesz_rooted, separation
from tests.differences import slopes
from tests.refused import refused


def slow_separation(points, periodic):
    gaps = np.abs(points[:, None] - points[None])
    if periodic:
        gaps = np.minimum(gaps, 1 - gaps)
    distances = np.linalg.norm(gaps, axis=2)
    return min(distances[i, j] for i in range(len(points)) for j in range(i))


@pytest.mark.parametrize("periodic", [False, True])
@pytest.mark.parametrize(("n", "d"), [(2, 1), (30, 1), (50, 3), (20, 14)])
def test_separation_is_the_smallest_distance_of_two_points(n, d, periodic):
    points = np.random.default_rng(n).random((n, d))
    assert separation(points, periodic) == pytest.approx(slow_separation(points, periodic), rel=1e-12)


def test_coincident_points_have_separation_zero_a_huge_energy_and_no_nan():
    assert separation(np.full((2, 3), 0.5)) == 0.0
    assert separation([[0.0, 0.0], [0.5, 0.5], [0.0, 0.0]], periodic=True) == 0.0
    points = np.full((3, 4), 0.25)
    assert riesz_rooted(points) > 1e90
    assert not log_riesz(points, want_gradient=True)[1].any()


def log_riesz(points, s=None, periodic=True, want_gradient=False):
    columns = np.ascontiguousarray(points.T)
    return log_riesz_of_columns(columns, s or 2 * len(columns), periodic, want_gradient)


def slow_energy(points, s, periodic):
    n, d = points.shape
    total = 0.0
    for i in range(n):
        for j in range(n):
            if i != j:
                gap = np.abs(points[i] - points[j])
                if periodic:
                    gap = np.minimum(gap, 1 - gap)
                total += (n ** (-1 / d) / np.linalg.norm(gap)) ** s
    return total / n


def random_points(n, d, seed=0):
    return np.random.default_rng(seed).random((n, d))


@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize(("n", "d", "s"), [
    (2, 1, 1), (9, 1, 2), (20, 2, 3), (20, 3, None), (7, 5, 7), (12, 14, None), (40, 2, 1),
])  # fmt: skip
def test_the_energy_is_the_double_loop(n, d, s, periodic):
    points = random_points(n, d, seed=n)
    expected = slow_energy(points, s or 2 * d, periodic)
    assert math.exp(log_riesz(points, s, periodic)[0]) == pytest.approx(expected, rel=1e-12)
    assert riesz_rooted(points, s, periodic) == pytest.approx(expected ** (1 / (s or 2 * d)), rel=1e-12)


@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize(("d", "s"), [(1, 1), (2, None), (3, 5), (6, None)])
def test_gradients_are_those_of_central_differences(d, s, periodic):
    points = random_points(7, d, seed=1)
    value, gradient = log_riesz(points, s, periodic, want_gradient=True)
    assert value == log_riesz(points, s, periodic)[0]
    assert math.exp(value / (s or 2 * d)) == riesz_rooted(points, s, periodic)
    slow = slopes(lambda x: log_riesz(x, s, periodic)[0], points)
    np.testing.assert_allclose(gradient.T, slow, atol=1e-6 * np.abs(slow).max())


@settings(max_examples=30)
@given(seed=st.integers(0, 10**6), n=st.integers(2, 12), d=st.integers(1, 6))
def test_the_periodic_energy_does_not_feel_shifts_and_reflections(seed, n, d):
    rng = np.random.default_rng(seed)
    points = rng.random((n, d))
    moved = (np.where(rng.random(d) < 0.5, 1 - points, points)[:, rng.permutation(d)] + rng.random(d)) % 1.0
    assert riesz_rooted(moved) == pytest.approx(riesz_rooted(points), rel=1e-6)


def test_the_root_of_a_large_exponent_is_spacing_over_separation():
    points = random_points(30, 2)
    limit = 30 ** (-1 / 2) / separation(points, periodic=True)
    assert riesz_rooted(points, s=2000) == pytest.approx(limit, rel=1e-2)


def test_the_root_of_an_energy_beyond_floats_is_a_float():
    points = np.array([[0.5] * 14, [0.5] * 13 + [0.5 + 1e-14], [0.1] * 14])
    assert log_riesz(points)[0] > 710
    spacing, distance = 3 ** (-1 / 14), points[1, 13] - 0.5
    assert riesz_rooted(points) == pytest.approx(spacing / distance * (2 / 3) ** (1 / 28), rel=1e-9)
    gradient = log_riesz(points, want_gradient=True)[1] / 28
    assert np.isfinite(gradient).all()
    assert gradient[13, 0] > 0 > gradient[13, 1]
    assert gradient[13, 0] == pytest.approx(1 / distance, rel=1e-9)


@pytest.mark.parametrize("n", [0, 1])
@pytest.mark.parametrize("measure", [separation, riesz_rooted])
def test_fewer_than_two_points_have_neither(measure, n):
    refused(InvalidValue, f"at least 2 points, got {n}", measure, np.zeros((n, 2)))


@pytest.mark.parametrize("s", [0, -2, 1.5, True, "4"])
def test_an_exponent_that_is_no_positive_integer_is_refused(s):
    refused(InvalidValue, "s must be an integer >= 1", riesz_rooted, [[0.1], [0.2]], s=s)
