"""SO3: the contract, and agreement with scipy's rotations."""

import math

import numpy as np
import pytest
from scipy import stats
from scipy.spatial.transform import Rotation, Slerp

from evenroad.errors import InvalidValue
from evenroad.space import SO3
from evenroad.testing import SpaceContract
from tests.refused import refused

IDENTITY = np.array([[1.0, 0.0, 0.0, 0.0]])


class TestSO3(SpaceContract):
    space = SO3()


@pytest.fixture
def pair():
    u = np.random.default_rng(0).random((200, 3))
    return SO3().from_cube(u[:100]), SO3().from_cube(u[100:])


def as_rotation(q):
    return Rotation.from_quat(q, scalar_first=True)


def test_distance_is_half_the_angle_between_the_rotations(pair):
    a, b = pair
    angle = (as_rotation(a).inv() * as_rotation(b)).magnitude()
    np.testing.assert_allclose(SO3().distance(a, b), angle / 2, atol=1e-14)


def test_interpolation_is_that_of_scipy(pair):
    a, b = pair
    for t in (0.1, 0.5, 0.9):
        ours = as_rotation(SO3().interpolate(a, b, t))
        theirs = [Slerp([0, 1], as_rotation(np.stack(ends)))(t) for ends in zip(a, b, strict=True)]
        assert (ours.inv() * Rotation.concatenate(theirs)).magnitude().max() < 1e-13


def test_quaternions_of_the_cube_are_of_unit_norm_and_uniform_on_the_sphere():
    q = SO3().from_cube(np.random.default_rng(1).random((4000, 3)))
    np.testing.assert_allclose(np.linalg.norm(q, axis=1), 1.0, atol=1e-15)
    # On the 3-sphere (1 + coordinate) / 2 has the Beta(3/2, 3/2) distribution, whatever the direction.
    directions = np.vstack([np.eye(4), [[0.5, -0.5, 0.5, 0.5]]])
    for direction in directions:
        assert stats.kstest((1 + q @ direction) / 2, stats.beta(1.5, 1.5).cdf).pvalue > 1e-3


def test_a_quaternion_and_its_negative_are_one_rotation(pair):
    a, b = pair
    np.testing.assert_array_equal(SO3().distance(a, -a), 0.0)
    np.testing.assert_array_equal(SO3().distance(a, -b), SO3().distance(a, b))
    there = SO3().interpolate(a, -b, 0.3)
    np.testing.assert_array_equal(there, SO3().interpolate(a, b, 0.3))


def test_ends_are_given_back_to_the_last_bit(pair):
    a, b = pair
    np.testing.assert_array_equal(SO3().interpolate(a, b, 0.0), a)
    np.testing.assert_array_equal(SO3().interpolate(a, b, 1.0), b)
    np.testing.assert_array_equal(SO3().interpolate(a, -a, 1.0), -a)


@pytest.mark.parametrize("angle", [1e-3, 1e-7, 1e-9, 1e-12, 1e-200])
def test_small_turns_keep_their_digits(angle):
    b = np.array([[math.cos(angle), 0.0, math.sin(angle), 0.0]])
    np.testing.assert_allclose(SO3().distance(IDENTITY, b), [angle], rtol=1e-9)
    middle = SO3().interpolate(IDENTITY, b, 0.25)
    np.testing.assert_allclose(SO3().distance(IDENTITY, middle), [angle / 4], rtol=1e-9)


def test_half_turns_are_made_towards_the_second_quaternion():
    b = np.array([[0.0, 0.0, 0.0, 1.0]])
    assert SO3().distance(IDENTITY, b)[0] == pytest.approx(math.pi / 2, abs=1e-15)
    np.testing.assert_allclose(SO3().interpolate(IDENTITY, b, 0.5), [[0.5**0.5, 0, 0, 0.5**0.5]])
    np.testing.assert_allclose(SO3().interpolate(IDENTITY, -b, 0.5), [[0.5**0.5, 0, 0, -(0.5**0.5)]])


def test_quaternions_that_are_not_of_unit_norm_are_refused_and_named():
    wrong = np.array([[1.0, 0.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0]])
    good = np.repeat(IDENTITY, 2, axis=0)
    refused(InvalidValue, "b must hold unit quaternions: row 1 has norm 1.414", lambda: SO3().distance(good, wrong))
    refused(InvalidValue, "a must hold", lambda: SO3().interpolate(wrong, good, 0.5))
    assert SO3().contains(wrong).tolist() == [True, False]
    assert SO3().contains([[1e300, 1e300, 1e300, 1e300]]).tolist() == [False]


def test_quaternions_written_with_seven_digits_are_taken():
    a = np.round(SO3().from_cube([[0.2, 0.3, 0.4]]), 7)
    assert SO3().distance(a, a) == [0.0]
