"""The looks of a robot: shapes and colours that its file draws, and what stands for those that cannot be read."""

import logging
import os

import numpy as np
import pytest
from PIL import Image

import evenroad as er
from evenroad.loading.cache import file_of
from evenroad.loading.find import find_robot
from evenroad.loading.load import load_model
from evenroad.viz.bodies import robot_parts, robot_sets
from evenroad.viz.parts import by_colour
from evenroad.viz.player import arm_data

CUBE = '<geometry><box size="0.1 0.1 0.1"/></geometry>'
BALL = "<collision><geometry><sphere radius='0.2'/></geometry></collision>"
TRIANGLES = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl red\nf 1 2 3\nusemtl blue\nf 1 2 4\n"
MATERIALS = "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n"
COLLADA = """<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="1" name="metre"/><up_axis>Z_UP</up_axis></asset>
<library_effects><effect id="green"><profile_COMMON><technique sid="t"><lambert>
<diffuse><color>0 1 0 1</color></diffuse></lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#green"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common>
<accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1" material="s"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="s" target="#m"/></technique_common></bind_material></instance_geometry></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>"""


@pytest.fixture
def arm(tmp_path):
    """A function from what is drawn of a link `tip`, whose collision geometry is a ball, to the robot."""

    def made(visuals, beside=""):
        (tmp_path / "arm.urdf").write_text(
            f'<robot name="arm">{beside}<link name="base">{BALL}</link><link name="tip">{visuals}{BALL}</link>'
            '<joint name="turn" type="revolute"><parent link="base"/><child link="tip"/><origin xyz="0 0 1"/>'
            '<axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>'
        )
        return load_model(tmp_path / "arm.urdf")

    return made


def colours(model):
    """Return the colours of the tip as it is drawn, each once."""
    part = robot_parts(model.robot, model.file)["tip"]
    return sorted({tuple(row) for row in part.colours.tolist()})


def mesh(name):
    return f'<visual><geometry><mesh filename="{name}" scale="0.1 0.1 0.1"/></geometry></visual>'


def test_materials_of_a_urdf_colour_what_they_are_of_by_name_or_in_place(arm):
    beside = '<material name="steel"><color rgba="0.2 0.4 0.6 1"/></material>'
    own = '<material name=""><color rgba="1 0.5 0 1"/></material>'
    model = arm(f'<visual>{CUBE}<material name="steel"/></visual><visual>{CUBE}{own}</visual>', beside)
    assert colours(model) == [(51, 102, 153), (255, 128, 0)]
    assert [len(part.corners) for part in by_colour(robot_parts(model.robot, model.file)["tip"])] == [12, 12]


@pytest.mark.parametrize("rgba", ["", "red", "nan 0 0 1", "1"])
def test_a_colour_that_is_none_is_as_if_there_were_none(arm, rgba):
    bare = colours(arm(f"<visual>{CUBE}</visual>"))
    assert colours(arm(f'<visual>{CUBE}<material name="m"><color rgba="{rgba}"/></material></visual>')) == bare


CLEAR = '<material name="clear"><color rgba="0 1 0 0"/></material>'


@pytest.mark.parametrize(("own", "beside"), [(CLEAR, ""), ('<material name="clear"/>', CLEAR)])
def test_what_is_wholly_transparent_is_not_drawn(arm, own, beside):
    model = arm(f'<visual>{CUBE}</visual><visual><geometry><sphere radius="0.4"/></geometry>{own}</visual>', beside)
    assert np.abs(robot_parts(model.robot, model.file)["tip"].corners).max() == pytest.approx(0.05)


def test_an_obj_has_the_colours_of_its_materials(arm, tmp_path):
    (tmp_path / "tip.obj").write_text(f"mtllib tip.mtl\n{TRIANGLES}")
    (tmp_path / "tip.mtl").write_text(MATERIALS)
    model = arm(mesh("tip.obj"))
    assert colours(model) == [(0, 0, 255), (255, 0, 0)]
    data = arm_data(er.ArmWorld(model.robot), er.plan(er.ArmWorld(model.robot), [0], [0.5]), model.file)
    shown = [body["colour"] for body in data["bodies"] if (body["set"], body["name"]) == ("visual", "tip")]
    assert sorted(shown) == [[0, 0, 1], [1, 0, 0]]
    (tmp_path / "tip.mtl").write_text(MATERIALS.replace("0 0 1", "0 1 1"))
    assert colours(model) == [(0, 255, 255), (255, 0, 0)]


@pytest.mark.parametrize("changed", ["other.mtl", "skin.png", "late.mtl"])
def test_a_kept_drawing_is_drawn_anew_if_a_file_that_its_mesh_names_changes(arm, tmp_path, changed):
    """The materials have another name than the mesh, one has a texture, and one file comes later."""
    corners = "".join(f"v {0.01 * i} {0.1 * (i % 7)} {0.1 * (i % 11)}\nvt 0.5 0.5\n" for i in range(2200))
    faces = "".join(f"f {i}/{i} {i + 1}/{i + 1} {i + 2}/{i + 2}\n" for i in range(1, 2199))
    (tmp_path / "tip.obj").write_text(
        f"mtllib {'late' if changed == 'late.mtl' else 'other'}.mtl\n{corners}usemtl skin\n{faces}"
    )
    material = "newmtl skin\nKd 1 0 0\nmap_Kd skin.png\n"
    if changed != "late.mtl":
        (tmp_path / "other.mtl").write_text(material)
    Image.new("RGB", (4, 4), (32, 224, 32)).save(tmp_path / "skin.png")
    model = arm(mesh("tip.obj"))
    before = colours(model)
    assert colours(model) == before
    if changed == "skin.png":
        Image.new("RGB", (4, 4), (224, 32, 32)).save(tmp_path / "skin.png")
    else:
        (tmp_path / changed).write_text(material.replace("map_Kd skin.png\n", ""))
    assert colours(model) != before


def test_a_dae_has_the_colours_of_its_materials(arm, tmp_path):
    pytest.importorskip("collada")
    (tmp_path / "tip.dae").write_text(COLLADA)
    assert colours(arm(mesh("tip.dae"))) == [(0, 255, 0)]


def test_collision_bodies_stand_for_drawings_that_cannot_be_read_and_one_line_says_so(arm, caplog):
    model = arm(mesh("missing.obj"))
    with caplog.at_level(logging.WARNING, "evenroad"):
        shown = robot_sets(model.robot, model.file)
    (record,) = caplog.records
    assert "missing.obj" in record.getMessage()
    assert "\n" not in record.getMessage()
    assert "missing.obj" in shown.note
    assert next(iter(shown.sets)) == "collision"
    assert np.abs(shown.sets["collision"]["tip"].corners).max() == pytest.approx(0.2)


def test_an_arm_with_a_tool_looks_as_its_file_says_and_the_tool_as_its_shapes(arm, tmp_path):
    (tmp_path / "hand.urdf").write_text(f'<robot name="hand"><link name="palm">{BALL}</link></robot>')
    model = load_model(find_robot("ur5")[0])
    robot = model.robot.with_tool(er.load_robot(tmp_path / "hand.urdf"), "tool0")
    assert file_of(robot) == model.file
    sets, bare = robot_sets(robot).sets, robot_sets(model.robot).sets
    for name in ("visual", "collision"):
        assert np.abs(sets[name]["palm"].corners).max() == pytest.approx(0.2)
        np.testing.assert_array_equal(sets[name]["forearm_link"].corners, bare[name]["forearm_link"].corners)


def test_the_file_of_a_robot_is_the_one_with_its_joints(tmp_path, arm):
    """An arm with a hand, then one of the same name without: each has its own file."""
    arm(f"<visual>{CUBE}</visual>")
    (tmp_path / "with_hand.urdf").write_text(
        (tmp_path / "arm.urdf")
        .read_text()
        .replace(
            "</robot>",
            f'<link name="hand">{BALL}</link><joint name="flange" type="fixed"><parent link="tip"/>'
            '<child link="hand"/><origin xyz="0 0 1"/></joint></robot>',
        )
    )
    for file in tmp_path.glob("*.urdf"):
        # Files that were just written are not remembered.
        os.utime(file, (1e9, 1e9))
    with_hand, bare = load_model(tmp_path / "with_hand.urdf"), load_model(tmp_path / "arm.urdf")
    assert file_of(with_hand.robot).path.name == "with_hand.urdf"
    assert file_of(bare.robot).path.name == "arm.urdf"


def test_the_newest_of_many_robots_are_remembered(tmp_path, arm):
    """Each robot beyond the number that is kept puts out the oldest one alone."""
    arm(f"<visual>{CUBE}</visual>")
    text = (tmp_path / "arm.urdf").read_text()
    robots = []
    for number in range(40):
        file = tmp_path / f"arm{number}.urdf"
        file.write_text(text.replace("0 0 1", f"0 0 {1 + number}"))
        # Files that were just written are not remembered.
        os.utime(file, (1e9, 1e9))
        robots.append(load_model(file).robot)
        for back in range(min(number, 20)):
            assert file_of(robots[number - back]).path.name == f"arm{number - back}.urdf"
