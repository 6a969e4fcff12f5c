"""Straight lines, polylines, splines and arcs of the tip as steps of a task."""

import math

import numpy as np
import pytest

import evenroad as er
from evenroad.cli import main
from evenroad.errors import EvenroadError
from evenroad.task import Attach, Detach, MoveAlong, MoveCircular, MoveLinear, MoveTo, Task, load_task
from evenroad.trajectory import load_trajectory
from tests.robots import oracle

HOME = [0.0, -2.0, 1.9, -1.5, -math.pi / 2, 0.0]
TURNED = {"rpy": (math.pi / 2, 0.0, math.pi / 2)}


def at(x, y, z):
    """The flange forward."""
    return er.Pose((x, y, z), **TURNED)


BEGIN = MoveTo(er.PoseGoal(at(0.32, 0.1, 0.45)))


@pytest.fixture(scope="module")
def world():
    return er.ArmWorld("ur5", er.Scene([er.Box((0.3, 0.3, 0.02), xyz=(0.5, 0.0, 0.0), name="plate")]))


def tips(robot, q):
    """Rotations and origins of the flange by the oracle."""
    return oracle.link_poses(robot, np.asarray(q))["tool0"]


def off_line(points, a, b):
    along = np.subtract(b, a) / np.linalg.norm(np.subtract(b, a))
    gap = points - np.asarray(a)
    return np.linalg.norm(gap - np.outer(gap @ along, along), axis=1)


def test_the_tip_follows_lines_circles_and_splines_and_reaches_every_pose(world):
    line, corner, end = at(0.32, 0.3, 0.45), at(0.32, 0.3, 0.3), at(0.4, 0.1, 0.3)
    smooth = [at(0.4, 0.0, 0.35), at(0.35, -0.1, 0.45), at(0.4, -0.2, 0.4)]
    via, to = at(0.42, -0.2, 0.5), at(0.4, -0.2, 0.6)
    steps = [BEGIN, MoveLinear(line), MoveAlong([corner, end]), MoveAlong(smooth, spline=True), MoveCircular(via, to)]
    done = Task(steps).plan(world, HOME)
    assert done.solved
    _, straight, polyline, spline, arc = done.motions
    assert [len(motion.parts) for motion in done.motions] == [1, 1, 2, 1, 1]
    for motion, poses in ((straight, [line]), (polyline, [corner, end]), (spline, smooth), (arc, [via, to])):
        waypoints = np.concatenate([part.path for part in motion.parts])
        turns, origins = tips(world.robot, waypoints)
        for pose in poses:
            row = np.linalg.norm(origins - pose.xyz, axis=1).argmin()
            np.testing.assert_allclose(origins[row], pose.xyz, atol=1e-9)
            np.testing.assert_allclose(turns[row], pose.rotation_matrix, atol=1e-9)
        assert all(world.validate(part.path).all() for part in motion.parts)
    # As it is driven, corners of the path rounded: 0.1 mm from the lines, and from the circle.
    points = [tips(world.robot, part.trajectory(deviation=5e-5).positions)[1] for part in polyline.parts]
    assert off_line(points[0], line.xyz, corner.xyz).max() < 1e-4
    assert off_line(points[1], corner.xyz, end.xyz).max() < 1e-4
    round_ = tips(world.robot, arc.parts[0].trajectory(deviation=5e-5).positions)[1]
    centre, radius = np.array([0.4 - 0.04, -0.2, 0.5]), 0.0
    start = np.array(smooth[-1].xyz)
    a, b = np.subtract(via.xyz, start), np.subtract(to.xyz, start)
    normal = np.cross(a, b)
    centre = start + (a @ a * np.cross(b, normal) + b @ b * np.cross(normal, a)) / (2.0 * normal @ normal)
    radius = np.linalg.norm(start - centre)
    assert np.abs(np.linalg.norm(round_ - centre, axis=1) - radius).max() < 1e-4


def test_with_a_blend_the_arm_goes_on_and_passes_the_corner_as_near_as_told(world):
    corner, end = at(0.32, 0.3, 0.45), at(0.32, 0.3, 0.3)
    done = Task([BEGIN, MoveAlong([corner, end], blend=0.03)]).plan(world, HOME)
    (part,) = done.motions[1].parts
    trajectory = done.trajectory()
    moving = np.abs(trajectory.velocities).max(axis=1) > 1e-9
    points = tips(world.robot, trajectory.positions)[1]
    near = np.linalg.norm(points - corner.xyz, axis=1)
    assert moving[near.argmin()]
    assert 0.001 < near.min() < 0.03
    away = tips(world.robot, part.path)[1]
    beyond = np.linalg.norm(away - corner.xyz, axis=1) > 0.03 + 1e-9
    off = np.minimum(off_line(away, at(0.32, 0.1, 0.45).xyz, corner.xyz), off_line(away, corner.xyz, end.xyz))
    assert off[beyond].max() < 1e-9


def test_the_tip_is_no_faster_than_its_step_says_and_as_fast_where_the_joints_allow(world):
    done = Task([BEGIN, MoveLinear(at(0.32, 0.35, 0.45), speed=0.05), MoveLinear(at(0.32, 0.1, 0.45))]).plan(
        world, HOME
    )
    trajectory = done.trajectory(limits=None)
    points = tips(world.robot, trajectory.positions)[1]
    fast = np.linalg.norm(np.diff(points, axis=0), axis=1) / np.diff(trajectory.times)
    slow = np.flatnonzero(np.abs(points[:-1, 0] - 0.32) + np.abs(points[:-1, 2] - 0.45) < 2e-4)
    first = slow[0] + np.flatnonzero(np.abs(points[slow[0] :, 1] - 0.35) < 1e-6)[0]
    assert fast[slow[0] : first].max() <= 0.05 * (1.0 + 1e-6)
    assert np.median(fast[slow[0] : first]) > 0.0498
    assert fast[first + 5 :].max() > 0.2


def test_a_start_is_chosen_from_which_the_whole_curve_can_be_followed(world):
    """Of the postures that reach the first pose the nearest one comes to a limit."""
    far = [er.Pose((0.45, -0.35, z), rpy=(0.0, math.pi, 0.0)) for z in (0.55, 0.25)]
    done = Task([MoveTo(er.PoseGoal(far[0])), MoveLinear(far[1])]).plan(world, HOME)
    assert done.solved
    np.testing.assert_allclose(tips(world.robot, done.path[-1:])[1][0], far[1].xyz, atol=1e-9)


def test_a_curve_that_cannot_be_followed_says_which_share_can_and_what_stops_it(world):
    down = Task([MoveTo(HOME), MoveLinear(er.Pose((0.45, 0.1, -0.2), rpy=(math.pi, 0, 0)))])
    result = down.plan(world, HOME)
    assert (result.solved, result.step) == (False, 1)
    assert "of the curve can be followed: then 'wrist_3_link' touches 'plate'" in result.message
    result = Task([MoveLinear(at(2.0, 0.0, 0.4))]).plan(world, HOME)
    assert "no joint angles go on: the posture has the condition number" in result.message


def test_a_task_that_cannot_be_done_ends_soon(world):
    """However many choices there are before the step that fails."""
    grasps = [
        er.PoseGoal(er.Pose((0.4, y, 0.4), rpy=(math.pi, 0, 0)), free_axis="z") for y in np.linspace(-0.3, 0.3, 24)
    ]
    result = Task([MoveTo(grasps)] * 3 + [MoveLinear(at(2.0, 0.0, 0.4)), MoveTo(HOME)]).plan(world, HOME, seconds=0.5)
    assert not result.solved
    assert result.timings["task"] < 2.0


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: MoveLinear("home"), "a pose of MoveLinear must be a Pose or PoseGoal, got 'home'"),
        (lambda: MoveLinear(er.PoseGoal(at(0, 0, 0), free_axis="z")), "must be whole"),
        (lambda: MoveLinear(at(0, 0, 0), speed=0.0), "speed must be"),
        (lambda: MoveAlong([]), "poses of MoveAlong must be one pose or more"),
        (lambda: MoveAlong([at(0, 0, 0)], blend=-1), "blend must be"),
        (lambda: MoveAlong([at(0, 0, 0)], blend=0.1, spline=True), "blend goes without it"),
        (lambda: MoveCircular(er.PoseGoal(at(0, 0, 0), tip="a"), er.PoseGoal(at(0, 0, 1), tip="b")), "one tip"),
    ],
)
def test_a_step_that_makes_no_sense_is_refused_in_one_line(make, says):
    with pytest.raises(EvenroadError, match=says) as caught:
        make()
    assert "\n" not in str(caught.value)


FILE = """
robot: ur5
scene: {obstacles: {plate: {shape: box, size: [0.3, 0.3, 0.02], xyz: [0.5, 0, 0]}}}
start: "0 -2 1.9 -1.5 -1.5708 0"
steps:
  - move_to: {poses: ["0.32 0.1 0.45 1.5708 0 1.5708"]}
  - move_linear: "0.32 0.3 0.45 1.5708 0 1.5708"
  - move_along: {poses: ["0.32 0.3 0.3 1.5708 0 1.5708", "0.4 0.1 0.3 1.5708 0 1.5708"], blend: 0.02, speed: 0.2}
  - move_circular: {via: "0.4 0 0.35 1.5708 0 1.5708", to: "0.4 0 0.45 1.5708 0 1.5708", tip: tool0}
"""


@pytest.fixture
def file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "task.yaml").write_text(FILE)
    return tmp_path / "task.yaml"


def test_the_command_follows_the_curves_of_a_file(file, capsys):
    said = load_task(file)
    assert said.task.steps[2].blend == 0.02
    assert said.task.steps[3].to.tip == "tool0"
    assert main(["run", "task.yaml", "-o", "out.json"]) == 0
    assert "solved: 4 motions" in capsys.readouterr().out
    end = tips(er.load_robot("ur5"), load_trajectory("out.json").positions[-1:])[1][0]
    np.testing.assert_allclose(end, [0.4, 0.0, 0.45], atol=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("blend: 0.02", "blend: wide", "step 2 in task.yaml: blend must be"),
        ("via: ", "by: ", "'by'|'via'"),
        ('via: "0.4 0 0.35 1.5708', 'via: "0.4 0.05 0.375 1.5708', "step 3 of the task: a circle needs three points"),
        ('move_linear: "0.32 0.3 0.45 1.5708 0 1.5708"', 'move_linear: "0.3 0.3 0.4"', "needs a rotation"),
    ],
)
def test_a_file_of_curves_that_makes_no_sense_is_refused_by_the_command(file, capsys, old, new, says):
    text = FILE.replace(old, new)
    file.write_text(text.replace("0.4 0 0.45 1.5708", "0.4 0 0.45 1.5708"))
    assert main(["run", "task.yaml"]) == 2
    error = " ".join(capsys.readouterr().err.split())
    assert any(part.strip("'") in error for part in says.split("|")), error


HAND = "".join(
    f'<link name="{name}"><collision><origin xyz="{xyz}"/><geometry><box size="{size}"/></geometry></collision></link>'
    for name, xyz, size in [
        ("base", "0 0 -2", "0.1 0.1 0.1"), ("bx", "0 0 3", "0.01 0.01 0.01"), ("by", "0 0 3.1", "0.01 0.01 0.01"),
        ("hand", "0 0 0", "0.2 0.04 0.04"), ("left", "0.09 0 -0.06", "0.02 0.04 0.08"),
        ("right", "-0.09 0 -0.06", "0.02 0.04 0.08"),
    ]
)  # fmt: skip
SLIDES = "".join(
    f'<joint name="{name}" type="prismatic"><parent link="{parent}"/><child link="{child}"/><axis xyz="{axis}"/>'
    '<limit lower="-1" upper="1" velocity="1" effort="1"/></joint>'
    for name, parent, child, axis in [
        ("x", "base", "bx", "1 0 0"), ("y", "bx", "by", "0 1 0"), ("z", "by", "hand", "0 0 1"),
    ]
)  # fmt: skip
FINGERS = "".join(
    f'<joint name="to_{name}" type="fixed"><parent link="hand"/><child link="{name}"/></joint>'
    for name in ("left", "right")
)


@pytest.mark.parametrize(("width", "solved"), [(0.158, True), (0.164, True), (0.18, False)])
def test_fingers_may_touch_what_they_take_but_not_go_into_it(tmp_path, width, solved):
    """The fingers are 160 mm apart: 2 mm into each side of what is 164 mm wide, 10 mm at 180."""
    (tmp_path / "gantry.urdf").write_text(f'<robot name="gantry">{HAND}{SLIDES}{FINGERS}</robot>')
    robot = er.load_robot(tmp_path / "gantry.urdf")
    assert robot.shapes
    block = er.Box((width, 0.03, 0.05), xyz=(0.3, 0.0, -0.3), name="block")
    world = er.ArmWorld(robot, er.Scene([block]))
    grasp, home = [0.3, 0.0, -0.24], [0.0, 0.0, 0.0]
    steps = [
        MoveTo(er.PoseGoal(er.Pose((0.3, 0.0, -0.24)), tip="hand"), approach=0.1, away="z"),
        Attach("block", "hand"),
        MoveTo(home, retreat=0.1, away="z"),
        Detach("block"),
        MoveTo([0.1, 0.0, 0.1], retreat=0.1, away="z"),
    ]
    result = Task(steps).plan(world, home, tip="hand")
    assert result.solved == solved, result.message
    if solved:
        return
    assert result.step == 0
    assert "touches 'block less 5 mm'" in result.message
    with pytest.raises(EvenroadError, match="step 0 of the task attaches 'block' where '.*' touches 'block less 5 mm'"):
        Task(steps[1:]).plan(er.ArmWorld(robot, er.Scene([block])), grasp, tip="hand")
    deep = [steps[0], Attach("block", "hand", depth=0.012), *steps[2:]]
    assert Task(deep).plan(world, home, tip="hand").solved
