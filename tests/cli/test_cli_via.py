"""``evenroad plan --via`` and ``--constraint``, and poses of several links."""

import json

import numpy as np
import pytest

import evenroad as er
from evenroad.robots.kinematics import link_poses

ON_UR5 = ("plan", "box-reach.yaml", "--robot", "ur5", "--start", "home", "--no-picture")
INSIDE = "tool0: 0.65 0 0.2 0 1.570796326795 0"


def test_a_path_and_its_trajectory_pass_points_on_the_way_exactly(answer, tmp_path):
    record, shown = answer(*ON_UR5, "--goal", "home", "--via", INSIDE, "--via", "0.5 -1.5 1.2 -1 -1.5 0", "--timed")
    assert "through 2 points on the way" in shown
    robot, path = er.load_robot("ur5"), np.array(record["path"])
    at = link_poses(robot, path)[:, robot.links.index("tool0"), :3, 3]
    first = np.linalg.norm(at - (0.65, 0.0, 0.2), axis=1)
    second = np.abs(path - (0.5, -1.5, 1.2, -1.0, -1.5, 0.0)).max(axis=1)
    assert first.min() < 1e-9
    assert second.min() < 1e-9
    assert first.argmin() < second.argmin()
    assert record["trajectory"]["stops"] >= 2
    driven = np.array(record["trajectory"]["states"]["positions"])
    at = link_poses(robot, driven)[:, robot.links.index("tool0"), :3, 3]
    assert np.linalg.norm(at - (0.65, 0.0, 0.2), axis=1).min() < 1e-9


def test_constraints_of_the_command_hold_along_the_path(answer):
    options = ("--constraint", "upright 3", "--deg", "--constraint", "plane z within=0.002")
    ends = ("--start", "30 -80 100 -110 -90 0", "--goal", "-30 -80 100 -110 -90 0")
    record, _ = answer("plan", "empty.yaml", "--robot", "ur5", "--no-picture", *ends, *options)
    robot, path = er.load_robot("ur5"), np.array(record["path"])
    poses = link_poses(robot, np.linspace(path[:-1], path[1:], 10).reshape(-1, 6))[:, robot.links.index("tool0")]
    assert np.ptp(poses[:, 2, 3]) <= 0.004
    assert np.degrees(np.arccos(np.abs(poses[:, 2, 2]).min())) <= 3.0
    assert record["deviation"]["plane_m"] <= 0.002


def test_a_goal_of_two_links_is_reached_by_both_together(answer):
    robot = er.load_robot("ur5")
    record, _ = answer(*ON_UR5, "--goal-pose", INSIDE)
    q = np.array(record["path"][-1])
    x, y, z = link_poses(robot, q[np.newaxis])[0, robot.links.index("wrist_3_link"), :3, 3].tolist()
    pose = f"{INSIDE} & wrist_3_link: {x:.12f} {y:.12f} {z:.12f}"
    record, shown = answer(*ON_UR5, "--goal-pose", pose)
    assert "tool0 at (0.65, 0, 0.2) and wrist_3_link at" in shown.replace("\n", " ").replace("  ", " ")
    assert len(record["query"]["goal_poses"]) == 1


@pytest.mark.parametrize(("options", "said"), [
    (("--via", "0 0.5 0.5 0 0 0"), "via point 1, '0 0.5 0.5 0 0 0', is not free: 'forearm_link' touches 'table', 2"),
    (("--via", "home", "--via", "0 0 9 0 0 0"), "via point 2: '0 0 9 0 0 0' puts joint 'elbow_joint' at 9 rad"),
    (("--via", "tool0: 1 2"), "via point 1: a goal pose must be 3 or 6 or 7 finite numbers"),
    (("--via", "home", "-n", "64"), "--via goes without"),
    (("--via", "home", "--trajectory", "a.movej.script"), "--via goes without a.movej.script"),
    (("--constraint", "roll z"), "unknown constraint 'roll'"),
    (("--constraint", "circle"), "the constraint 'circle' needs centre"),
    (("--constraint", "circle 0,0"), "centre of circle must be 3 finite numbers"),
    (("--constraint", "line y of=3"), "'of=3' says nothing of the constraint 'line y of=3'"),
    (("--constraint", "joints"), "needs a range"),
    (("--constraint", "together tool0"), "needs second"),
    (("--constraint", "line y", "--constraint", "line z"), "constraints of one kind must be of different tips"),
])  # fmt: skip
def test_what_is_wrong_with_a_point_on_the_way_or_a_constraint_is_said_in_one_line(refuse, options, said):
    assert said in refuse(*ON_UR5, "--goal", "home", *options)


def test_a_pose_on_the_way_that_is_not_reached_is_an_answer(run, tmp_path):
    code, out, _ = run(*ON_UR5, "--goal", "home", "--via", "tool0: 3 0 0", "--out", "far")
    assert code == 1
    assert "via point 1 cannot be reached" in out.replace("\n", " ")
    assert json.loads((tmp_path / "far.json").read_text())["status"] == "goal_unreachable"
