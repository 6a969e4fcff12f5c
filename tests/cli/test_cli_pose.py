"""``evenroad plan --goal-pose``."""

import json

import pytest

POSE = ("--goal-pose", "0.65 0 0.2 0 0.70710678 0 0.70710678")
ON_UR5 = ("plan", "box-reach.yaml", "--robot", "ur5", "--start", "home")


def test_a_goal_pose_is_reached_and_the_record_says_how(answer):
    record, shown = answer(*ON_UR5, *POSE)
    assert "tool0 at (0.65, 0, 0.2)" in shown
    (pose,) = record["query"]["goal_poses"]
    assert pose["tip"] == "tool0"
    assert pose["postures"] >= 4
    assert max(pose["off_m"], pose["off_rad"]) < 1e-6


def test_a_pose_in_degrees_a_free_axis_a_tolerance_and_several_goals_go_together(answer):
    poses = ("--goal-pose", "0.65", "0", "0.2", "0", "90", "0", "--goal-pose", "0.6 0 0.2 0 90 0")
    how = ("--deg", "--free-axis", "z", "--tolerance", "0.001 0.01", "--tip", "wrist_3_link")
    first, second = answer(*ON_UR5, *poses, "--goal", "inside", *how)[0]["query"]["goal_poses"]
    assert first["free_axis"] == [0, 0, 1]
    assert (second["position_tolerance"], second["angle_tolerance"]) == (0.001, 0.01)


def test_out_of_reach_is_an_answer_with_a_picture(run, tmp_path):
    code, out, err = run(*ON_UR5, "--goal-pose", "2 0 0", "--out", "far")
    assert (code, err) == (1, "")
    assert "goal_unreachable" in out
    assert max(map(len, out.splitlines())) <= 100
    assert json.loads((tmp_path / "far.json").read_text())["status"] == "goal_unreachable"
    assert (tmp_path / "far.png").exists()
    assert not (tmp_path / "far.csv").exists()


DOWN = ("--goal-pose", "0.4 -0.3 0.5 180 0 0", "--deg", "--start", "20 -90 90 -90 -90 0")


@pytest.mark.parametrize(("options", "said"), [
    (("--goal-pose", "0.6 0 0.2 0 0 0 2"), "norm 1, got 2"),
    (("--goal-pose", "0.6 0 nan"), "finite numbers, got '0.6 0 nan'"),
    ((*POSE, "--tolerance", "-1"), "position_tolerance must be a finite number >= 0"),
    (("--goal-pose", "0.6 0 0.2", "--free-axis", "z"), "--free-axis needs a rotation"),
    (("--goal", "inside", "--tip", "tool0"), "--tip goes with --goal-pose"),
    ((), "missing from evenroad plan: --goal, or --goal-pose"),
    ((*DOWN, "--straight", "0"), "must have a length"),
    ((*DOWN, "--straight", "far"), "--straight must be 1 or 2 finite numbers, got 'far'"),
    ((*DOWN, "--straight", "0.1", "--away", "0 0 0"), "away must be a direction"),
    ((*DOWN, "--away", "up"), "--away goes with --straight"),
    ((*DOWN, "--upright", "-1"), "tolerance of upright must be a finite number > 0"),
    ((*DOWN, "--upright", "nan"), "tolerance of upright must be a finite number > 0, got nan"),
    ((*DOWN, "--upright", "5", "--upright-axis", "up"), "axis of upright must be"),
    ((*DOWN, "--upright-axis", "z"), "--upright-axis goes with --upright"),
])  # fmt: skip
def test_what_is_wrong_with_a_goal_pose_or_a_path_is_said_in_one_line(refuse, options, said):
    assert said in refuse(*ON_UR5, *options)


@pytest.mark.parametrize(("options", "said"), [
    (("--tip", "hand"), "unknown link of 'ur5': 'hand'"), (("--tip", "base_link"), "moves the link 'base_link'"),
    (("--frame", "hand"), "unknown link of 'ur5': 'hand'"), (("--frame", "wrist_1_link"), "must stand still"),
])  # fmt: skip
def test_a_link_that_cannot_be_is_refused_before_a_world_is_made(refuse, monkeypatch, options, said):
    monkeypatch.setattr("evenroad.planning.read_problem.ArmWorld", lambda *_, **__: pytest.fail("a world was made"))
    assert said in refuse(*ON_UR5, *POSE, *options)


def test_what_the_scene_attaches_is_held_and_said(run, answer, tmp_path):
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
    _, shown = answer(*words, "--goal-pose", "0.5 0 0.08 180 0 0", "--deg", code=1)
    assert "'crate' touches 'table'" in shown


def test_straight_and_upright_are_asked_for_and_their_deviations_told(answer):
    record, shown = answer(*ON_UR5, *DOWN, "--straight", "0.05 0.05", "--away", "up", "--upright", "5")
    assert set(record["deviation"]) == {"tilt_rad", "line_m", "line_rad"}
    assert record["deviation"]["line_m"] < 1e-3
    assert "largest deviations: tilt [rad]" in shown


def test_axes_may_be_negative(answer):
    words = (*ON_UR5, *DOWN, "--straight", "0.05", "--upright", "5")
    spaced, joined = ("--away", "-z", "--upright-axis", "-z"), ("--away=-z", "--upright-axis=-z")
    assert answer(*words, *spaced)[0]["path"] == answer(*words, *joined)[0]["path"]
    answer(*words, "--upright-axis", "z", code=1)


def test_a_roadmap_leads_to_poses_with_full_hands_and_straight(answer, refuse, run, tmp_path):
    run("roadmap", "ur5", "-n", 64, "-o", "my.roadmap")
    (tmp_path / "pick.yaml").write_text(
        "obstacles:\n  post: {shape: box, size: [0.1, 0.1, 0.5], xyz: [0.5, 0.5, 0.25]}\n"
        "attach:\n  rod: {shape: cylinder, radius: 0.02, length: 0.2, link: tool0, xyz: [0, 0, 0.1],"
        " touches: [wrist_2_link]}\n"
    )
    words = ["plan", "pick.yaml", "--robot", "ur5", "--roadmap", "my.roadmap", *DOWN]
    record, _ = answer(*words, "--straight", "0.05")
    assert record["planner"].startswith("prm lazy")
    assert record["query"]["holds"] == ["rod"]
    assert record["deviation"]["line_m"] < 1e-3
    assert "--upright goes without --roadmap" in refuse(*words, "--upright", "5")
