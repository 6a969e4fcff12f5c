import json
import re

import numpy as np
import pytest

from evenroad.planning.read_request import arm_request
from evenroad.robot.reference.validate import MeshCheck
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
    query, made = arm_request("ur5", "box-reach", "home", "inside"), load_trajectory("t.json")
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


@pytest.mark.parametrize(("words", "said"), [
    (["--speed", "0.5"], "--speed goes with --trajectory or --timed only"),
    (["--trajectory", "t.txt"], "unknown format of a trajectory '.txt'"),
    (["--trajectory", "t.json", "--speed", "2"], "speed must be at most 1"),
    (["--trajectory", "t.json", "--limits", "none.yaml"], "none.yaml"),
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
