"""Product, SE2 and SE3: the contract, and distances and ways part by part."""

import math

import numpy as np
import pytest

from evenroad.errors import InvalidValue, UnknownName
from evenroad.space import SE2, SE3, SO3, BoxSpace, Circle, Product
from evenroad.testing import SpaceContract

PUZZLE = SE3([-508.88, -230.13, -123.75], [319.62, 531.87, 101.0])


class TestSE2(SpaceContract):
    space = SE2([0.0, 0.0], [30.0, 20.0], weights=[1.0, 4.0])


class TestSE2OfSums(SpaceContract):
    space = SE2([0.0, 0.0], [30.0, 20.0], combine="sum")


class TestSE3(SpaceContract):
    space = PUZZLE


class TestTwoBodies(SpaceContract):
    space = Product([SO3(), Product([BoxSpace([0.0], [1.0]), Circle()])], weights=[1.0, 0.5], combine="l2")


def test_the_distance_of_poses_in_space_is_way_plus_turn():
    half_turn = [0.0, 0.0, 1.0, 0.0]
    a, b = np.array([[0.0, 0, 0, 1, 0, 0, 0]]), np.array([[2.0, 3, 6, *half_turn]])
    np.testing.assert_allclose(PUZZLE.distance(a, b), [7.0 + math.pi / 2])
    way, turn = PUZZLE.part_distances(a, b)
    np.testing.assert_allclose([way, turn], [[7.0], [math.pi / 2]])


def test_weights_multiply_the_distances_of_the_parts():
    a, b = np.array([[0.0, 0.0, 3.0]]), np.array([[3.0, 4.0, -3.0]])
    turn = 2 * math.pi - 6.0
    summed = SE2([0, 0], [9, 9], weights=[2.0, 5.0], combine="sum")
    squared = SE2([0, 0], [9, 9], weights=[2.0, 5.0])
    np.testing.assert_allclose(summed.distance(a, b), [10.0 + 5.0 * turn])
    np.testing.assert_allclose(squared.distance(a, b), [math.hypot(10.0, 5.0 * turn)])


def test_a_product_is_flat_only_if_its_parts_are_and_squares_are_summed():
    flat = SE2([0, 0], [9, 9], weights=[2.0, 5.0]).flat
    np.testing.assert_array_equal(flat.scale, [2.0, 2.0, 5.0])
    np.testing.assert_array_equal(flat.period, [np.inf, np.inf, 2 * math.pi])
    assert SE2([0, 0], [9, 9], combine="sum").flat is None
    assert SE3([0, 0, 0], [1, 1, 1], combine="l2").flat is None
    assert Product([Circle()], weights=[3.0]).flat.scale == [3.0]
    assert Product([SO3()]).flat is None


def test_every_part_moves_as_it_would_alone():
    q = PUZZLE.from_cube(np.random.default_rng(0).random((40, 6)))
    a, b, t = q[:20], q[20:], np.linspace(0, 1, 20)
    between = PUZZLE.interpolate(a, b, t)
    for part, columns in zip(PUZZLE.parts, (slice(0, 3), slice(3, 7)), strict=True):
        np.testing.assert_array_equal(between[:, columns], part.interpolate(a[:, columns], b[:, columns], t))


def test_a_pose_is_inside_if_all_of_its_parts_are_and_products_are_values():
    space = SE3([0, 0, 0], [1, 1, 1])
    q = [[0.5, 0.5, 0.5, 1, 0, 0, 0], [1.5, 0.5, 0.5, 1, 0, 0, 0], [0.5, 0.5, 0.5, 1, 1, 0, 0]]
    assert space.contains(q).tolist() == [True, False, False]
    assert SE3([0, 0, 0], [1, 1, 1]) == SE3((0, 0, 0), np.ones(3))
    assert SE3([0, 0, 0], [1, 1, 1]) != SE3([0, 0, 0], [1, 1, 1], weights=[1, 2])
    assert len({SE2([0, 0], [1, 1]), SE2([0, 0], [1, 1])}) == 1


@pytest.mark.parametrize(("make", "text"), [
    (lambda: Product([]), "parts"),
    (lambda: Product([Circle()], weights=[1.0, 2.0]), "weights"),
    (lambda: Product([Circle(), Circle()], combine="max"), "'max'; known: l2, sum"),
    (lambda: SE3([0, 0], [1, 1]), "3 numbers"),
    (lambda: SE2([0, 0, 0], [1, 1, 1]), "2 numbers"),
    (lambda: PUZZLE.distance([[0, 0, 0, 1, 1, 0, 0]], [[0, 0, 0, 1, 0, 0, 0]]), "unit quaternions: row 0"),
])  # fmt: skip
def test_what_makes_no_product_and_no_pose_is_refused(make, text):
    with pytest.raises((InvalidValue, UnknownName), match=text):
        make()
