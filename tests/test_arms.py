"""Planning for an arm in one call."""

import json

import numpy as np
import pytest

import evenroad as er
from evenroad import arms
from evenroad.cli import main
from evenroad.robot.reference.recheck import MeshCheck
from tests.robot.mesh_arms import write_fork_arm


def test_names_files_and_values_give_the_path_that_the_command_gives(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    line = ["plan", "box-reach.yaml", "--robot", "ur5", "--start", "home", "--goal", "inside", "--no-picture"]
    assert main([*line, "--sampler", "even", "--out", "a"]) == 0
    expected = json.loads((tmp_path / "a.json").read_text())["path"]
    scene, robot = er.load_scene("box-reach"), er.load_robot("ur5")
    goal = [scene.states["inside"][joint] for joint in robot.group]
    for asked in (
        ("ur5", "box-reach", "home", "inside"),
        (robot, scene, "home", goal),
        ("ur5", scene, np.array([scene.states["home"][joint] for joint in robot.group]), "inside"),
    ):
        result = er.plan_arm(*asked)
        assert result.solved
        assert result.path.tolist() == expected
    points = er.draw("even", 512, 6)
    assert er.plan_arm(robot, scene, "home", "inside", points).path.tolist() == expected


def test_options_of_files_do_not_go_with_a_robot_that_is_a_value():
    with pytest.raises(er.InvalidValue, match="with the file of a robot"):
        er.plan_arm(er.load_robot("ur5"), "box-reach", "home", "inside", group="a")


def test_an_end_that_is_no_configuration_is_refused():
    with pytest.raises(er.InvalidValue, match="start must be 6 finite numbers"):
        er.plan_arm("ur5", "box-reach", [0.0, 0.0], "inside")
    with pytest.raises(er.UnknownName, match="unknown state 'outside'"):
        er.plan_arm("ur5", "box-reach", "home", "outside")


def test_meshes_have_the_last_word(tmp_path, monkeypatch):
    write_fork_arm(tmp_path)
    (tmp_path / "desk.yaml").write_text(
        "obstacles: {}\nstates:\n  home: {turn: 0, bend: 0, slide: 0}\n  away: {turn: 0.5, bend: 0.2, slide: 0.1}\n"
    )
    monkeypatch.setattr(arms, "recheck", lambda *_: MeshCheck("in collision", 7, "at (0, 0, 0)"))
    result = er.plan_arm(tmp_path / "arm.urdf", tmp_path / "desk.yaml", "home", "away", 64)
    assert result.status == "mesh_collision"
    assert not result.solved
    assert "not for the shapes that they stand for: in collision at (0, 0, 0)" in result.message
