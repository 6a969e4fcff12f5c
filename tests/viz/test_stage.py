from dataclasses import replace

import numpy as np

from evenroad._native.picture import nearest
from evenroad.geometry.shapes import Box, Sphere
from evenroad.viz.camera import Camera
from evenroad.viz.stage import Stage, part_of
from evenroad.viz.surfaces import surface_of

CAMERA = Camera(np.array([2.0, -2.0, 1.5]), np.array([0.0, 0.0, 0.3]), (90, 60))


def rays(camera):
    """Directions of all pixels, (rows, columns, 3), with depth 1."""
    (width, height), (right, up, forward) = camera.size, camera.axes
    x, y = np.meshgrid(np.arange(width) + 0.5 - width / 2, height / 2 - np.arange(height) - 0.5)
    return (x[..., None] * right + y[..., None] * up) / camera.scale + forward


def test_a_pixel_s_ray_leads_back_to_it():
    for row, column in ((0, 0), (30, 45), (59, 89)):
        seen = CAMERA.pixels((CAMERA.eye + 3.0 * rays(CAMERA)[row, column])[np.newaxis])[0]
        np.testing.assert_allclose(seen, [column + 0.5, row + 0.5, 1.0 / 3.0], atol=1e-9)


def test_each_pixel_shows_the_triangle_that_its_ray_meets_first():
    """Rays and triangles one by one (Moeller and Trumbore 1997)."""
    rng = np.random.default_rng(4)
    corners = rng.normal(0.0, 0.35, (25, 1, 3)) + rng.normal(0.0, 0.35, (25, 3, 3))
    near, owner = (each.reshape(-1) for each in nearest(CAMERA.pixels(corners), 90, 60))
    towards = rays(CAMERA).reshape(-1, 3)
    for place in rng.integers(0, len(towards), 800):
        met = [_met(CAMERA.eye, towards[place], each) for each in corners]
        first = int(np.argmin(met)) if np.isfinite(np.min(met)) else -1
        assert owner[place] == first
        np.testing.assert_allclose(near[place], 0.0 if first < 0 else 1.0 / met[first], rtol=1e-5)
    assert np.count_nonzero(owner >= 0) > 500


def _met(eye, ray, triangle):
    """Return the depth at which a ray meets a triangle, infinity where it does not."""
    a, u, v = triangle[0], triangle[1] - triangle[0], triangle[2] - triangle[0]
    across = np.cross(ray, v)
    area = u @ across
    from_a = (eye - a) / area
    second, turned = from_a @ across, np.cross(from_a, u)
    third = turned @ ray
    inside = second >= 0 and third >= 0 and second + third <= 1
    return turned @ v if inside and turned @ v > 0 else np.inf


def test_normals_of_a_ball_are_smooth_and_those_of_a_box_are_its_faces():
    ball = part_of(surface_of(Sphere(0.3)), (0, 0, 0))
    away = ball.corners / np.linalg.norm(ball.corners, axis=2, keepdims=True)
    assert (ball.normals * away).sum(axis=2).min() > 0.98
    box = part_of(surface_of(Box((1, 2, 3))), (0, 0, 0))
    np.testing.assert_allclose(np.abs(box.normals).max(axis=2), 1.0, atol=1e-9)


def test_a_ball_throws_a_shadow_on_the_floor_and_a_translucent_one_none():
    surface = surface_of(Sphere(0.25, xyz=(0, 0, 0.6)))
    stage = Stage(CAMERA, 0.0)
    empty = np.asarray(stage.picture([part_of(surface_of(Box((0.01, 0.01, 0.01))), (9, 9, 9))])).astype(int)
    solid = np.asarray(stage.picture([part_of(surface, (200, 80, 80))])).astype(int)
    grey = (np.abs(solid - empty).max(axis=2) > 20) & (np.ptp(solid, axis=2) < 30)
    red = np.ptp(solid, axis=2) > 40
    assert grey.sum() > 15
    assert red.sum() > 30
    faint = np.asarray(stage.picture([
        part_of(surface_of(Box((0.01, 0.01, 0.01))), (9, 9, 9)), replace(part_of(surface, (200, 80, 80)), opacity=0.5)
    ])).astype(int)  # fmt: skip
    assert np.median(np.abs(faint - empty).max(axis=2)[grey & ~red]) < 5


def test_what_is_translucent_is_seen_through_obstacles_alone_and_paler():
    """Before a wall, behind a wall, and behind the arm."""
    ball = replace(part_of(surface_of(Sphere(0.2, xyz=(0, 0, 0.3))), (220, 40, 40)), opacity=0.8, hidden=0.5)
    wall = part_of(surface_of(Box((0.02, 1.2, 1.2), xyz=(0.5, -0.5, 0.4), rpy=(0, 0, -0.785))), (90, 90, 90))
    stage = Stage(CAMERA, -0.5)

    def reds(parts, see_through):
        picture = np.asarray(stage.picture([*parts, ball], see_through)).astype(int)
        return (picture[..., 0] - picture[..., 2]).clip(0)[20:40, 35:55].mean()

    free, hidden, behind = reds([], 0), reds([wall], 0), reds([wall], 1)
    assert free > 1.5 * hidden > 3.0 * behind
