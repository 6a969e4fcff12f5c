"""Distances of points from obstacles."""

import math

import numpy as np
import pytest

from evenroad.robot.kernel.separation import point_to_obstacle
from evenroad.robot.scene import Obstacle
from tests.robot.kernel_arms import STRAIGHT, random_rotation, random_scene
from tests.robot.oracle import obstacle_distance

QUARTER = (0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def test_the_distance_of_points_from_obstacles_is_the_oracles():
    points = np.random.default_rng(1).uniform(-1.0, 1.0, (100, 3))
    for obstacle in random_scene(2, count=30).obstacles:
        slow = [point_to_obstacle(point, obstacle) for point in points]
        np.testing.assert_allclose(slow, obstacle_distance(points, obstacle), atol=1e-12)


@pytest.mark.parametrize(
    ("obstacle", "point", "distance"),
    [
        (Obstacle.of("b", "box", (2.0, 4.0, 6.0), (0, 0, 0)), (4.0, 6.0, 3.0), 5.0),
        (Obstacle.of("b", "box", (2.0, 4.0, 6.0), (0, 0, 0), QUARTER), (4.0, 0.0, 0.0), 2.0),
        (Obstacle.of("b", "box", (2.0, 4.0, 6.0), (0, 0, 0)), (0.5, 1.0, -2.0), 0.0),
        (Obstacle.of("s", "sphere", (1.0,), (1.0, 0, 0)), (4.0, 0.0, 0.0), 2.0),
        (Obstacle.of("c", "capsule", (1.0, 2.0), (0, 0, 0)), (0.0, 0.0, 3.0), 1.0),
        (Obstacle.of("c", "cylinder", (1.0, 2.0), (0, 0, 0)), (0.0, 0.0, 3.0), 2.0),
        (Obstacle.of("c", "cylinder", (1.0, 2.0), (0, 0, 0)), (4.0, 0.0, 5.0), 5.0),
    ],
)
def test_distances_that_can_be_worked_out_by_hand(obstacle, point, distance):
    assert math.isclose(point_to_obstacle(np.array(point), obstacle), distance)


def test_random_rotations_of_the_tests_are_rotations():
    for seed in range(5):
        turn = np.reshape(random_rotation(np.random.default_rng(seed)), (3, 3))
        np.testing.assert_allclose(turn @ turn.T, np.reshape(STRAIGHT, (3, 3)), atol=1e-12)
        assert np.linalg.det(turn) > 0.0
