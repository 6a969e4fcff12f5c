"""What a URDF says is honoured, noted or refused: nothing is dropped in silence, at no level."""

import copy
import math
from xml.etree.ElementTree import Element, fromstring, tostring

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue, UnknownName
from evenroad.loading.masses import read_masses
from evenroad.loading.urdf import read_urdf
from evenroad.robot import ArmWorld, load_model, with_limits
from evenroad.task import MoveTo, Task
from evenroad.trajectory import limits_of
from tests.robots.urdf_texts import LIMIT, SPHERE, joint, link, two_joints, urdf, write

MASS = "<inertial><origin xyz='0 0 1'/><mass value='2'/><inertia ixx='1' iyy='2' izz='3'/></inertial>"
DRAWN = "<visual><origin xyz='0 0 0'/><geometry><mesh filename='a.stl' scale='1 1 1'/></geometry></visual>"
INSIDE = f"{LIMIT}<mimic joint='a'/><safety_controller soft_lower_limit='-1' soft_upper_limit='1'/>"
FULL = urdf(
    link("base"), link("upper", DRAWN + MASS), link("lower"), joint("a", "base", "upper"),
    joint("b", "upper", "lower", inside=INSIDE),
)  # fmt: skip
ELEMENTS = range(len(list(fromstring(FULL).iter())))


def notes_of(folder, tree):
    return read_urdf(write(folder, tostring(tree, encoding="unicode"))).notes


def test_the_file_that_is_changed_below_has_no_notes(tmp_path):
    assert notes_of(tmp_path, fromstring(FULL)) == ()


@pytest.mark.parametrize("number", ELEMENTS)
def test_an_unknown_attribute_and_element_is_noted_at_every_level(number, tmp_path):
    for change in (lambda node: node.set("zzz", "1"), lambda node: node.insert(0, Element("zzz"))):
        tree = fromstring(FULL)
        node = list(tree.iter())[number]
        change(node)
        if node.tag == "geometry" and len(node) > 1 and node[1].tag == "sphere":
            continue  # Refused before: a geometry is one shape.
        (note,) = notes_of(tmp_path, tree)
        assert "zzz" in note


@pytest.mark.parametrize("number", ELEMENTS)
def test_a_misspelt_element_or_attribute_is_refused_with_a_hint(number, tmp_path):
    around = fromstring(FULL)
    node = list(around.iter())[number]
    for name in node.attrib:
        tree = copy.deepcopy(around)
        same = list(tree.iter())[number]
        same.set(name[:-1] + 2 * name[-1], same.attrib.pop(name))
        with pytest.raises(UnknownName, match=f"did you mean '{name}'"):
            notes_of(tmp_path, tree)
    if number:
        tree = copy.deepcopy(around)
        list(tree.iter())[number].tag = node.tag[:-1] + 2 * node.tag[-1]
        with pytest.raises(UnknownName, match=f"did you mean '{node.tag}'"):
            notes_of(tmp_path, tree)


@pytest.mark.parametrize("inside", [
    "<gazebo reference='a'><colision/></gazebo>", "<transmission name='t'><type>x</type></transmission>",
    "<ros2_control name='c'><joint name='a'/></ros2_control>", "<material name='m'><color rgba='1 1 1 1'/></material>",
])  # fmt: skip
def test_what_belongs_to_simulators_and_controllers_is_no_matter(inside, tmp_path):
    assert read_urdf(write(tmp_path, two_joints().replace("</robot>", inside + "</robot>"))).notes == ()


def turned(text, old, new):
    assert old in text
    return text.replace(old, new)


# 90 degrees about y, by rpy and by URDF 1.2's quaternion.
RPY, QUATERNION = "rpy='0 1.5707963267948966 0'", "quat_xyzw='0 0.7071067811865476 0 0.7071067811865476'"


@pytest.mark.parametrize("owner", ["<origin xyz='0 0 0.3'/>", "<visual><origin xyz='0 0 0'/>", "<origin xyz='0 0 1'/>"])
def test_a_quaternion_turns_joints_bodies_and_masses_as_roll_pitch_and_yaw_do(owner, tmp_path):
    cube = DRAWN.replace("<mesh filename='a.stl' scale='1 1 1'/>", "<box size='0.1 0.2 0.3'/>")
    text = urdf(link("base"), link("upper", cube + MASS), joint("a", "base", "upper"))

    def numbers(rotation):
        file = write(tmp_path, turned(text, owner, owner.replace("/>", f" {rotation}/>")))
        robot, (masses, _) = load_model(file, use_visuals=True).robot, read_masses(file)
        corners = robot.shapes[-1].corners.reshape(-1, 3).max(axis=0)
        return np.concatenate([robot.joints[0].rotation, corners, masses[0].inertia])

    np.testing.assert_allclose(numbers(QUATERNION), numbers(RPY), atol=1e-12)
    assert np.abs(numbers(QUATERNION) - numbers("")).max() > 0.05, "the rotation matters"


def test_two_rotations_of_one_origin_or_a_quaternion_that_is_none_are_refused(tmp_path):
    for rotation, says in ((f"{RPY} {QUATERNION}", "got both"), ("quat_xyzw='0 0 0 0'", "must have a direction")):
        text = turned(two_joints(), "xyz='0 0 0.3'", f"xyz='0 0 0.3' {rotation}")
        with pytest.raises(InvalidValue, match=says):
            read_urdf(write(tmp_path, text))


def with_soft(soft, kind="revolute", limit="<limit lower='-3' upper='3' velocity='2' effort='1'/>"):
    inside = f"{limit}<safety_controller k_velocity='1' {soft}/>"
    return urdf(link("base"), link("upper"), joint("a", "base", "upper", kind, inside))


@pytest.mark.parametrize(("soft", "ends", "is_noted"), [
    ("soft_lower_limit='-1' soft_upper_limit='2'", (-1, 2), True),
    ("soft_lower_limit='-9' soft_upper_limit='2'", (-3, 2), True),
    ("soft_upper_limit='2'", (-3, 2), True),
    ("soft_lower_limit='0' soft_upper_limit='0'", (-3, 3), False),
    ("", (-3, 3), False),
    ("soft_lower_limit='4' soft_upper_limit='5'", (-3, 3), True),
])  # fmt: skip
def test_soft_limits_narrow_hard_ones_and_zeros_mean_none(soft, ends, is_noted, tmp_path):
    read = read_urdf(write(tmp_path, with_soft(soft)))
    assert (read.joints[0].lower, read.joints[0].upper) == ends
    assert read.joints[0].stops == (-3, 3)
    assert any("soft limits" in note for note in read.notes) == is_noted


def test_a_joint_without_end_that_has_soft_limits_turns_between_them(tmp_path):
    (turn,) = read_urdf(write(tmp_path, with_soft("soft_lower_limit='-1' soft_upper_limit='2'", "continuous"))).joints
    assert (turn.kind, turn.lower, turn.upper, turn.stops) == ("revolute", -1, 2, (-math.inf, math.inf))


def test_a_hand_that_stands_beyond_its_soft_limits_starts_and_goes_within_them(tmp_path):
    file = write(tmp_path, with_soft("soft_lower_limit='-1' soft_upper_limit='2'"))
    scene = er.Scene([])
    for world in (ArmWorld(load_model(file).robot, scene), scene):
        more = {} if isinstance(world, ArmWorld) else {"robot": file}
        result = er.plan(world, [2.7], [0.5], **more)
        assert result.solved
        assert result.path[0].tolist() == [2.7]
        assert "soft limits" in er.plan(world, [0.5], [2.7], **more).message
        assert not er.plan(world, [3.1], [0.5], **more).solved
    world = ArmWorld(load_model(file).robot, scene)
    assert Task([MoveTo("0.5")]).plan(world, [2.7]).solved
    assert er.Replanner(world, [0.5]).update([2.7]).solved
    assert er.plan_many(world, [[2.7]], [[0.5]]).status == [er.Status.SOLVED]
    hard = with_limits(load_model(file).robot, {"a": (-3.0, 3.0)})
    assert er.plan(ArmWorld(hard, scene), [0.5], [2.7]).solved


def test_a_mimic_keeps_its_soft_and_its_hard_limits_by_its_leader(tmp_path):
    own = "<limit lower='-2' upper='2' velocity='1' effort='1'/>"
    follows = own + "<mimic joint='a' multiplier='2'/><safety_controller soft_lower_limit='-1' soft_upper_limit='1'/>"
    text = urdf(link("base"), link("upper"), link("lower", SPHERE), joint("a", "base", "upper", inside=own),
                joint("b", "upper", "lower", inside=follows))  # fmt: skip
    leader = read_urdf(write(tmp_path, text)).joints[0]
    assert (leader.lower, leader.upper, leader.stops) == (-0.5, 0.5, (-1.0, 1.0))


@pytest.mark.parametrize("name", ["arm/yaw", "gantry/x", "left/x", "a/theta"])
def test_a_joint_is_no_coordinate_of_another_because_of_its_name(name, tmp_path):
    text = two_joints().replace("'a'", f"'{name}'").replace("'upper'", f"'{name}'").replace("'b'", "'left/roll'")
    file = write(tmp_path, text)
    assert load_model(file).robot.group == (name, "left/roll")
    assert load_model(file, group=name).robot.group == (name,)


def test_accelerations_and_jerks_of_the_file_are_kept_in_time(tmp_path):
    more = LIMIT.replace("/>", " acceleration='0.5' deceleration='0.25' jerk='4'/>")
    robot = load_model(write(tmp_path, two_joints().replace(LIMIT, more, 1))).robot
    limits = limits_of(robot)
    assert limits.velocity == (2.0, 2.0)
    assert limits.acceleration[0] == 0.5
    assert limits.deceleration[0] == 0.25
    assert limits.jerk[0] == 4.0
    times = er.plan(ArmWorld(robot, er.Scene([])), [0.9, 0.0], [-0.9, 0.5]).trajectory()
    assert np.abs(times.accelerations[:, 0]).max() <= 0.5


@pytest.mark.parametrize("wrong", ["acceleration='-1'", "jerk='fast'"])
def test_rates_that_are_none_are_refused(wrong, tmp_path):
    text = two_joints().replace(LIMIT, LIMIT.replace("/>", f" {wrong}/>"), 1)
    with pytest.raises(InvalidValue, match=wrong.partition("=")[0]):
        read_urdf(write(tmp_path, text))


def test_a_plan_hands_on_the_notes_about_its_robot(tmp_path):
    file = write(tmp_path, two_joints().replace("<origin", "<zzz/><origin", 1))
    result = er.plan(er.Scene([]), [0.0, 0.0], [0.5, 0.5], robot=file)
    assert "<zzz> of <joint> 'a'" in result.notes[0]
    assert er.io.plan_record(result, {})["notes"] == result.notes
    assert er.plan(ArmWorld(load_model(file).robot), [0.0, 0.0], [0.5, 0.5]).notes == ()
