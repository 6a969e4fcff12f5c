"""Tasks from files, and the command that runs them."""

import numpy as np
import pytest

import evenroad as er
from evenroad.cli import main
from evenroad.errors import BrokenFile, EvenroadError
from evenroad.task import Attach, Detach, MoveTo, Wait, load_task
from evenroad.trajectory import load_trajectory

CELL = """
obstacles:
  table: {shape: box, size: [0.8, 1.2, 0.04], xyz: [0.5, 0, -0.04]}
  can: {shape: box, size: [0.06, 0.06, 0.16], xyz: [0.5, 0.2, 0.06]}
allowed: {table: [base_link]}
"""
STEPS = """
robot: ur5
scene: cell.yaml
start: "0 -1.57 1.57 -1.57 -1.57 0"
steps:
  - move_to: {poses: ["0.5 0.2 0.142 3.14159 0 0", "0.5 0.2 0.142 3.14159 0 0.8"], approach: 0.1}
  - attach: can
  - move_to: {poses: ["0.5 -0.3 0.061 0 0 0"], tip: can, free_axis: z, retreat: 0.05, approach: 0.05, away: up}
  - detach: {object: can, onto: table}
  - wait: 0.5
  - move_to: {goals: ["0 -1.57 1.57 -1.57 -1.57 0"], retreat: 0.1}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "cell.yaml").write_text(CELL)
    (tmp_path / "task.yaml").write_text(STEPS)
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    return tmp_path


def test_a_file_says_the_steps_as_values(folder):
    said = load_task(folder / "task.yaml")
    grasp, attach, place, detach, wait, home = said.task.steps
    assert (said.robot, said.scene, said.start) == ("ur5", str(folder / "cell.yaml"), "0 -1.57 1.57 -1.57 -1.57 0")
    assert (attach, detach, wait) == (Attach("can"), Detach("can", onto="table"), Wait(0.5))
    assert isinstance(grasp.goal, list)
    assert grasp.goal[1] == er.PoseGoal(er.Pose((0.5, 0.2, 0.142), rpy=(3.14159, 0, 0.8)))
    assert place == MoveTo(
        er.PoseGoal(er.Pose((0.5, -0.3, 0.061)), tip="can", free_axis="z"), approach=0.05, retreat=0.05, away="up"
    )
    assert (home.goal, home.retreat) == ("0 -1.57 1.57 -1.57 -1.57 0", 0.1)


def test_the_command_writes_one_trajectory_that_ends_where_it_began(folder, capsys):
    assert main(["run", "../task.yaml", "-o", "out.json", "out.movej.script", "--speed", "0.5"]) == 0
    assert "solved: 3 motions" in capsys.readouterr().out
    trajectory = load_trajectory("out.json")
    np.testing.assert_allclose(trajectory.positions[-1], [0, -1.57, 1.57, -1.57, -1.57, 0], atol=1e-9)
    assert "sleep(0.504)" in (folder / "elsewhere" / "out.movej.script").read_text()


def test_a_task_that_cannot_be_done_says_which_step_and_leaves_no_earlier_trajectory(folder, capsys):
    (folder / "task.yaml").write_text(STEPS.replace("-0.3 0.061", "-0.3 0.01"))
    (folder / "elsewhere" / "out.csv").write_text("earlier")
    assert main(["run", "../task.yaml", "-o", "out.csv"]) == 1
    assert "step 2 of the task cannot be done" in " ".join(capsys.readouterr().out.split())
    assert not (folder / "elsewhere" / "out.csv").exists()


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("wait: 0.5", "wait: soon", "step 4 in .*task.yaml: seconds must be"),
        ("wait: 0.5", "jump: 1", "step 4 in .*: .*'jump'; known: attach, close, detach, move_along, .*wait"),
        ("attach: can", "attach: {object: can, hand: 1}", "step 1 in .*'hand'"),
        ("attach: can", "attach", "step 1 in .*: a step must be one of move_to: ..., move_linear"),
        ("approach: 0.1}", "approach: -0.1}", "step 0 in .*approach must be"),
        ('poses: ["0.5 -0.3 0.061 0 0 0"]', 'poses: ["0.5"]', "step 2 in .*a goal pose must be 3 or 6 or 7"),
        ("start:", "begin:", "'start'|'begin'"),
        ("steps:", "steps: 3\nmore:", "more|must be a list"),
    ],
)
def test_what_a_task_does_not_have_is_refused_in_one_line(folder, old, new, says):
    (folder / "task.yaml").write_text(STEPS.replace(old, new))
    with pytest.raises(EvenroadError, match=says) as caught:
        load_task(folder / "task.yaml")
    assert "\n" not in str(caught.value)


def test_constraints_of_a_file_are_texts_as_the_command_takes_them(folder):
    said = "free_axis: z, upright: 0.2, constraints: [line y within=0.001, 'joints elbow_joint=0,2.5'], retreat: 0.05"
    (folder / "task.yaml").write_text(STEPS.replace("free_axis: z, retreat: 0.05", said))
    (_, _, place, *_) = load_task(folder / "task.yaml").task.steps
    line, joints, upright = place.constraints.parts
    assert line == er.constraints.KeepOnLine("y", within=0.001)
    assert joints == er.constraints.KeepJoints({"elbow_joint": (0.0, 2.5)})
    assert upright == er.constraints.KeepUpright(0.2)
    (folder / "task.yaml").write_text(STEPS.replace("free_axis: z", "free_axis: z, constraints: bend 3"))
    with pytest.raises(EvenroadError, match="step 2 in .*unknown constraint 'bend'"):
        load_task(folder / "task.yaml")


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("detach: {object: can, onto: table}", "detach: cup", "step 3 of the task lets go of 'cup', which it cannot"),
        ("attach: can", "attach: cup", "unknown obstacle 'cup'; known: can, table"),
    ],
)
def test_a_step_of_what_is_not_held_or_not_there_ends_the_command_with_one_line(folder, capsys, old, new, says):
    (folder / "task.yaml").write_text(STEPS.replace(old, new))
    assert main(["run", "../task.yaml"]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert says in line


def test_a_file_that_is_not_there_is_named(folder, capsys):
    with pytest.raises(BrokenFile, match="cannot read the task"):
        load_task("nothing.yaml")
    (folder / "task.yaml").write_text(STEPS.replace("robot: ur5", ""))
    assert main(["run", "../task.yaml"]) == 2
    assert "give --robot" in capsys.readouterr().err
