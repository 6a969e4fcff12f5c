"""Tests of evenroad.viz.outline."""

import math

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from evenroad.robot.scene import Obstacle
from evenroad.viz.outline import obstacle_bounds, obstacle_outline

VIEWS = ((0, 1), (0, 2), (1, 2))
ROTATIONS = {
    "straight": np.eye(3),
    "about z": np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]]),
    "askew": np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]]),
}


def corners(obstacle: Obstacle) -> np.ndarray:
    """Points, (c, 3), whose convex hull the obstacle is, a cylinder with 32 corners at each end."""
    if obstacle.shape == "box":
        signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        local = 0.5 * signs * np.array(obstacle.size)
    else:
        radius, length = obstacle.size
        angle = np.arange(32) * 2.0 * math.pi / 32
        rim = radius * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(32)])
        local = np.concatenate([rim + np.array([0.0, 0.0, z]) for z in (-0.5 * length, 0.5 * length)])
    return local @ np.reshape(obstacle.rotation, (3, 3)).T + obstacle.xyz


@pytest.mark.parametrize("axes", VIEWS)
@pytest.mark.parametrize("turn", ROTATIONS)
@pytest.mark.parametrize(("shape", "size"), [("box", (0.5, 0.2, 0.3)), ("cylinder", (0.2, 0.7))])
def test_an_outline_is_the_hull_of_the_corners_as_seen(shape, size, turn, axes):
    obstacle = Obstacle.of("it", shape, size, (1.0, -2.0, 0.5), tuple(ROTATIONS[turn].ravel()))
    outline = obstacle_outline(obstacle, axes)
    hull, ours = ConvexHull(corners(obstacle)[:, axes]), ConvexHull(outline)
    assert ours.volume == pytest.approx(hull.volume, rel=1e-9)
    inside = hull.equations @ np.column_stack([outline, np.ones(len(outline))]).T
    assert inside.max() < 1e-9
    # In order: the sides of the polygon as drawn enclose the same area.
    x, y = outline.T
    assert 0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) == pytest.approx(hull.volume)


@pytest.mark.parametrize("turn", ROTATIONS)
def test_bounds_hold_all_corners_tightly(turn):
    obstacle = Obstacle.of("it", "box", (0.5, 0.2, 0.3), (1.0, -2.0, 0.5), tuple(ROTATIONS[turn].ravel()))
    low, high = obstacle_bounds(obstacle)
    np.testing.assert_allclose(low, corners(obstacle).min(axis=0))
    np.testing.assert_allclose(high, corners(obstacle).max(axis=0))
