"""Capsules inside of shapes: inside, and near enough to all of them."""

import numpy as np
import pytest

from evenroad.geometry import Box, Capsule, Cylinder, Mesh, PointCloud, Pose, Sphere, TriangleMesh
from evenroad.geometry.inner import capsules_inside, inner_of, is_inside

TILTED = Pose.from_rpy((0.3, -0.2, 0.5), (0.4, -1.0, 2.0))


def surface(capsules, rng, count=4_000):
    """Points on the surfaces of capsules, in the shape's own frame."""
    points = []
    for each in capsules:
        a, b = (TILTED.inverse().apply(np.array(end)) for end in (each.a, each.b))
        normal = rng.normal(size=(count, 3))
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        points.append(a + rng.random((count, 1)) * (b - a) + each.radius * normal)
    return np.concatenate(points)


@pytest.mark.parametrize(
    "size", [(0.5, 0.4, 0.02), (0.02, 0.5, 0.4), (0.1, 0.1, 0.1), (0.1, 0.2, 0.3), (1.0, 0.05, 0.05)]
)
def test_capsules_of_a_box_are_inside_and_go_from_side_to_side(size):
    inner = capsules_inside(Box(size, pose=TILTED))
    points = surface(inner, np.random.default_rng(0))
    outside = np.abs(points) - 0.5 * np.array(size)
    assert outside.max() < 0.0
    assert outside.max(axis=0).min() > -0.02 * max(size)


@pytest.mark.parametrize(("radius", "length"), [(0.1, 0.5), (0.1, 0.2), (0.2, 0.05)])
def test_capsules_of_a_cylinder_are_inside(radius, length):
    points = surface(capsules_inside(Cylinder(radius, length, pose=TILTED)), np.random.default_rng(0))
    assert np.hypot(points[:, 0], points[:, 1]).max() < radius
    assert np.abs(points[:, 2]).max() < 0.5 * length
    assert np.hypot(points[:, 0], points[:, 1]).max() > 0.98 * radius


def test_round_shapes_are_kept_and_clouds_have_no_inside():
    ball, capsule = Sphere(0.1, link="a"), Capsule((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.1, link="a")
    assert capsules_inside(capsule) == (capsule,)
    assert [each.radius for each in capsules_inside(ball)] == [0.1]
    assert capsules_inside(PointCloud(np.zeros((1, 3)), 0.1)) == ()
    assert inner_of([ball, capsule]) is None
    assert len(inner_of([ball, Box((1.0, 1.0, 1.0))])) == 1 + len(capsules_inside(Box((1.0, 1.0, 1.0))))


def box_mesh(size, centre=(0.0, 0.0, 0.0), inward=False):
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([face for a, b, c, d in sides for face in ((a, b, c), (a, c, d))])
    return corners * size + centre, faces[:, ::-1] if inward else faces


def joined(*parts):
    firsts = np.cumsum([0, *(len(vertices) for vertices, _ in parts[:-1])])
    return TriangleMesh(
        np.concatenate([vertices for vertices, _ in parts]),
        np.concatenate([faces + first for (_, faces), first in zip(parts, firsts, strict=True)]),
    )


def test_balls_of_a_closed_mesh_are_inside():
    size = np.array([0.3, 0.2, 0.1])
    inner = capsules_inside(Mesh(joined(box_mesh(size)), pose=TILTED))
    points = surface(inner, np.random.default_rng(0))
    assert (np.abs(points) - 0.5 * size).max() < 0.0
    assert max(each.radius for each in inner) > 0.045
    assert np.abs(points[:, 0]).max() > 0.12
    turned = capsules_inside(Mesh(joined(box_mesh(size, inward=True)), pose=TILTED))
    assert [each.radius for each in turned] == pytest.approx([each.radius for each in inner])


@pytest.mark.parametrize("inward", [True, False])
def test_nothing_is_inside_of_a_hollow(inward):
    """Whichever way the sides of the hollow are turned."""
    hollow = box_mesh(np.full(3, 0.3), inward=inward)
    inner = capsules_inside(Mesh(joined(box_mesh(np.full(3, 0.4)), hollow), pose=TILTED))
    points = surface(inner, np.random.default_rng(0))
    away = np.abs(points).max(axis=1)
    assert len(inner) > 0
    assert away.min() > 0.15
    assert away.max() < 0.2
    assert not is_inside(joined(box_mesh(np.full(3, 0.4)), hollow).vertices[hollow[1]], np.ones(3))


def test_nothing_is_inside_of_the_bay_of_a_link_in_the_form_of_a_c():
    """Its hull has the bay."""
    parts = (
        box_mesh((0.4, 0.1, 0.1), (0.0, -0.15, 0.0)),
        box_mesh((0.4, 0.1, 0.1), (0.0, 0.15, 0.0)),
        box_mesh((0.1, 0.198, 0.1), (-0.15, 0.0, 0.0)),
    )
    points = surface(capsules_inside(Mesh(joined(*parts), pose=TILTED)), np.random.default_rng(0))
    assert not ((points[:, 0] > -0.1) & (np.abs(points[:, 1]) < 0.1)).any()
    assert np.abs(points).max() < 0.2


def test_an_open_mesh_and_a_flat_one_have_no_inside_and_it_does_not_matter_how_triangles_face():
    vertices, faces = box_mesh(np.ones(3))
    assert capsules_inside(Mesh(TriangleMesh(vertices, faces[1:]))) == ()
    mixed = faces.copy()
    mixed[0] = mixed[0, ::-1]
    assert capsules_inside(Mesh(TriangleMesh(vertices, mixed))) == capsules_inside(Mesh(TriangleMesh(vertices, faces)))
    flat = TriangleMesh(vertices * (1.0, 1.0, 0.0), faces)
    assert capsules_inside(Mesh(flat)) == ()
