"""``evenroad roadmap``, and ``evenroad plan --roadmap``."""

import numpy as np
import pytest

import evenroad as er
from evenroad._npz import digest
from evenroad.roadmap import KNearest
from evenroad.robot import ArmWorld
from tests.command_line import CELL

ENDS = ["--start", "home", "--goal", "inside"]
ALONG = ["plan", "box-reach.yaml", "--robot", "ur5", *ENDS]
ZEROS = "0,0,0,0,0,0"
WRONG_LIMITS = "obstacles: {}\nlimits: {knee: [0, 1]}\n"


def test_it_makes_the_roadmap_that_python_makes(made, run):
    expected = er.build_roadmap(ArmWorld("ur5", "cell.yaml"), 64, rule=KNearest(12))
    code, out, _ = run("roadmap", "ur5", "--cell", "cell.yaml", "-n", 64, "-k", 12)
    assert code == 0
    assert f"64 milestones and {len(expected.edges)} edges" in out
    roadmap = er.load_roadmap("ur5.roadmap")
    np.testing.assert_array_equal(roadmap.milestones, expected.milestones)
    np.testing.assert_array_equal(roadmap.edges, expected.edges)


def test_a_plan_along_it_is_that_of_python_and_proved(answer, made):
    record, _ = answer(*ALONG, "--roadmap", "my.roadmap")
    world = ArmWorld("ur5", "box-reach")
    assert record["path"] == er.plan(world, "home", "inside", "my.roadmap").path.tolist()
    assert record["proof"] == "certified"
    assert record["planner"].startswith("prm lazy")


@pytest.mark.parametrize(("words", "said"), [
    (["roadmap", "ur5", "-n", "0"], "n must be"),
    (["roadmap", "ur5", "-k", "0"], "k must be"),
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
    (["plan", "box-reach.yaml", *ENDS, "--roadmap", "none", "--robot-radius", "1"], "--roadmap goes with --robot"),
])  # fmt: skip
def test_bad_input_gets_one_line_and_nothing_is_written(refuse, tmp_path, words, said):
    (tmp_path / "cell.yaml").write_text(CELL)
    (tmp_path / "limits.yaml").write_text(WRONG_LIMITS)
    assert said in refuse(*words)


def test_a_roadmap_of_another_arm_or_of_other_limits_is_refused(refuse, made):
    for robot in (
        ["arm7", "--start", ZEROS + ",0", "--goal", ZEROS + ",0"],
        ["ur5", "--start", ZEROS, "--goal", ZEROS],
    ):
        assert "another space" in refuse("plan", "empty.yaml", "--robot", *robot, "--roadmap", "my.roadmap")


def test_a_roadmap_that_is_no_more_what_was_written_gets_one_line(refuse, made):
    whole = bytearray((made / "my.roadmap").read_bytes())
    middle, last = len(whole) // 2, len(whole) - 5
    with np.load("my.roadmap") as archive:
        arrays = {name: archive[name] for name in archive.files if name != "digest"}

    def kept(name, gone=(), **changed):
        changed = {n: a for n, a in arrays.items() if n not in gone} | {n: np.asarray(a) for n, a in changed.items()}
        np.savez(name, digest=digest(changed), **changed)
        return (made / f"{name}.npz").read_bytes()

    of_one_arm = dict.fromkeys(("robot", "scene", "settings", "turns", "weights"), "")
    of_one_arm |= {"surface_points": np.empty((0, 3)), "surface_triangles": np.empty((0, 3), np.int64)}
    for content, said in (
        (b"", "is empty"),
        (b"hello", "is text"),
        (whole[: len(whole) // 3], "damaged"),
        (whole[:middle] + bytes([whole[middle] ^ 255]) + whole[middle + 1 :], "damaged"),
        (whole[:last] + bytes([whole[last] ^ 255]) + whole[last + 1 :], "damaged"),
        (kept("older", version="0.0.1"), "of evenroad 0.0.1"),
        (kept("astray", edges=np.array([[0, 99]], np.int32), lengths=[1.0]), "edges must join milestones 0 .. 63"),
        (kept("ruled", rule="all of them"), "rule"),
        (kept("learned", ("points", "origin", "rule", "lengths"), **of_one_arm), "made for one arm"),
    ):
        (made / "other.roadmap").write_bytes(content)
        error = refuse(*ALONG, "--roadmap", "other.roadmap")
        assert "other.roadmap" in error
        assert said in error
