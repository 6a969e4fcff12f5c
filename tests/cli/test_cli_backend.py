"""With what an arm's configurations are checked is said, and why where it is the slow way."""

import json

import pytest

from evenroad.robot import arm_world
from evenroad.robot.kernel import selftest
from tests.robot.urdf_texts import two_joints


@pytest.fixture
def desk(tmp_path):
    (tmp_path / "arm.urdf").write_text(two_joints())
    (tmp_path / "desk.yaml").write_text(
        "obstacles:\n  ball: {shape: sphere, radius: 0.05, xyz: [0.0, 0, 0.75]}\n"
    )
    return tmp_path


PLAN = ("plan", "desk.yaml", "--robot", "arm.urdf", "--start", "-0.9,0", "--goal", "0.9,0", "--out", "a")


def test_the_lanes_are_named_where_they_work(run, desk):
    _, out, _ = run(*PLAN)
    assert "checked by lanes" in " ".join(out.split())
    assert json.loads((desk / "a.json").read_text())["checked_with"] == "lanes"
    assert "one core, with lanes, in empty space" in " ".join(run("robot", "arm.urdf")[1].split())


def test_the_fallback_is_said_aloud_with_its_reason(run, desk, monkeypatch):
    for module in (selftest, arm_world):
        monkeypatch.setattr(module, "lanes_failure", lambda: "OSError: no vectors")
    said = "scalar (lanes do not work here: OSError: no vectors)"
    _, out, _ = run(*PLAN)
    assert f"checked by {said}" in " ".join(out.split())
    assert json.loads((desk / "a.json").read_text())["checked_with"] == said
    assert f"one core, with {said}" in " ".join(run("robot", "arm.urdf")[1].split())
