"""What ``evenroad plan`` says of meshes where nobody can be asked about them; tests_peers has the checks themselves."""

import json
import sys

import pytest

from evenroad.robot import load_robot
from evenroad.robot.reference import validate
from tests.robot.mesh_arms import write_fork_arm

SCENE = "obstacles:\n  ball: {shape: sphere, radius: 0.05, xyz: [0.0, 0.3, 0.3]}\n"


def arguments(robot):
    return [
        "plan",
        "desk.yaml",
        "--robot",
        robot,
        "--start",
        "home",
        "--goal",
        "away",
        "-n",
        128,
        "--out",
        "a",
    ]


def test_without_coal_a_path_among_meshes_is_said_to_be_unchecked(run, tmp_path, monkeypatch):
    write_fork_arm(tmp_path)
    states = "states:\n  home: {turn: 0, bend: 0, slide: 0}\n  away: {turn: 0.5, bend: 0.2, slide: 0.1}\n"
    (tmp_path / "desk.yaml").write_text(SCENE + states)
    monkeypatch.setitem(sys.modules, "coal", None)
    code, out, err = run(*arguments("arm.urdf"))
    assert (code, err) == (0, "")
    assert "meshes not checked (needs evenroad[mesh])" in " ".join(out.split())
    record = json.loads((tmp_path / "a.json").read_text())
    assert record["status"] == "solved"
    assert record["meshes"]["verdict"] == "not checked"
    assert record["meshes"]["configuration"] is None
    assert (tmp_path / "a.csv").exists()


@pytest.mark.parametrize("robot", ["ur5", "arm7"])
def test_a_robot_without_meshes_pays_nothing_for_those_of_others(run, tmp_path, monkeypatch, robot):
    def refuse(*_):
        raise AssertionError("nothing is to be read again")

    for name in ("CoalWorld", "original_shapes"):
        monkeypatch.setattr(validate, name, refuse)
    zeros = ", ".join(f"{joint}: 0.0" for joint in load_robot(robot).group)
    away = zeros.replace("0.0", "0.2")
    (tmp_path / "desk.yaml").write_text(
        f"obstacles: {{}}\nstates:\n  home: {{{zeros}}}\n  away: {{{away}}}\n"
    )
    code, out, _ = run(*arguments(robot))
    assert code == 0
    assert "meshes" not in out
    assert json.loads((tmp_path / "a.json").read_text())["meshes"] is None
