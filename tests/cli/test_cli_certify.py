"""``evenroad certify``: what is guaranteed, as a table and as JSON, and what is refused."""

import json

import numpy as np
import pytest

import evenroad as er
from evenroad.points import draw, save_points
from evenroad.roadmap import KNearest, Radius, certify
from evenroad.robot.kinematics import capsule_ends
from evenroad.robot_roadmap.certify import certify_robot_roadmap, joints_per_metre
from evenroad.space import BoxSpace


@pytest.fixture
def sets(tmp_path):
    save_points(tmp_path / "two.npz", draw("cover", 200, 2))
    np.save(tmp_path / "four.npy", draw("even", 64, 4).points)


def test_json_says_what_python_says(run, sets):
    code, out, err = run(
        "certify", "two.npz", "--connect-radius", 0.3, "--clearance", 0.1, "--length", 2, "--json"
    )
    record = json.loads(out)
    certificate = certify(draw("cover", 200, 2), Radius(0.3), BoxSpace([0.0, 0.0], [1.0, 1.0]))
    assert (code, err) == (0, "")
    assert record["dispersion"] == certificate.dispersion
    assert record["factor"] == certificate.factor(0.1)
    assert record["longest"] == certificate.longest(2.0, 0.1)
    assert record["clearance_for_factor"]["2"] == certificate.clearance_for(2.0)
    assert record["complete_from_clearance"] == certificate.dispersion


def test_the_box_has_the_sides_that_are_given(run, sets):
    record = json.loads(run("certify", "two.npz", "--sides", "10,5", "-k", 20, "--json")[1])
    certificate = certify(draw("cover", 200, 2), KNearest(20), BoxSpace([0.0, 0.0], [10.0, 5.0]))
    assert record["between"] == certificate.between
    assert record["rule"] == "k=20 symmetrised"


def test_the_table_says_in_words_what_holds(run, sets):
    code, out, _ = run("certify", "two.npz", "--clearance", 0.2)
    assert code == 0
    assert "if none is found, none does" in out
    assert "with 0.2" in out


def test_nothing_guaranteed_is_an_answer_with_exit_code_1(run, sets):
    code, out, _ = run("certify", "four.npy", "-k", 4)
    assert code == 1
    assert "nothing is guaranteed" in out
    assert run("certify", "two.npz", "--clearance", 0.01)[0] == 1


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((), "give one point set or --roadmap FILE"),
        (("two.npz", "four.npy"), "give one point set or --roadmap FILE"),
        (("two.npz", "--roadmap", "x"), "give one point set or --roadmap FILE"),
        (("two.npz", "--clearance", "0"), "--clearance must be"),
        (("two.npz", "--length", "1"), "--length goes with --clearance"),
        (("two.npz", "--sides", "1"), "--sides must be 2 numbers"),
        (("two.npz", "--sides", "1,x"), "--sides must be 2 numbers"),
        (("two.npz", "-k", "3", "--connect-radius", "1"), "not both"),
        (("two.npz", "-k", "2", "--goals", "2"), "k has to be above 2"),
        (("two.npz", "--connect-radius", "-1"), "connection radius"),
        (("--roadmap", "two.npz", "--goals", "0"), "--goals must be"),
        (("none.npz",), "no such file"),
        (("--roadmap", "two.npz"), "roadmap"),
        (("--roadmap", "two.npz", "-k", "3"), "-k goes with a point set"),
    ],
)
def test_bad_input_is_one_line(run, sets, words, said):
    code, out, err = run("certify", *words)
    assert (code, out) == (2, "")
    assert err.startswith("evenroad: error: ")
    assert err.count("\n") == 1
    assert said in err


def test_an_arms_roadmap_is_certified_in_metres(run):
    robot = er.load_robot("ur5", group="shoulder_lift_joint,elbow_joint")
    roadmap = er.make_roadmap(robot, None, 128, k=40, gamma=0.0)
    er.save_robot_roadmap("two.roadmap", roadmap)
    record = json.loads(run("certify", "--roadmap", "two.roadmap", "--clearance", 0.2, "--json")[1])
    certificate, per_metre, allowance = certify_robot_roadmap(roadmap)
    assert record["dispersion"] == certificate.dispersion
    assert record["joints_per_metre"] == per_metre
    # No place of the two joints' ranges is farther from a milestone.
    one, rng = roadmap.one_turn, np.random.default_rng(0)
    q = one.low + rng.random((300, 2)) * (one.high - one.low)
    way = q[:, None] - roadmap.milestones[None]
    turn = np.where(one.wraps, 2 * np.pi, np.inf)
    way = np.minimum(np.abs(way), turn - np.abs(way)) * roadmap.weights
    assert np.linalg.norm(way, axis=2).min(1).max() <= certificate.dispersion
    assert 0.0 < allowance < 0.01
    # An end is linked to all milestones that no joint's half turn keeps apart.
    assert certificate.ends == pytest.approx(np.pi * roadmap.weights[one.wraps].min())


def test_no_body_moves_farther_than_the_joints_allow():
    robot = er.load_robot("ur5")
    world, weights = er.ArmWorld(robot, er.load_scene("box-reach")), np.array([1.3, 1.5, 1.2, 0.6, 0.5, 0.2])
    rng = np.random.default_rng(1)
    a = rng.uniform(-2.0, 2.0, (200, 6))
    b = a + 0.2 * rng.standard_normal((200, 6))
    moved = (
        np.linalg.norm(capsule_ends(robot, b) - capsule_ends(robot, a), axis=-1).reshape(200, -1).max(axis=1)
    )
    allowed = np.linalg.norm(weights * (b - a), axis=1) / joints_per_metre(world, weights)
    assert (moved <= allowed).all()
    assert (moved > 0.3 * allowed).any()
