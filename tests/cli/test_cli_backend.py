"""With what an arm's configurations are checked is said, and why where it is the slow way."""

from evenroad.robot import arm_world
from evenroad.robot.kernel import selftest

PLAN = ("plan", "desk.yaml", "--robot", "arm.urdf", "--start", "-0.9,0", "--goal", "0.9,0")


def test_the_lanes_are_named_where_they_work_and_the_fallback_with_its_reason(run, answer, desk, monkeypatch):
    record, shown = answer(*PLAN)
    assert "checked by lanes" in shown
    assert record["checked_with"] == "lanes"
    assert "one core, with lanes, in empty space" in " ".join(run("robot", "arm.urdf")[1].split())
    for module in (selftest, arm_world):
        monkeypatch.setattr(module, "lanes_failure", lambda: "OSError: no vectors")
    said = "scalar (lanes do not work here: OSError: no vectors)"
    record, shown = answer(*PLAN)
    assert f"checked by {said}" in shown
    assert record["checked_with"] == said
    assert f"one core, with {said}" in " ".join(run("robot", "arm.urdf")[1].split())
