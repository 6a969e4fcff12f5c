import math

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from evenroad.geometry.fit import (
    MOST_CAPSULES,
    capsule_around,
    capsules_around_mesh,
    fit_capsules,
    smallest_around_prism,
    union_volume,
    volume,
)
from evenroad.geometry.mesh_file import load_mesh
from evenroad.geometry.pose import Pose
from evenroad.geometry.rotation import rotation_from_rpy
from evenroad.geometry.shapes import Box, Capsule, Cylinder, Mesh, Sphere

XYZ = (0.3, -0.2, 0.5)
PLACE = Pose(XYZ, rotation_from_rpy(0.4, -1.1, 2.0))
lengths = st.floats(0.005, 2.0)


def _outside(points, capsules):
    """How far each point is outside of the union of the capsules."""
    least = np.full(len(points), np.inf)
    for capsule in capsules:
        a, way = np.array(capsule.a), np.subtract(capsule.b, capsule.a)
        t = np.clip((points - a) @ way / max(way @ way, 1e-300), 0, 1)
        least = np.minimum(least, np.linalg.norm(points - a - t[:, np.newaxis] * way, axis=1) - capsule.radius)
    return least


def _in_link(points, shape):
    return points @ np.reshape(shape.pose.rotation, (3, 3)).T + shape.pose.xyz


@settings(max_examples=40, deadline=None)
@given(size=st.tuples(lengths, lengths, lengths))
def test_capsules_contain_every_corner_and_face_of_a_box(size):
    shape = Box(size, pose=PLACE, link="x")
    steps = np.linspace(-0.5, 0.5, 7)
    grid = np.array([[x, y, z] for x in steps for y in steps for z in steps]) * size
    assert (_outside(_in_link(grid, shape), fit_capsules(shape)) <= 0).all()


@settings(max_examples=40, deadline=None)
@given(radius=lengths, length=lengths)
def test_a_capsule_contains_the_rims_of_a_cylinder(radius, length):
    shape = Cylinder(radius, length, pose=PLACE, link="x")
    angle = np.tile(np.linspace(0, 2 * np.pi, 24), 2)
    rims = np.c_[radius * np.cos(angle), radius * np.sin(angle), np.repeat([-length / 2, length / 2], 24)]
    capsules = fit_capsules(shape)
    assert len(capsules) == 1
    assert (_outside(_in_link(rims, shape), capsules) <= 0).all()


def test_a_sphere_and_a_capsule_are_kept():
    (ball,) = fit_capsules(Sphere(0.1, pose=PLACE, link="x"))
    assert ball == Capsule(XYZ, XYZ, 0.1, link="x")
    (capsule,) = fit_capsules(Capsule(0.1, 0.4, pose=PLACE, link="x"))
    assert capsule.radius == 0.1
    assert math.dist(capsule.a, capsule.b) == pytest.approx(0.4)


def test_a_flat_box_gets_capsules_side_by_side_and_they_add_less_than_one():
    flat = Box((0.1, 0.3, 0.8), link="x")
    radius, half = smallest_around_prism(0.5 * math.hypot(0.1, 0.3), 0.4)
    one = Capsule((0, 0, -half), (0, 0, half), radius, link="x")
    capsules = fit_capsules(flat)
    assert len(capsules) == 3
    assert union_volume(capsules) < 0.7 * union_volume([one])


@settings(max_examples=40, deadline=None)
@given(points=arrays(np.float64, st.tuples(st.integers(1, 30), st.just(3)), elements=st.floats(-1, 1, width=32)))
def test_a_capsule_around_points_contains_every_one(points):
    a, b, radius = capsule_around(points)
    assert (_outside(points, [Capsule(tuple(a), tuple(b), radius, link="x")]) <= 1e-9).all()


@settings(max_examples=12, deadline=None)
@given(vertices=arrays(np.float64, (12, 3), elements=st.floats(-1, 1, width=32)), seed=st.integers(0, 2**32 - 1))
def test_every_triangle_of_a_mesh_lies_within_one_of_its_capsules_union(vertices, seed):
    """Any soup of triangles: points all over the surface are in the union of the capsules."""
    rng = np.random.default_rng(seed)
    triangles = rng.integers(0, 12, (10, 3))
    capsules = [
        Capsule(tuple(a), tuple(b), radius, link="x") for a, b, radius in capsules_around_mesh(vertices, triangles)
    ]
    assert 1 <= len(capsules) <= MOST_CAPSULES
    weights = rng.dirichlet(np.ones(3), (10, 20))
    surface = np.einsum("tkc,tcx->tkx", weights, vertices[triangles]).reshape(-1, 3)
    assert (_outside(surface, capsules) <= 1e-9).all()
    assert (_outside(vertices[triangles].reshape(-1, 3), capsules) <= 1e-9).all()


def test_an_angle_of_two_bars_gets_more_than_one_capsule():
    bars = trimesh.util.concatenate(
        [
            trimesh.creation.box((0.1, 0.1, 1.0)),
            trimesh.creation.box((1.0, 0.1, 0.1), transform=trimesh.transformations.translation_matrix((0.5, 0, 0.5))),
        ]
    )
    fitted = capsules_around_mesh(np.array(bars.vertices), np.array(bars.faces))
    assert len(fitted) >= 2
    assert sum(map(volume, fitted)) < 0.5 * volume(capsule_around(np.array(bars.vertices)))


def test_a_link_that_is_thick_at_both_ends_gets_capsules_of_its_own_there():
    """Parting with one end alone saves nothing yet: the rest is as thick as before."""
    places = [trimesh.transformations.translation_matrix((0, 0, z)) for z in (-0.25, 0.25)]
    ends = [trimesh.creation.box((0.12, 0.16, 0.12), transform=place) for place in places]
    link = trimesh.util.concatenate([trimesh.creation.cylinder(0.03, 0.6, sections=24), *ends])
    fitted = capsules_around_mesh(np.array(link.vertices), np.array(link.faces))
    assert len(fitted) == 3
    assert min(radius for *_, radius in fitted) < 0.04


def test_the_same_mesh_gives_the_same_capsules():
    mesh = trimesh.creation.cone(0.1, 0.5)
    first, second = (capsules_around_mesh(np.array(mesh.vertices), np.array(mesh.faces)) for _ in range(2))
    assert [(*a, *b, r) for a, b, r in first] == [(*a, *b, r) for a, b, r in second]


def test_a_mesh_file_is_contained_with_its_scale_and_place(tmp_path):
    trimesh.creation.capsule(0.5, 0.1).export(file := tmp_path / "part.stl")
    shape = Mesh(file, (1.0, 2.0, -1.0), pose=PLACE, link="x")
    vertices = load_mesh(file).vertices
    assert (_outside(_in_link(vertices * shape.scale, shape), fit_capsules(shape)) <= 0).all()


def test_volumes_are_those_of_the_shapes(tmp_path):
    mesh, soup = tmp_path / "a.stl", tmp_path / "b.stl"
    box = trimesh.creation.box((1, 2, 3))
    box.export(mesh)
    trimesh.Trimesh(box.vertices, box.faces[:-1], process=False).export(soup)
    for shape, expected in (
        (Box((1, 2, 3)), 6.0),
        (Mesh(mesh, (1, 1, -2)), 12.0),
        (Mesh(soup), 6.0),
        (Sphere(1), 4 / 3 * math.pi),
        (Cylinder(1, 2), 2 * math.pi),
        (Capsule((0, 0, 0), (2, 0, 0), 1), 2 * math.pi + 4 / 3 * math.pi),
    ):
        assert shape.volume == pytest.approx(expected)


def test_the_volume_of_a_union_counts_what_overlaps_once():
    capsule = Capsule((0, 0, 0), (0, 0, 1), 0.2, link="x")
    expected = math.pi * 0.04 * (1 + 4 / 3 * 0.2)
    assert union_volume([capsule]) == pytest.approx(expected, rel=0.03)
    assert union_volume([capsule, capsule]) == union_volume([capsule])
    away = Capsule((1, 0, 0), (1, 0, 1), 0.2, link="x")
    assert union_volume([capsule, away]) == pytest.approx(2 * expected, rel=0.03)
