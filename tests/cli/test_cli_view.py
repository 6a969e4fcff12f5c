import json

import pytest
from PIL import Image

REACH = ("plan", "box-reach.yaml", "--robot", "ur5", "--start", "home", "--goal", "inside", "--no-picture")


def test_a_plan_becomes_a_moving_picture(run, tmp_path):
    run(*REACH)
    code, out, err = run("view", "box-reach.json", "--gif", "out.gif")
    assert (code, out, err) == (0, "wrote out.gif\n", "")
    with Image.open(tmp_path / "out.gif") as picture:
        assert picture.n_frames > 30
        first = picture.convert("RGB").tobytes()
        picture.seek(picture.n_frames // 2)
        assert picture.convert("RGB").tobytes() != first


def test_a_scene_is_shown_with_the_arm_at_rest(run, tmp_path):
    code, _, err = run("view", "box-reach.yaml", "--robot", "ur5", "--gif", "out.gif")
    assert (code, err) == (0, "")
    assert (tmp_path / "out.gif").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["box-reach.yaml"], "give --robot"),
        (["none.json"], "cannot read the plan none.json"),
        (["bad.json"], "is not a plan of evenroad"),
        (["disk.json"], "not the plan of an arm"),
        (["box-reach.yaml", "--robot", "ur5", "--gif", "out.png"], "--gif must name a .gif"),
        (["box-reach.yaml", "--robot", "ur5", "--port", "70000"], "port"),
        (["box-reach.yaml", "--robot", "none"], "none"),
    ],
)
def test_bad_input_is_one_line(run, tmp_path, words, said):
    (tmp_path / "bad.json").write_text(json.dumps({"query": {"start": [0, 0]}}))
    run("demo", "-n", "64", "--out", "disk")
    code, _, err = run("view", *words)
    assert code == 2
    assert said in err
    assert err.count("\n") == 1
