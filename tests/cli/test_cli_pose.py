"""``evenroad plan --goal-pose``."""

import json

import pytest

POSE = ("--goal-pose", "0.65 0 0.2 0 0.70710678 0 0.70710678")


def plan(*more):
    return ["plan", "box-reach.yaml", "--robot", "ur5", "--start", "home", "--no-picture", *more]


def test_a_goal_pose_is_reached_and_the_record_says_how(run, tmp_path):
    code, out, err = run(*plan(*POSE))
    assert (code, err) == (0, "")
    assert "tool0 at (0.65, 0, 0.2)" in out
    assert max(map(len, out.splitlines())) <= 100
    (pose,) = json.loads((tmp_path / "box-reach.json").read_text())["query"]["goal_poses"]
    assert pose["tip"] == "tool0"
    assert pose["postures"] >= 4
    assert max(pose["off_m"], pose["off_rad"]) < 1e-6


def test_a_pose_in_degrees_a_free_axis_a_tolerance_and_several_goals_go_together(run, tmp_path):
    both = (
        "--goal-pose",
        "0.65",
        "0",
        "0.2",
        "0",
        "90",
        "0",
        "--goal-pose",
        "0.6 0 0.2 0 90 0",
        "--goal",
        "inside",
    )
    code, _, err = run(
        *plan(*both, "--deg", "--free-axis", "z", "--tolerance", "0.001 0.01", "--tip", "wrist_3_link")
    )
    assert (code, err) == (0, "")
    first, second = json.loads((tmp_path / "box-reach.json").read_text())["query"]["goal_poses"]
    assert first["free_axis"] == [0, 0, 1]
    assert (second["position_tolerance"], second["angle_tolerance"]) == (0.001, 0.01)


def test_out_of_reach_is_an_answer_with_a_picture(run, tmp_path):
    code, out, err = run(*plan("--goal-pose", "2 0 0")[:-3], "--goal-pose", "2 0 0", "--out", "far")
    assert (code, err) == (1, "")
    assert "goal_unreachable" in out
    assert json.loads((tmp_path / "far.json").read_text())["status"] == "goal_unreachable"
    assert (tmp_path / "far.png").exists()
    assert not (tmp_path / "far.csv").exists()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--goal-pose", "0.6 0 0.2 0 0 0 2"), "norm 1, got 2"),
        (("--goal-pose", "0.6 0 nan"), "finite numbers, got '0.6 0 nan'"),
        ((*POSE, "--tip", "hand"), "unknown link of 'ur5': 'hand'"),
        ((*POSE, "--frame", "wrist_1_link"), "must stand still"),
        ((*POSE, "--tolerance", "-1"), "position_tolerance must be a finite number >= 0"),
        (("--goal-pose", "0.6 0 0.2", "--free-axis", "z"), "--free-axis needs a rotation"),
        (("--goal", "inside", "--tip", "tool0"), "--tip goes with --goal-pose"),
        ((), "missing from evenroad plan: --goal, or --goal-pose"),
    ],
)
def test_what_is_wrong_with_a_goal_pose_is_said_in_one_line(run, tmp_path, options, said):
    code, out, err = run(*plan(*options))
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert said in err
    assert not list(tmp_path.glob("box-reach*"))


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--tip", "hand"), "unknown link of 'ur5': 'hand'"),
        (("--tip", "base_link"), "moves the link 'base_link'"),
        (("--frame", "hand"), "unknown link of 'ur5': 'hand'"),
        (("--frame", "wrist_1_link"), "must stand still"),
    ],
)
def test_a_link_that_cannot_be_is_refused_before_a_world_is_made(run, monkeypatch, options, said):
    monkeypatch.setattr(
        "evenroad.planning.arm_request.ArmWorld", lambda *_, **__: pytest.fail("a world was made")
    )
    assert said in run(*plan(*POSE, *options))[2]


def test_what_the_scene_attaches_is_held_and_said(run, tmp_path):
    (tmp_path / "pick.yaml").write_text(
        "obstacles:\n  table: {shape: box, size: [1, 1, 0.1], xyz: [0.3, 0, -0.05]}\n"
        "allowed: {table: [base_link, shoulder_link]}\n"
        "attach:\n  crate: {shape: box, size: [0.1, 0.1, 0.1], link: tool0, xyz: [0, 0, 0.06],"
        " touches: [wrist_2_link]}\n"
    )
    words = ["plan", "pick.yaml", "--robot", "ur5", "--start", "0 -90 0 -90 0 0"]
    code, out, err = run(*words, "--goal-pose", "0.5 0 0.3 180 0 0", "--deg")
    assert (code, err) == (0, "")
    assert "holds" in out
    assert "crate" in out
    assert json.loads((tmp_path / "pick.json").read_text())["query"]["holds"] == ["crate"]
    assert (tmp_path / "pick.png").exists()
    code, out, err = run(*words, "--goal-pose", "0.5 0 0.08 180 0 0", "--deg")
    assert code == 1
    assert "'crate' touches 'table'" in " ".join(out.split())


DOWN = ("--goal-pose", "0.4 -0.3 0.5 180 0 0", "--deg", "--start", "20 -90 90 -90 -90 0")


def test_straight_and_upright_are_asked_for_and_their_deviations_told(run, tmp_path):
    words = ["plan", "box-reach.yaml", "--robot", "ur5", "--no-picture", *DOWN]
    code, out, err = run(*words, "--straight", "0.05 0.05", "--away", "up", "--upright", "5", "--out", "a")
    assert (code, err) == (0, "")
    record = json.loads((tmp_path / "a.json").read_text())
    assert set(record["deviation"]) == {"tilt_rad", "line_m", "line_rad"}
    assert record["deviation"]["line_m"] < 1e-3
    assert "largest deviations: tilt [rad]" in " ".join(out.split())
    assert max(map(len, out.splitlines())) <= 100


def test_axes_may_be_negative(run, tmp_path):
    words = ["plan", "box-reach.yaml", "--robot", "ur5", "--no-picture", *DOWN]
    words += ["--straight", "0.05", "--upright", "5", "--out", "a"]
    paths = []
    for axes in (("--away", "-z", "--upright-axis", "-z"), ("--away=-z", "--upright-axis=-z")):
        code, _, err = run(*words, *axes)
        assert (code, err) == (0, "")
        paths.append((tmp_path / "a.csv").read_text())
    assert paths[0] == paths[1]
    code, _, err = run(*words, "--upright-axis", "z")
    assert (code, err) == (1, "")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--straight", "0"), "must have a length"),
        (("--straight", "far"), "--straight must be 1 or 2 finite numbers, got 'far'"),
        (("--straight", "0.1", "--away", "0 0 0"), "away must be a direction"),
        (("--away", "up"), "--away goes with --straight"),
        (("--upright", "-1"), "tolerance of upright must be a finite number > 0"),
        (("--upright", "nan"), "tolerance of upright must be a finite number > 0, got nan"),
        (("--upright", "5", "--upright-axis", "up"), "axis of upright must be"),
        (("--upright-axis", "z"), "--upright-axis goes with --upright"),
    ],
)
def test_what_is_wrong_with_a_way_is_said_in_one_line(run, tmp_path, options, said):
    code, out, err = run("plan", "box-reach.yaml", "--robot", "ur5", *DOWN, *options)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert said in err


def test_a_robots_roadmap_leads_to_poses_with_full_hands_and_straight(run, made):
    (made / "pick.yaml").write_text(
        "obstacles:\n  post: {shape: box, size: [0.1, 0.1, 0.5], xyz: [0.5, 0.5, 0.25]}\n"
        "attach:\n  rod: {shape: cylinder, radius: 0.02, length: 0.2, link: tool0, xyz: [0, 0, 0.1],"
        " touches: [wrist_2_link]}\n"
    )
    words = ["plan", "pick.yaml", "--roadmap", "my.roadmap", "--no-picture", *DOWN]
    code, _, err = run(*words, "--straight", "0.05")
    assert (code, err) == (0, "")
    record = json.loads((made / "pick.json").read_text())
    assert record["planner"] == "roadmap"
    assert record["query"]["holds"] == ["rod"]
    assert record["deviation"]["line_m"] < 1e-3
    code, _, err = run(*words, "--upright", "5")
    assert code == 2
    assert "--upright goes without --roadmap" in err
