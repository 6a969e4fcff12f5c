"""BoxSpace, Circle and JointSpace: the contract, wrapping the short way, exact ends, and what they refuse."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evenroad.errors import InvalidValue
from evenroad.space import BoxSpace, Circle, FlatMetric, JointSpace
from evenroad.testing import SpaceContract

ARM = JointSpace(
    low=[-math.pi, -2.0, -math.pi, 0.1],
    high=[math.pi, 3.0, math.pi, 0.4],
    wrapping=[True, False, True, False],
    weights=[1.0, 2.0, 0.5, 10.0],
)


class TestBox(SpaceContract):
    space = BoxSpace([-1.0, 10.0, 0.0], [2.0, 11.0, 1e-3])


class TestWeightedBox(SpaceContract):
    space = BoxSpace([0.0] * 6, [1.0] * 6, weights=[1, 2, 3, 4, 5, 6])


class TestCircle(SpaceContract):
    space = Circle()


class TestJointSpace(SpaceContract):
    space = ARM


class TestTorus(SpaceContract):
    space = JointSpace([0.0, 10.0], [1.0, 370.0], wrapping=True, weights=[360.0, 1.0])


def test_angles_come_back_in_the_half_open_range_and_those_in_it_as_they_are():
    just_below = np.nextafter(-math.pi, -4.0)
    near_the_end = np.array([[math.pi], [just_below], [np.nextafter(math.pi, 0)], [-1e-300 - math.pi]])
    for t in (0.0, 0.5, 1.0):
        back = Circle().interpolate(near_the_end, near_the_end, t)
        assert ((back >= -math.pi) & (back < math.pi)).all()
    assert Circle().from_cube([[0.0], [1.0]]).tolist() == [[-math.pi], [-math.pi]]
    inside = np.linspace(-math.pi, 3.14, 50)[:, np.newaxis]
    for t, end in ((0.0, inside), (1.0, inside[::-1])):
        np.testing.assert_array_equal(Circle().interpolate(inside, inside[::-1], t), end)


def test_a_circle_is_measured_and_crossed_the_short_way_round():
    a, b = np.array([[3.0]]), np.array([[-3.0]])
    np.testing.assert_allclose(Circle().distance(a, b), [2 * math.pi - 6.0], rtol=1e-14)
    np.testing.assert_allclose(Circle().interpolate(a, b, 0.25), [[3.0 + 0.25 * (2 * math.pi - 6.0)]])
    np.testing.assert_allclose(Circle().interpolate(a, b, 0.75), [[-3.0 - 0.25 * (2 * math.pi - 6.0)]])


def test_any_angle_stands_for_the_one_in_range():
    turned = np.array([[0.3 + 2 * math.pi], [0.3 - 6 * math.pi], [math.pi]])
    np.testing.assert_allclose(Circle().interpolate(turned, turned, 0.0), [[0.3], [0.3], [-math.pi]])
    np.testing.assert_allclose(Circle().distance(turned[:2], [[0.3], [0.3]]), 0.0, atol=1e-14)
    assert Circle().contains(turned).all()


@pytest.mark.parametrize("angle", [0.0, 0.5, 1.0, 3.0])
def test_opposite_directions_are_joined_by_one_way_in_either_direction(angle):
    torus = JointSpace([0.0], [8.0], wrapping=True)
    a, b = np.array([[angle]]), np.array([[angle + 4.0]])
    assert torus.interpolate(a, b, 0.25)[0, 0] == angle + 1.0
    assert torus.interpolate(b, a, 0.75)[0, 0] == angle + 1.0


def test_weights_multiply_the_differences_of_their_axes():
    box = BoxSpace([0.0, 0.0], [10.0, 10.0], weights=[3.0, 2.0])
    np.testing.assert_allclose(box.distance([[0.0, 0.0]], [[1.0, 2.0]]), [5.0])
    np.testing.assert_allclose(box.flat.scale, [3.0, 2.0])
    assert np.isinf(box.flat.period).all()


def test_joints_with_stops_do_not_wrap_and_bounds_are_inside():
    a, b = np.array([[3.0, -2.0, 0.0, 0.1]]), np.array([[-3.0, 3.0, 0.0, 0.1]])
    np.testing.assert_allclose(ARM.distance(a, b), [math.hypot(2 * math.pi - 6.0, 10.0)])
    np.testing.assert_array_equal(ARM.flat.period, [2 * math.pi, np.inf, 2 * math.pi, np.inf])
    box = BoxSpace([0.0, 0.0], [1.0, 2.0])
    q = [[0, 0], [1, 2], [0.5, np.nextafter(2, 3)], [-1e-300, 1]]
    assert box.contains(q).tolist() == [True, True, False, False]


finite = st.floats(-1e6, 1e6)


@given(a=finite, b=finite, t=st.floats(0.0, 1.0))
def test_interpolation_is_exact_at_its_ends_and_never_beyond_them(a, b, t):
    box = BoxSpace([-1e6], [1e6])
    first, second = np.array([[a]]), np.array([[b]])
    assert box.interpolate(first, second, 0.0) == first
    assert box.interpolate(first, second, 1.0) == second
    assert min(a, b) <= box.interpolate(first, second, t)[0, 0] <= max(a, b)


@given(a=st.floats(-50.0, 50.0), b=st.floats(-50.0, 50.0))
def test_the_distance_on_a_circle_is_that_of_its_definition(a, b):
    turns = abs(math.remainder(a - b, 2 * math.pi))
    assert abs(Circle().distance([[a]], [[b]])[0] - turns) <= 1e-13


def test_spaces_are_values():
    assert BoxSpace([0, 0], [1, 1]) == BoxSpace(np.zeros(2), (1.0, 1.0))
    assert hash(BoxSpace([0], [1])) == hash(BoxSpace([0], [1]))
    assert BoxSpace([0], [1]) != BoxSpace([0], [2])
    assert Circle() == Circle()
    assert repr(BoxSpace([0], [1])) == "BoxSpace(low=(0.0,), high=(1.0,), weights=(1.0,))"


@pytest.mark.parametrize(("make", "text"), [
    (lambda: BoxSpace([0.0], [0.0]), "axis 0"),
    (lambda: BoxSpace([0.0, 2.0], [1.0, 1.0]), "axis 1"),
    (lambda: BoxSpace([-1.7e308], [1.7e308]), "axis 0"),
    (lambda: BoxSpace([0.0], [math.inf]), "high"),
    (lambda: BoxSpace([math.nan], [1.0]), "low"),
    (lambda: BoxSpace([], []), "low"),
    (lambda: BoxSpace(0.0, 1.0), "low"),
    (lambda: BoxSpace([0.0], [1.0, 2.0]), "high"),
    (lambda: BoxSpace([0.0], [1.0], weights=[0.0]), "weights"),
    (lambda: BoxSpace([0.0], [1.0], weights=[-1.0]), "weights"),
    (lambda: BoxSpace([0.0], [1.0], weights=[1.0, 1.0]), "weights"),
    (lambda: JointSpace([0.0], [1.0], wrapping=[True, False]), "wrapping"),
    (lambda: JointSpace([0.0], [1.0], wrapping=[1]), "wrapping"),
    (lambda: JointSpace([0.0], [1.0], wrapping=None), "wrapping"),
    (lambda: JointSpace([0.0], [1.0], wrapping=np.array(True)), "wrapping"),
    (lambda: FlatMetric([1.0, math.inf], [math.inf, 1.0]), "scale"),
    (lambda: FlatMetric([1.0], [math.nan]), "period"),
    (lambda: FlatMetric([1.0], [1.0, 1.0]), "one length"),
    (lambda: FlatMetric([], []), "scale"),
    (lambda: FlatMetric("ab", [1.0]), "scale"),
])  # fmt: skip
def test_parameters_that_make_no_space_are_refused(make, text):
    with pytest.raises(InvalidValue, match=text):
        make()
