"""The same waypoints are read from every format that other planners write."""

import json

import numpy as np
import pytest
import yaml

from evenroad.errors import BrokenFile, UnknownName
from evenroad.trajectory import Limits, make_trajectory, save_trajectory
from evenroad.trajectory.waypoints_file import read_waypoints

ROWS = [[0.1, -0.2], [0.3, 0.4], [0.5, 0.6]]
MESSAGE = {"joint_names": ["a", "b"], "points": [{"positions": row} for row in ROWS]}
TEXTS = {
    "named.csv": "a,b\n0.1,-0.2\n0.3,0.4\n0.5,0.6\n",
    "timed.csv": "time,a,b,a.velocity,b_vel\n0,0.1,-0.2,0,0\n1,0.3,0.4,1,1\n2,0.5,0.6,0,0\n",
    "units.csv": "time [s], a [rad or m], b [rad or m], a [rad or m]/s\n0,0.1,-0.2,1\n1,0.3,0.4,1\n2,0.5,0.6,1\n",
    "semicolons.csv": "a;b\n0.1;-0.2\n0.3;0.4\n0.5;0.6;\n",
    "message.yaml": yaml.safe_dump(MESSAGE),
    "moveit.yaml": yaml.safe_dump({"joint_trajectory": MESSAGE}),
    "plan.json": json.dumps({"query": {"joints": ["a", "b"]}, "path": ROWS}),
}


@pytest.mark.parametrize("name", TEXTS)
def test_waypoints_are_read_with_their_joints(name, tmp_path):
    (tmp_path / name).write_text(TEXTS[name])
    found = read_waypoints(tmp_path / name)
    np.testing.assert_array_equal(found.positions, ROWS)
    assert found.joints == ("a", "b")


@pytest.mark.parametrize("text", ["0.1 -0.2 \n0.3 0.4\n\n0.5 0.6\n", "# x\n0.1,-0.2\n0.3,0.4\n0.5,0.6"])
def test_numbers_without_names_are_in_the_order_of_the_robot(text, tmp_path):
    (tmp_path / "matrix.txt").write_text(text)
    found = read_waypoints(tmp_path / "matrix.txt")
    np.testing.assert_array_equal(found.positions, ROWS)
    assert found.joints == ()


@pytest.mark.parametrize("suffix", ["json", "csv", "yaml"])
def test_trajectories_of_our_own_are_read_by_their_states(suffix, tmp_path):
    trajectory = make_trajectory(np.array(ROWS), Limits((1.0,) * 2, (2.0,) * 2), names=("a", "b"))
    save_trajectory(tmp_path / f"t.{suffix}", trajectory)
    found = read_waypoints(tmp_path / f"t.{suffix}")
    np.testing.assert_array_equal(found.positions, trajectory.positions)
    assert found.joints == ("a", "b")


@pytest.mark.parametrize(
    ("name", "text", "error", "said"),
    [
        ("a.csv", "", BrokenFile, "empty"),
        ("a.csv", "a,a\n1,2\n", BrokenFile, "names joint 'a' twice"),
        ("a.csv", "a,b\n1,2\n3\n", BrokenFile, "2 numbers in each line"),
        ("a.csv", "1,nan\n", BrokenFile, "waypoint 0 has none"),
        ("a.csv", "time\n1\n", BrokenFile, "names no joint"),
        pytest.param("a.csv", "a," + 200_000 * "b" + "\n1,2\n", BrokenFile, "is not a table of text", id="wide"),
        ("a.yaml", "joint_names: [a]\npoints: [{positions: [1, 2]}]\n", BrokenFile, "1 joints for each point"),
        ("a.yaml", "joint_name: [a]\npoints: []\n", UnknownName, "joint_names"),
        ("a.yaml", "multi_dof_joint_trajectory: {}\njoint_trajectory: {}\n", UnknownName, "one value each"),
        ("a.json", "{}", BrokenFile, "has no path"),
        ("a.json", '{"path": [[1], [2, 3]]}', BrokenFile, "damaged path"),
        ("a.doc", "", UnknownName, "format of a path"),
    ],
)
def test_what_is_no_path_is_refused_by_a_line_that_says_why(name, text, error, said, tmp_path):
    (tmp_path / name).write_text(text)
    with pytest.raises(error, match=said):
        read_waypoints(tmp_path / name)
