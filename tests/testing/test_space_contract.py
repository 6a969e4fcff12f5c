"""The space contract finds the mistakes that it is there for."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

from evenroad.space import SE3, SO3, BoxSpace, Circle, FlatMetric, Rectangle, Space
from evenroad.space.batch import as_batch_pair
from evenroad.testing import SpaceContract


@dataclass(frozen=True)
class Changed:
    """A good space of which some methods are replaced."""

    good: Space
    replaced: dict

    def __getattr__(self, name):
        return self.replaced[name] if name in self.replaced else getattr(self.good, name)


def contract_of(space):
    contract = SpaceContract()
    contract.space = space
    return contract


def euler_angles(u):
    """Uniform Euler angles: the classic wrong way to draw a rotation."""
    yaw, pitch, roll = np.pi * (np.asarray(u) - 0.5).T * [[1.0], [0.5], [1.0]]
    (cy, sy), (cp, sp), (cr, sr) = [(np.cos(x), np.sin(x)) for x in (yaw, pitch, roll)]
    return np.column_stack(
        [
            cy * cp * cr + sy * sp * sr,
            cy * cp * sr - sy * sp * cr,
            cy * sp * cr + sy * cp * sr,
            sy * cp * cr - cy * sp * sr,
        ]
    )


@pytest.mark.parametrize(
    "space",
    [
        Changed(SO3(), {"from_cube": euler_angles}),
        Changed(BoxSpace([0.0, 0.0], [1.0, 1.0]), {"from_cube": lambda u: np.asarray(u) ** 2}),
        Changed(BoxSpace([0.0] * 3, [1.0] * 3), {"from_cube": lambda u: np.asarray(u) ** [1.0, 1.0, 1.5]}),
    ],
    ids=["euler", "squares", "one axis"],
)
def test_a_map_that_does_not_preserve_volumes_is_found(space):
    with pytest.raises(AssertionError):
        contract_of(space).test_equal_volumes_of_the_cube_get_equal_measure()


@pytest.mark.parametrize("space", [SO3(), SE3([0, 0, 0], [900.0, 0.1, 5.0]), BoxSpace([0] * 8, range(1, 9))])
def test_a_map_that_preserves_volumes_passes_at_other_places_too(space):
    contract = contract_of(space)
    contract.test_equal_volumes_of_the_cube_get_equal_measure()


def test_a_metric_that_is_not_symmetric_is_found():
    line = BoxSpace([0.0], [1.0])
    one_way = Changed(line, {"distance": lambda a, b: line.distance(a, b) * np.where(a < b, 1.0, 1.5)[:, 0]})
    with pytest.raises(AssertionError):
        contract_of(one_way).test_distance_is_symmetric()


def test_a_squared_distance_is_no_metric():
    line = BoxSpace([0.0], [1.0])
    squared = Changed(line, {"distance": lambda a, b: line.distance(a, b) ** 2})
    with pytest.raises(AssertionError):
        contract_of(squared).test_distance_satisfies_the_triangle_inequality()


def test_an_angle_that_goes_the_long_way_round_is_found():
    straight = BoxSpace([-math.pi], [math.pi])
    long_way = Changed(Circle(), {"interpolate": straight.interpolate})
    with pytest.raises(AssertionError):
        contract_of(long_way).test_interpolation_covers_the_distance_evenly()


def test_a_linear_way_between_quaternions_is_found():
    def linear(a, b, t):
        between = (1 - np.reshape(t, (-1, 1))) * a + np.reshape(t, (-1, 1)) * b
        return between / np.linalg.norm(between, axis=1, keepdims=True)

    with pytest.raises(AssertionError):
        contract_of(Changed(SO3(), {"interpolate": linear})).test_interpolation_covers_the_distance_evenly()


def test_a_flat_metric_that_is_not_the_distance_is_found():
    wrong = Changed(Circle(), {"flat": FlatMetric([1.0], [math.inf])})
    with pytest.raises(AssertionError):
        contract_of(wrong).test_a_flat_metric_is_the_distance()


def test_a_map_that_leaves_the_space_is_found():
    wide = Changed(
        Rectangle((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)), {"from_cube": lambda u: 2.0 * np.asarray(u)}
    )
    with pytest.raises(AssertionError):
        contract_of(wide).test_from_cube_takes_the_corners_of_the_cube()


def test_a_space_that_reads_over_bad_input_is_found():
    lax = Changed(BoxSpace([0.0], [1.0]), {"distance": lambda a, b: np.abs(np.subtract(a, b)).sum(axis=-1)})
    with pytest.raises(pytest.fail.Exception):
        contract_of(lax).test_an_entry_that_is_not_finite_is_refused(np.nan)
    with pytest.raises(pytest.fail.Exception):
        contract_of(lax).test_a_wrong_shape_is_refused()


class TwofoldLine(Space):
    """A user's space that writes the four needed methods and inherits the rest: a line, measured twice."""

    dim = 1

    def from_cube(self, u):
        return BoxSpace([0.0], [1.0]).from_cube(u)

    def distance(self, a, b):
        first, second = as_batch_pair(a, b, 1)
        return 2.0 * np.abs(first - second)[:, 0]

    def interpolate(self, a, b, t):
        return BoxSpace([0.0], [1.0]).interpolate(a, b, t)


class TestAUsersOwnSpace(SpaceContract):
    space = TwofoldLine()
