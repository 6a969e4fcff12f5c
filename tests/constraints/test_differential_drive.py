"""An arm on a base that cannot go sideways: through a door, with no speed across its heading."""

import math
from itertools import pairwise

import numpy as np
import pytest

import evenroad as er
from evenroad.cli import main
from evenroad.constraints.differential_drive import driven_world
from evenroad.errors import EvenroadError, InvalidValue, NotAvailable
from evenroad.robot import with_group
from evenroad.task import MoveTo
from evenroad.trajectory import Limits, arm_trajectory, load_trajectory, make_trajectory, proved_in

PLATFORM = """
<robot name="platform">
  <link name="floor"/>
  <link name="platform">
    <collision><origin xyz="0 0 0.2"/><geometry><box size="0.6 0.4 0.3"/></geometry></collision>
  </link>
  <joint name="base" type="planar"><parent link="floor"/><child link="platform"/><axis xyz="0 0 1"/></joint>
</robot>
"""
BASE = ("base/x", "base/y", "base/theta")
DRIVE = er.constraints.DifferentialDrive()
ARM = [0.0, -1.57, 1.57, -1.57, -1.57, 0.0]


@pytest.fixture(scope="module")
def world(tmp_path_factory):
    file = tmp_path_factory.mktemp("platform") / "platform.urdf"
    file.write_text(PLATFORM)
    arm = er.load_robot("ur5")
    platform = er.load_robot(file, group=BASE).with_tool(arm, "platform", pose=er.Pose((0.1, 0.0, 0.36)))
    boxes = [
        er.Box((0.1, 1.5, 2.0), xyz=(1.5, 1.2, 1.0), name="wall left of the door"),
        er.Box((0.1, 1.5, 2.0), xyz=(1.5, -1.2, 1.0), name="wall right of the door"),
    ]
    limits = {"base/x": (-1.0, 4.0), "base/y": (-2.0, 2.0), "base/theta": (-math.pi, math.pi)}
    return er.ArmWorld(with_group(platform, (*BASE, *arm.group)), er.Scene(boxes, limits=limits))


def sideways(path):
    """Largest way across the heading, of states of a path near each other."""
    moved = np.diff(path, axis=0)
    heading = 0.5 * (path[1:, 2] + path[:-1, 2])
    return np.abs(np.cos(heading) * moved[:, 1] - np.sin(heading) * moved[:, 0]).max()


def dense(path):
    return np.concatenate([np.linspace(a, b, 200) for a, b in pairwise(path)])


def test_a_path_through_a_door_never_goes_sideways_nor_does_its_trajectory(world):
    start, goal = [0.0, 0.8, 0.0, *ARM], [3.0, 0.5, 1.0, 0.5, *ARM[1:]]
    result = er.plan(world, start, goal, constraints=DRIVE, seconds=60.0)
    assert result.solved
    assert result.proof == "certified"
    assert world.validate(result.path).all()
    assert result.path[[0, -1]].tolist() == [start, goal]
    assert sideways(dense(result.path)) < 1e-9
    assert result.bodies == world.bodies
    assert result.clearance == world.path_clearance(result.path) > 0.0
    assert result.nearest[1].startswith("wall")
    # One turn in a place is enough.
    turns = (np.delete(np.diff(result.path, axis=0), 2, axis=1) == 0.0).all(axis=1)
    assert not (turns[1:] & turns[:-1]).any()
    free = er.plan(world, start, goal)
    assert sideways(dense(free.path)) > 1e-4
    limits = Limits((0.5, 0.5, 1.0, *[1.0] * 6), (1.0, 1.0, 2.0, *[2.0] * 6))
    driven = result.trajectory(limits=limits)
    assert sideways(driven.positions) < 1e-6
    with pytest.raises(InvalidValue, match="stops where it turns: deviation must be 0"):
        result.trajectory(limits=limits, deviation=0.1)
    with pytest.raises(InvalidValue, match="stops where it turns: deviation must be 0"):
        arm_trajectory(world, result.path, limits, constraints=DRIVE)
    with pytest.raises(InvalidValue, match="starts and stops at rest"):
        result.trajectory(limits=limits, start_velocity=[0.1] * 9)


def test_a_motion_turns_drives_and_turns_and_the_one_back_is_the_same(world):
    driven, rng = driven_world(world, DRIVE), np.random.default_rng(0)
    low, high = np.array([-1.0, -2.0, -math.pi]), np.array([1.0, 2.0, math.pi])
    a, b = (np.hstack([rng.uniform(low, high, (60, 3)), rng.uniform(-0.3, 0.3, (60, 6)) + ARM]) for _ in range(2))
    found = 0
    for first, last in zip(a, b, strict=True):
        states = driven.along(first, last)
        back = driven.along(last, first)
        assert (states is None) == (back is None)
        if states is None:
            continue
        found += 1
        assert (states == back[::-1]).all()
        assert (states[0] == first).all()
        assert (states[-1] == last).all()
        assert sideways(dense(states)) < 1e-9
        # No other heading needs less turning than a quarter and a half.
        assert np.abs(np.diff(states[:, 2])).sum() <= 2.5 * math.pi
    assert found > 20


def test_backwards_where_that_needs_less_turning(world):
    driven = driven_world(world, DRIVE)
    a, b = np.array([0.5, 0.0, 0.0, *ARM]), np.array([-0.5, 0.0, 0.0, *ARM])
    assert driven.along(a, b).tolist() == [a.tolist(), b.tolist()]


def test_turns_that_follow_each_other_are_made_one_and_one_that_comes_back_is_none(world):
    driven = driven_world(world, DRIVE)
    path = np.array(
        [[x, 0.0, turn, *ARM] for x, turn in ((0.0, 0.0), (0.0, 0.4), (0.0, 0.0), (-0.3, 0.0), (-0.3, 0.2))]
    )
    path = np.vstack([path, [-0.3, 0.0, 0.1, *ARM]])
    assert driven.shortened(path)[:, :3].tolist() == [[0.0, 0.0, 0.0], [-0.3, 0.0, 0.0], [-0.3, 0.0, 0.1]]
    assert driven.shortened(path[:3])[:, :3].tolist() == [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]


def test_a_task_from_its_file_drives_such_a_base_within_limits_of_a_file(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "platform.urdf").write_text(PLATFORM)
    (tmp_path / "task.yaml").write_text(
        "robot: platform.urdf\nstart: '0 0.8 0'\nscene:\n"
        "  obstacles: {post: {shape: box, size: [0.2, 0.2, 1], xyz: [1.5, 0.8, 0.5]}}\n"
        "  limits: {base/x: [-1, 4], base/y: [-2, 2], base/theta: [-3.2, 3.2]}\n"
        "steps:\n  - move_to: {goals: ['3 0.8 0'], constraints: [differential-drive]}\n"
    )
    limit = "{has_velocity_limits: true, max_velocity: 0.5}"
    (tmp_path / "limits.yaml").write_text("joint_limits: {" + ", ".join(f"{name}: {limit}" for name in BASE) + "}")
    command = ["run", "task.yaml", "--group", "base", "-o", "out.json"]
    assert main([*command, "--limits", "limits.yaml"]) == 0
    made = load_trajectory("out.json")
    assert sideways(made.positions) < 1e-6
    scene = er.Scene(limits={"base/x": (-1.0, 4.0), "base/y": (-2.0, 2.0), "base/theta": (-3.2, 3.2)})
    world = er.ArmWorld(er.load_robot("platform.urdf", group="base"), scene)
    assert proved_in(made, world, DRIVE).proof == "certified"
    askew = make_trajectory([[0, 0.8, 0], [3, 0.4, 0]], made.limits, names=made.names)
    assert proved_in(askew, world).proof == "certified"
    with pytest.raises(NotAvailable, match="not proved free"):
        proved_in(askew, world, DRIVE)
    capsys.readouterr()
    assert main(command) == 2
    assert "has no velocity limit" in capsys.readouterr().err
    assert main(["run", "task.yaml", "--limits", "limits.yaml", "-o", "limits.yaml"]) == 2
    assert "would overwrite the file" in capsys.readouterr().err


def test_what_does_not_go_with_such_a_base_is_refused(world):
    start = [0.0, 0.8, 0.0, *ARM]
    upright = er.constraints.KeepUpright(0.1, tip="tool0")
    with pytest.raises(InvalidValue, match="cannot go sideways goes without other constraints"):
        er.plan(world, start, start, constraints=DRIVE & upright)
    with pytest.raises(InvalidValue, match="goes without approach and retreat"):
        MoveTo(ARM, approach=0.1, constraints=DRIVE)
    with pytest.raises(EvenroadError, match="base/x"):
        er.plan("box-reach", "home", "inside", robot="ur5", constraints=DRIVE)
