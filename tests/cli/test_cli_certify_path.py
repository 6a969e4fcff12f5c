"""`evenroad certify-path` says where a path touches, and its exit code says whether it is proved."""

import json

import pytest

import evenroad as er

WORDS = ("--robot", "ur5", "--scene", "box-reach.yaml")


@pytest.fixture
def paths(tmp_path):
    """A plan, and the straight line from its start to its goal, which touches."""
    result = er.plan(er.ArmWorld("ur5", "box-reach"), "home", "inside")
    result.save("plan.csv")
    er.io.save_path_csv("straight.csv", result.path[[0, -1]], result.world.robot.joint_names)
    return result.path


def test_a_plan_is_proved_and_gets_a_certificate(run, paths, tmp_path):
    code, out, err = run("certify-path", "plan.csv", *WORDS, "--certificate", "plan.cert")
    assert (code, err) == (0, "")
    assert f"{len(paths) - 1} straight motions proved" in " ".join(out.split())
    assert (tmp_path / "plan.cert").read_bytes().startswith(b"evenroad certificate 1")


def test_a_path_that_touches_says_which_bodies_and_where(run, paths):
    code, out, _ = run("certify-path", "straight.csv", *WORDS)
    assert code == 1
    assert "'wrist_1_link' and 'box top' at share 0.7370321" in " ".join(out.split())
    code, out, _ = run("certify-path", "straight.csv", *WORDS, "--json")
    record = json.loads(out)
    assert code == 1
    assert record["status"] == "touches"
    assert record["touch"]["waypoint"] == 0
    assert not er.ArmWorld("ur5", "box-reach").valid(record["touch"]["configuration"])


def test_wrong_input_is_refused_in_one_line(refuse, paths):
    assert "cannot read the path none.csv: No such file" in refuse("certify-path", "none.csv", *WORDS)
    assert "format of a path" in refuse("certify-path", "plan.doc", *WORDS)
