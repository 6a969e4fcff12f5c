import json
import re
from pathlib import Path

import numpy as np
import pytest

from evenroad.collision.validate import MeshCheck
from evenroad.planning.read_problem import arm_problem
from evenroad.robot import link_poses
from evenroad.trajectory import limits_of, load_trajectory

REACH = ("plan", "box-reach.yaml", "--robot", "ur5", "--start", "home", "--goal", "inside", "--no-picture")


def test_a_plan_gets_times_in_every_format(run, tmp_path):
    files = [f"t{suffix}" for suffix in (".json", ".csv", ".yaml", ".script", ".movej.script")]
    code, out, err = run(*REACH, *(word for file in files for word in ("--trajectory", file)))
    assert (code, err) == (0, "")
    assert "trajectory" in out
    assert all((tmp_path / file).stat().st_size > 500 for file in files)
    record = json.loads((tmp_path / "box-reach.json").read_text())
    assert record["trajectory"]["files"] == files
    assert record["trajectory"]["proof"] == "certified"
    radii = [float(r) for r in re.findall(r"r=([\d.]+)", (tmp_path / "t.movej.script").read_text())]
    assert max(radii) > 0.0
    assert radii[-1] == 0.0


def test_what_is_driven_is_free_between_its_states_too(run):
    assert run(*REACH, "--trajectory", "t.json", "--deviation", "0.2")[0] == 0
    query, made = arm_problem("ur5", "box-reach", "home", "inside"), load_trajectory("t.json")
    shares = np.linspace(0.0, 1.0, 5)[:-1, None, None]
    between = made.positions[:-1] + shares * np.diff(made.positions, axis=0)
    assert query.world.valid(between.reshape(-1, 6)).all()
    limits = limits_of(query.world.robot)
    assert np.all(np.abs(np.diff(made.positions, axis=0)) <= np.array(limits.velocity) * made.times[1] + 1e-9)


def test_a_fifth_of_the_speed_takes_five_times_as_long(run):
    run(*REACH, "--trajectory", "full.json")
    run(*REACH, "--trajectory", "slow.json", "--speed", "0.2")
    full, slow = (load_trajectory(f"{name}.json") for name in ("full", "slow"))
    assert slow.duration == pytest.approx(5 * full.duration, abs=0.05)
    assert np.abs(slow.velocities).max() <= 0.2 * 3.2 + 1e-9


def test_the_tip_keeps_its_speed_and_acceleration(run):
    run(*REACH, "--trajectory", "free.json")
    assert run(*REACH, "--trajectory", "kept.json", "--tip-speed", "0.4", "--tip-acceleration", "1.5")[0] == 0
    free, kept = (load_trajectory(f"{name}.json") for name in ("free", "kept"))
    robot = arm_problem("ur5", "box-reach", "home", "inside").world.robot
    ways = [
        np.linalg.norm(np.diff(link_poses(robot, each.positions)[:, -1, :3, 3], axis=0), axis=1) / each.times[1]
        for each in (free, kept)
    ]
    assert ways[1].max() <= 0.4 * (1 + 1e-6) < ways[0].max()
    assert np.abs(np.diff(ways[1])).max() <= 1.5 * kept.times[1] * (1 + 1e-3)
    assert json.loads(Path("box-reach.json").read_text())["trajectory"]["highest"]["tip acceleration"] <= 1.0


def test_a_moving_start_and_goal_are_driven_on(run):
    velocity = {"shoulder_pan_joint": 0.2, "elbow_joint": -0.1}
    words = ",".join(f"{name}={value}" for name, value in velocity.items())
    assert run(*REACH, "--trajectory", "t.json", "--start-velocity", words, "--goal-velocity", "0,0,0,0,0,0.3")[0] == 0
    made = load_trajectory("t.json")
    for row, wanted in ((0, velocity), (-1, {made.names[5]: 0.3})):
        np.testing.assert_allclose(made.velocities[row], [wanted.get(name, 0.0) for name in made.names], atol=1e-9)


HEAVY = """
<robot name="lifter"><link name="base"/><link name="arm">
  <inertial><origin xyz="0.4 0 0"/><mass value="2"/></inertial>
  <collision><origin xyz="0.2 0 0"/><geometry><box size="0.4 0.04 0.04"/></geometry></collision></link>
  <joint name="lift" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
    <limit lower="-1.5" upper="1.5" velocity="10" effort="9"/></joint></robot>
"""


def test_torques_are_those_of_the_robots_own_file(run):
    Path("lifter.urdf").write_text(HEAVY)
    Path("nothing.yaml").write_text("obstacles: []")
    words = ("plan", "nothing.yaml", "--robot", "lifter.urdf", "--start", "1", "--goal", "-1", "--no-picture")
    assert run(*words, "--trajectory", "free.json")[0] == 0
    assert run(*words, "--torque", "--trajectory", "kept.json")[0] == 0
    free, kept = (load_trajectory(f"{name}.json") for name in ("free", "kept"))

    def largest(made):
        """2 kg at 0.4 m, which fall."""
        q, push = made.positions[:, 0], made.accelerations[:, 0]
        return np.abs(2.0 * 0.4**2 * push - 2.0 * 9.81 * 0.4 * np.cos(q)).max()

    assert largest(free) > 9.5
    assert 8.5 < largest(kept) <= 9.0


LIMIT = '<limit lower="-4" upper="4" velocity="1"/>'
PLATFORM = f"""
<robot name="platform"><link name="floor"/><link name="rail"/><link name="cart"/><link name="platform">
  <collision><origin xyz="0 0 0.2"/><geometry><box size="0.6 0.4 0.3"/></geometry></collision></link>
  <joint name="x" type="prismatic"><parent link="floor"/><child link="rail"/><axis xyz="1 0 0"/>{LIMIT}</joint>
  <joint name="y" type="prismatic"><parent link="rail"/><child link="cart"/><axis xyz="0 1 0"/>{LIMIT}</joint>
  <joint name="turn" type="revolute"><parent link="cart"/><child link="platform"/><axis xyz="0 0 1"/>{LIMIT}</joint>
</robot>
"""


def test_a_base_with_two_wheels_drives_along_its_heading(run):
    Path("platform.urdf").write_text(PLATFORM)
    Path("room.yaml").write_text("obstacles: []")
    words = ("plan", "room.yaml", "--robot", "platform.urdf", "--start", "0,0,0", "--goal", "0,1,0", "--no-picture")
    drive = ("--constraint", "differential-drive", "x=x", "y=y", "heading=turn")
    code, _, err = run(*words, *drive, "--trajectory", "t.json")
    assert (code, err) == (0, "")
    made = load_trajectory("t.json")
    x, y, heading = made.positions.T
    middle = 0.5 * (heading[1:] + heading[:-1])
    assert np.abs(np.diff(x) * np.sin(middle) - np.diff(y) * np.cos(middle)).max() < 1e-9
    assert np.ptp(heading) > 1.5


def test_a_drive_of_joints_that_are_not_there_is_refused(refuse):
    words = ("--constraint", "differential-drive", "--timed")
    assert "unknown joint of 'ur5': 'base/x'" in refuse(*REACH, *words)


@pytest.mark.parametrize(("words", "said"), [
    (["--speed", "0.5"], "--speed goes with --trajectory or --timed only"),
    (["--trajectory", "t.txt"], "unknown format of a trajectory '.txt'"),
    (["--trajectory", "t.json", "--speed", "2"], "speed must be at most 1"),
    (["--trajectory", "t.json", "--limits", "none.yaml"], "none.yaml"),
    (["--torque"], "--torque goes with --trajectory or --timed only"),
    (["--timed", "--torque"], "torques need its <inertial> elements"),
    (["--timed", "--tip-speed", "0"], "--tip-speed must be a finite number > 0"),
    (["--tip-acceleration", "2"], "--tip-acceleration goes with"),
    (["--timed", "--start-velocity", "0.1,0"], "--start-velocity must be 6 finite numbers"),
    (["--timed", "--goal-velocity", "elbow=0.1"], "did you mean 'elbow_joint'?"),
    (["--timed", "--start-velocity", "elbow_joint"], "--start-velocity must be 6 finite numbers"),
    (["--timed", "--start-velocity", "elbow_joint=9"], "must be up to"),
    (["--timed", "--start-velocity", "elbow_joint=0.1", "--via", "home"], "--start-velocity goes without --via"),
    (["--trajectory", "t.json", "--step", "0"], "step"),
    (["--trajectory", "t.script", "--step", "0.01"], "0.008"),
    (["--trajectory", "t.csv", "--controller-joints", "a,b"], "unknown joint"),
    (["--trajectory", "none/t.csv"], "none"), (["--trajectory", "box-reach.csv"], "another result"),
    (["--trajectory", "t.json", "--out", "t"], "another result"),
    (["--trajectory", "box-reach.json"], "another result"),
    (["--trajectory", "t.json", "--trajectory", "./t.json"], "another result"),
])  # fmt: skip
def test_bad_input_is_one_line_and_nothing_is_written(refuse, words, said):
    assert said in refuse(*REACH, *words)


def test_the_meshes_are_asked_about_what_is_driven(run, tmp_path, monkeypatch):
    asked = []

    def in_collision(query, path):
        asked.append(path)
        return MeshCheck("in collision", 1, "a touches b")

    (tmp_path / "t.json").write_text("of an earlier run")
    monkeypatch.setattr("evenroad.cli.trajectory.mesh_check", in_collision)
    code, _, err = run(*REACH, "--trajectory", "t.json")
    assert code == 2
    assert "in collision a touches b; a smaller --deviation may help" in err
    assert len(asked[0]) > 100
    assert not (tmp_path / "t.json").exists()


def test_an_arm_that_is_there_already_has_nothing_to_drive(run, tmp_path):
    (tmp_path / "t.json").write_text("of an earlier run")
    stay = ("plan", "box-reach.yaml", "--robot", "ur5", "--start", "home", "--goal", "home", "--no-picture")
    code, out, err = run(*stay, "--trajectory", "t.json")
    assert (code, err) == (0, "")
    assert "the start is the goal" in out
    assert not (tmp_path / "t.json").exists()
