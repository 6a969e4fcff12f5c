"""What an MJCF says beside bodies: loops, keyframes, limits of tendons and servos."""

import re

import numpy as np
import pytest

from evenroad.errors import BrokenFile
from evenroad.planning import plan
from evenroad.robot import Scene, load_model
from tests_peers.mjcf_files import LOOP, write

mujoco = pytest.importorskip("mujoco")


@pytest.mark.parametrize(
    ("equality", "said"),
    [
        ("<connect body1='b' body2='c' anchor='0 0 0'/>", "closes a loop: the connect of 'b' with 'c'; links must"),
        ("<weld body1='b' body2='c'/>", "closes a loop: the weld of 'b' with 'c'"),
        ("<weld body1='b'/>", "closes a loop: the weld of 'b' with 'world'"),
        ("<joint joint1='j' joint2='k' polycoef='0 1 2 0 0'/>", "its equality of joint 'j' is not linear"),
        ("<joint joint1='j' joint2='k'/><joint joint1='j'/>", "its equality of joint 'j' is its second"),
    ],
)  # fmt: skip
def test_closed_loops_and_what_is_no_mimic_are_refused_in_one_line(tmp_path, equality, said):
    with pytest.raises(BrokenFile, match=said) as error:
        load_model(write(tmp_path, LOOP, f"<equality>{equality}</equality>"))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("equality", "note"),
    [
        ("<weld body1='b' body2='hand'/>", "'b' with 'hand' is left out: a body of motion capture goes"),
        ("<weld body1='b' body2='c' active='false'/>", "'b' with 'c' is left out: it is not active"),
    ],
)
def test_equalities_that_close_no_loop_are_noted(tmp_path, equality, note):
    model = load_model(write(tmp_path, LOOP, f"<equality>{equality}</equality>"))
    assert model.robot.group == ("j", "k", "i")
    assert any(said.startswith(f"the weld of {note}") for said in model.notes)


ARM = """<body name='arm' pos='0 0 .2'><joint name='turn' axis='0 1 0' range='-170 170' ref='10'/>
  <geom type='capsule' fromto='0 0 0 0 0 .4' size='.05'/><body name='sled' pos='0 0 .5'>
  <joint name='slide' type='slide' range='0 1'/><geom type='box' size='.05 .05 .1'/></body></body>"""
FREE = "<body name='crate' pos='2 0 0'><freejoint name='crate'/><geom size='.1'/></body>"


def test_keyframes_are_named_states_where_mujoco_has_them(tmp_path):
    keys = "<key name='home' qpos='2 0 0 1 0 0 0 .5 .25'/><key qpos='2 0 1 1 0 0 0 -.1 0'/>"
    path = write(tmp_path, FREE + ARM, f"<keyframe>{keys}</keyframe>")
    model = load_model(path)
    assert model.robot.states == {"home": {"turn": 0.5, "slide": 0.25}, "key_1": {"turn": -0.1, "slide": 0.0}}
    assert [note for note in model.notes if "keyframe" in note] == [
        "free joints and balls stay as they are drawn, not as in keyframe key_1"
    ]
    compiled = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(compiled)
    mujoco.mj_resetDataKeyframe(compiled, data, 0)
    mujoco.mj_kinematics(compiled, data)
    np.testing.assert_allclose(model.robot.fk("home", "sled").xyz, data.body("sled").xpos, atol=1e-9)
    assert plan(Scene(), "home", "key_1", robot=path).solved


def more_notes(folder, rest):
    """The notes that a piece adds to those of the arm."""
    return set(load_model(write(folder, ARM, rest)).notes) - set(load_model(write(folder, ARM)).notes)


@pytest.mark.parametrize(("rest", "says"), [
    ("<tendon><fixed name='rope' limited='true' range='-1 1'><joint joint='turn' coef='1'/></fixed></tendon>",
     "limits of tendons are left out: rope"),
    ("<actuator><position joint='turn' kp='5' ctrlrange='-1 1'/></actuator>", "position actuators, .*: turn"),
])  # fmt: skip
def test_limits_of_tendons_and_servos_are_noted(rest, says, tmp_path):
    (note,) = more_notes(tmp_path, rest)
    assert re.search(says, note)


@pytest.mark.parametrize("rest", [
    "<actuator><position joint='turn' kp='5' ctrlrange='-4 4'/><motor joint='turn' ctrlrange='-1 1'/></actuator>",
    "<sensor><jointpos joint='turn'/></sensor>",
    "<tendon><fixed name='rope'><joint joint='turn' coef='1'/></fixed></tendon>",
])  # fmt: skip
def test_what_limits_nothing_is_no_matter(rest, tmp_path):
    assert more_notes(tmp_path, rest) == set()
