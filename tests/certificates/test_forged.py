"""Certificates that were written by hand to prove what is false: both checkers refuse them."""

import struct

import numpy as np
import pytest
import trimesh

from evenroad_verify.command import main
from evenroad_verify.errors import BadInput
from tests.certificates.checker_in_c import ACCEPTED, BAD_INPUT, REFUSED, ManyChecks
from tests.certificates.small import inputs_of, sources_in
from tests.certificates.written import accepts

URDF = """<robot name="cube">
  <link name="base"/>
  <link name="cube"><collision><geometry><mesh filename="cube.stl"/></geometry></collision></link>
  <link name="hand"/>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="cube"/><axis xyz="1 0 0"/>
    <limit lower="-1" upper="1"/></joint>
  <joint name="wrist" type="{kind}"><parent link="cube"/><child link="hand"/>{mimic}
    <limit lower="-1" upper="1"/></joint>
</robot>
"""
FAR = "obstacles:\n  a: {sphere: 0.1, xyz: [5, 0, 0]}\n"
INSIDE = "obstacles:\n  a: {sphere: 0.01, xyz: [0.1, 0.05, 0]}\n"


def written(sources, triangles, obstacles=1, points=((0.0,), (0.01,)), degree=1, line=""):
    """A certificate that takes both nodes apart to single elements, and separates those by their centres."""
    tasks, answers = [(triangles, obstacles)], []
    for first, second in tasks:
        answers.append(3 if first == second == 1 else 2 if second > 1 else 1)
        if answers[-1] == 2:
            tasks += [(first, second // 2), (first, second - second // 2)]
        elif answers[-1] == 1:
            tasks += [(first // 2, second), (first - first // 2, second)]
    answers += [0] * (-len(answers) % 3)
    head = (
        f"evenroad certificate 1\ninputs {inputs_of(sources).digest}\njoint slide\n{line}degree {degree}\nmotions 1\n"
    )
    packed = bytes(a + 6 * b + 36 * c for a, b, c in zip(*[iter(answers)] * 3, strict=True))
    body = b"".join(struct.pack("<d", *point) for point in points) + packed
    return f"{head}answers {len(tasks)}\ndirections 0\n\n".encode() + body


def files_in(folder, scene, kind="revolute", mimic="", doubled=False):
    """A cube that slides, and a scene; the triangles of the cube may come twice, once from either side."""
    cube = trimesh.creation.box((1.0, 1.0, 1.0))
    faces = np.vstack([cube.faces, cube.faces[:, ::-1]]) if doubled else cube.faces
    trimesh.Trimesh(cube.vertices, faces, process=False).export(folder / "cube.stl")
    return sources_in(folder, scene, URDF.format(kind=kind, mimic=mimic))


def codes(sources, certificate):
    """What both checkers say."""
    with ManyChecks() as many:
        assert many.read(sources.robot, sources.scene) == ACCEPTED
        return (ACCEPTED if accepts(certificate, inputs_of(sources)) else REFUSED), many.code(certificate)


def test_every_point_of_a_cloud_must_be_outside_of_a_closed_mesh(tmp_path):
    scene = "obstacles:\n  a: {shape: cloud, file: a.xyz, radius: 0.01}\n"
    for inside, code in ((0.1, REFUSED), (4.0, ACCEPTED)):
        (tmp_path / "a.xyz").write_text(f"5 0 0\n{inside} 0.05 0\n")
        sources = files_in(tmp_path, scene)
        assert codes(sources, written(sources, 12, obstacles=2)) == (code, code)


@pytest.mark.parametrize("doubled", [False, True])
def test_a_mesh_whose_triangles_come_twice_is_solid(doubled, tmp_path):
    for scene, code in ((INSIDE, REFUSED), (FAR, ACCEPTED)):
        sources = files_in(tmp_path, scene, doubled=doubled)
        assert codes(sources, written(sources, 24 if doubled else 12)) == (code, code)


@pytest.mark.parametrize("times", [1, 2])
def test_two_triangles_of_the_same_corners_are_one_that_leaves_a_mesh_open(times, tmp_path):
    sources = files_in(tmp_path, INSIDE)
    cube = trimesh.load(tmp_path / "cube.stl")
    flap = [[[0.5, 0.5, 0.5], [0.6, 0.5, 0.5], [0.5, 0.6, 0.5]]] * times
    corners = np.concatenate([cube.triangles, flap]).reshape(-1, 3)
    faces = np.arange(len(corners)).reshape(-1, 3)
    trimesh.Trimesh(corners, faces, process=False).export(tmp_path / "cube.stl")
    assert codes(sources, written(sources, 12 + times)) == (ACCEPTED, ACCEPTED)


@pytest.mark.parametrize(("kind", "mimic"), [("fixed", ""), ("floating", ""), ("revolute", '<mimic joint="slide"/>')])
def test_only_a_joint_that_could_move_by_itself_is_held(kind, mimic, tmp_path):
    sources = files_in(tmp_path, FAR)
    assert codes(sources, written(sources, 12, line="held 0.5 wrist\n")) == (ACCEPTED, ACCEPTED)
    assert codes(sources, written(sources, 12, line="held 0.5 slide\n")) == (REFUSED, REFUSED)
    sources = files_in(tmp_path, FAR, kind, mimic)
    assert codes(sources, written(sources, 12, line="held 0.5 wrist\n")) == (REFUSED, REFUSED)


def test_a_table_of_waypoints_is_no_curve(tmp_path, capsys):
    sources, table = files_in(tmp_path, FAR), tmp_path / "path.csv"
    table.write_text("slide\n0\n0.01\n")
    for middle, code in ((0.005, ACCEPTED), (0.2, REFUSED)):
        certificate = tmp_path / "cube.cert"
        certificate.write_bytes(written(sources, 12, points=((0.0,), (middle,), (0.01,)), degree=2))
        words = [str(each) for each in (certificate, sources.robot, sources.scene)]
        assert main(words) == ACCEPTED
        assert main([*words, "--path", str(table)]) == code
    table.write_bytes(b"\xff\xfe")
    certificate.write_bytes(written(sources, 12))
    assert main([*words, "--path", str(table)]) == REFUSED


@pytest.mark.parametrize(
    "entry",
    [
        "{box: {size: [1, 1, 1], xyz: [0.5, 0, 0]}, xyz: [5, 0, 0]}",
        "{box: {size: [1, 1, 1], shape: box}}",
        "{shape: mesh, file: cube.stl, convex: True}",
        "{shape: mesh, file: holes.dae}",
        "{shape: mesh, file: hull.dae}",
        "{shape: mesh, file: nothing.dae}",
        "{shape: mesh, file: pairs.dae}",
    ],
)
def test_what_another_reader_could_read_otherwise_is_bad_input(entry, tmp_path):
    corners = '<polygons><input semantic="VERTEX" source="#v"/><p>0 1 2</p>{}</polygons>'
    for name, part, stride in (
        ("holes", f"<mesh>{corners.format('<ph><p>0 1 2</p><h>0 1 2</h></ph>')}", 3),
        ("pairs", f"<mesh>{corners.format('')}", 2),
        ("nothing", "<mesh>", 3),
        ("hull", "<convex_mesh>", 3),
    ):
        end = "</convex_mesh>" if name == "hull" else "</mesh>"
        (tmp_path / f"{name}.dae").write_text(
            f'<COLLADA><library_geometries><geometry id="g">{part}<source id="s"><float_array>0 0 0 1 0 0 0 1 0'
            f'</float_array><technique_common><accessor stride="{stride}"/></technique_common></source>'
            f'<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>{end}</geometry>'
            '</library_geometries><library_visual_scenes><visual_scene id="w"><node><instance_geometry url="#g"/>'
            '</node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#w"/></scene></COLLADA>'
        )
    sources = files_in(tmp_path, f"obstacles:\n  a: {entry}\n")
    with pytest.raises(BadInput):
        inputs_of(sources)
    with ManyChecks() as many:
        assert many.read(sources.robot, sources.scene) == BAD_INPUT


def test_a_robot_without_bodies_proves_nothing(tmp_path, capsys):
    sources = sources_in(
        tmp_path, "obstacles: {}\n", URDF.replace("collision", "visual").format(kind="fixed", mimic="")
    )
    head = f"evenroad certificate of no path 1\ninputs {inputs_of(sources).digest}\njoint slide\n"
    data = f"{head}goals 1\nballs 0\nwitnesses 0\ncells 1 0\n\n".encode() + struct.pack("<2d", 0.0, 0.5) + b"\0"
    (tmp_path / "cube.cert").write_bytes(data)
    assert main([str(each) for each in (tmp_path / "cube.cert", sources.robot, sources.scene)]) == REFUSED
