"""Tests of evenroad.viz.outline."""

import math

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from evenroad.robot.scene import Obstacle
from evenroad.viz.outline import obstacle_bounds, obstacle_outline, stadium

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


@pytest.mark.parametrize("axes", VIEWS)
@pytest.mark.parametrize(("shape", "size"), [("sphere", (0.2,)), ("capsule", (0.1, 0.7))])
def test_an_outline_of_a_round_body_holds_all_of_it_and_little_more(shape, size, axes):
    obstacle = Obstacle.of("it", shape, size, (0.1, 0.2, 0.3), tuple(ROTATIONS["askew"].ravel()))
    half = 0.5 * size[1] if len(size) > 1 else 0.0
    points = np.random.default_rng(0).uniform(-1, 1, (4000, 3)) * [size[0], size[0], size[0] + half]
    beyond = np.maximum(np.abs(points[:, 2]) - half, 0)
    points = points[np.hypot(np.hypot(points[:, 0], points[:, 1]), beyond) <= size[0]]
    points = points @ ROTATIONS["askew"].T + obstacle.xyz
    outline = obstacle_outline(obstacle, axes)
    hull = ConvexHull(outline)
    assert (hull.equations @ np.column_stack([points[:, axes], np.ones(len(points))]).T).max() < 5e-3
    np.testing.assert_allclose(outline.min(axis=0), points[:, axes].min(axis=0), atol=0.08)
    np.testing.assert_allclose(outline.max(axis=0), points[:, axes].max(axis=0), atol=0.08)
    low, high = obstacle_bounds(obstacle)
    assert ((low <= points) & (points <= high)).all()


def test_a_stadium_is_at_its_radius_from_its_segment():
    a, b = np.array([0.1, 0.2]), np.array([0.5, -0.3])
    outline = stadium(a, b, 0.25)
    t = np.clip((outline - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)[:, np.newaxis]
    np.testing.assert_allclose(np.linalg.norm(outline - a - t * (b - a), axis=1), 0.25)
