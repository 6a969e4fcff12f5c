"""Meshes as values and from files, and what is said without coal; tests_peers has the worlds themselves."""

import sys

import numpy as np
import pytest

from evenroad.errors import BrokenFile, InvalidValue, NotAvailable
from evenroad.geometry import TriangleMesh, load_mesh
from evenroad.geometry.mesh import merged
from tests.refused import refused

CORNERS = np.array([(x, y, z) for x in (0, 1) for y in (0, 2) for z in (0, 3)], dtype=np.float64)
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
CUBE = TriangleMesh(CORNERS, [t for a, b, c, d in SIDES for t in ((a, b, c), (a, c, d))], "cube")

ASCII_STL = """solid one
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 2 0 0
vertex 0 4 0
endloop
endfacet
endsolid one
"""


def test_the_surface_of_a_box_encloses_its_volume_with_outward_faces():
    a, b, c = np.moveaxis(CUBE.vertices[CUBE.triangles], 1, 0)
    # The divergence theorem: triangles that look outward sum up to the volume.
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(6.0)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    assert areas.sum() == pytest.approx(2 * (2 + 3 + 6))
    outward = np.cross(b - a, c - a)
    middle = np.array([0.5, 1.0, 1.5])
    assert (np.einsum("ij,ij->i", outward, (a + b + c) / 3 - middle) > 0).all()


def test_merged_meshes_keep_their_triangles_and_are_read_only():
    far = TriangleMesh(CUBE.vertices + 10, CUBE.triangles)
    both = merged((CUBE, far))
    assert both.triangles.shape == (24, 3)
    np.testing.assert_array_equal(both.vertices[both.triangles[12:]], far.vertices[far.triangles])
    with pytest.raises(ValueError, match="read-only"):
        CUBE.vertices[0, 0] = 5.0


@pytest.mark.parametrize(("vertices", "triangles", "text"), [
    (np.zeros((3, 2)), [[0, 1, 2]], "vertices"),
    ([[0, 0, np.nan], [0, 0, 1], [0, 1, 0]], [[0, 1, 2]], "finite"),
    (np.eye(3), [[0, 1]], "triangles"), (np.eye(3), [[0.0, 1.0, 2.0]], "integers"),
    (np.eye(3), [[0, 1, 3]], "rows of the 3 vertices"), (np.eye(3), [[0, 1, -1]], "rows of the 3 vertices"),
    (np.eye(3), np.empty((0, 3), dtype=int), "one triangle or more"),
    (np.eye(3), [[0, 1, 2], [0]], "triangles"),
])  # fmt: skip
def test_arrays_that_are_no_mesh_are_refused(vertices, triangles, text):
    refused(InvalidValue, text, TriangleMesh, vertices, triangles)


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "dae"])
def test_a_file_gives_the_mesh_that_was_written(tmp_path, suffix):
    trimesh = pytest.importorskip("trimesh")
    file = tmp_path / f"cube.{suffix}"
    try:
        trimesh.Trimesh(CUBE.vertices, CUBE.triangles, process=False).export(file)
    except ImportError:
        pytest.skip(f"trimesh cannot write .{suffix} here")
    mesh = load_mesh(file, scale=2.0)
    assert mesh.name == f"cube.{suffix}"
    corners = mesh.vertices[mesh.triangles].reshape(-1, 9)
    expected = 2.0 * CUBE.vertices[CUBE.triangles].reshape(-1, 9)
    np.testing.assert_allclose(corners[np.lexsort(corners.T)], expected[np.lexsort(expected.T)], rtol=1e-6, atol=1e-6)


def _dae_in(unit, folder):
    trimesh = pytest.importorskip("trimesh")
    pytest.importorskip("collada")
    file = folder / "cube.dae"
    trimesh.Trimesh(CUBE.vertices, CUBE.triangles, process=False).export(file)
    file.write_text(file.read_text().replace("</asset>", f"{unit}</asset>"))
    return file


@pytest.mark.parametrize(
    ("unit", "metres"), [("", 1.0), ('<unit name="millimetre" meter="0.001"/>', 0.001), ('<unit meter="10"/>', 10.0)]
)
def test_a_collada_file_is_read_in_metres_whatever_its_unit(tmp_path, unit, metres):
    mesh = load_mesh(_dae_in(unit, tmp_path), scale=2.0)
    np.testing.assert_allclose(np.ptp(mesh.vertices, axis=0), 2.0 * metres * np.array([1, 2, 3]), rtol=1e-6)


@pytest.mark.parametrize("length", ["0", "-1", "nan"])
def test_a_unit_without_a_length_is_refused(tmp_path, length):
    with pytest.raises(BrokenFile, match=rf"cube\.dae must have a unit of a finite length > 0, got {length} m"):
        load_mesh(_dae_in(f'<unit meter="{length}"/>', tmp_path))


def test_a_plain_text_stl_is_read(tmp_path):
    (tmp_path / "one.stl").write_text(ASCII_STL)
    mesh = load_mesh(tmp_path / "one.stl")
    assert len(mesh.triangles) == 1
    np.testing.assert_array_equal(mesh.vertices.max(axis=0), [2, 4, 0])


def test_files_that_hold_no_mesh_are_refused(tmp_path):
    refused(BrokenFile, r"gone\.stl is missing", load_mesh, tmp_path / "gone.stl")
    refused(BrokenFile, "missing", load_mesh, tmp_path)
    for name, content in [
        ("empty.stl", b""),
        ("noise.stl", b"\x00\xff" * 300),
        ("text.obj", b"hello"),
        ("text.stl", b"hello"),
        ("points.obj", b"v 0 0 0\nv 1 0 0\n"),
        ("nan.obj", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("what.xyz3", b"1 2 3"),
        ("broken.dae", b"<COLLADA>"),
    ]:
        (tmp_path / name).write_bytes(content)
        refused(BrokenFile, name.replace(".", r"\."), load_mesh, tmp_path / name)
    refused(InvalidValue, "scale", load_mesh, tmp_path / "text.obj", scale=0.0)


def test_a_ply_that_is_cut_off_is_refused_and_not_read_in_part(tmp_path):
    pytest.importorskip("trimesh")
    vertices = "".join("{:g} {:g} {:g}\n".format(*vertex) for vertex in CUBE.vertices)
    faces = "".join("3 {} {} {}\n".format(*face) for face in CUBE.triangles)
    header = (
        f"ply\nformat ascii 1.0\nelement vertex {len(CUBE.vertices)}\nproperty float x\nproperty float y\n"
        f"property float z\nelement face {len(CUBE.triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    whole = header + vertices + faces
    (tmp_path / "cube.ply").write_text(whole)
    assert len(load_mesh(tmp_path / "cube.ply").triangles) == 12
    (tmp_path / "cube.ply").write_text(whole.rstrip())
    assert len(load_mesh(tmp_path / "cube.ply").triangles) == 12
    for lost in (3, 8, 9, 30, 60):
        (tmp_path / "cube.ply").write_text(whole[:-lost])
        refused(BrokenFile, "cut off|cannot read", load_mesh, tmp_path / "cube.ply")


def test_without_what_reads_a_file_the_extra_is_named(tmp_path, monkeypatch):
    (tmp_path / "one.dae").write_text(ASCII_STL)
    monkeypatch.setitem(sys.modules, "collada", None)
    refused(NotAvailable, r"one.dae needs the extra: pip install 'evenroad\[dae\]'", load_mesh, tmp_path / "one.dae")


def test_points_beside_triangles_are_refused_since_they_would_touch_nothing(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.Scene([trimesh.creation.box(), trimesh.PointCloud(CORNERS)])
    scene.export(tmp_path / "room.glb")
    refused(BrokenFile, "8 points beside its triangles", load_mesh, tmp_path / "room.glb")


def test_a_binary_stl_is_read_as_trimesh_does_and_one_that_is_cut_off_is_refused(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere(subdivisions=2)
    (tmp_path / "ball.stl").write_bytes(ball.export(file_type="stl"))
    mesh, expected = load_mesh(tmp_path / "ball.stl"), trimesh.load(tmp_path / "ball.stl", process=False)
    np.testing.assert_array_equal(mesh.vertices[mesh.triangles], expected.vertices[expected.faces])
    assert len(mesh.compact.vertices) == len(ball.vertices)
    (tmp_path / "cut.stl").write_bytes(ball.export(file_type="stl")[:-10])
    refused(BrokenFile, "cut.stl", load_mesh, tmp_path / "cut.stl")
