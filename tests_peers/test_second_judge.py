"""The judge beside coal sees contacts that coal misses, and agrees where coal has triangles."""

import coal
import numpy as np
import pytest
from studies.benchmarks.coal_truth import ball, given, others, poses_in, soup

from evenroad.geometry import Pose, rotation_from_rpy
from evenroad.geometry.shapes import Box, Capsule, Cylinder, Sphere
from tests_peers.second_judge import boxes_meet, distance_to

COUNT = 300


def missed(mesh, way, other):
    """Return how many of some poses in contact coal calls free."""
    corners, triangles = mesh
    body, depth, size = others()[other]
    request, result = coal.CollisionRequest(), coal.CollisionResult()
    here, ways, found = coal.Transform3s.Identity(), given(corners, triangles), 0
    for pose, _ in poses_in(ball()[0], depth, size, COUNT):
        result.clear()
        found += not coal.collide(ways[way], here, body, pose, request, result)
    return found


@pytest.mark.parametrize("other", others())
def test_coal_misses_no_contact_of_triangles(other):
    assert missed(ball(), "triangles", other) == 0
    assert missed(soup(*ball()), "triangles", other) == 0


def test_coal_misses_most_contacts_of_a_convex_body_whose_triangles_share_no_corners():
    # Where this fails, docs/guides/coal.md is out of date.
    assert missed(soup(*ball()), "convex representation", "bar") > COUNT // 2
    assert missed(ball(), "convex representation", "bar") == 0


def test_two_boxes_meet_where_a_point_is_in_both():
    turned = Pose((0.0, 0.0, 0.0), rotation_from_rpy(0.0, 0.0, np.pi / 4.0)).matrix
    # Edges cross, and no corner is in the other box.
    assert boxes_meet((2.0, 0.1, 0.1), np.eye(4), (2.0, 0.1, 0.1), turned)
    away = turned.copy()
    away[:3, 3] = (0.0, 0.0, 0.101)
    assert not boxes_meet((2.0, 0.1, 0.1), np.eye(4), (2.0, 0.1, 0.1), away)


@pytest.mark.parametrize("shape", [Box((0.2, 0.3, 0.4)), Sphere(0.2), Capsule(0.1, 0.4), Cylinder(0.1, 0.4)], ids=str)
def test_distances_are_those_to_the_nearest_of_many_points(shape):
    points = np.random.default_rng(0).uniform(-0.5, 0.5, (60, 3))
    inside = np.random.default_rng(1).uniform(-0.5, 0.5, (200_000, 3))
    inside = inside[distance_to(shape, inside) <= 0.0]
    nearest = np.array([np.linalg.norm(inside - point, axis=1).min() for point in points])
    np.testing.assert_allclose(np.maximum(distance_to(shape, points), 0.0), nearest, atol=0.03)
