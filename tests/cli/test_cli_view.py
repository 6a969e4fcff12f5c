import json

import numpy as np
import pytest
from PIL import Image

from evenroad.cli.view import View
from evenroad.robot import held_values

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


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"goal_index": 9}, "goal_index"),
        ({"query": {"joints": None}}, "damaged plan"),
        ({"query": {"held": {"a": "b"}}}, "damaged plan"),
        ({"query": {"srdf": 5}}, "damaged plan"),
    ],
)
def test_a_damaged_plan_is_one_line(run, tmp_path, change, said):
    run(*REACH)
    file = tmp_path / "box-reach.json"
    record = json.loads(file.read_text())
    record |= change | {"query": record["query"] | change.get("query", {})}
    file.write_text(json.dumps(record))
    code, _, err = run("view", "box-reach.json", "--gif", "out.gif")
    assert code == 2
    assert said in err
    assert err.count("\n") == 1


def test_joints_that_were_held_are_where_the_plan_held_them(run, tmp_path):
    joints = "shoulder_pan_joint,elbow_joint,wrist_1_joint"
    code, _, err = run(
        *("plan", "box-reach.yaml", "--robot", "ur5", "--group", joints, "--start", "home", "--no-picture"),
        *("--goal", "0.2,0.1,-1.5"),
    )
    assert code == 0, err
    query, _ = View(world=tmp_path / "box-reach.json")._query()
    held = held_values(query.world.robot)
    assert held["shoulder_lift_joint"] == pytest.approx(-np.pi / 2)
