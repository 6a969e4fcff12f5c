"""Planar and floating joints are held unless they are named; a base that an SRDF lets move is planned for."""

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import EvenroadError
from evenroad.robot import load_model

BASE = """<link name="base"><collision><geometry><box size="0.4 0.3 0.2"/></geometry></collision></link>
  <link name="arm"><collision><origin xyz="0.3 0 0"/><geometry><box size="0.6 0.05 0.05"/></geometry></collision></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.2"/>
    <axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="1" effort="1"/></joint>"""
PLANAR = f"""<robot name="r"><link name="odom"/><joint name="drive" type="planar"><parent link="odom"/>
  <child link="base"/><origin xyz="0 0 0.1"/><axis xyz="0 0 1"/></joint>{BASE}</robot>"""
FIXED = f'<robot name="r">{BASE}</robot>'
SRDF = """<robot name="r"><virtual_joint name="drive" type="planar" parent_frame="odom" child_link="base"/>
  <group name="whole"><joint name="drive"/><joint name="turn"/></group><group name="arm"><joint name="turn"/></group>
</robot>"""
COORDINATES = ("drive/x", "drive/y", "drive/theta")
LIMITS = {"drive/x": (-2.0, 2.0), "drive/y": (-2.0, 2.0)}


@pytest.fixture(params=["planar joint of the URDF", "virtual joint of the SRDF"])
def load(request, tmp_path):
    """Return a loader of one robot with a base that can move."""
    (tmp_path / "r.urdf").write_text(PLANAR if request.param.startswith("planar") else FIXED)
    (tmp_path / "r.srdf").write_text(SRDF)
    return lambda **options: load_model(tmp_path / "r.urdf", srdf=tmp_path / "r.srdf", **options)


def test_a_base_is_held_unless_it_is_named(load):
    assert load(group="arm").robot.joint_names == ("turn",)
    assert load(group="whole").robot.joint_names == (*COORDINATES, "turn")
    assert load(group="turn,drive").robot.joint_names == ("turn", *COORDINATES)


def test_a_note_says_how_a_base_is_planned_for_until_it_is(load):
    held = [note for note in load(group="arm").notes if "drive" in note]
    assert held == [
        "joint 'drive' is planar: it is held at 0; --group drive plans for drive/x, drive/y, drive/theta, within 50 m"
        " or the limits of a scene"
    ]
    for group in ("whole", "drive", "turn,drive"):
        assert not [note for note in load(group=group).notes if "held at 0" in note]


def test_a_base_moves_its_links_in_the_plane_and_turns_them(load):
    robot = load(group="whole").robot
    pose = robot.fk(np.array([0.5, -0.25, np.pi / 2, 0.0]), "arm")
    np.testing.assert_allclose(pose.xyz[:2], (0.5, -0.25), atol=1e-12)
    np.testing.assert_allclose(pose.apply((1.0, 0.0, 0.0)) - pose.xyz, (0.0, 1.0, 0.0), atol=1e-12)


def test_a_state_places_the_base(load, tmp_path):
    state = '<group_state name="s" group="{}"><joint name="drive" value="1 2 0.5"/><joint name="turn" value="0.3"/>'
    states = "".join(state.format(group) + "</group_state>" for group in ("whole", "arm"))
    (tmp_path / "r.srdf").write_text(SRDF.replace("</robot>", states + "</robot>"))
    whole = load(group="whole").robot.states["s"]
    assert whole == {"drive/x": 1.0, "drive/y": 2.0, "drive/theta": 0.5, "turn": 0.3}
    assert load(group="arm").robot.states["s"]["turn"] == 0.3


def test_an_arm_on_a_base_drives_through_a_door_too_narrow_for_its_outstretched_arm(load):
    walls = [er.Box((0.1, 1.7, 1.0), xyz=(0.0, y, 0.5), name=f"wall {y:+g}") for y in (-1.15, 1.15)]
    world = er.ArmWorld(load(group="whole").robot, er.Scene(walls, limits=LIMITS))
    start, goal = np.array([-1.0, 0.0, np.pi / 2, 0.0]), np.array([1.0, 0.5, 0.0, 1.5])
    assert not world.valid(np.array([0.0, 0.0, np.pi / 2, 0.0])), "the arm reaches into the wall"
    result = er.plan(world, start, goal)
    assert result.solved
    for t in np.linspace(0.0, 1.0, 50):
        assert world.valid(world.space.interpolate(result.path[:-1], result.path[1:], t)).all()


def test_an_ordinary_joint_of_such_a_name_is_planned_for(tmp_path):
    (tmp_path / "r.urdf").write_text(FIXED.replace('"turn"', '"arm/roll"'))
    assert load_model(tmp_path / "r.urdf").robot.joint_names == ("arm/roll",)


def test_a_joint_of_the_robot_is_not_taken_for_a_base_of_its_name(tmp_path):
    name = "drive/x"
    (tmp_path / "r.urdf").write_text(FIXED.replace('"turn"', f'"{name}"'))
    (tmp_path / "r.srdf").write_text(SRDF.replace('"turn"', f'"{name}"'))
    robot = load_model(tmp_path / "r.urdf", srdf=tmp_path / "r.srdf", group="whole").robot
    assert robot.joint_names == (name,)


def test_no_joint_mimics_several_coordinates(tmp_path):
    (tmp_path / "r.urdf").write_text(
        PLANAR.replace('effort="1"/></joint>', 'effort="1"/><mimic joint="drive"/></joint>')
    )
    with pytest.raises(EvenroadError, match="'turn' in .* mimics 'drive', which has several coordinates"):
        load_model(tmp_path / "r.urdf")


def test_a_base_without_limits_goes_where_it_is_near(load):
    result = er.plan(er.ArmWorld(load(group="whole").robot), [0.0] * 4, [1.0, -0.5, 2.0, 1.0])
    assert result.solved


def test_a_floating_joint_is_held_at_0_and_a_note_says_so(tmp_path):
    (tmp_path / "r.urdf").write_text(PLANAR.replace('"planar"', '"floating"'))
    model = load_model(tmp_path / "r.urdf")
    assert model.robot.joint_names == ("turn",)
    assert "joint 'drive' is floating: it is held at 0" in model.notes[0]
    robot = load_model(tmp_path / "r.urdf", group="drive,turn").robot
    turned = robot.fk(np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.0]), "base")
    np.testing.assert_allclose(turned.xyz, (0.1, 0.2, 0.4), atol=1e-12)
    np.testing.assert_allclose(turned.rpy, (0.6, 0.5, 0.4), atol=1e-12)


def test_a_floating_virtual_joint_moves_a_base_in_all_ways(tmp_path):
    (tmp_path / "r.urdf").write_text(FIXED)
    (tmp_path / "r.srdf").write_text(SRDF.replace('"planar"', '"floating"'))
    load = lambda group: load_model(tmp_path / "r.urdf", srdf=tmp_path / "r.srdf", group=group)  # noqa: E731
    names = tuple(f"drive/{each}" for each in ("x", "y", "z", "yaw", "pitch", "roll"))
    assert load("whole").robot.joint_names == (*names, "turn")
    assert load("arm").robot.joint_names == ("turn",)
    assert (
        load("arm").notes[0].startswith("joint 'drive' is floating: it is held at 0; --group drive plans for drive/x,")
    )
    pose = load("whole").robot.fk(np.array([0.5, -0.25, 0.3, 0.0, np.pi / 2, 0.0, 0.0]), "base")
    np.testing.assert_allclose(pose.xyz, (0.5, -0.25, 0.3), atol=1e-12)
    np.testing.assert_allclose(pose.apply((1.0, 0.0, 0.0)) - pose.xyz, (0.0, 0.0, -1.0), atol=1e-12)
