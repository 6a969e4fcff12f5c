"""``evenroad roadmap``, and ``evenroad plan --roadmap``."""

import subprocess
import sys

import numpy as np
import pytest

import evenroad as er
from evenroad._npz import digest
from evenroad.robot_roadmap.static_scene import joined_scenes
from tests.command_line import CELL

ALONG = ["plan", "box-reach.yaml", "--start", "home", "--goal", "inside"]
WRONG_LIMITS = "obstacles: {}\nlimits: {knee: [0, 1]}\n"


def test_it_makes_the_roadmap_that_python_makes(made):
    robot, cell = er.load_robot("ur5"), er.load_scene("cell.yaml")
    expected = er.build_roadmap(er.ArmWorld(robot, cell), 64)
    roadmap = er.load_roadmap("my.roadmap")
    np.testing.assert_array_equal(roadmap.milestones, expected.milestones)
    np.testing.assert_array_equal(roadmap.edges, expected.edges)


def test_a_plan_along_it_is_that_of_python_and_proved(answer, made):
    record, _ = answer(*ALONG, "--roadmap", "my.roadmap")
    roadmap = er.load_roadmap("my.roadmap")
    world = er.ArmWorld(roadmap.robot, joined_scenes(roadmap.scene, er.load_scene("box-reach")))
    assert record["path"] == roadmap.within(world).plan("home", "inside").path.tolist()
    assert record["proof"] == "certified"
    again, _ = answer(*ALONG, "--roadmap", "my.roadmap", "--robot", "ur5")
    assert again["path"] == record["path"]


@pytest.mark.parametrize(("words", "said"), [
    (["roadmap", "ur5", "-n", "0"], "n must be"),
    (["roadmap", "ur5", "-n", "99999"], "n must be at most 32768"),
    (["roadmap", "ur5", "-k", "0"], "k must be"),
    (["roadmap", "ur5", "--resolution", "0"], "resolution must be"),
    (["roadmap", "ur5", "--resolution", "1e-9"], "resolution must be larger"),
    (["roadmap", "ur5", "--seed", "-1"], "--seed must be"),
    (["roadmap", "ur5", "-o", "."], "must end with a file name"),
    (["roadmap", "nobody"], "there is no robot file 'nobody'"),
    (["roadmap", "ur5", "--group", "left"], "unknown group 'left'"),
    (["roadmap", "ur5", "--group", ""], "the group has no joint"),
    (["roadmap", "ur5", "--cell", "none.yaml"], "there is no scene file none.yaml"),
    (["roadmap", "ur5", "--cell", "limits.yaml"], "unknown joint in the limits of scene 'limits': 'knee'"),
    (["roadmap", "ur5", "-o", "no/where.roadmap"], "no"),
    (["roadmap", "ur5", "--cell", "cell.yaml", "-o", "cell.yaml"], "would overwrite"),
    ([*ALONG, "--roadmap", "cell.yaml"], "is text, not a .npz roadmap"),
    ([*ALONG, "--roadmap", "none"], "no such file: none"),
    ([*ALONG, "--roadmap", "none", "-n", "5"], "goes without points"),
    ([*ALONG, "--roadmap", "none", "--improve"], "goes without points"),
    ([*ALONG, "--roadmap", "none", "--group", "a"], "--group goes with --robot"),
    ([*ALONG, "--roadmap", "x", "--robot-radius", "1"], "not both"),
])  # fmt: skip
def test_bad_input_gets_one_line_and_nothing_is_written(refuse, tmp_path, words, said):
    (tmp_path / "cell.yaml").write_text(CELL)
    (tmp_path / "limits.yaml").write_text(WRONG_LIMITS)
    assert said in refuse(*words)


def test_bad_input_is_refused_in_one_line(made):
    (made / "today.yaml").write_text((made / "cell.yaml").read_text().replace("-0.025", "-0.03"))
    (made / "limits.yaml").write_text(WRONG_LIMITS)
    plan = ["plan", "cell.yaml", "--roadmap", "my.roadmap", "--goal", "1,-1.5,0,0,0,0", "--start"]
    free = "0,-1.5,0,0,0,0"
    every = [
        ["roadmap", "ur5", "-n", "0"],
        ["roadmap", "ur5", "--resolution", "-1"],
        ["roadmap", "ur5", "-o", "no/where.roadmap"],
        ["roadmap", "ur5", "--cell", "limits.yaml"],
        [*plan, "nowhere"],
        [*plan, free, "--out", "no/where"],
        [*plan, free, "--goal", "99,-1.5,0,0,0,0"],
        [*plan, free, "--goal", "1,-1.5"],
        [*plan, free, "-n", "0"],
        ["plan", "today.yaml", *plan[2:], free],
    ]
    code = f"from evenroad.cli import main; print([main(words) for words in {every!r}])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == f"{[2] * len(every)}\n"
    assert [line[:15] for line in done.stderr.splitlines()] == ["evenroad: error"] * len(every)


def test_a_roadmap_that_is_no_more_what_was_written_gets_one_line(refuse, made):
    whole = bytearray((made / "my.roadmap").read_bytes())
    middle, last = len(whole) // 2, len(whole) - 5
    with np.load("my.roadmap") as archive:
        arrays = {name: archive[name] for name in archive.files if name != "digest"}

    def kept(name, **changed):
        changed = arrays | {key: np.asarray(value) for key, value in changed.items()}
        np.savez(name, digest=digest(changed), **changed)
        return (made / f"{name}.npz").read_bytes()

    nothing = {"milestones": np.empty((0, 6)), "edges": np.empty((0, 2), np.int32)}
    for content, said in (
        (b"", "is empty"),
        (b"hello", "is text"),
        (whole[: len(whole) // 3], "damaged"),
        (whole[:middle] + bytes([whole[middle] ^ 255]) + whole[middle + 1 :], "damaged"),
        (whole[:last] + bytes([whole[last] ^ 255]) + whole[last + 1 :], "damaged"),
        (kept("older", version="0.0.1"), "of evenroad 0.0.1"),
        (kept("empty", **nothing, turns=np.empty((0, 6), np.int8)), "must have a milestone or more"),
        (kept("robotless", robot="{}"), "lacks some of what a roadmap of an arm holds"),
        (kept("nested", robot="[" * 100_000), "lacks some of what a roadmap of an arm holds"),
        (kept("coarse", settings='{"resolution": "a"}'), "resolution must be"),
    ):
        (made / "other.roadmap").write_bytes(content)
        error = refuse(*ALONG, "--roadmap", "other.roadmap")
        assert "other.roadmap" in error
        assert said in error


def test_what_contradicts_the_roadmap_gets_one_line(refuse, made):
    (made / "today.yaml").write_text((made / "cell.yaml").read_text().replace("-0.025", "-0.03"))
    ends = ["--roadmap", "my.roadmap", "--start", "0,-1.5,0,0,0,0", "--goal", "1,-1.5,0,0,0,0"]
    for words, said in (
        (["today.yaml"], "'table' of scene 'today' is a box"),
        (["cell.yaml", "--robot", "arm7"], "made for another robot, 'ur5'"),
        (["cell.yaml", "--clearance", "0.01"], "was built with 0 m"),
        (["cell.yaml", "--robot", "ur5", "--group", "elbow_joint"], "among its joints of the group"),
    ):
        assert said in refuse("plan", *words, *ends)
