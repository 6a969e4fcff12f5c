import math

import numpy as np
import pytest

from evenroad.errors import EvenroadError, InvalidValue, UnknownName
from evenroad.robot import (
    Scene,
    at_states,
    configuration,
    held_values,
    load_robot,
    load_scene,
    named_states,
    with_group,
)
from tests.refused import refused
from tests.robots.urdf_texts import LIMIT, joint, link, two_joints, urdf, write


@pytest.fixture
def ur5():
    return load_robot("ur5")


LISTS = (
    "0,-1.57,0,-1.57,0,0.5",
    "0 -1.57 0 -1.57 0 0.5",
    " 0, -1.57, 0,-1.57 ,0,5e-1 ",
    "[0, -1.57, 0, -1.57, 0, 0.5]",
)


@pytest.mark.parametrize("text", LISTS)
def test_a_list_is_read_in_the_order_of_the_joints(ur5, text):
    np.testing.assert_array_equal(configuration(ur5, text), [0, -1.57, 0, -1.57, 0, 0.5])


def test_named_joints_move_and_the_others_stay(ur5):
    q = configuration(ur5, "elbow_joint=1.2,wrist_3_joint=-0.5")
    np.testing.assert_array_equal(q, [0, 0, 1.2, 0, 0, -0.5])


def test_a_state_of_the_scene_goes_before_one_of_the_robot(ur5):
    scene = Scene((), name="s", states={"home": dict.fromkeys(ur5.group, 0.25)})
    assert configuration(ur5, "home")[1] == -math.pi / 2
    assert configuration(ur5, "home", scene)[1] == 0.25
    assert set(named_states(ur5, load_scene("box-reach"))) == {"home", "inside", "zero"}


def test_degrees_turn_angles_but_neither_lengths_nor_named_states(tmp_path, ur5):
    text = urdf(link("x"), link("y"), link("z"), joint("slide", "x", "y", "prismatic"), joint("turn", "y", "z"))
    robot = load_robot(write(tmp_path, text))
    np.testing.assert_allclose(configuration(robot, "0.5,45", degrees=True), [0.5, math.pi / 4])
    np.testing.assert_allclose(configuration(robot, "turn=45", degrees=True), [0, math.pi / 4])
    assert configuration(ur5, "home", degrees=True)[1] == -math.pi / 2


def test_a_joint_that_is_not_named_stays_within_its_limits(tmp_path):
    inside = "<limit lower='0.2' upper='1' velocity='1' effort='1'/>"
    text = urdf(link("x"), link("y"), link("z"), joint("a", "x", "y"), joint("b", "y", "z", inside=inside))
    np.testing.assert_array_equal(configuration(load_robot(write(tmp_path, text)), "a=0.5"), [0.5, 0.2])


@pytest.mark.parametrize(("text", "kind", "says"), [
    ("0,0,3.5,0,0,0", InvalidValue,
        "puts joint 'elbow_joint' at 3.5 rad, 0.358 rad outside its limits .-3.14159, 3.14159."),
    ("elbow_joint=-4", InvalidValue, "joint 'elbow_joint' at -4 rad, 0.858 rad outside"),
    ("0,0,0", InvalidValue, "has 6 numbers, shoulder_pan_joint,.*; got 3 in '0,0,0'"),
    ("0,0,0,0,0,nan", InvalidValue, "joint 'wrist_3_joint' must be a finite number, got 'nan'"),
    ("0,0,x,0,0,0", InvalidValue, "joint 'elbow_joint' must be a finite number, got 'x'"),
    ("elbow_joint=x", InvalidValue, "got 'x'"),
    ("elbow_joint=1,elbow_joint=2", InvalidValue, "given twice"),
    ("elbow_joint=1,2", InvalidValue, "'2' is not of the form name=value"),
    ("knee=1", UnknownName, "joint of 'ur5': 'knee'; known: elbow_joint"),
    ("hom", UnknownName,
        "unknown state 'hom'; did you mean 'home'"),
    ("there", UnknownName, "unknown state 'there'; known: home, zero; or give 6 numbers: shoulder_pan_joint,"),
    ("", InvalidValue, "must not be empty"),
])  # fmt: skip
def test_what_is_no_configuration_is_refused_in_one_line(ur5, text, kind, says):
    with pytest.raises(EvenroadError, match=says) as caught:
        configuration(ur5, text)
    assert isinstance(caught.value, kind)
    assert "\n" not in str(caught.value)


def test_a_state_that_lacks_a_joint_or_breaks_a_limit_is_refused(ur5):
    scene = Scene((), name="s", states={"half": {"elbow_joint": 1.0}, "far": dict.fromkeys(ur5.group, 4.0)})
    with pytest.raises(InvalidValue, match="the state 'half' has no value for shoulder_pan_joint, shoulder_lift_joint"):
        configuration(ur5, "half", scene)
    refused(InvalidValue, "'far' puts joint 'elbow_joint' at 4 rad", configuration, ur5, "far", scene)


def test_a_continuous_joint_takes_any_angle(tmp_path):
    robot = load_robot(write(tmp_path, urdf(link("x"), link("y"), joint("a", "x", "y", "continuous", ""))))
    assert configuration(robot, "700", degrees=True) == math.radians(700)


@pytest.fixture
def only_a(tmp_path):
    """Two joints a and b, a finger that follows b; planned for is a alone."""
    text = two_joints().replace("</robot>", "") + link("finger")
    text += joint("f", "lower", "finger", inside=LIMIT + "<mimic joint='b'/>") + "</robot>"
    return load_robot(write(tmp_path, text), group="a")


UP = Scene(
    (), name="s", states={"up": {"a": 0.25, "b": 0.5, "f": 0.5}, "down": {"a": -0.5}, "bent": {"a": 0.5, "b": 1}}
)


@pytest.mark.parametrize("ends", [("up", "down"), ("down", "up"), ("up", "up"), (" up ", "0.3"), ("a=0.3", "up")])
def test_joints_that_are_not_planned_for_are_held_where_the_named_states_have_them(only_a, ends):
    robot = at_states(only_a, ends, UP)
    assert held_values(robot) == {"b": 0.5}
    for end in ends:
        assert configuration(robot, end, UP).shape == (1,)


def test_numbers_and_states_of_the_group_alone_hold_nothing(only_a):
    assert held_values(at_states(only_a, ("down", "0.5"), UP)) == {"b": 0.0}
    held = with_group(only_a, ["a"], {"b": 0.75})
    assert held_values(at_states(held, ("down", "0.5"), UP)) == {"b": 0.75}


def test_a_state_lacks_no_joint_breaks_no_limit_and_is_not_taken_for_another_posture(only_a):
    scene = Scene((), name="s", states={"far": {"a": 0, "b": 99}, "odd": {"a": 0, "knee": 1}})
    with pytest.raises(InvalidValue, match="the state 'far' puts joint 'b' at 99 rad, 98 rad outside its limits"):
        at_states(only_a, ("far", "0"), scene)
    refused(UnknownName, "joint of the state 'odd': 'knee'; known: a, b", at_states, only_a, ("odd", "0"), scene)
    refused(InvalidValue, "'up' has joint 'b' at 0.5, where 'arm' holds it at 0", configuration, only_a, "up", UP)
    with pytest.raises(
        InvalidValue, match="'b' is not planned for, .* from 0.5 in the state 'up' to 1 in 'bent'; the group is a"
    ):
        at_states(only_a, ("up", "bent"), UP)


def test_a_state_beyond_a_limit_by_rounding_holds_the_joint_there(only_a):
    scene = Scene((), name="s", states={"up": {"a": 0.5, "b": 1.0000001}})
    robot = at_states(only_a, ("up", "0"), scene)
    assert held_values(robot) == {"b": 1.0000001}
    np.testing.assert_array_equal(configuration(robot, "up", scene), [0.5])


def test_a_joint_with_blanks_in_its_name_can_be_given_by_name(tmp_path):
    text = urdf(link("x"), link("y"), link("z"), joint("my joint", "x", "y"), joint("the other one", "y", "z"))
    robot = load_robot(write(tmp_path, text))
    for written in ("my joint=0.5,the other one=-0.25", "my joint = 0.5 the other one=-0.25"):
        np.testing.assert_array_equal(configuration(robot, written), [0.5, -0.25])
    np.testing.assert_array_equal(configuration(robot, "the other one=-0.25"), [0, -0.25])
    refused(UnknownName, "'joint'", configuration, robot, "joint=0.5")


def test_a_robot_without_named_states_says_where_they_would_come_from():
    with pytest.raises(UnknownName, match="has no named states, as .* or give 7 numbers: shoulder_pan"):
        configuration(load_robot("arm7"), "home")
