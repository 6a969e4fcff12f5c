"""What is sent is proved anew, from the states that are sent: damage, other states and other scenes are refused."""

import json
import random
import re

import numpy as np
import pytest

import evenroad as er
from evenroad._seal import with_digest
from evenroad.trajectory import Limits, make_trajectory, save_trajectory

REACH = ("plan", "box-reach.yaml", "--robot", "ur5", "--start", "home", "--goal", "inside", "--no-picture")
SEND = ("--fastest", "10")
WALL = "wall: {shape: box, size: [0.4, 0.4, 1.2], xyz: [0.45, 0.35, 0.5]}"
TURN = ("--start", "0,-1.57,0,-1.57,0,0", "--goal", "1.5,-0.4,0,-1.57,0,0")


@pytest.fixture
def planned(run, tmp_path):
    """A plan with times: its file, and its record."""
    run(*REACH, "--timed", "-o", "plan.json")
    return tmp_path / "plan.json", json.loads((tmp_path / "plan.json").read_text())


def written(file, record, *, sealed=True):
    """Write a record as somebody would who knows of the digest, or of none."""
    plain = {name: value for name, value in record.items() if name != "sha256"}
    file.write_text(json.dumps(with_digest(plain) if sealed else plain))


def test_a_plan_with_any_wrong_digit_is_refused(planned, refuse):
    file, record = planned
    text, rng = file.read_text(), random.Random(5)
    digits = [i for i, letter in enumerate(text) if letter.isdigit()]
    for i in rng.sample(digits, 12):
        damaged = text[:i] + str((int(text[i]) + rng.randint(1, 9)) % 10) + text[i + 1 :]
        try:
            if json.loads(damaged) == record:
                # A last digit that makes no other number.
                continue
        except ValueError:
            pass
        file.write_text(damaged)
        refuse("send", "plan.json", *SEND)


def _hit(states):
    """Bend the states in the middle, smoothly, into the table."""
    bump = np.sin(np.linspace(0.0, np.pi, len(states["times"]))) ** 2
    table, push = np.array(states["positions"]), 1.5
    table[:, 1] += push * bump
    dt = states["times"][1]
    states["positions"] = table.tolist()
    states["velocities"] = np.gradient(table, dt, axis=0).tolist()
    states["accelerations"] = np.zeros_like(table).tolist()
    for kind in ("velocity", "acceleration"):
        states["limits"][kind] = [1e3] * 6


def _spike(states):
    states["positions"][30][2] += 0.01


def _slower_than_it_says(states):
    states["velocities"] = np.zeros_like(states["velocities"]).tolist()


def _faster_clock(states):
    states["times"] = [0.3 * each for each in states["times"]]


def _begins_later(states):
    for name in ("positions", "velocities", "accelerations"):
        states[name] = states[name][20:]
    states["times"] = states["times"][:-20]


def _ends_earlier(states):
    for name in ("times", "positions", "velocities", "accelerations"):
        states[name] = states[name][:-20]


def _other_joints(states):
    states["joint_names"] = states["joint_names"][::-1]


@pytest.mark.parametrize(("change", "said"), [
    (_hit, "not proved free at .* s|acceleration of"), (_spike, "acceleration"),
    (_slower_than_it_says, "velocity and motion"), (_faster_clock, "velocity"),
    (_begins_later, "does not begin at the start"), (_ends_earlier, "does not end at a goal"),
    (_other_joints, "joints"),
])  # fmt: skip
@pytest.mark.parametrize("sealed", [False, True])
def test_states_are_proved_as_they_are_sent_whatever_the_file_says(planned, refuse, change, said, sealed):
    file, record = planned
    change(record["trajectory"]["states"])
    written(file, record, sealed=sealed)
    assert_says(refuse("send", "plan.json", *SEND, "--controller-joints", ",".join(er.load_robot("ur5").group)), said)


def assert_says(line, pattern):
    assert re.search(pattern, line), line


def test_states_of_a_plan_in_another_scene_are_refused(planned, run, refuse, tmp_path):
    file, record = planned
    (tmp_path / "none.yaml").write_text("obstacles: {}\n")
    start, goal = (",".join(map(str, record["query"][end])) for end in ("start", "goal"))
    run("plan", "none.yaml", "--robot", "ur5", f"--start={start}", f"--goal={goal}", "--timed", "-o", "none.json")
    record["trajectory"] = json.loads((tmp_path / "none.json").read_text())["trajectory"]
    written(file, record)
    assert_says(refuse("send", "plan.json", *SEND), "not proved free at .* touches")


def test_a_plan_that_does_not_say_of_what_it_was_made_is_proved_and_that_is_said(run, refuse, tmp_path):
    scene, file = tmp_path / "c.yaml", tmp_path / "c.json"
    scene.write_text("obstacles: {}\n")
    run("plan", "c.yaml", "--robot", "ur5", *TURN, "--timed", "--no-picture")
    record = json.loads(file.read_text())
    code, out, err = run("send", "c.json", *SEND)
    assert (code, err) == (0, "")
    assert "certified" in out
    for missing in ("made_of", "sha256"):
        written(file, {name: value for name, value in record.items() if name != missing}, sealed=missing != "sha256")
        code, out, err = run("send", "c.json", *SEND)
        assert code == 0
        assert "only what is proved anew is known" in err
        assert "certified" in out
    # What the file says of limits is not believed then.
    record["trajectory"]["states"]["limits"]["acceleration"] = [1e3] * 6
    _bend(record["trajectory"]["states"], 40.0)
    written(file, record, sealed=False)
    assert "acceleration" in refuse("send", "c.json", "--fastest", "10")
    scene.write_text("obstacles: {" + WALL + "}\n")
    record = {name: value for name, value in record.items() if name not in ("made_of", "sha256", "trajectory")}
    written(file, record, sealed=False)
    assert_says(refuse("send", "c.json", *SEND), "not proved free")


def _bend(states, push):
    """Let a joint accelerate more than it can, without a jump."""
    dt, n = states["times"][1], len(states["times"])
    wave = np.zeros(n)
    wave[n // 2 - 4 : n // 2 + 4] = push * np.array([1, -1, -1, 1, 1, -1, -1, 1])
    speed = dt * np.cumsum(wave)
    table = np.array(states["positions"])
    table[:, 5] += dt * np.cumsum(speed)
    states["positions"] = table.tolist()
    states["velocities"] = np.gradient(table, dt, axis=0).tolist()


def test_what_a_plan_keeps_is_proved_anew_too(run, refuse, tmp_path):
    (tmp_path / "none.yaml").write_text("obstacles: {}\n")
    ends = ("--start", "0,-1.57,1.57,-1.57,-1.57,0", "--goal", "1.2,-1.2,1.2,-1.57,-1.57,0", "--no-picture", "--timed")
    plan = ("plan", "none.yaml", "--robot", "ur5", *ends)
    assert run(*plan, "--straight", "0.1 0.1", "-o", "kept.json")[0] == 0
    assert run(*plan, "-o", "free.json")[0] == 0
    kept, free = (json.loads((tmp_path / name).read_text()) for name in ("kept.json", "free.json"))
    assert run("send", "kept.json", *SEND)[0] == 0
    assert "made for" in run("send", "kept.json", "--fastest", "0.3")[1]
    written(tmp_path / "kept.json", kept | {"trajectory": free["trajectory"]})
    assert_says(refuse("send", "kept.json", *SEND), "not proved free")


def test_a_trajectory_s_file_says_where_it_is_proved_anew(run, refuse, tmp_path):
    scene, file = tmp_path / "c.yaml", tmp_path / "t.json"
    scene.write_text("obstacles: {}\n")
    run("plan", "c.yaml", "--robot", "ur5", *TURN, "--trajectory", "t.json", "--no-picture")
    code, out, err = run("send", "t.json", *SEND)
    assert (code, err) == (0, "")
    assert "certified" in out
    text = file.read_text()
    file.write_text(text.replace("0.008,", "0.009,", 1))
    assert "not as it was written" in refuse("send", "t.json", *SEND)
    file.write_text(text)
    scene.write_text("obstacles: {" + WALL + "}\n")
    assert "scene of t.json changed" in refuse("send", "t.json", *SEND)


def test_one_that_does_not_say_it_needs_a_robot_and_a_scene(run, refuse, tmp_path):
    group = er.load_robot("ur5").group
    made = make_trajectory([[0, -1.57, 0, -1.57, 0, 0], [1.5, -0.4, 0, -1.57, 0, 0]], Limits((1.0,) * 6, (2.0,) * 6))
    save_trajectory(tmp_path / "t.json", made)
    (tmp_path / "wall.yaml").write_text("obstacles: {" + WALL + "}\n")
    assert "name these with --robot and --scene" in refuse("send", "t.json")
    assert "go together" in refuse("send", "t.json", "--robot", "ur5")
    assert "unknown group 'joint_1" in refuse("send", "t.json", "--robot", "ur5", "--scene", "empty")
    save_trajectory(tmp_path / "t.json", make_trajectory(made.waypoints, made.limits, names=group))
    assert run("send", "t.json", "--robot", "ur5", "--scene", "empty")[0] == 0
    assert_says(
        refuse("send", "t.json", "--robot", "ur5", "--scene", "wall.yaml"), "not proved free at .*touches 'wall'"
    )


def test_the_trajectory_of_a_task_is_planned_again_and_must_be_the_same(run, refuse, tmp_path):
    (tmp_path / "task.yaml").write_text(
        "robot: ur5\nscene: box-reach.yaml\nstart: home\n"
        "steps:\n  - move_to: inside\n  - wait: 0.1\n  - move_to: home\n"
    )
    assert run("run", "task.yaml", "-o", "t.json", "--speed", "0.3")[0] == 0
    code, out, err = run("send", "t.json")
    assert (code, err) == (0, "")
    assert "certified" in out
    record = json.loads((tmp_path / "t.json").read_text())
    record["positions"][30][2] += 1e-9
    written(tmp_path / "t.json", record)
    assert "leads to other motions" in refuse("send", "t.json")
