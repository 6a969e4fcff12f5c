"""The answer to a task is read back as it was saved: its steps, motions, worlds and times."""

import json
import math

import numpy as np
import pytest

import evenroad as er
from evenroad.cli import main
from evenroad.constraints import KeepInBox, KeepJoints, KeepOrientation, KeepUpright
from evenroad.errors import BrokenFile
from evenroad.task import Attach, Close, Detach, MoveAlong, MoveCircular, MoveLinear, MoveTo, Open, Task, Wait
from evenroad.task.record import plain_value, value_of_plain

HOME = [0.0, -1.57, 1.57, -1.57, -1.57, 0.0]
TABLE = er.Box((0.8, 1.2, 0.04), xyz=(0.5, 0, -0.04), name="table")
CAN = er.Box((0.06, 0.06, 0.16), xyz=(0.5, 0.2, 0.06), name="can")
DOWN = er.Pose((0.5, 0.2, 0.142), rpy=(math.pi, 0, 0.3))
STEPS = [
    MoveTo(er.PoseGoal(DOWN), approach=0.1, constraints=KeepJoints({"elbow_joint": (-3.0, 3.0)})),
    Attach("can", link="tool0", depth=0.004),
    MoveTo(er.PoseGoal(er.Pose((0.5, -0.3, 0.061)), tip="can", free_axis="z"), retreat=0.05, approach=0.05, away="up"),
    Detach("can", onto="table"),
    Wait(0.2),
    MoveTo(np.array(HOME), retreat=0.1),
]


@pytest.fixture(scope="module")
def done():
    world = er.ArmWorld("ur5", er.Scene([TABLE, CAN], allowed=frozenset({("base_link", "table")})))
    made = Task(STEPS).plan(world, HOME)
    assert made.solved, made.message
    return made


def test_a_loaded_answer_has_the_steps_the_motions_and_the_trajectory(done, tmp_path):
    done.save(tmp_path / "task.json")
    loaded = er.load(tmp_path / "task.json")
    assert (loaded.steps[:-1], loaded.message, loaded.tried) == (done.steps[:-1], done.message, done.tried)
    assert tuple(loaded.steps[-1].goal) == tuple(HOME)
    assert np.array_equal(loaded.path, done.path)
    assert [each.goal for each in loaded.motions] == [each.goal for each in done.motions]
    again, first = loaded.trajectory(speed=0.4), done.trajectory(speed=0.4)
    assert again.positions.tobytes() == first.positions.tobytes()


def test_a_saved_answer_is_sent_and_one_that_jumps_is_not(done, tmp_path, capsys):
    done.save(tmp_path / "task.json")
    assert main(["send", str(tmp_path / "task.json"), "--fastest", "0.5"]) == 0
    assert "made for at most 0.5 rad/s" in capsys.readouterr().out
    record = json.loads((tmp_path / "task.json").read_text())
    record["motions"][1], record["motions"][2] = record["motions"][2], record["motions"][1]
    del record["sha256"]
    (tmp_path / "task.json").write_text(json.dumps(record))
    assert main(["send", str(tmp_path / "task.json")]) == 2
    assert "do not begin where those before them end" in capsys.readouterr().err


def test_an_answer_without_a_path_is_read_back_and_says_why(tmp_path):
    failed = Task([MoveTo(er.PoseGoal(er.Pose((5, 0, 0))))]).plan(er.ArmWorld("ur5"), "home")
    failed.save(tmp_path / "task.json")
    loaded = er.load(tmp_path / "task.json")
    assert (loaded.status, loaded.message, loaded.step) == (failed.status, failed.message, 0)
    with pytest.raises(er.errors.NotAvailable, match="nothing to draw: step 0 of the task cannot be done"):
        loaded.plot()


@pytest.mark.parametrize(
    "step",
    [
        MoveTo(["home", DOWN, er.PoseGoal(DOWN, free_axis="x", angle_tolerance=0.1)]),
        MoveTo("home", constraints=KeepUpright(0.1) & KeepInBox((-1, -1, 0), (1, 1, 1)) & KeepOrientation(0.2)),
        MoveLinear(DOWN, speed=0.1),
        MoveAlong([DOWN, er.Pose((0.4, 0, 0.3), rpy=(1, 2, 3))], blend=0.01),
        MoveCircular(er.PoseGoal(DOWN, "tool0"), er.PoseGoal(DOWN, "tool0")),
        Attach("can", touches=["a", "b"]),
        Open({"finger": 0.02}),
        Close(until="can"),
    ],
)
def test_each_step_is_read_back_as_it_was(step):
    loaded = value_of_plain(json.loads(json.dumps(plain_value(step))))
    assert repr(loaded).replace("[", "(").replace("]", ")") == repr(step).replace("[", "(").replace("]", ")")


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"steps": [{"is": "Path"}]}, "unknown kind of value 'Path'"),
        ({"steps": [{"is": "Wait", "hours": 1}]}, "damaged task"),
        ({"motions": [{}]}, "it lacks 'parts'"),
        ({"status": "fine"}, "'fine' is not a valid Status"),
        ({"format": "evenroad.task 1"}, "'format' must be 'evenroad.task 2'"),
    ],
)
def test_a_damaged_answer_is_refused(done, tmp_path, change, why):
    done.save(tmp_path / "task.json")
    record = json.loads((tmp_path / "task.json").read_text()) | change
    del record["sha256"]
    (tmp_path / "task.json").write_text(json.dumps(record))
    with pytest.raises(BrokenFile, match=why):
        er.load(tmp_path / "task.json")
