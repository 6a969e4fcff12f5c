"""What the checker reads of scenes and meshes is what other people's readers read."""

import ast
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh
import yaml

import evenroad_verify
from evenroad.loading.find import DATA
from evenroad_verify.errors import BadInput
from evenroad_verify.files import Files, parse_xml
from evenroad_verify.meshes import read_mesh
from evenroad_verify.scene import read_scene
from evenroad_verify.yaml_subset import parse_yaml

CHECKER = Path(evenroad_verify.__file__).parent

TEXTS = {
    "blocks": "a:\n  b c: 1   # a comment\n  d:\n  - x\n  - y: 2\n    z: [1, 2]\n  -\n    - deep\ne: 'it''s # none'\n",
    "brackets": 'obstacles: {a: {shape: box, size: [1, 2,\n  3e-2]}, "b c": [], d: {}}\nname: x:y\n',
    "nothing": "# only this\n\nallowed:\nstates: {}\n",
    "windows": "a: 1\r\nb: [2, 3]\r\n",
}


@pytest.mark.parametrize("name", [*TEXTS, *(path.name for path in sorted(DATA.glob("*.yaml")))])
def test_a_text_is_read_as_pyyaml_reads_it(name):
    text = TEXTS[name] if name in TEXTS else (DATA / name).read_text()
    expected = yaml.load(text, Loader=yaml.BaseLoader)

    def plain(value):
        if isinstance(value, dict):
            return {key: plain(each) for key, each in value.items()}
        return [plain(each) for each in value] if isinstance(value, list) else (value or "")

    assert plain(parse_yaml(text)) == plain(expected)


@pytest.mark.parametrize(
    "text",
    [
        *("a: 1\na: 2", "{a: 1, a: 2}", "a: &x 1\nb: *x", "a: !!float 1", "a: |\n  text", "a: >\n  text", "\ta: 1"),
        *("a: [1, 2", "a: {b: }}", "a: 1\n   b: 2", "? a\n: b", "<<: {a: 1}\n- b", "[" * 100, "%YAML 1.2\n---\na: 1"),
        "name: a\n---\nobstacles: {}",
    ],
)
def test_what_is_not_understood_is_bad_input(text, tmp_path):
    (tmp_path / "scene.yaml").write_text(text)
    with pytest.raises(BadInput):
        read_scene(Files(), tmp_path / "scene.yaml")


def test_xml_with_entities_is_bad_input():
    bomb = b'<!DOCTYPE a [<!ENTITY b "bb"><!ENTITY c "&b;&b;&b;">]><robot name="&c;"/>'
    for data in (bomb, bomb.decode().encode("utf-16"), b"<robot>", b"\xff"):
        with pytest.raises(BadInput):
            parse_xml(data, "arm.urdf")


@pytest.mark.parametrize("suffix", ["stl", "stl_ascii", "obj", "dae"])
def test_triangles_are_those_that_trimesh_reads(suffix):
    mesh = trimesh.creation.icosphere(1, 0.2).apply_translation([0.3, -0.1, 0.2])
    data = trimesh.exchange.export.export_mesh(mesh, None, file_type=suffix)
    data = data.encode() if isinstance(data, str) else data
    shapes = read_mesh(data, f"mesh.{suffix[:3]}", np.array([2.0, 2.0, 2.0]))
    corners = np.concatenate([shape.points[shape.corners] for shape in shapes])
    np.testing.assert_allclose(corners, 2.0 * mesh.triangles, atol=1e-6)


def test_polygons_of_an_obj_are_fans():
    data = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1/1/1 2 3 -1\n"
    (shape,) = read_mesh(data, "square.obj", np.ones(3))
    assert shape.points[shape.corners].tolist() == [
        [[0, 0, 0], [1, 0, 0], [1, 1, 0]],
        [[0, 0, 0], [1, 1, 0], [0, 1, 0]],
    ]


@pytest.mark.parametrize("data", [b"", b"f 1 2 3\n", b"v 0 0 x\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", b"v 0 0 0\nf 1 1 4\n"])
def test_a_broken_mesh_is_bad_input(data):
    with pytest.raises(BadInput):
        read_mesh(data, "broken.obj", np.ones(3))


def test_a_corner_0_of_an_obj_and_two_corners_in_a_line_of_an_stl_are_bad_input():
    with pytest.raises(BadInput, match="counted from 1"):
        read_mesh(b"v 0 0 0\nv 1 0 0\nf 0 1 2\nv 1 1 0\n", "zero.obj", np.ones(3))
    facet = b"facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    text = b"solid vertex\n" + facet + b" ".join(facet.split()) + b"\nendsolid\n"
    with pytest.raises(BadInput, match="one line"):
        read_mesh(text, "lines.stl", np.ones(3))
    assert len(read_mesh(b"solid vertex\n" + facet + b"endsolid\n", "one.stl", np.ones(3))[0].corners) == 1


def test_the_checker_imports_numpy_alone():
    imported = set()
    for path in CHECKER.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                imported |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                imported.add(node.module.partition(".")[0])
    assert imported - sys.stdlib_module_names == {"numpy", "evenroad_verify"}
