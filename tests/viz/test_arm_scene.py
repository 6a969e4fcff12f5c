import numpy as np
import pytest

import evenroad as er
from evenroad.geometry.shapes import PointCloud
from evenroad.robots.kinematics import capsule_endpoints
from evenroad.viz import arm
from evenroad.viz.surfaces import surface_of


@pytest.fixture(scope="module")
def reach():
    return er.plan("box-reach", "home", "inside", robot="ur5")


def test_the_camera_sees_the_whole_arm_and_nothing_stands_before_most_of_it(reach):
    scene = arm.ArmScene.of(reach, reach.world)
    camera = scene.stage._camera
    seen = camera.pixels(capsule_endpoints(reach.world.robot, reach.path).reshape(-1, 3))
    assert (seen[:, :2] > 0).all()
    assert (seen[:, :2] < camera.size).all()
    with_boxes = np.asarray(scene.picture(reach.start)).astype(int)
    other = np.asarray(scene.picture(reach.goal)).astype(int)
    assert np.count_nonzero(np.abs(with_boxes - other).max(axis=2) > 30) > 3000


def test_clouds_are_drawn_as_cubes_of_their_points():
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    vertices, triangles = surface_of(PointCloud(points, radius=0.1))
    assert vertices.shape == (16, 3)
    assert triangles.shape == (24, 3)
    np.testing.assert_allclose(np.abs(vertices[8:] - points[1]).max(), 0.1)


def test_what_touches_at_a_start_in_collision_is_red(reach):
    world = reach.world
    q = reach.goal + np.array([0.35, 0, 0, 0, 0, 0])
    result = er.plan(world, q, reach.goal)
    assert result.status == "start_invalid"
    assert "box left" in world.explain(q)

    def red(picture):
        shown = np.asarray(picture).astype(int)
        return np.count_nonzero((shown[..., 0] > 150) & (shown[..., 1:] < 90).all(axis=-1))

    assert red(arm.draw_arm_plan(result, world)) > red(arm.draw_arm_plan(reach, world)) + 400
