import math
from dataclasses import replace

import numpy as np
import pytest

from evenroad.errors import InvalidValue, UnknownName
from evenroad.geometry import (
    Box,
    Capsule,
    Cylinder,
    Mesh,
    PointCloud,
    Pose,
    Sphere,
    TriangleMesh,
    fit_capsules,
    height_map,
    rotation_from_rpy,
    shape_of,
)
from evenroad.geometry.shapes import along_z, without_pose
from tests.refused import refused

PLACE = Pose((1.0, -2.0, 0.5), rotation_from_rpy(0.3, 1.2, -2.0))
FLAT = TriangleMesh(np.eye(3), [[0, 1, 2]], "flat")


@pytest.mark.parametrize(("make", "says"), [
    (lambda: Box((1, 1)), "3 finite"),
    (lambda: Box((1, 1, 0)), "> 0, got 0"),
    (lambda: Sphere(-1), "radius of a sphere .* got -1"),
    (lambda: Sphere(math.nan), "radius of a sphere"),
    (lambda: Cylinder(1, 0), "length of a cylinder"),
    (lambda: Capsule((0, 0, math.nan), (0, 0, 1), 1), "end a of a capsule .*nan"),
    (lambda: Capsule((0, 0, 0), (0, 0, 1), 0.0), "radius of a capsule .* > 0, got 0.0"),
    (lambda: Capsule(1, 0), "length of a capsule"),
    (lambda: Mesh(FLAT, (1, 0, 1)), "scale of mesh flat must not be 0"),
    (lambda: PointCloud(np.zeros((3, 2))), "points of a cloud .*3, 2"),
    (lambda: PointCloud(np.zeros((0, 3))), "one point or more"),
    (lambda: PointCloud(np.full((1, 3), np.inf)), "finite"),
    (lambda: PointCloud(np.full((1, 3), 1e10)), "within 1e.09 m"),
    (lambda: PointCloud(np.zeros((1, 3)), -1.0), "radius of a cloud"),
    (lambda: fit_capsules(PointCloud(np.zeros((1, 3)))), "cloud of 1 points"),
    (lambda: shape_of("box", (1.0, 1.0)), "a box must have 3"),
    (lambda: shape_of("cone", (1.0,)), "'cone'; known: box, capsule, cylinder, sphere"),
])  # fmt: skip
def test_a_shape_with_dimensions_that_are_none_is_refused(make, says):
    refused((InvalidValue, UnknownName), says, make)


@pytest.mark.parametrize("shape", [Box((1, 2, 3)), Sphere(0.5), Cylinder(0.5, 2), Capsule(0.5, 2)], ids=str)
def test_a_shape_is_made_again_from_its_kind_and_size(shape):
    placed = replace(shape, pose=PLACE, link="arm")
    assert shape_of(placed.kind, placed.size, placed.pose, placed.link) == placed


def test_point_clouds_are_read_only_copies_and_equal_by_value():
    points = np.zeros((2, 3))
    cloud = PointCloud(points)
    points[0] = 1.0
    assert (cloud.points == 0.0).all()
    with pytest.raises(ValueError, match="read-only"):
        cloud.points[0] = 1.0
    assert cloud == PointCloud(np.zeros((2, 3)))
    assert hash(cloud) == hash(PointCloud(np.zeros((2, 3))))
    for other in (PointCloud(np.ones((2, 3))), PointCloud(points, 0.1), PointCloud(np.zeros((2, 3)), pose=PLACE)):
        assert cloud != other
    assert cloud != "cloud"


@pytest.mark.parametrize("pose", [Pose(), PLACE])
def test_a_capsule_along_z_has_its_ends_where_they_were(pose):
    capsule = Capsule((0.1, 0.2, 0.3), (-0.4, 0.9, 0.2), 0.05, pose=pose, link="arm")
    turned = along_z(capsule)
    assert (turned.a[:2], turned.b[:2], turned.link) == ((0, 0), (0, 0), "arm")
    for end in ("a", "b"):
        np.testing.assert_allclose(
            turned.pose.apply(getattr(turned, end)), pose.apply(getattr(capsule, end)), atol=1e-15
        )
    assert along_z(turned) is turned


def test_a_capsule_without_a_length_is_a_sphere_and_without_its_pose_moved():
    ball = along_z(Capsule((1, 0, 0), (1, 0, 0), 0.5, pose=PLACE))
    assert ball == Sphere(0.5, pose=PLACE @ Pose((1, 0, 0)))
    capsule = Capsule(0.1, 2.0, pose=PLACE, link="arm")
    moved = without_pose(capsule)
    np.testing.assert_allclose(moved.a, PLACE.apply((0, 0, -1)))
    np.testing.assert_allclose(moved.b, PLACE.apply((0, 0, 1)))
    assert without_pose(moved) is moved


def test_a_height_map_is_the_surface_over_its_grid_where_heights_are_known():
    heights = np.arange(12.0).reshape(3, 4) ** 2
    mesh = height_map(heights, 0.5, (-1.0, 2.0))
    assert len(mesh.triangles) == 12
    corners = mesh.vertices[mesh.triangles]
    middle = corners.mean(axis=1)
    # Every triangle is one half of a cell, seen from above it is turned to the eye.
    sides = corners[:, 1:] - corners[:, :1]
    np.testing.assert_allclose(np.cross(sides[:, 0], sides[:, 1])[:, 2], 0.25)
    i, j = ((mesh.vertices[:, :2] + (1.0, -2.0)) / 0.5).round().astype(int).T
    np.testing.assert_array_equal(mesh.vertices[:, 2], heights[i, j])
    assert len(np.unique(middle[:, :2], axis=0)) == 12
    heights = np.zeros((3, 4))
    heights[0, 0] = np.nan
    assert len(height_map(heights, 0.1).triangles) == 10


@pytest.mark.parametrize(("arguments", "says"), [
    ((np.zeros((1, 4)), 0.1), "2 or more along both"), ((np.zeros(4), 0.1), "2 or more along both"),
    ((np.full((2, 2), np.inf), 0.1), "none inf"),
    ((np.full((2, 2), np.nan), 0.1), "one triangle or more"),
    ((np.zeros((2, 2)), 0.0), "spacing must be"), ((np.zeros((2, 2)), 0.1, (0.0,)), "low must be 2"),
])  # fmt: skip
def test_heights_that_are_none_are_refused(arguments, says):
    refused(InvalidValue, says, height_map, *arguments)


def test_clouds_are_equal_by_the_bits_of_every_point():
    points = np.random.default_rng(0).normal(size=(1000, 3))
    cloud, same = PointCloud(points, 0.01), PointCloud(points.copy(), 0.01)
    assert cloud == same
    assert hash(cloud) == hash(same)
    for row in (0, 1, 500, 999):
        other = points.copy()
        other[row, 2] += 1e-9
        assert PointCloud(other, 0.01) != cloud
    assert PointCloud(points[:-1], 0.01) != cloud
    assert PointCloud(points, 0.02) != cloud
    assert PointCloud([(0.0, 0, 0)]) != PointCloud([(-0.0, 0, 0)])
