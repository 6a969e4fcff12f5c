"""A xacro is the URDF that it stands for, as ROS's own xacro expands it."""

from pathlib import Path
from xml.etree import ElementTree

import pytest

from evenroad.errors import BrokenFile, UnknownName
from evenroad.loading.xacro.expand import expanded
from evenroad.robot import load_model, load_robot

xacro = pytest.importorskip("xacro")

XACRO = """<?xml version="1.0"?>
<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="reach" default="0.3"/>
  <xacro:property name="reach" value="$(arg reach)"/>
  <xacro:macro name="part" params="name parent">
    <link name="${name}"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
    <joint name="to_${name}" type="revolute">
      <parent link="${parent}"/><child link="${name}"/><origin xyz="0 0 ${2 * reach}"/>
      <limit lower="${-pi / 2}" upper="1" velocity="1" effort="1"/>
    </joint>
  </xacro:macro>
  <link name="base"/>
  <xacro:part name="upper" parent="base"/><xacro:part name="lower" parent="upper"/>
</robot>
"""


@pytest.mark.parametrize("name", ["arm.urdf.xacro", "arm.urdf"])
def test_a_xacro_is_read_whatever_it_is_called(tmp_path, name):
    (tmp_path / name).write_text(XACRO)
    robot = load_robot(tmp_path / name)
    assert robot.group == ("to_upper", "to_lower")
    assert robot.joints[0].xyz == (0.0, 0.0, 0.6)
    assert robot.joints[0].lower == pytest.approx(-1.5707963267948966)


def test_arguments_decide_and_are_not_mixed_up_in_the_cache(tmp_path):
    path = tmp_path / "arm.xacro"
    path.write_text(XACRO)
    assert load_robot(path).joints[0].xyz[2] == 0.6
    assert load_robot(path, arguments={"reach": "1.5"}).joints[0].xyz[2] == 3.0


def test_a_file_beside_a_xacro_is_included_by_its_name_wherever_the_process_is(tmp_path, monkeypatch):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "arm.xacro").write_text(XACRO)
    whole = '<robot name="a" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:include filename="{}"/></robot>'
    (tmp_path / "parts" / "inner.xacro").write_text(whole.format("arm.xacro"))
    (tmp_path / "whole.xacro").write_text(whole.format("parts/inner.xacro"))
    assert load_robot(tmp_path / "whole.xacro").group == ("to_upper", "to_lower")
    monkeypatch.chdir(tmp_path)
    assert load_robot("whole.xacro").group == ("to_upper", "to_lower")
    monkeypatch.chdir(tmp_path / "parts")
    assert load_robot("../whole.xacro", arguments={"reach": "1.5"}).joints[0].xyz[2] == 3.0


def test_an_argument_that_no_file_knows_is_refused(tmp_path):
    path = tmp_path / "arm.xacro"
    path.write_text(XACRO)
    with pytest.raises(UnknownName, match="argument of the xacro .*'reech'; did you mean 'reach'"):
        load_robot(path, arguments={"reech": "1.5"})
    (tmp_path / "whole.xacro").write_text(
        '<robot name="a" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:include filename="arm.xacro"/></robot>'
    )
    assert load_robot(tmp_path / "whole.xacro", arguments={"reach": "1.5"}).joints[0].xyz[2] == 3.0
    with pytest.raises(UnknownName, match="did you mean 'reach'"):
        load_robot(tmp_path / "whole.xacro", arguments={"reech": "1.5"})


def test_packages_that_are_given_are_found_in_a_xacro_and_for_its_meshes(tmp_path):
    import trimesh

    parts = tmp_path / "elsewhere"
    parts.mkdir()
    trimesh.creation.box((0.1, 0.1, 0.1)).export(parts / "box.stl")
    (parts / "macro.xacro").write_text(
        XACRO.replace('<sphere radius="0.05"/>', '<mesh filename="package://parts/box.stl"/>')
    )
    path = tmp_path / "arm.xacro"
    path.write_text(
        '<robot name="a" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:include filename="$(find parts)/macro.xacro"/></robot>'
    )
    model = load_model(path, packages={"parts": parts})
    assert [body.shapes for body in model.bodies] == [("mesh box.stl",)] * 2
    # What one robot was given is not there for the next.
    with pytest.raises(BrokenFile, match="cannot be expanded: .*parts"):
        load_model(path)


def test_a_xacro_with_a_mistake_is_refused_with_the_mistake(tmp_path):
    path = tmp_path / "arm.xacro"
    path.write_text(XACRO.replace("${2 * reach}", "${2 * far}"))
    with pytest.raises(BrokenFile, match=r"the xacro .*arm\.xacro cannot be expanded: .*far"):
        load_model(path)


ALIKE = {
    "lazy properties": (
        '<xacro:property name="b" value="${a * 2}"/><xacro:property name="a" value="1"/><x v="${b}"/>'
        '<xacro:property name="a" value="5"/><x v="${b} ${a}"/>'
    ),
    "what a text stands for": "".join(
        f'<xacro:property name="p{i}" value="{text}"/><x v="${{p{i}}} ${{p{i} * 2}}"/>'
        for i, text in enumerate(["'5'", "5", "5.0", "true", "1_0", " 7 ", "'${1 + 1}'", "a b", "1e-9", "${[1, 2]}"])
    ),
    "parameters": (
        "<xacro:property name='y' value='4'/><xacro:macro name='m' params=\"x y:=^ z:=^|7 u=${1 + 2} v:='a b' *o **p\">"
        '<x v="${x} ${y} ${z} ${u} ${v}"><xacro:insert_block name="o"/><xacro:insert_block name="p"/></x></xacro:macro>'
        '<xacro:m x="${pi}"><o xyz="${y}"/><p><a/><b/></p></xacro:m>'
        '<xacro:call macro="m" x="1" y="2"><o/><p/></xacro:call>'
    ),
    "scopes": (
        '<xacro:macro name="m" params=""><xacro:property name="k" value="${1 + 1}" scope="parent"/>'
        '<xacro:property name="g" value="7" scope="global"/><xacro:property name="own" value="3"/></xacro:macro>'
        '<xacro:macro name="n" params=""><xacro:m/><x v="${k} ${g}"/></xacro:macro>'
        '<xacro:property name="own" value="1"/><xacro:n/><xacro:m/><x v="${k} ${g} ${own}"/>'
    ),
    "arguments": (
        '<xacro:arg name="s" default="3"/><xacro:arg name="t" default="${2 * 2}"/>'
        "<x v=\"$(arg s) ${'$(arg t)' == '4'} ${$(arg s) * 2} ${xacro.arg('t')} $(eval s + 1) $${s} $$$(arg s)\"/>"
    ),
    "blocks of properties": (
        '<xacro:property name="o"><a v="${k}"/><b/></xacro:property><xacro:property name="k" value="3"/>'
        '<xacro:property name="k" default="4"/><c><xacro:insert_block name="o"/></c>'
    ),
}


@pytest.mark.parametrize("kind", ALIKE)
def test_a_xacro_is_expanded_as_ros_does(tmp_path, kind):
    path = tmp_path / "a.xacro"
    path.write_text(f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{ALIKE[kind]}</robot>')
    xacro.init_stacks(str(path))
    document = xacro.parse(None, str(path))
    xacro.process_doc(document, mappings={"s": "6"})
    ours = expanded(path, {"s": "6"} if kind == "arguments" else {}, Path, {})
    assert as_lists(ours) == as_lists(ElementTree.fromstring(document.toxml()))


def as_lists(element):
    return element.tag, dict(element.attrib), [as_lists(each) for each in element]
