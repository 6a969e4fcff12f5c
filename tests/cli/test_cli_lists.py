"""Named things are listed, completed, and the help of a plan is one screen."""

import json

import pytest
from PIL import Image

import evenroad as er


@pytest.mark.parametrize(("verb", "known", "about"), [
    ("robots", er.list_robots(), "ships"),
    ("scenes", ("box-reach", "shelf"), "can, ball"),
    ("maps", ("maze3", "office.yaml"), "240 by 160 cells of 0.05 m"),
    ("samplers", ("even", "sobol"), "scrambled"),
])  # fmt: skip
def test_each_list_has_its_names_and_what_they_are(run, verb, known, about):
    code, out, error = run(verb)
    assert (code, error) == (0, "")
    assert set(known) <= {line.split()[0] for line in out.splitlines() if not line.startswith(" ")}
    assert about in out
    listed = json.loads(run(verb, known[1], "--json")[1])
    assert known[1] in listed
    assert known[0] not in listed


def test_a_part_that_no_name_has_is_refused(run):
    code, _, error = run("scenes", "shef")
    assert (code, error) == (2, "evenroad: error: unknown part of a name 'shef'; did you mean 'shelf'?\n")


def test_every_listed_name_is_known(run, tmp_path):
    for name in json.loads(run("scenes", "--json")[1]):
        er.load_scene(name)
    for name in json.loads(run("maps", "--json")[1]):
        er.load_map(name)
    for name in json.loads(run("robots", "--json")[1]):
        if name in ("arm7", "ur5"):
            er.load_robot(name)


def test_the_help_of_a_plan_fits_on_a_screen_and_names_the_rest(run):
    _, out, _ = run("plan", "--help")
    lines = out.splitlines()
    assert len(lines) <= 40
    assert max(map(len, lines)) <= 80
    for kind, option in (("robot", "--goal-pose"), ("disk", "--guarantees"), ("car", "--turning-radius")):
        assert f"evenroad plan --help {kind}" in out
        code, told, error = run("plan", "--help", kind)
        assert (code, error) == (0, "")
        assert f"  {option} " in told


def test_a_plan_is_printed_as_json(run, tmp_path):
    words = ("plan", "office.yaml", "--start", "1", "2", "--goal", "8.5", "3", "--robot-radius", "0.25", "--no-picture")
    code, out, _ = run(*words, "--out", str(tmp_path / "plan"), "--json")
    assert code == 0
    record = json.loads(out)
    written = json.loads((tmp_path / "plan.json").read_text())
    assert {**record, "sha256": written["sha256"]} == written


def test_a_picture_of_the_same_name_is_not_taken_for_the_map_that_ships(run, tmp_path):
    Image.new("L", (30, 20), 255).save(tmp_path / "maze3.png")
    assert "maze3        640 by 480 cells of 1 pixel" in run("maps")[1]
