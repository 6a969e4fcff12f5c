from dataclasses import fields, replace

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from evenroad.errors import InvalidValue
from evenroad.geometry import Box, Capsule, Cylinder, Mesh, PointCloud, Pose, Sphere, TriangleMesh
from evenroad.geometry.fit import farthest
from evenroad.geometry.hulls import Hull, halves, piece_of, products
from evenroad.geometry.mesh import convex_hull
from tests.refused import refused
from tests.robots.mesh_arms import fork

TURNED = Pose((0.1, -0.2, 0.3), (0.0, -1.0, 0.0, 0.6, 0.0, -0.8, 0.8, 0.0, 0.6))


def mesh(of, pose=TURNED):
    return Mesh(TriangleMesh(of.vertices, of.faces), pose=pose, link="a")


def beyond(points, hull):
    """How far points are outside of a hull at most, by the planes of its sides."""
    equations = ConvexHull(hull.points).equations
    return (points @ equations[:, :3].T + equations[:, 3]).max() - hull.radius


@pytest.mark.parametrize(("shape", "corners"), [
    (Box((0.3, 0.2, 0.1), pose=TURNED, link="a"), 8), (Cylinder(0.2, 0.5, pose=TURNED, link="a"), 64),
])  # fmt: skip
def test_a_hull_contains_its_shape_and_little_else(shape, corners):
    hull = piece_of(shape).hull
    size = 0.5 * np.array(shape.size if isinstance(shape, Box) else (0.4, 0.4, 0.5))
    u = np.random.default_rng(0).uniform(-1, 1, (2000, 3))
    if isinstance(shape, Cylinder):
        u = u[np.hypot(u[:, 0], u[:, 1]) <= 1]
        u[:, :2] /= np.hypot(u[:, :1], u[:, 1:2])
    assert beyond(TURNED.apply(size * u), hull) <= 0.0
    assert len(hull.points) == corners
    assert ConvexHull(hull.points).volume <= 1.01 * shape.volume
    assert len(halves(piece_of(shape))) == 1


def test_round_shapes_are_kept():
    ball, stick = piece_of(Sphere(0.2, link="a")).hull, piece_of(Capsule(0.1, 0.4, link="a")).hull
    assert ball.is_round
    assert stick.is_round
    assert ball.radius == pytest.approx(0.2, abs=1e-8)
    np.testing.assert_array_equal(stick.points, [[0, 0, -0.2], [0, 0, 0.2]])
    refused(InvalidValue, "no hull", piece_of, PointCloud(np.zeros((1, 3))))


def test_many_corners_become_few_that_contain_the_others_by_little():
    ball = trimesh.creation.icosphere(subdivisions=5, radius=0.1)
    hull = piece_of(mesh(ball)).hull
    assert len(hull.points) < len(ball.vertices) / 15
    assert 0.0 < hull.radius < 1.5e-3
    assert beyond(TURNED.apply(ball.vertices), hull) <= 0.0


def test_a_closed_convex_mesh_is_one_solid_whose_hull_comes_nearer_in_place_of_being_split():
    drum = trimesh.creation.cylinder(radius=0.1, height=0.3, sections=400)
    piece = piece_of(mesh(drum))
    assert piece.parts.shape == (1, 800, 3)
    radii = [piece.hull.radius]
    while (nearer := halves(piece)) != (piece,):
        (piece,) = nearer
        radii.append(piece.hull.radius)
        assert beyond(TURNED.apply(drum.vertices), piece.hull) <= 0.0
    assert len(radii) > 2
    assert (np.diff(radii) < 0.0).all()
    assert radii[-1] < 1e-8
    without_a_triangle = trimesh.Trimesh(drum.vertices, drum.faces[1:])
    assert len(halves(piece_of(mesh(without_a_triangle)))) == 2


def test_halves_contain_all_triangles_of_a_fork_and_less_than_its_hull():
    pieces = [piece_of(mesh(fork()))]
    whole = ConvexHull(pieces[0].hull.points).volume
    for _ in range(3):
        pieces = [half for piece in pieces for half in halves(piece)]
    assert len(pieces) == 8
    for piece in pieces:
        assert beyond(piece.parts.reshape(-1, 3), piece.hull) <= 0.0
    area = sum(0.5 * np.linalg.norm(np.cross(t[1] - t[0], t[2] - t[0])) for p in pieces for t in p.parts)
    assert area == pytest.approx(fork().area)
    assert sum(ConvexHull(piece.hull.points).volume for piece in pieces) < 0.5 * whole


def test_hulls_are_equal_by_value():
    first, second = (Hull(np.eye(3), 0.1, "a") for _ in range(2))
    assert first == second
    assert hash(first) == hash(second)
    compared = [each.name for each in fields(first) if each.compare]
    assert compared == ["points", "radius", "link"], "of which fingerprints are made"
    assert first != replace(first, solid=True)
    assert first != Hull(np.eye(3), 0.1, "b")
    assert first != Hull(2 * np.eye(3), 0.1, "a")
    with pytest.raises(ValueError, match="read-only"):
        first.points[0] = 1.0


def test_the_hull_of_points_is_convex_faces_outward_and_holds_them_all():
    rng = np.random.default_rng(0)
    points = rng.normal(size=(200, 3))
    for grown in (0.0, 0.1):
        hull = convex_hull(points, "cloud", grown)
        a, b, c = hull.vertices[hull.triangles].swapaxes(0, 1)
        normals = np.cross(b - a, c - a)
        beyond = np.einsum("tpi,ti->tp", points - a[:, np.newaxis], normals)
        depth = beyond / np.linalg.norm(normals, axis=1)[:, np.newaxis]
        assert depth.max() <= 1e-12 - grown, "grown by a cube, a ball of that radius is inside"
        assert len(piece_of(Mesh(hull)).parts) == 1, "solid"


def test_the_hull_of_a_flat_mesh_is_a_micrometre_thick_and_of_one_place_refused():
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 0]], dtype=float)
    assert np.ptp(convex_hull(square).vertices, axis=0) == pytest.approx((1.0, 1.0, 1e-6), abs=1.1e-6)
    refused(InvalidValue, "the mesh nothing has no convex hull: 0 points", convex_hull, np.zeros((0, 3)), "nothing")
    refused(InvalidValue, "points must", convex_hull, [(0, 0), (1, 1)])


def test_products_made_in_blocks_are_those_made_at_once_and_no_farther_point_is_missed():
    rng = np.random.default_rng(0)
    for count, ways in ((30_001, 120), (5003, 250), (7, 3), (0, 4)):
        points, directions = rng.normal(size=(count, 3)), rng.normal(size=(ways, 3))
        np.testing.assert_allclose(products(points, directions), points @ directions.T, rtol=0.0, atol=1e-14)
    points = rng.normal(size=(30_001, 3))
    few = farthest(points, 128)
    assert {tuple(each) for each in farthest(few, 128)} == {tuple(each) for each in few}
    for way in np.eye(3):
        assert (few @ way).max() > 0.97 * (points @ way).max()
