"""The space contract finds the mistakes that it is there for."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

from evenroad.space import SE3, SO3, BoxSpace, Circle, FlatMetric, Rectangle, Space
from evenroad.space.batch import as_batch_pair
from evenroad.testing import SpaceContract
from tests.refused import refused


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


def linear(a, b, t):
    """A straight line between quaternions: not at an even speed."""
    between = (1 - np.reshape(t, (-1, 1))) * a + np.reshape(t, (-1, 1)) * b
    return between / np.linalg.norm(between, axis=1, keepdims=True)


LINE, SQUARE, CUBE = BoxSpace([0.0], [1.0]), BoxSpace([0.0, 0.0], [1.0, 1.0]), BoxSpace([0.0] * 3, [1.0] * 3)
UNIT = Rectangle((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))
VOLUMES = "equal_volumes_of_the_cube_get_equal_measure"
EVENLY = "interpolation_covers_the_distance_evenly"
MISTAKES = [
    (SO3(), {"from_cube": euler_angles}, VOLUMES),
    (SQUARE, {"from_cube": lambda u: np.asarray(u) ** 2}, VOLUMES),
    (CUBE, {"from_cube": lambda u: np.asarray(u) ** [1.0, 1.0, 1.5]}, VOLUMES),
    (LINE, {"distance": lambda a, b: LINE.distance(a, b) * np.where(a < b, 1.0, 1.5)[:, 0]}, "distance_is_symmetric"),
    (LINE, {"distance": lambda a, b: LINE.distance(a, b) ** 2}, "distance_satisfies_the_triangle_inequality"),
    # The long way round, and not at an even speed.
    (Circle(), {"interpolate": BoxSpace([-math.pi], [math.pi]).interpolate}, EVENLY),
    (SO3(), {"interpolate": linear}, EVENLY),
    (Circle(), {"flat": FlatMetric([1.0], [math.inf])}, "a_flat_metric_is_the_distance"),
    (UNIT, {"from_cube": lambda u: 2.0 * np.asarray(u)}, "from_cube_takes_the_corners_of_the_cube"),
]


@pytest.mark.parametrize(("space", "replaced", "law"), MISTAKES)
def test_a_mistake_is_found(space, replaced, law):
    refused(AssertionError, "", lambda: getattr(contract_of(Changed(space, replaced)), f"test_{law}")())


@pytest.mark.parametrize("space", [SO3(), SE3([0, 0, 0], [900.0, 0.1, 5.0]), BoxSpace([0] * 8, range(1, 9))])
def test_a_map_that_preserves_volumes_passes_at_other_places_too(space):
    contract_of(space).test_equal_volumes_of_the_cube_get_equal_measure()


def test_a_space_that_reads_over_bad_input_is_found():
    lax = Changed(BoxSpace([0.0], [1.0]), {"distance": lambda a, b: np.abs(np.subtract(a, b)).sum(axis=-1)})
    refused(pytest.fail.Exception, "", lambda: contract_of(lax).test_an_entry_that_is_not_finite_is_refused(np.nan))
    refused(pytest.fail.Exception, "", lambda: contract_of(lax).test_a_wrong_shape_is_refused())


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
