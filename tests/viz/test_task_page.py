"""The page that plays a task: each motion in its turn, and each thing where it is at every time."""

import base64
import json
import re

import numpy as np
import pytest

import evenroad as er
from evenroad.cli import main
from evenroad.errors import NotAvailable
from evenroad.robots.kinematics import link_poses
from evenroad.task import Attach, Detach, MoveTo, Task, Wait
from evenroad.viz.task_page import page_of_task

HOME = [0.0, -1.57, 1.57, -1.57, -1.57, 0.0]
AT, TO = (0.5, 0.2, 0.06), (0.5, -0.3, 0.061)


@pytest.fixture(scope="module")
def done():
    """A UR5 that takes a can from one place of a table to another."""
    table = er.Box((0.8, 1.2, 0.04), xyz=(0.5, 0, -0.04), name="table")
    can = er.Cylinder(0.03, 0.16, xyz=AT, name="can")
    world = er.ArmWorld("ur5", er.Scene([table, can], allowed={("base_link", "table")}))
    grasp = er.PoseGoal(er.Pose((0.5, 0.2, 0.145), rpy=(np.pi, 0, 0)), tip="tool0", free_axis="z")
    place = er.PoseGoal(er.Pose(TO), tip="can", free_axis="z")
    steps = [
        MoveTo(grasp, approach=0.1),
        Wait(0.5),
        Attach("can"),
        MoveTo(place, retreat=0.05, approach=0.05, away="up"),
    ]
    answer = Task([*steps, Detach("can", onto="table"), MoveTo(HOME, retreat=0.1)]).plan(world, HOME)
    assert answer.solved, answer.message
    return answer


def data_of(text):
    return json.loads(re.search(r'type="application/json">(.*?)</script>', text, re.DOTALL)[1])


def places(data, name, time):
    """Return the middles of all bodies of a name that are there at a time, as the page places them."""
    times, robot = np.array(data["times"]), er.load_robot("ur5")
    values = {joint["name"]: row for joint, row in zip(data["joints"], data["values"], strict=True)}
    q = [np.interp(time, times, values[joint]) for joint in robot.joint_names]
    poses, found = link_poses(robot, np.array([q]))[0], []
    for body in data["bodies"]:
        if body["name"] != name or not any(a <= time < b for a, b in body.get("when", [[0, 1e9]])):
            continue
        corners = np.frombuffer(base64.b64decode(body["v"]), "<f4").reshape(-1, 3)
        pose = np.reshape(body["pose"], (4, 4)).T if "pose" in body else poses[body["link"]]
        found.append((corners.min(0) + corners.max(0)) / 2 @ pose[:3, :3].T + pose[:3, 3])
    return found


def test_the_can_is_at_one_place_at_every_time_first_on_the_table_then_in_the_hand_and_then_put_down(done):
    data = data_of(page_of_task(done))
    end, seen = data["times"][-1], []
    for time in np.linspace(0.0, end, 100):
        (place,) = places(data, "can", time)
        seen.append(place)
        assert len(places(data, "table", time)) == 1
    np.testing.assert_allclose(seen[0], AT, atol=1e-3)
    np.testing.assert_allclose(seen[-1], TO, atol=2e-3)
    assert np.linalg.norm(np.diff(seen, axis=0), axis=1).max() < 0.1
    assert np.max(seen, axis=0)[2] > AT[2] + 0.04


def test_it_plays_the_states_of_the_trajectory_at_its_times(done):
    data, trajectory = data_of(page_of_task(done)), done.trajectory()
    assert data["timed"]
    assert data["times"][-1] == pytest.approx(trajectory.duration, abs=0.1)
    assert (np.diff(data["times"]) >= 0).all()
    rows = [row for row in data["values"] if row]
    np.testing.assert_allclose([row[0] for row in rows], trajectory.positions[0], atol=1e-4)
    np.testing.assert_allclose([row[-1] for row in rows], trajectory.positions[-1], atol=1e-4)
    assert len(rows[0]) == len(data["times"]) == len(data["clearance"])


def test_evenroad_view_writes_it_of_a_saved_task(done, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    done.save("pick.json")
    assert main(["view", "pick.json", "--html", "pick.html"]) == 0
    assert data_of((tmp_path / "pick.html").read_text())["title"].startswith("solved: 3 motions")
    assert main(["view", "pick.json", "--gif", "pick.gif"]) == 2
    assert "--html" in capsys.readouterr().err


def test_a_task_without_a_way_is_not_played():
    world = er.ArmWorld("ur5", "box-reach")
    with pytest.raises(NotAvailable, match="no path to play: step 0"):
        page_of_task(Task([MoveTo([0.0, 0.8, 0, 0, 0, 0])]).plan(world, "home"))
    with pytest.raises(NotAvailable, match="the arm stays"):
        page_of_task(Task([Wait(1.0), MoveTo("home")]).plan(world, "home"))
