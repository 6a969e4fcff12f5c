"""The verb fly: files of a flight, and bad input in one line."""

import json

import pytest

FOREST = "obstacles:\n" + "".join(
    f"  tree {k}: {{shape: cylinder, radius: 0.2, length: 6, xyz: [{3 + 2 * k}, {0.3 * (-1) ** k}, 2]}}\n"
    for k in range(4)
)
LIMITS = ("--speed", "6", "--acceleration", "8")


@pytest.fixture
def forest(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "forest.yaml").write_text(FOREST)
    return tmp_path


def test_a_flight_is_written_with_its_states_polynomials_and_picture(run, forest):
    code, out, error = run("fly", "forest.yaml", "--start", "0", "0", "2", "--goal", "12", "0", "2", *LIMITS)
    assert (code, error) == (0, "")
    assert "certified" in out
    record = json.loads((forest / "forest-flight.json").read_text())
    rows = (forest / "forest-flight.csv").read_text().splitlines()
    assert float(rows[-1].split(",")[0]) == record["duration"]
    assert (forest / "forest-flight.png").stat().st_size > 1000
    code, out, error = run("fly", "forest.yaml", "--start", "0", "0", "2", "--goal", "12", "0", "2", *LIMITS, "--json")
    assert "view its plan instead" in run("view", "forest-flight.json")[2]
    said = json.loads(out)
    assert (code, error, said["status"], said["duration"]) == (0, "", "solved", record["duration"])
    assert said["files"] == [f"forest-flight.{suffix}" for suffix in ("csv", "json", "png")]


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        (("--speed", "-6"), "speed must be a finite number > 0, got -6"),
        (("--start", "0", "0"), "--start must be three or six finite numbers"),
        (("--step", "0"), "step must be"),
        (("--out", "forest.yaml"), None),
    ],
)
def test_bad_input_is_one_line_and_writes_nothing(run, forest, changed, says):
    words = ["fly", "forest.yaml", "--start", "0", "0", "2", "--goal", "12", "0", "2", *LIMITS, *changed]
    code, _, error = run(*words)
    if says is None:
        assert code == 0  # the name of the files, without its suffix
        return
    assert code == 2
    assert says in error
    assert error.count("\n") == 1
    assert [each.name for each in forest.iterdir()] == ["forest.yaml"]


@pytest.mark.parametrize(
    ("terminals", "says"),
    [
        (("--start", "3", "0.3", "2", "--goal", "12", "0", "2"), "touches 'tree 0'"),
        (("--start", "0", "0", "2", "--goal", "12", "0", "2", "7", "0", "0"), "the speed along x must be from -6 to 6"),
    ],
)
def test_a_start_or_goal_that_is_not_free_is_an_answer(run, forest, terminals, says):
    code, out, error = run("fly", "forest.yaml", *terminals, *LIMITS, "--no-picture")
    assert (code, error) == (1, "")
    assert says in " ".join(out.split())
    assert [each.name for each in forest.iterdir()] == ["forest.yaml"]
