"""``evenroad plan --footprint``: the record, the picture and the errors of a car's plan."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

BOX = "[[-0.45, -0.31], [0.45, -0.31], [0.45, 0.31], [-0.45, 0.31]]"
PLAN = ("plan", "office.yaml", "--footprint", BOX, "--turning-radius", "0.6", "--start", "1", "2", "90", "--deg")


@pytest.mark.usefixtures("in_an_empty_folder")
def test_a_plan_of_a_car_has_its_pieces_a_csv_and_a_picture_of_what_it_sweeps(run, tmp_path):
    import evenroad as er

    code, out, err = run(*PLAN, "--goal", "8.5", "3", "0", "--csv")
    assert (code, err) == (0, "")
    assert "exact" in out
    assert "changes between forwards and backwards" in out
    result, query = er.io.load_plan("office.json")
    assert query["turning_radius"] == 0.6
    assert result.start.tolist() == [1.0, 2.0, pytest.approx(np.pi / 2)]
    assert np.abs(result.pieces[:, 1]).sum() == pytest.approx(result.cost)
    table = np.loadtxt("office.csv", delimiter=",", skiprows=1)
    np.testing.assert_array_equal(table, result.path)
    with Image.open("office.png") as picture:
        colours = {colour for _, colour in picture.convert("RGB").getcolors(1 << 24)}
    assert (166, 206, 240) in colours


@pytest.mark.usefixtures("in_an_empty_folder")
@pytest.mark.parametrize("more", [("--forward-only",), ("--holonomic",), ("--cusp-cost", "3")])
def test_a_car_is_driven_as_the_options_say(run, more):
    words = [each for each in PLAN if each not in ("--turning-radius", "0.6")] if "--holonomic" in more else PLAN
    code, out, _ = run(*words, "--goal", "1", "2.6", "80", *more, "--no-picture", "--time", "20")
    assert code == 0, out


@pytest.mark.usefixtures("in_an_empty_folder")
def test_a_goal_region_has_a_radius_and_a_range_of_angles(run):
    import evenroad as er

    code, _, err = run(*PLAN, "--goal", "8.5", "3", "0", "--goal-radius", "0.3", "--goal-within", "20", "--no-picture")
    assert (code, err) == (0, "")
    result, query = er.io.load_plan("office.json")
    assert (query["goal_radius"], query["goal_within"]) == (0.3, 20.0)
    x, y, angle = result.path[-1]
    assert np.hypot(x - 8.5, y - 3.0) <= 0.3
    assert abs((angle + np.pi) % (2.0 * np.pi) - np.pi) <= np.radians(20.0) + 1e-9
    code, _, _ = run(*PLAN, "--goal", "8.5", "3", "--goal-radius", "0.3", "--no-picture")
    assert code == 0
    code, _, err = run(*PLAN, "--goal", "8.5", "3", "0", "--goal-within", "20", "--no-picture")
    assert (code, "--goal-within goes with --goal-radius" in err) == (2, True)


@pytest.mark.usefixtures("in_an_empty_folder")
def test_a_footprint_may_be_written_as_in_python(run):
    import evenroad as er

    words = (*PLAN[:3], "((-.45, -.31), (.45, -.31), (.45, .31), (-.45, .31))", *PLAN[4:], "--goal", "1", "2.6", "80")
    code, _, err = run(*words, "--no-picture")
    assert (code, err) == (0, "")
    _, query = er.io.load_plan("office.json")
    assert query["footprint"] == [[[-0.45, -0.31], [0.45, -0.31], [0.45, 0.31], [-0.45, 0.31]]]


@pytest.mark.usefixtures("in_an_empty_folder")
@pytest.mark.parametrize(
    ("words", "says"),
    [
        ((*PLAN, "--goal", "8.5", "3"), "three finite numbers x y angle"),
        ((*PLAN, "--goal", "8.5", "3", "x"), "three finite numbers x y angle"),
        ((*PLAN[:3], "[[0,0]", *PLAN[4:], "--goal", "8.5", "3", "0"), "--footprint must be corners"),
        ((*PLAN[:3], "[[0,0],[1,1],[1,0],[0,1]]", *PLAN[4:], "--goal", "8.5", "3", "0"), "cross itself"),
        ((*PLAN[:5], "60", *PLAN[6:], "--goal", "8.5", "3", "0"), "diagonal of the map"),
        ((*PLAN, "--goal", "8.5", "3", "0", "-n", "64"), "without points"),
        ((*PLAN, "--goal", "8.5", "3", "0", "--robot-radius", "0.2"), "exactly one of them"),
        ((*PLAN, "--goal", "8.5", "3", "0", "--guarantees"), "--guarantees goes with --robot-radius only"),
        (
            (*PLAN[:2], "--forward-only", "--robot-radius", "0.2", "--start", "1", "2", "--goal", "8", "3"),
            "--footprint",
        ),
        ((*PLAN[:-1], "--goal", "8.5", "3", "0"), "radians, got 90; --deg"),
    ],
)
def test_what_is_no_car_is_refused_in_one_line(run, words, says):
    code, _, err = run(*words)
    assert code == 2
    assert says in err
    assert len(err.strip().splitlines()) == 1


DISK = ("plan", "office.yaml", "--robot-radius", "0.25", "--start", "1", "2", "--goal", "8.5", "3", "--no-picture")
CAR = (*PLAN, "--goal", "1", "2.6", "80", "--no-picture")


@pytest.mark.usefixtures("in_an_empty_folder")
@pytest.mark.parametrize("plan", [DISK, (*CAR, "--lateral", "0.3", "--curvature-rate", "2")])
def test_a_robot_on_a_map_gets_its_times_in_files_and_in_the_record(run, plan):
    from evenroad.cli.plan_file import read_plan
    from evenroad.trajectory import load_trajectory

    limits = ("--speed", "0.8", "--acceleration", "0.5", "--step", "0.02")
    code, out, err = run(*plan, *limits, "--trajectory", "go.csv", "--trajectory", "go.json", "--trajectory", "go.yaml")
    assert (code, err) == (0, "")
    assert "off the path" in out
    table = np.loadtxt("go.csv", delimiter=",", skiprows=1)
    plain = load_trajectory("go.json")
    np.testing.assert_array_equal(table[:, 1 : 1 + plain.positions.shape[1]], plain.positions)
    speed = np.linalg.norm(np.diff(plain.positions[:, :2], axis=0), axis=1) / plain.times[1]
    assert 0.0 < speed.max() <= 0.8 + 1e-9
    kept = read_plan(Path("office.json")).trajectory
    np.testing.assert_array_equal(kept.positions, plain.positions)
    assert plain.source["plan"]["query"]["map"] == "office.yaml"


@pytest.mark.usefixtures("in_an_empty_folder")
@pytest.mark.parametrize(
    ("plan", "words", "says"),
    [
        (DISK, ("--speed", "0.5"), "--speed goes with --trajectory or --timed only"),
        (CAR, ("--lateral", "0.5"), "--lateral goes with --trajectory or --timed only"),
        (DISK, ("--timed", "--speed", "-1"), "speed must be a finite number > 0"),
        (CAR, ("--timed", "--curvature-rate", "0"), "curvature_rate must be a finite number > 0"),
        (DISK, ("--trajectory", "go.script"), "format of a trajectory"),
        (DISK, ("--trajectory", "office.json"), "another result of this plan"),
        (DISK, ("--timed", "--lateral", "0.5"), "--lateral goes with --footprint only"),
    ],
)
def test_times_that_cannot_be_are_refused_before_planning(run, plan, words, says):
    code, _, err = run(*plan, *words)
    assert (code, len(err.strip().splitlines())) == (2, 1)
    assert says in err
    assert not Path("office.json").exists()


@pytest.mark.usefixtures("in_an_empty_folder")
@pytest.mark.parametrize("times", [(), ("--timed", "--curvature-rate", "2")])
def test_the_plan_of_a_car_is_viewed_on_its_map_and_a_damaged_one_refused(run, times):
    assert run(*CAR, *times)[0] == 0
    code, out, err = run("view", "office.json", "--html", "page.html", "--png", "page.png")
    assert (code, out, err) == (0, "wrote page.png\nwrote page.html\n", "")
    assert '"kind":"map"' in Path("page.html").read_text()
    record = json.loads(Path("office.json").read_text())
    del record["sha256"], record["query"]["turning_radius"]
    Path("office.json").write_text(json.dumps(record))
    code, _, err = run("view", "office.json", "--html", "page.html")
    assert (code, len(err.strip().splitlines())) == (2, 1)
    assert "footprint" in err


@pytest.mark.usefixtures("in_an_empty_folder")
@pytest.mark.parametrize("robot", [("--robot-radius", "0.2"), ("--footprint", BOX, "--turning-radius", "0.6")])
def test_a_clearance_that_is_preferred_makes_the_path_longer_and_is_recorded(run, robot):
    import evenroad as er

    pose = ("90",) if "--footprint" in robot else ()
    words = ("plan", "office.yaml", *robot, "--start", "1", "2", *pose, "--goal", "8.5", "3", *("0",) * len(pose))
    words = (*words, "--no-picture", *(("--deg",) if pose else ()))
    costs = []
    for more in ((), ("--prefer-clearance", "0.3")):
        code, out, err = run(*words, *more)
        assert (code, err) == (0, ""), out
        result, query = er.io.load_plan("office.json")
        costs.append(result.cost)
    assert query["prefer_clearance"] == 0.3
    assert costs[0] < costs[1]
