"""The checker in C, which shares nothing with the one in Python, says the same of every certificate and forgery."""

import os
import subprocess
import sys

import numpy as np
import pytest
import trimesh

from evenroad_verify.command import main
from tests.certificates.checker_in_c import ACCEPTED, BAD_INPUT, REFUSED, ManyChecks, program
from tests.certificates.small import certificate_in, inputs_of, sources_in
from tests.certificates.written import CHANGES, accepts, box_reach, joined, parts_of, shelf, with_digest

WALL = "obstacles:\n  wall: {shape: box, size: [0.2, 0.2, 0.2], xyz: [1.25, 0.0, 0.0]}\n"


@pytest.fixture(scope="module")
def many():
    with ManyChecks() as process:
        yield process


def says(words):
    """Return exit code, output and errors of the command in C."""
    done = subprocess.run([program("command"), *words], capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


@pytest.mark.parametrize("written", [box_reach, shelf])
def test_both_commands_print_the_same_of_a_plan(written, capsys):
    assert main(written().words) == ACCEPTED
    assert says(written().words) == (ACCEPTED, capsys.readouterr().out, "")


def test_an_output_that_is_closed_early_leaves_the_exit_code():
    refused = [box_reach().words[0], *shelf().words[1:]]
    for words, code in ((box_reach().words, ACCEPTED), (refused, REFUSED)):
        for command in ([program("command")], [sys.executable, "-m", "evenroad_verify"]):
            reading, writing = os.pipe()
            os.close(reading)
            done = subprocess.run([*command, *words], stdout=writing, stderr=subprocess.PIPE)
            os.close(writing)
            assert (done.returncode, done.stderr) == (code, b"")


def test_a_path_in_a_table_must_be_that_of_the_certificate(tmp_path):
    plan, row = tmp_path / "plan.csv", ",".join(box_reach().world.robot.group)
    plan.write_text("\n".join([row, *(",".join(map(repr, q)) for q in box_reach().path.tolist())]))
    assert says([*box_reach().words, "--path", str(plan)])[0] == ACCEPTED
    for old, new in (("1.216", "1.217"), ("\n", "\n\n0,0\n"), ("elbow", "knee")):
        (tmp_path / "other.csv").write_text(plan.read_text().replace(old, new, 1))
        words = [*box_reach().words, "--path", str(tmp_path / "other.csv")]
        assert says(words)[0] == main(words) == (BAD_INPUT if "0,0" in new else REFUSED)


def test_what_cannot_be_read_is_one_line_of_error(tmp_path):
    (tmp_path / "broken.yaml").write_text("obstacles: {a: {shape: cone}}")
    certificate, robot, scene, srdf = box_reach().words
    for words in ([certificate, robot], [certificate, robot, "none"], [certificate, scene, scene, srdf]):
        code, said, error = says(words)
        assert (code, said, len(error.splitlines())) == (BAD_INPUT, "", 1)


def forgeries(written, rng, count):
    """Yield files that claim something else than a certificate, or prove it otherwise."""
    for _ in range(count):
        lines, waypoints, packed, directions = parts_of(written.data)
        row, size = rng.integers(len(waypoints)), 10.0 ** rng.uniform(-6, 0)
        kind = rng.integers(6)
        if kind == 0:
            waypoints[row, rng.integers(6)] += rng.choice([-size, size])
        elif kind == 1:
            packed[rng.integers(len(packed))] = rng.integers(216)
        elif kind == 2:
            directions[rng.integers(len(directions))] += rng.normal(0, size, 3)
        elif kind == 3:
            directions = np.delete(directions, rng.integers(len(directions)), axis=0)
            lines = [f"directions {len(directions)}" if line.startswith("directions") else line for line in lines]
        elif kind == 4:
            lines.insert(3, f"clearance {size:.9f}")
        else:
            lines.insert(3, f"padding {size:.9f} forearm_link")
        yield joined(lines, waypoints, packed, directions)


@pytest.mark.parametrize("written", [box_reach, shelf])
def test_both_agree_on_forgeries(written, many):
    inputs, rng, accepted = written().inputs(), np.random.default_rng(5), 0
    assert many.read(written().sources.robot, written().sources.scene, written().sources.srdf) == ACCEPTED
    for data in forgeries(written(), rng, 50):
        assert many.accepts(data) == accepts(data, inputs)
        accepted += many.accepts(data)
    assert 0 < accepted < 50


@pytest.mark.parametrize("change", CHANGES)
def test_a_scene_that_became_worse_refuses_even_with_a_new_digest(change, many, tmp_path):
    worse, (old, new) = tmp_path / "worse.yaml", CHANGES[change]
    worse.write_text(box_reach().sources.scene.read_text().replace(old, new))
    assert many.read(box_reach().sources.robot, worse, box_reach().sources.srdf) == ACCEPTED
    assert not many.accepts(box_reach().data)
    assert not many.accepts(with_digest(box_reach().data, box_reach().inputs(scene=worse)))


def test_flipped_bits_never_stop_it(many, tmp_path):
    sources, data = certificate_in(tmp_path, WALL, [[-0.4], [0.0], [0.1]])
    assert many.read(sources.robot, sources.scene) == ACCEPTED
    inputs, rng, accepted = inputs_of(sources), np.random.default_rng(1), 0
    for i in range(4000):
        other = bytearray(data[: rng.integers(len(data))] if i % 20 == 0 else data)
        for place in rng.integers(len(other), size=rng.integers(1, 4)) if other else ():
            other[place] ^= 1 << rng.integers(8)
        accepted += (said := many.accepts(other))
        if said or i % 40 == 0:
            assert said == accepts(bytes(other), inputs)
    assert 0 < accepted < 1000


@pytest.mark.parametrize("suffix", ["stl", "stl_ascii", "obj", "dae"])
@pytest.mark.parametrize("radius", [0.3, 0.05])
def test_closed_meshes_are_solid(suffix, radius, many, tmp_path):
    shell = trimesh.creation.icosphere(1, radius).apply_translation([1.0 if radius == 0.3 else 1.3, 0.0, 0.0])
    data = trimesh.exchange.export.export_mesh(shell, None, file_type=suffix)
    (tmp_path / f"shell.{suffix[:3]}").write_bytes(data.encode() if isinstance(data, str) else data)
    scene = f"obstacles:\n  shell: {{shape: mesh, file: shell.{suffix[:3]}}}\n"
    sources, certificate = certificate_in(tmp_path, scene, [[-0.05], [0.05]])
    assert many.read(sources.robot, sources.scene) == ACCEPTED
    assert many.accepts(certificate) == accepts(certificate, inputs_of(sources)) == (radius == 0.05)


COLLADA = """<COLLADA><library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="f" count="{count}">{corners}</float_array></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles><input semantic="VERTEX" source="#v" offset="0"/><p>{first}</p></triangles>
<triangles><input semantic="VERTEX" source="#v" offset="0"/><p>{second}</p></triangles></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="x"><node><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#x"/></scene></COLLADA>"""


@pytest.mark.parametrize("hole", [False, True])
def test_a_closed_collada_mesh_of_two_materials_is_solid(hole, many, tmp_path):
    """The ball is within the shell, which is one of a box around it: half of its triangles have another material."""
    box = trimesh.creation.box((1.0, 1.0, 1.0)).apply_translation([1.0, 0.0, 0.0])
    box.update_faces(np.arange(12) >= hole)
    halves = {
        name: " ".join(map(str, some.ravel())) for name, some in (("first", box.faces[:5]), ("second", box.faces[5:]))
    }
    corners = " ".join(map(repr, box.vertices.ravel().tolist()))
    (tmp_path / "shell.dae").write_text(COLLADA.format(count=24, corners=corners, **halves))
    box.export(tmp_path / "shell.stl")
    scene = "obstacles:\n  shell: {shape: mesh, file: shell.stl}\n"
    _, data = certificate_in(tmp_path, scene, [[-0.05], [0.05]])
    sources = sources_in(tmp_path, scene.replace("stl", "dae"))
    inputs = inputs_of(sources)
    data = with_digest(data, inputs)
    assert many.read(sources.robot, sources.scene) == ACCEPTED
    assert many.agrees(data, inputs) is hole


@pytest.mark.parametrize("line", ["outer loop vertex 0 0 0", "vertex 0 0 0 vertex 1 0 0"])
def test_corners_that_share_a_line_of_an_stl_are_bad_input(line, many, tmp_path):
    facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    (tmp_path / "one.stl").write_text(f"solid vertex\n{facet}{line}\nendsolid\n")
    sources = sources_in(tmp_path, "obstacles: {a: {shape: mesh, file: one.stl}}\n")
    assert many.read(sources.robot, sources.scene) == BAD_INPUT


TEXTS = {
    "blocks": "obstacles: # x\n  a b:\n    shape: box\n    size:\n    - 1\n    - 2\n    - 3\n    xyz: [0, 0,\n  -9]\n",
    "quotes": "'name': 'it''s # none'\nobstacles: {\"a\": {shape: sphere, radius: 1e-2, xyz: [+9., .5, 0]}}\n",
    "list": "obstacles:\n- {name: a, box: {size: [1, 1, 1]}, xyz: [9, 0, 0]}\n-\n  sphere: 0.1\n  xyz: [8, 0, 0]\n",
    "nothing": "# only this\r\n\r\nallowed:\r\nobstacles: {}\r\n",
}
BROKEN = (
    *("obstacles: {}\nobstacles: {}", "{obstacles: {}, obstacles: {}}", "obstacles: &x {}\nname: *x"),
    *("name: |\n  text", "\tname: 1", "obstacles: [1, 2", "obstacles: {a: }}", "name: 1\n   name2: 2", "? a\n: b"),
    *("<<: {name: 1}\n- b", "[" * 100, "%YAML 1.2\n---\nname: 1", "obstacles: {a: {shape: box, size: [1, 1]}}"),
    *("other: 1", "obstacles: {a: {shape: sphere, radius: nan}}", "obstacles: {a: {shape: sphere, radius: -1}}"),
    *("obstacles: {a: {shape: sphere, radius: 0x1}}", "allowed: {a: [b]}", "obstacles: [[1, 2]]", "name: 'a", "[1,"),
    "name: a\n---\nobstacles: {}",
)


@pytest.mark.parametrize("name", TEXTS)
def test_both_read_a_scene_alike(name, many, tmp_path):
    _, data = certificate_in(tmp_path, "obstacles: {}\n", [[0.0], [0.1]])
    sources = sources_in(tmp_path, TEXTS[name])
    assert many.read(sources.robot, sources.scene) == ACCEPTED
    assert inputs_of(sources)
    assert not many.accepts(data)


@pytest.mark.parametrize("text", BROKEN)
def test_a_scene_that_is_not_understood_is_bad_input(text, many, tmp_path):
    sources = sources_in(tmp_path, text)
    assert many.read(sources.robot, sources.scene) == BAD_INPUT


@pytest.mark.parametrize(
    "urdf",
    [
        *("", "<robot", "<robot>", "<robot><link name='a'/></robo>", "<robot><link/></robot>", "<a/>", "<robot/><b/>"),
        *('<!DOCTYPE a [<!ENTITY b "c">]><robot name="&b;"/>', "<robot><link name='a'/><link name='b'/></robot>"),
        "<x>" * 300,
    ],
)
def test_a_robot_that_is_not_understood_is_bad_input(urdf, many, tmp_path):
    sources = sources_in(tmp_path, "obstacles: {}\n", urdf)
    assert many.read(sources.robot, sources.scene) == BAD_INPUT
