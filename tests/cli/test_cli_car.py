"""``evenroad plan --footprint``: the record, the picture and the errors of a car's plan."""

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
