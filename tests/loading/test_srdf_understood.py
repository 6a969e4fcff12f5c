"""What an SRDF says is honoured, noted or refused; and notes on robots that seem to have another unit."""

from xml.etree.ElementTree import Element, fromstring, tostring

import pytest

from evenroad.cli.robot import Robot as RobotCommand
from evenroad.errors import BrokenFile, Undecided, UnknownName
from evenroad.loading.srdf import read_srdf
from evenroad.loading.urdf import read_urdf
from evenroad.robot import load_model
from tests.robots.urdf_texts import SPHERE, joint, link, two_joints, urdf, write

FULL = """<robot name='r'><group name='g'><joint name='a'/><link name='upper'/><group name='h'/></group>
<group name='h'><chain base_link='base' tip_link='lower'/></group>
<group_state name='s' group='h'><joint name='a' value='0'/></group_state>
<virtual_joint name='v' type='fixed' parent_frame='world' child_link='base'/><passive_joint name='b'/>
<end_effector name='e' parent_link='lower' group='h' zzz='1'/><disable_default_collisions link='lower'/>
<enable_collisions link1='base' link2='lower'/><disable_collisions link1='base' link2='upper' reason='Adjacent'/>
</robot>"""
ELEMENTS = [number for number, each in enumerate(fromstring(FULL).iter()) if each.tag != "end_effector"]


def read(folder, text):
    urdf = read_urdf(write(folder, two_joints()))
    return read_srdf(write(folder, text, "r.srdf"), urdf)


@pytest.mark.parametrize("number", ELEMENTS)
def test_an_unknown_attribute_and_element_is_noted_at_every_level(number, tmp_path):
    plain = read(tmp_path, FULL).notes
    for change in (lambda node: node.set("zzz", "1"), lambda node: node.insert(0, Element("zzz"))):
        tree = fromstring(FULL)
        change(list(tree.iter())[number])
        (note,) = set(read(tmp_path, tostring(tree, encoding="unicode")).notes) - set(plain)
        assert "zzz" in note


@pytest.mark.parametrize("number", ELEMENTS[1:])
def test_a_misspelt_element_is_refused_with_a_hint(number, tmp_path):
    tree = fromstring(FULL)
    node = list(tree.iter())[number]
    meant, node.tag = node.tag, node.tag + node.tag[-1]
    with pytest.raises(UnknownName, match=f"did you mean '{meant}'"):
        read(tmp_path, tostring(tree, encoding="unicode"))


def test_collisions_that_are_off_by_default_are_on_where_the_file_says_so(tmp_path):
    others = "".join(link(name) for name in ("c", "d"))
    text = two_joints().replace("</robot>", others + joint("jc", "lower", "c") + joint("jd", "c", "d") + "</robot>")
    more = "<disable_default_collisions link='c'/><enable_collisions link1='c' link2='base'/>"
    more += "<enable_collisions link1='c' link2='upper'/><disable_collisions link1='upper' link2='c'/>"
    srdf = write(tmp_path, f"<robot name='r'>{more}</robot>", "r.srdf")
    model = load_model(write(tmp_path, text), srdf=srdf)
    pairs = {frozenset(pair) for pair in model.robot.pairs}
    assert {other for pair in pairs if "c" in pair for other in pair} == {"c", "base"}
    assert frozenset(("base", "d")) in pairs
    assert any("disable_default_collisions: c" in note for note in model.notes)


@pytest.mark.parametrize(("second", "is_refused"), [("a", False), ("b", True)])
def test_two_groups_of_one_name_must_say_the_same(second, is_refused, tmp_path):
    text = FULL.replace("</robot>", "<group name='x'><joint name='{0}'/></group></robot>")
    text = text.format("a").replace("</robot>", f"<group name='x'><joint name='{second}'/></group></robot>")
    if is_refused:
        with pytest.raises(BrokenFile, match="two groups 'x'"):
            read(tmp_path, text)
    else:
        assert read(tmp_path, text).groups["x"] == ("a",)


def test_two_states_of_one_name_and_group_must_say_the_same(tmp_path):
    state = "<group_state name='s' group='h'><joint name='a' value='{}'/></group_state></robot>"
    assert read(tmp_path, FULL.replace("</robot>", state.format(0))).states["h", "s"] == {"a": 0.0}
    with pytest.raises(BrokenFile, match="two states 's' of the group 'h'"):
        read(tmp_path, FULL.replace("</robot>", state.format(1)))


def test_a_robot_of_several_groups_is_shown_with_their_names_where_a_plan_needs_one(tmp_path, capsys):
    file = write(tmp_path, two_joints())
    groups = "".join(f"<group name='g{name}'><joint name='{name}'/></group>" for name in "ab")
    srdf = write(tmp_path, f"<robot name='r'>{groups}</robot>", "r.srdf")
    with pytest.raises(Undecided, match="ga, gb"):
        load_model(file, srdf=srdf)
    assert load_model(file, srdf=srdf, group="*").robot.group == ("a", "b")
    assert RobotCommand(robot=str(file), srdf=srdf).run() == 0
    assert "--group chooses one of ga, gb" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(("text", "says"), [
    (two_joints(SPHERE.replace("0.05", "60")), "link 'lower' is 120 m long"),
    (two_joints(SPHERE.replace("0.05", "0.00004")), "link 'base' is 0.1 m long, 'lower' 8e-05 m"),
    (two_joints().replace("0 0 0.3", "0 0 300"), "is 300 m away"),
    (two_joints().replace("0.05", "0.0002"), "is 0.3 m away"),
])  # fmt: skip
def test_sizes_of_another_unit_are_noted(text, says, tmp_path):
    (note,) = load_model(write(tmp_path, text)).notes
    assert says in note
    assert "metres are expected" in note


def test_an_arm_beside_a_link_for_a_sensor_is_no_matter(tmp_path):
    assert load_model(write(tmp_path, two_joints(SPHERE.replace("0.05", "0.0002")))).notes == ()
    assert load_model(write(tmp_path, urdf(link("base"), link("up"), joint("a", "base", "up")))).notes == ()
