"""A task is done step by step: each motion is free in the world as it is then; a failure says which step, and why."""

import itertools
import math
import re
from dataclasses import replace

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import EvenroadError
from evenroad.robot import HeldObject
from evenroad.task import Attach, Detach, MoveTo, Task, Wait
from evenroad.task.stage import touches
from evenroad.trajectory.urscript import movej_script
from tests.robots import oracle
from tests.robots.shape_oracle import shape_clearance

HOME = [0.0, -2.0, 1.9, -1.5, -math.pi / 2, 0.0]
CAN = er.Box((0.06, 0.06, 0.16), xyz=(0.70, 0.1, 0.29), name="can")
SHELF = [
    er.Box((0.5, 0.6, 0.04), xyz=(0.0, -0.62, 0.02), name="table"),
    er.Box((0.32, 0.7, 0.02), xyz=(0.76, 0.1, 0.20), name="board"),
    er.Box((0.32, 0.7, 0.02), xyz=(0.76, 0.1, 0.62), name="upper board"),
    er.Box((0.32, 0.02, 0.62), xyz=(0.76, -0.26, 0.31), name="side"),
    er.Box((0.02, 0.7, 0.62), xyz=(0.93, 0.1, 0.31), name="back"),
]
PLACE = er.PoseGoal(er.Pose((0.0, -0.6, 0.121)), tip="can", free_axis="z")


def grasp(angle):
    """A flange at the can's side, from a direction in the plane."""
    away = 0.033
    xyz = (0.70 - away * math.cos(angle), 0.1 - away * math.sin(angle), 0.30)
    return er.PoseGoal(er.Pose(xyz, rpy=(0.0, math.pi / 2, angle)), free_axis="z")


def pick_and_place(grasps):
    """Take the can out of the shelf, put it onto the table, and go home."""
    return Task(
        [
            MoveTo(grasps, approach=0.12),
            Attach("can"),
            MoveTo(PLACE, retreat=0.05, approach=0.05, away="up"),
            Detach("can", onto="table"),
            Wait(0.4),
            MoveTo(HOME, retreat=0.1),
        ]
    )


@pytest.fixture(scope="module")
def world():
    """A UR5 before the shelf."""
    return er.ArmWorld("ur5", er.Scene([*SHELF, CAN]))


@pytest.fixture(scope="module")
def done(world):
    """The task's plan."""
    return pick_and_place([grasp(angle) for angle in np.linspace(-1.2, 1.2, 8)]).plan(world, HOME)


def along(path):
    """States along a path."""
    return np.linspace(path[:-1], path[1:], 10, axis=1).reshape(-1, path.shape[1])


def apart(robot, bodies, path, allowed=frozenset()):
    """By how much the oracle keeps bodies apart along a path."""
    return oracle.clearance(robot, er.Scene(bodies, allowed=allowed), along(path)).min()


def test_every_part_is_free_in_the_world_as_it_is_then(world, done):
    assert done.solved
    into, out, back = done.motions
    robot = world.robot
    (middle, line), (lift, carry, lower), (leave, home) = into.parts, out.parts, back.parts
    assert apart(robot, [*SHELF, CAN], middle.path) > 0.0
    gripper = frozenset((link, "can") for link in ("tool0", "wrist_3_link"))
    assert apart(robot, [*SHELF, CAN], line.path, gripper) > 0.0
    # While it is held the can moves with the flange, and touches nothing but what it stood on, or shall stand on.
    turn, origin = (each[0] for each in oracle.link_poses(robot, line.path[-1:])["tool0"])
    held = er.Box(CAN.size, pose=er.Pose(origin, tuple(turn.ravel())).inverse() @ CAN.pose)
    holding = robot.holding(HeldObject("can", held, "tool0", ("tool0", "wrist_3_link")))
    can = er.Box(CAN.size, link="can")
    for path, spared in ((lift.path, "board"), (carry.path, ""), (lower.path, "table")):
        assert apart(robot, SHELF, path) > 0.0
        others = er.Scene([each for each in SHELF if each.name != spared])
        assert shape_clearance(holding, [can], others, along(path)).min() > 0.0
    turn, origin = (each[0] for each in oracle.link_poses(holding, lower.path[-1:])["can"])
    np.testing.assert_allclose([*origin, turn[2, 2]], [0.0, -0.6, 0.121, 1.0], atol=1e-4)
    placed = er.Box(CAN.size, pose=er.Pose(origin, tuple(turn.ravel())), name="can")
    assert apart(robot, [*SHELF, placed], leave.path, gripper) > 0.0
    assert apart(robot, [*SHELF, placed], home.path) > 0.0


def test_parts_follow_each_other_and_a_grasp_with_which_the_rest_fails_is_not_taken(done):
    path = [part.path for part in done.parts]
    assert all(np.array_equal(before[-1], after[0]) for before, after in itertools.pairwise(path))
    assert done.tried > len(done.motions), "no grasp had to be given up: this tests nothing"


def test_one_trajectory_stands_still_where_the_gripper_acts(done):
    trajectory = done.trajectory(speed=0.5)
    assert np.abs(np.diff(trajectory.positions, axis=0)).max() < 0.05
    still = np.abs(trajectory.velocities).max(axis=1) < 1e-9
    for motion in done.motions:
        assert np.abs(trajectory.positions[still] - motion.end).max(axis=1).min() < 1e-9
    waiting = still & (np.abs(trajectory.positions - done.motions[1].end).max(axis=1) < 1e-9)
    assert 0.4 <= waiting.sum() * (trajectory.times[1] - trajectory.times[0]) <= 0.45


def test_a_step_that_cannot_be_done_is_named_with_its_reason(world):
    result = Task([MoveTo(HOME), Wait(1.0), MoveTo([0.0, -0.15, 0.0, 0.0, 0.0, 0.0])]).plan(world, HOME)
    assert (result.status, result.step, result.path, result.cost) == (er.Status.GOAL_INVALID, 2, None, None)
    assert result.message.startswith("step 2 of the task cannot be done: ")
    assert "touches" in result.message
    with pytest.raises(EvenroadError, match="there is no trajectory: step 2"):
        result.trajectory()


def test_an_unknown_keyword_is_refused_with_the_known_ones(world):
    with pytest.raises(EvenroadError, match=r"'secs'.*seconds"):
        Task([MoveTo(HOME)]).plan(world, HOME, secs=3)


def test_what_is_lifted_from_a_table_may_not_end_inside_it():
    """What it stood on it may touch while it is lifted, not where it is put."""
    table = er.Box((0.5, 0.9, 0.04), xyz=(0.6, 0.0, 0.02), name="table")
    can = er.Box((0.06, 0.06, 0.16), xyz=(0.6, 0.2, 0.121), name="can")
    above = er.PoseGoal(er.Pose((0.6, 0.2, 0.205), rpy=(math.pi, 0.0, 0.0)), free_axis="z")
    inside = er.PoseGoal(er.Pose((0.6, -0.2, 0.07)), tip="can", free_axis="z")
    steps = [MoveTo(above, approach=0.1), Attach("can"), MoveTo(inside, retreat=0.1, approach=0.1, away="up")]
    result = Task(steps).plan(er.ArmWorld("ur5", er.Scene([table, can])), HOME)
    assert (result.status, result.step) == (er.Status.GOAL_INVALID, 2)
    assert "'can' touches 'table'" in result.message


TABLE = er.Box((0.5, 0.9, 0.04), xyz=(0.6, 0.0, 0.02), name="table")
STANDING = er.Box((0.06, 0.06, 0.16), xyz=(0.6, 0.2, 0.121), name="can")


@pytest.mark.parametrize("bodies", [None, "capsules"])
@pytest.mark.parametrize(
    ("depth", "height", "solved"), [(0.005, 0.118, True), (0.005, 0.06, False), (0.07, 0.06, True)]
)
def test_what_is_put_onto_a_table_may_be_in_it_by_the_stated_depth_alone(bodies, depth, height, solved):
    above = er.PoseGoal(er.Pose((0.6, 0.2, 0.205), rpy=(math.pi, 0.0, 0.0)), free_axis="z")
    place = er.PoseGoal(er.Pose((0.6, -0.2, height)), tip="can", free_axis="z")
    steps = [
        MoveTo(above, approach=0.1),
        Attach("can", depth=depth),
        MoveTo(place, retreat=0.1, approach=0.1, away="up"),
        Detach("can", onto="table"),
    ]
    world = er.ArmWorld(er.load_robot("ur5", bodies=bodies), er.Scene([TABLE, STANDING]))
    result = Task(steps).plan(world, HOME)
    assert result.solved == solved
    if not solved:
        assert (result.status, result.step) == (er.Status.GOAL_INVALID, 2)
        assert "'can less 5 mm' touches 'table'" in result.message


@pytest.mark.parametrize(("depth", "solved"), [(0.005, False), (0.02, True)])
def test_an_edge_of_what_a_robot_of_capsules_holds_may_be_no_deeper_in_a_table_than_stated(depth, solved):
    tilt = 0.5
    edge = 0.08 * math.cos(tilt) + 0.03 * math.sin(tilt)
    above = er.PoseGoal(er.Pose((0.6, 0.2, 0.205), rpy=(math.pi, 0.0, 0.0)), free_axis="z")
    # The edge is 11 mm deep, where a capsule inside of the can is 5 mm above the table.
    place = er.PoseGoal(er.Pose((0.6, -0.2, 0.04 + edge - 0.011), rpy=(tilt, 0.0, 0.0)), tip="can")
    steps = [
        MoveTo(above, approach=0.1),
        Attach("can", depth=depth),
        MoveTo(place, retreat=0.1, approach=0.1, away="up"),
        Detach("can", onto="table"),
    ]
    world = er.ArmWorld(er.load_robot("ur5", bodies="capsules"), er.Scene([TABLE, STANDING]))
    result = Task(steps).plan(world, HOME)
    assert result.solved == solved
    if not solved:
        assert (result.status, result.step) == (er.Status.GOAL_INVALID, 2)
        assert "'can less 5 mm' touches 'table'" in result.message


def test_what_is_lifted_is_not_pushed_through_what_it_stands_on():
    above = er.PoseGoal(er.Pose((0.6, 0.2, 0.205), rpy=(math.pi, 0.0, 0.0)), free_axis="z")
    steps = [MoveTo(above, approach=0.1), Attach("can"), MoveTo(HOME, retreat=0.1, away="up")]
    world = er.ArmWorld("ur5", er.Scene([TABLE, STANDING]))
    assert Task(steps).plan(world, HOME).solved
    down = [*steps[:2], MoveTo(HOME, retreat=0.03, away="z")]
    result = Task(down).plan(world, HOME)
    assert (result.step, result.solved) == (2, False)
    assert "'can' touches 'table'" in result.message


def test_what_is_out_of_reach_is_not_taken(world):
    with pytest.raises(
        EvenroadError, match=r"step 0 of the task attaches 'can', which is 0\.3\d* m from 'tool0' there"
    ):
        Task([Attach("can"), MoveTo(HOME)]).plan(world, HOME)


def test_what_is_taken_and_let_go_at_once_stays_where_it_is_and_keeps_its_clearance(world):
    world = replace(world, scene=world.scene.with_clearance({"can": 0.01}))
    result = Task([Attach("can", reach=1.0), Detach("can"), MoveTo([0.1, *HOME[1:]])]).plan(world, HOME)
    (part,) = result.parts
    assert (part.world.scene.obstacles[-1].name, part.world.scene.obstacles[-1].clearance) == ("can", 0.01)
    np.testing.assert_allclose(part.world.scene.obstacles[-1].xyz, CAN.pose.xyz, atol=1e-12)


def test_a_task_of_many_motions_is_done(world):
    """No limit of what is tried in vain holds for what has to be done."""
    assert Task([MoveTo(HOME), Wait(0.1)] * 100).plan(world, HOME).solved
    assert Task([*[Wait(0.1)] * 2000, MoveTo(HOME)]).plan(world, HOME).solved


def test_a_continuous_joint_goes_on_where_the_motion_before_ended(tmp_path):
    """Not a whole turn away, in one step."""
    links = "".join(
        f'<link name="l{i}"><collision><origin xyz="0.2 0 0"/><geometry><box size="0.3 0.03 0.03"/></geometry>'
        "</collision></link>"
        for i in range(3)
    )
    joints = "".join(
        f'<joint name="j{i}" type="continuous"><parent link="l{i}"/><child link="l{i + 1}"/>'
        '<origin xyz="0.4 0 0.05"/><axis xyz="0 0 1"/><limit velocity="1" effort="1"/></joint>'
        for i in range(2)
    )
    file = tmp_path / "turning.urdf"
    file.write_text(f'<robot name="turning">{links}{joints}</robot>')
    task = Task([MoveTo([-3.0, 0.5]), MoveTo([-2.0, 0.5])])
    trajectory = task.plan(er.ArmWorld(er.load_robot(file), er.Scene([])), [3.0, 0.0]).trajectory()
    assert np.abs(np.diff(trajectory.positions, axis=0)).max() < 0.02
    np.testing.assert_allclose(trajectory.positions[-1], [2.0 * math.pi - 2.0, 0.5], atol=1e-6)
    np.testing.assert_allclose(trajectory.waypoints[-1], trajectory.positions[-1], atol=1e-6)


def test_a_trajectory_has_names_and_limits_of_the_arm_and_keeps_the_constraints_of_a_step(world):
    upright = er.constraints.KeepUpright(0.2)
    result = Task([MoveTo([0.6, *HOME[1:]], constraints=upright), MoveTo(HOME)]).plan(world, HOME)
    (motion, _), trajectory = result.motions, result.trajectory(speed=0.5)
    assert motion.constraints == er.constraints.KeepUpright(0.2, tip="tool0")
    assert trajectory.names == world.robot.group
    assert trajectory.limits.along_path is None


def test_the_arm_waits_no_shorter_than_it_is_told(world):
    trajectory = Task([MoveTo([0.1, *HOME[1:]]), Wait(0.003)]).plan(world, HOME).trajectory()
    assert np.array_equal(trajectory.positions[-1], trajectory.positions[-2])


def test_a_program_of_waypoints_waits_where_the_task_does(world):
    there = [0.1, *HOME[1:]]
    trajectory = Task([Wait(0.2), MoveTo(there), Wait(0.4), MoveTo(HOME), Wait(1.0)]).plan(world, HOME).trajectory()
    calls = re.findall(r"^  (sleep|movej)\((.*)\)$", movej_script(trajectory), re.MULTILINE)
    assert [name for name, _ in calls] == ["sleep", "movej", "sleep", "movej", "sleep"]
    assert [float(value) for name, value in calls if name == "sleep"] == pytest.approx([0.2, 0.4, 1.0])


def test_a_wait_that_no_trajectory_holds_is_refused(world):
    result = Task([MoveTo([0.1, *HOME[1:]]), Wait(1e9)]).plan(world, HOME)
    with pytest.raises(EvenroadError, match="would stand still for 1e\\+09 s"):
        result.trajectory()


@pytest.mark.parametrize(
    ("steps", "says"),
    [
        ([], "one motion or more"),
        ([Wait(1.0)], "one motion or more"),
        (
            ["home"],
            "step 0 of a task must be a motion, such as MoveTo, Attach, Detach, Open, Close or Wait, got 'home'",
        ),
        ([Attach("cup"), MoveTo(HOME)], "unknown obstacle of step 0 of the task:? 'cup'"),
        ([MoveTo(HOME)] * 501, "one motion or more, up to 500, got 501"),
        ([Attach("can", "hand"), MoveTo(HOME)], "unknown link that takes 'can': 'hand'"),
        ([MoveTo(HOME), Attach("can", "hand")], "unknown link that takes 'can': 'hand'"),
        ([Detach("can"), MoveTo(HOME)], "step 0 of the task lets go of 'can', which it cannot"),
    ],
)
def test_steps_that_make_no_sense_are_refused_in_one_line(world, steps, says):
    with pytest.raises(EvenroadError, match=says) as caught:
        Task(steps).plan(world, HOME)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Wait(-1.0),
        lambda: MoveTo(HOME, approach=-0.1),
        lambda: MoveTo(HOME, constraints=er.CartesianLine(approach=0.1)),
        lambda: Attach(3),
        lambda: Detach(None),
        lambda: Detach("can", onto=3),
        lambda: Attach("can", touches=[3]),
        lambda: Attach("can", depth=-0.01),
        lambda: Attach("can", reach=math.nan),
    ],
)
def test_a_value_out_of_range_is_refused(make):
    with pytest.raises(EvenroadError):
        make()


def test_a_finger_that_mimics_a_planned_one_may_not_touch_what_is_held_unasked(tmp_path):
    """It moves against the hand, like the one that it follows."""
    shape = '<collision><geometry><box size="0.05 0.05 0.05"/></geometry></collision>'
    links = "".join(f'<link name="{name}">{shape}</link>' for name in ("base", "hand", "left", "right"))
    joints = "".join(
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="0.2 0 0"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="1"/>{more}</joint>'
        for name, parent, child, more in (
            ("turn", "base", "hand", ""),
            ("open", "hand", "left", ""),
            ("follow", "hand", "right", '<mimic joint="open" multiplier="-1"/>'),
        )
    )
    (tmp_path / "hand.urdf").write_text(f'<robot name="hand">{links}{joints}</robot>')
    robot = er.load_robot(tmp_path / "hand.urdf")
    assert touches(Attach("can", "hand"), robot) == ("hand",)
    assert touches(Attach("can", "hand"), er.load_robot(tmp_path / "hand.urdf", group=["turn"])) == (
        "hand",
        "left",
        "right",
    )
