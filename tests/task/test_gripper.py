"""Fingers are where Open and Close say: in the checks, in the trajectory, and in the file."""

import json
import math

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue, UnknownName
from evenroad.robot import with_group
from evenroad.task import Attach, Close, Detach, MoveTo, Open, Task, Wait, load_task

# An arm of one joint, and a palm at 0.3 m with two balls as fingers, which slide from 0.02 to 0.06 m beside its middle.
HAND = """<robot name="hand"><link name="base"/>
  <link name="arm"><collision><origin xyz="0.1 0 0"/><geometry><sphere radius="0.03"/></geometry></collision></link>
  <link name="palm"/>
  <link name="left"><collision><geometry><sphere radius="0.01"/></geometry></collision></link>
  <link name="right"><collision><geometry><sphere radius="0.01"/></geometry></collision></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
  <joint name="mount" type="fixed"><parent link="arm"/><child link="palm"/><origin xyz="0.3 0 0"/></joint>
  <joint name="finger_l" type="prismatic"><parent link="palm"/><child link="left"/><origin xyz="0 0.02 0"/>
    <axis xyz="0 1 0"/><limit lower="0" upper="0.04" velocity="0.1" effort="1"/></joint>
  <joint name="finger_r" type="prismatic"><parent link="palm"/><child link="right"/><origin xyz="0 -0.02 0"/>
    <axis xyz="0 1 0"/><limit lower="-0.04" upper="0" velocity="0.1" effort="1"/></joint></robot>"""
CAN = er.Sphere(0.02, xyz=(0.3, 0, 0), name="can")
TOUCHING = 0.02 + 0.01 - 0.02
"""Value of the left finger at which it touches the can: the radii of both, less where the finger is at 0."""


@pytest.fixture(scope="module")
def hand(tmp_path_factory):
    """The robot, with its fingers outside of the group."""
    file = tmp_path_factory.mktemp("hand") / "hand.urdf"
    file.write_text(HAND)
    return er.load_robot(file, group=["turn"])


@pytest.fixture(scope="module")
def done(hand):
    """A can is taken, turned by a radian, and put down; the fingers begin half open."""
    world = er.ArmWorld(with_group(hand, ["turn"], {"finger_l": 0.02, "finger_r": -0.02}), [CAN])
    steps = [Open(), Close(until="can"), Attach("can"), MoveTo([1.0]), Detach("can"), Open(), Wait(0.2), Close(0.0)]
    return Task(steps[:-1]).plan(world, [0.0])


def fingers_at(states):
    """Centres of both fingers in states of turn, finger_l and finger_r, by hand."""
    turn, left, right = states.T
    beside = np.stack([0.02 + left, right - 0.02], axis=1)
    x = 0.3 * np.cos(turn)[:, None] - beside * np.sin(turn)[:, None]
    y = 0.3 * np.sin(turn)[:, None] + beside * np.cos(turn)[:, None]
    return np.stack([x, y], axis=2)


def test_fingers_open_to_the_limits_at_which_they_are_farthest_apart(done):
    assert done.motions[0].fingers == {"finger_l": 0.04, "finger_r": -0.04}


def test_fingers_close_until_the_first_touches(done):
    closed = done.motions[1].fingers
    assert closed["finger_l"] == pytest.approx(TOUCHING, abs=2e-5)
    assert closed["finger_r"] == pytest.approx(-TOUCHING, abs=2e-5)


def test_the_trajectory_has_the_fingers_and_never_leaves_the_steps(done):
    trajectory = done.trajectory()
    assert trajectory.names == ("turn", "finger_l", "finger_r")
    states = trajectory.positions
    assert states[0].tolist() == [0.0, 0.02, -0.02]
    assert states[-1] == pytest.approx([1.0, 0.04, -0.04])
    turning = np.abs(trajectory.velocities[:, 0]) > 1e-9
    assert turning.any()
    assert np.ptp(states[turning, 1]) == 0.0
    # While the arm turns, both fingers are on the can, by their own distance from its middle.
    middle = 0.3 * np.stack([np.cos(states[turning, 0]), np.sin(states[turning, 0])], axis=1)
    apart = np.linalg.norm(fingers_at(states[turning]) - middle[:, None], axis=2)
    assert apart == pytest.approx(0.03, abs=2e-5)
    assert np.abs(np.diff(states[:, 1:], axis=0)).max() <= 0.1 * trajectory.step * (1 + 1e-9)


def test_fingers_never_enter_what_they_take(done):
    states = done.trajectory().positions
    taken = states[: int(np.argmax(np.abs(states[:, 0]) > 0.0))]
    assert (np.linalg.norm(fingers_at(taken) - [0.3, 0.0], axis=2) > 0.03 - 1e-5).all()


@pytest.mark.parametrize(("step", "passes"), [(Open(), False), (Close(), True)])
def test_an_arm_comes_near_a_post_with_closed_fingers_alone(hand, step, passes):
    at = 0.3 * math.cos(1.3), 0.3 * math.sin(1.3)
    done = Task([step, MoveTo([1.1])]).plan(er.ArmWorld(hand, [er.Sphere(0.012, xyz=(*at, 0), name="post")]), [0.0])
    beside = 0.06 if isinstance(step, Open) else 0.02
    nearest = min(
        math.dist((0.3 * math.cos(q) - beside * math.sin(q), 0.3 * math.sin(q) + beside * math.cos(q)), at)
        for q in np.linspace(0.0, 1.1, 200)
    )
    assert (nearest > 0.01 + 0.012) is passes
    assert done.solved is passes, done.message


def test_fingers_that_are_blocked_fail_the_step_and_name_what_blocks(hand):
    done = Task([Open(), MoveTo([1.0])]).plan(
        er.ArmWorld(hand, [er.Sphere(0.01, xyz=(0.3, 0.05, 0), name="rod")]), [0.0]
    )
    assert not done.solved
    assert done.message.startswith("step 0 of the task cannot be done: the fingers cannot move there: ")
    assert "rod" in done.message


def test_fingers_that_touch_nothing_fail_a_step_that_says_so(hand):
    far = er.Sphere(0.02, xyz=(0.0, 0.9, 0), name="can")
    done = Task([Open(), Close(until="can")]).plan(er.ArmWorld(hand, [far]), [0.0])
    assert done.step == 1
    assert "without touching 'can'" in done.message


def test_fingers_of_the_group_are_not_planned_for(hand):
    whole = with_group(hand, ["turn", "finger_l", "finger_r"])
    steps = [Open(), MoveTo([1.0, 0.0, 0.0]), Close(0.0), MoveTo({"turn": 0.5})]
    done = Task(steps).plan(er.ArmWorld(whole), [0.0, 0.01, -0.01])
    assert done.solved, done.message
    states = done.trajectory().positions
    assert states[0].tolist() == [0.0, 0.01, -0.01]
    turning = np.flatnonzero(np.diff(states[:, 0]))
    assert {tuple(row) for row in states[turning, 1:].round(9).tolist()} == {(0.04, -0.04), (0.0, 0.0)}


def test_named_states_are_postures_of_the_arm_once_fingers_moved(hand):
    scene = er.Scene([], states={"away": {"turn": 1.0, "finger_l": 0.0}, "wide": {"finger_l": 0.03, "finger_r": -0.03}})
    done = Task([Open("wide"), MoveTo("away")]).plan(er.ArmWorld(hand, scene), [0.0])
    assert done.solved, done.message
    assert done.trajectory().positions[-1].tolist() == pytest.approx([1.0, 0.03, -0.03])


def test_the_answer_of_a_file_is_that_of_python_and_is_saved(hand, tmp_path):
    (tmp_path / "task.yaml").write_text(
        "start: '0'\nsteps:\n- open\n- close: {until: can}\n- close: 0.01\n- open: {to: {finger_l: 0.02}}\n"
    )
    steps = load_task(tmp_path / "task.yaml").task.steps
    assert steps == (Open(), Close(until="can"), Close(0.01), Open({"finger_l": 0.02}))
    done = Task([Open(), MoveTo([0.5])]).plan(er.ArmWorld(hand), [0.0])
    done.save(tmp_path / "task.json")
    opened = json.loads((tmp_path / "task.json").read_text())["motions"][0]["parts"][0]
    assert opened["path"] == [[0.0, 0.0], [0.04, -0.04]]
    assert er.load(tmp_path / "task.json").steps[0] == Open()
    done.trajectory().save(tmp_path / "go.json")
    assert er.load(tmp_path / "go.json").names == ("turn", "finger_l", "finger_r")


def test_one_controller_gets_its_joints_alone(done):
    trajectory = done.trajectory()
    arm = trajectory.only(["turn"])
    assert arm.names == ("turn",)
    assert np.array_equal(arm.positions[:, 0], trajectory.positions[:, 0])
    assert trajectory.only(["finger_r", "finger_l"]).limits.velocity == (0.1, 0.1)
    with pytest.raises(UnknownName):
        trajectory.only(["elbow"])
    with pytest.raises(InvalidValue, match="each once"):
        trajectory.only(["turn", "turn"])


@pytest.mark.parametrize(
    ("step", "error"),
    [
        (Open(0.05), "step 0 of the task puts joint 'finger_l' at 0.05 m, 0.01 m outside its limits"),
        (Open({"turn": 1.0}), "moves joint 'turn', which is planned for: MoveTo moves it, or give a group without it"),
        (Open("shut"), "unknown state of step 0 of the task: 'shut'"),
        (Open({"thumb": 1.0}), "unknown joint of step 0 of the task: 'thumb'"),
        (Close(until="cup"), "unknown obstacle of step 0 of the task 'cup'"),
        (Open(link="foot"), "unknown link of step 0 of the task: 'foot'"),
    ],
)
def test_what_cannot_be_is_refused_by_its_step(hand, step, error):
    with pytest.raises((InvalidValue, UnknownName), match=error.replace("(", r"\(")):
        Task([step]).plan(er.ArmWorld(hand, [CAN]), [0.0])


def test_an_arm_without_fingers_has_none_to_move():
    with pytest.raises(InvalidValue, match="step 0 of the task needs fingers: 'ur5' has no joint beyond"):
        Task([Open()]).plan(er.ArmWorld("ur5"), "home")


@pytest.mark.parametrize("to", [True, [0.1], {}, {"a": "b"}, math.nan])
def test_steps_refuse_what_is_no_value_of_a_joint(to):
    with pytest.raises(InvalidValue):
        Open(to)
