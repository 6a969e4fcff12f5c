import math
import sys

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from evenroad.errors import BrokenFile, NotAvailable
from evenroad.robot.capsule import Capsule
from evenroad.robot.fit import fit_capsules, smallest_around_prism
from evenroad.robot.fit_mesh import MOST_CAPSULES, capsules_around_mesh
from evenroad.robot.fit_points import capsule_around, volume
from evenroad.robot.geometry import Geometry
from evenroad.robot.meshes import find_mesh, load_triangles
from evenroad.robot.rotation import rotation_from_rpy
from evenroad.robot.volume import shape_volume, union_volume

XYZ = (0.3, -0.2, 0.5)
TURNED = rotation_from_rpy(0.4, -1.1, 2.0)
lengths = st.floats(0.005, 2.0)


def _outside(points, capsules):
    """How far each point is outside of the union of the capsules; point by point."""
    worst = []
    for point in points:
        gaps = []
        for capsule in capsules:
            a, b = np.array(capsule.a), np.array(capsule.b)
            t = np.clip((point - a) @ (b - a) / max((b - a) @ (b - a), 1e-300), 0, 1)
            gaps.append(np.linalg.norm(point - a - t * (b - a)) - capsule.radius)
        worst.append(min(gaps))
    return np.array(worst)


def _in_link(points, geometry):
    return points @ np.reshape(geometry.rotation, (3, 3)).T + geometry.xyz


@settings(max_examples=40, deadline=None)
@given(size=st.tuples(lengths, lengths, lengths))
def test_capsules_contain_every_corner_and_face_of_a_box(size):
    geometry = Geometry("x", "box", size, XYZ, TURNED)
    steps = np.linspace(-0.5, 0.5, 7)
    grid = np.array([[x, y, z] for x in steps for y in steps for z in steps]) * size
    assert (_outside(_in_link(grid, geometry), fit_capsules(geometry)) <= 0).all()


@settings(max_examples=40, deadline=None)
@given(radius=lengths, length=lengths)
def test_a_capsule_contains_the_rims_of_a_cylinder(radius, length):
    geometry = Geometry("x", "cylinder", (radius, length), XYZ, TURNED)
    angle = np.linspace(0, 2 * np.pi, 24)
    rims = [
        np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(24, z)])
        for z in (-length / 2, length / 2)
    ]
    capsules = fit_capsules(geometry)
    assert len(capsules) == 1
    assert (_outside(_in_link(np.concatenate(rims), geometry), capsules) <= 0).all()


def test_a_sphere_and_a_capsule_are_kept():
    (ball,) = fit_capsules(Geometry("x", "sphere", (0.1,), XYZ, TURNED))
    assert ball == Capsule("x", XYZ, XYZ, 0.1)
    (capsule,) = fit_capsules(Geometry("x", "capsule", (0.1, 0.4), XYZ, TURNED))
    assert capsule.radius == 0.1
    assert math.dist(capsule.a, capsule.b) == pytest.approx(0.4)


def test_a_flat_box_gets_capsules_side_by_side_and_they_add_less_than_one():
    flat = Geometry("x", "box", (0.1, 0.3, 0.8), (0, 0, 0), rotation_from_rpy(0, 0, 0))
    radius, half = smallest_around_prism(0.5 * math.hypot(0.1, 0.3), 0.4)
    one = Capsule("x", (0, 0, -half), (0, 0, half), radius)
    capsules = fit_capsules(flat)
    assert len(capsules) == 3
    assert union_volume(capsules) < 0.7 * union_volume([one])


@settings(max_examples=60, deadline=None)
@given(
    points=arrays(np.float64, st.tuples(st.integers(1, 30), st.just(3)), elements=st.floats(-1, 1, width=32))
)
def test_a_capsule_around_points_contains_every_one(points):
    a, b, radius = capsule_around(points)
    assert (_outside(points, [Capsule("x", tuple(a), tuple(b), radius)]) <= 1e-9).all()


@settings(max_examples=25, deadline=None)
@given(
    vertices=arrays(np.float64, (12, 3), elements=st.floats(-1, 1, width=32)),
    seed=st.integers(0, 2**32 - 1),
)
def test_every_triangle_of_a_mesh_lies_within_one_of_its_capsules_union(vertices, seed):
    """Any soup of triangles: points all over the surface are in the union of the capsules."""
    rng = np.random.default_rng(seed)
    triangles = rng.integers(0, 12, (10, 3))
    capsules = [
        Capsule("x", tuple(a), tuple(b), radius) for a, b, radius in capsules_around_mesh(vertices, triangles)
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
            trimesh.creation.box(
                (1.0, 0.1, 0.1), transform=trimesh.transformations.translation_matrix((0.5, 0, 0.5))
            ),
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


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply"])
def test_a_mesh_file_is_contained_with_its_scale_and_place(tmp_path, suffix):
    file = tmp_path / f"part.{suffix}"
    trimesh.creation.capsule(0.5, 0.1).export(file)
    geometry = Geometry("x", "mesh", (1.0, 2.0, -1.0), XYZ, TURNED, file)
    vertices, _ = load_triangles(file)
    assert (_outside(_in_link(vertices * geometry.size, geometry), fit_capsules(geometry)) <= 0).all()


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("empty.stl", b"", "empty.stl"),
        ("none.obj", b"v 0 0 0\n", "none.obj"),
        ("text.stl", b"hello", "text.stl"),
        ("odd.xyzzy", b"hello", "cannot read the mesh .*odd.xyzzy"),
        ("nan.obj", b"v nan 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n", "nan.obj"),
    ],
)
def test_a_mesh_that_is_broken_or_empty_is_an_error_and_never_a_free_pass(tmp_path, name, content, says):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(BrokenFile, match=says):
        load_triangles(tmp_path / name)


def test_without_what_reads_a_mesh_the_extra_is_named(tmp_path, monkeypatch):
    trimesh.creation.box((1, 2, 3)).export(tmp_path / "part.stl")
    geometry = Geometry("x", "mesh", (1.0, 1.0, 1.0), XYZ, TURNED, tmp_path / "part.stl")
    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(NotAvailable, match=r"part\.stl needs the extra: pip install 'evenroad\[mesh\]'"):
        fit_capsules(geometry)


@pytest.mark.parametrize(
    ("name", "place"),
    [
        ("part.stl", "my_robot/urdf/part.stl"),
        ("../meshes/part.stl", "my_robot/meshes/part.stl"),
        ("package://my_robot/meshes/part.stl", "my_robot/meshes/part.stl"),
        ("package://other/part.stl", "other/part.stl"),
        ("package://in_ros/part.stl", "ros/in_ros/part.stl"),
        ("package://my%20own/part.stl", "my own/part.stl"),
    ],
)
def test_meshes_are_found_where_urdfs_and_ros_put_them(tmp_path, monkeypatch, name, place):
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "ros"))
    (tmp_path / "my_robot" / "urdf").mkdir(parents=True)
    (tmp_path / "my_robot" / "meshes").mkdir()
    (tmp_path / place).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / place).write_bytes(b"")
    found = find_mesh(name, tmp_path / "my_robot" / "urdf" / "arm.urdf", "x")
    assert found.resolve() == (tmp_path / place).resolve()


def test_a_file_url_is_absolute(tmp_path):
    (tmp_path / "part.stl").write_bytes(b"")
    assert (
        find_mesh(f"file://{tmp_path}/part.stl", tmp_path / "far" / "arm.urdf", "x") == tmp_path / "part.stl"
    )


def test_volumes_are_those_of_the_shapes(tmp_path):
    identity = rotation_from_rpy(0, 0, 0)
    mesh, soup = tmp_path / "a.stl", tmp_path / "b.stl"
    box = trimesh.creation.box((1, 2, 3))
    box.export(mesh)
    trimesh.Trimesh(box.vertices, box.faces[:-1], process=False).export(soup)
    for geometry, expected in (
        (Geometry("x", "box", (1, 2, 3), XYZ, identity), 6.0),
        (Geometry("x", "mesh", (1, 1, -2), XYZ, identity, mesh), 12.0),
        (Geometry("x", "mesh", (1, 1, 1), XYZ, identity, soup), 6.0),
        (Geometry("x", "sphere", (1,), XYZ, identity), 4 / 3 * math.pi),
        (Geometry("x", "cylinder", (1, 2), XYZ, identity), 2 * math.pi),
        (Geometry("x", "capsule", (1, 2), XYZ, identity), 2 * math.pi + 4 / 3 * math.pi),
    ):
        assert shape_volume(geometry) == pytest.approx(expected)


def test_the_volume_of_a_union_counts_what_overlaps_once():
    capsule = Capsule("x", (0, 0, 0), (0, 0, 1), 0.2)
    expected = math.pi * 0.04 * (1 + 4 / 3 * 0.2)
    assert union_volume([capsule]) == pytest.approx(expected, rel=0.03)
    assert union_volume([capsule, capsule]) == union_volume([capsule])
    away = Capsule("x", (1, 0, 0), (1, 0, 1), 0.2)
    assert union_volume([capsule, away]) == pytest.approx(2 * expected, rel=0.03)
