"""With what an arm's configurations are checked is said."""

PLAN = ("plan", "desk.yaml", "--robot", "arm.urdf", "--start", "-0.9,0", "--goal", "0.9,0")


def test_the_lanes_are_named(run, answer, desk):
    record, shown = answer(*PLAN)
    assert "checked by lanes" in shown
    assert record["checked_with"] == "lanes"
    assert "one core, with lanes, in empty space" in " ".join(run("robot", "arm.urdf")[1].split())
