"""Rectangle: the contract of a space, and its own geometry."""

import math

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.space import Rectangle
from evenroad.testing import SpaceContract

TURNED = Rectangle(corner=(-3.0, 2.0), edge_u=(4.0, 3.0), edge_v=(-1.2, 1.6))


class TestUprightRectangle(SpaceContract):
    space = Rectangle(corner=(0.0, 0.0), edge_u=(640.0, 0.0), edge_v=(0.0, 480.0))


class TestTurnedRectangle(SpaceContract):
    space = TURNED


def test_only_the_rectangle_is_contained():
    inside = TURNED.contains([[-3, 2], [1, 5], [-0.2, 6.6], [-1, 4], [-3.01, 2], [1, 5.01], [-0.3, 6.7]])
    assert inside.tolist() == [True, True, True, True, False, False, False]


def test_corners_go_to_corners_and_distance_is_not_measured_along_the_edges():
    corners = TURNED.from_cube([[0, 0], [1, 0], [0, 1], [1, 1]])
    np.testing.assert_allclose(corners, [[-3, 2], [1, 5], [-4.2, 3.6], [-0.2, 6.6]], atol=1e-14)
    np.testing.assert_allclose(TURNED.distance([[0.0, 0.0]], [[3.0, -4.0]]), [5.0])


def test_equal_areas_of_the_square_go_to_equal_areas():
    h = 1e-3
    u = np.random.default_rng(0).random((50, 2)) * (1 - h)
    along_u = TURNED.from_cube(u + np.array([h, 0])) - TURNED.from_cube(u)
    along_v = TURNED.from_cube(u + np.array([0, h])) - TURNED.from_cube(u)
    areas = along_u[:, 0] * along_v[:, 1] - along_u[:, 1] * along_v[:, 0]
    np.testing.assert_allclose(areas, h * h * TURNED.area, rtol=1e-9)
    assert math.isclose(TURNED.area, 5.0 * 2.0)


def test_interpolation_hits_both_ends_to_the_last_bit():
    a, b = np.array([[0.1, 1e9]]), np.array([[0.3, 1e-9]])
    np.testing.assert_array_equal(TURNED.interpolate(a, b, 0.0), a)
    np.testing.assert_array_equal(TURNED.interpolate(a, b, 1.0), b)


@pytest.mark.parametrize(("edge_u", "edge_v", "text"), [
    ((0.0, 0.0), (0.0, 1.0), "length"), ((1.0, 0.0), (0.0, 0.0), "length"),
    ((1.0, 0.0), (1.0, 1.0), "perpendicular"), ((1.0, math.nan), (0.0, 1.0), "finite"),
    ((1.0, math.inf), (0.0, 1.0), "finite"), ((1.0,), (0.0, 1.0), "2 finite"), ("ab", (0.0, 1.0), "2 finite"),
])  # fmt: skip
def test_edges_that_do_not_span_a_rectangle_are_refused(edge_u, edge_v, text):
    with pytest.raises(InvalidValue, match=text):
        Rectangle(corner=(0.0, 0.0), edge_u=edge_u, edge_v=edge_v)
