"""plan -> view -> send on one file."""

import json
import re

import numpy as np
import pytest

from evenroad.trajectory.formats import trajectory_of

REACH = ("plan", "box-reach.yaml", "--robot", "ur5", "--start", "home", "--goal", "inside", "--no-picture")


def _page(path):
    return json.loads(re.search(r'type="application/json">(.*?)</script>', path.read_text(), re.DOTALL)[1])


def test_an_arm_s_plan_is_played_and_sent_without_its_times(run, tmp_path):
    assert run(*REACH, "-o", "plan.json")[0] == 0
    code, out, err = run("view", "plan.json", "--html", "out.html")
    assert (code, out, err) == (0, "wrote out.html\n", "")
    page = _page(tmp_path / "out.html")
    assert not page["timed"]
    assert page["times"][-1] == 4.0
    code, out, err = run("send", "plan.json", "--fastest", "0.5")
    assert (code, err) == (0, "")
    assert "made for at most 0.5 rad/s" in out
    assert "none; --host" in out
    assert "certified" in out


def test_a_timed_plan_is_played_in_its_time_and_sent_as_it_is_if_slow_enough(run, tmp_path):
    assert run(*REACH, "--timed", "--speed", "0.2")[0] == 0
    kept = json.loads((tmp_path / "box-reach.json").read_text())["trajectory"]
    trajectory = trajectory_of(kept["states"], "plan")
    assert trajectory.duration == kept["duration"]
    run("view", "box-reach.json", "--html", "out.html")
    page = _page(tmp_path / "out.html")
    assert page["timed"]
    assert page["times"][-1] == pytest.approx(trajectory.duration, abs=1e-3)
    elbow = page["values"][[joint["name"] for joint in page["joints"]].index("elbow_joint")]
    np.testing.assert_allclose(elbow[:: len(elbow) - 1], trajectory.positions[[0, -1], 2], atol=1e-5)
    assert "of the plan" in run("send", "box-reach.json")[1]
    assert "made for at most 0.1 rad/s" in run("send", "box-reach.json", "--fastest", "0.1")[1]


def test_a_disk_s_plan_is_played_and_not_sent(run, refuse, tmp_path):
    run("plan", "maze1", "--start", "32", "30", "--goal", "608", "450", "--robot-radius", "6", "--no-picture")
    assert run("view", "maze1.json", "--html", "out.html")[0] == 0
    page = _page(tmp_path / "out.html")
    assert (page["kind"], page["size"], page["radius"]) == ("map", [640, 480], 6.0)
    assert len(page["states"]) == len(page["times"]) == len(page["clearance"])
    assert min(page["clearance"]) > 0
    assert "plan on a map" in refuse("send", "maze1.json")
    assert "--html plays" in refuse("view", "maze1.json", "--gif", "out.gif")


def test_a_scene_that_changed_since_is_said_and_nothing_is_sent_in_it(run, refuse, tmp_path):
    scene = "obstacles: {{ball: {{shape: sphere, radius: 0.05, xyz: [1, 0, {}]}}}}"
    (tmp_path / "desk.yaml").write_text(scene.format(1))
    ends = ("--start", "0,-1.5,0,-1.5,0,0", "--goal", "0.3,-1.5,0,-1.5,0,0", "--no-picture")
    assert run("plan", "desk.yaml", "--robot", "ur5", *ends)[0] == 0
    assert json.loads((tmp_path / "desk.json").read_text())["made_of"]["scene"]["name"] == "desk.yaml"
    assert run("view", "desk.json", "--html", "out.html")[2] == ""
    (tmp_path / "desk.yaml").write_text(scene.format(1.1))
    assert "the scene changed since" in run("view", "desk.json", "--html", "out.html")[2]
    assert "scene of desk.json changed since it was planned: plan again" in refuse("send", "desk.json")


def test_a_second_plan_says_what_it_replaces(run):
    words = ("plan", "maze1", "--start", "32", "30", "--goal", "608", "450", "--robot-radius", "6", "--no-picture")
    assert "replaced" not in run(*words)[1]
    assert "maze1.json (replaced)" in run(*words)[1]


@pytest.mark.parametrize(("words", "said"), [
    (("--host", "127.0.0.1"), "--host and --model go together"), (("--go",), "--go needs --host"),
    (("--fastest", "0"), "fastest"),
])  # fmt: skip
def test_sending_without_what_it_needs_is_one_line(run, refuse, words, said):
    run(*REACH)
    assert said in refuse("send", "box-reach.json", *words)
