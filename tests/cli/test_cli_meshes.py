"""What ``evenroad plan`` says of meshes where nobody can be asked about them; tests_peers has the checks themselves."""

import sys

import pytest

from evenroad.collision import coal_world
from evenroad.loading.load import load_robot
from tests.robots.mesh_arms import write_fork_arm

ENDS = ("--start", "home", "--goal", "away", "-n", 128)


def test_without_coal_a_path_among_meshes_is_said_to_be_unchecked(answer, tmp_path, monkeypatch):
    write_fork_arm(tmp_path)
    (tmp_path / "desk.yaml").write_text(
        "obstacles:\n  ball: {shape: sphere, radius: 0.05, xyz: [0.0, 0.3, 0.3]}\n"
        "states:\n  home: {turn: 0, bend: 0, slide: 0}\n  away: {turn: 0.5, bend: 0.2, slide: 0.1}\n"
    )
    monkeypatch.setitem(sys.modules, "coal", None)
    record, shown = answer("plan", "desk.yaml", "--robot", "arm.urdf", *ENDS)
    assert "second check none (needs evenroad[mesh])" in shown
    assert record["status"] == "solved"
    assert record["meshes"]["verdict"] == "not checked"
    assert record["meshes"]["configuration"] is None
    assert (tmp_path / "a.csv").exists()


@pytest.mark.parametrize("robot", ["ur5", "arm7"])
def test_a_robot_without_meshes_pays_nothing_for_those_of_others(answer, tmp_path, monkeypatch, robot):
    for name in ("CoalWorld", "original_shapes"):
        monkeypatch.setattr(coal_world, name, lambda *_: pytest.fail("nothing is to be read again"))
    home, away = (dict.fromkeys(load_robot(robot).group, at) for at in (0.0, 0.2))
    states = f"states: {{home: {home}, away: {away}}}\n".replace("'", "")
    (tmp_path / "desk.yaml").write_text(f"obstacles: {{}}\n{states}")
    record, shown = answer("plan", "desk.yaml", "--robot", robot, *ENDS)
    assert "second check" not in shown
    assert record["meshes"] is None
