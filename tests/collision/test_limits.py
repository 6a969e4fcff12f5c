"""Limits of joints: those of the robot, those of the scene, and values of five printed decimals."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

import evenroad as er
from evenroad.cli import main
from evenroad.planning import plan
from evenroad.robot import ArmWorld, Obstacle, Scene, configuration, in_scene
from evenroad.robots.variants import with_limits
from tests.plan_on import may_connect
from tests.robots.kernel_arms import ur5
from tests.robots.urdf_texts import joint, link, urdf, write

NARROW = Scene(name="cell 7", limits={"elbow_joint": (-1.0, 1.0)})
BENT = np.array([0.0, -1.5, 2.0, 0.0, 0.0, 0.0])
FREE = np.array([0.0, -1.5, 0.5, 0.0, 0.0, 0.0])
FAR = np.array([1.0, -1.5, -0.5, 0.0, 0.0, 0.0])
WRITTEN = 3.14159
"""Pi as URDFs write it: pi itself is 2.65e-6 beyond."""


def planners():
    def by_points(world, start, goal):
        return er.plan(world, start, goal, er.PRM(256))

    return [pytest.param(er.plan, id="trees"), pytest.param(by_points, id="points")]


def test_a_world_keeps_to_the_limits_of_its_scene():
    world = ArmWorld(ur5(), NARROW)
    assert (world.space.low[2], world.space.high[2]) == (-1.0, 1.0)
    assert world.valid(np.stack([FREE, BENT])).tolist() == [True, False]
    assert world.fingerprint() == ArmWorld(in_scene(ur5(), NARROW), NARROW).fingerprint()
    assert world.robot.fingerprint() == replace(world, resolution=0.1).robot.fingerprint()


def test_limits_that_narrow_nothing_leave_the_robot_and_those_of_no_joint_are_refused():
    robot = ur5()
    assert ArmWorld(robot, Scene(name="wide", limits={"elbow_joint": (-9.0, 9.0)})).robot is robot
    with pytest.raises(er.errors.UnknownName, match="limits of scene 'cell 7': 'knee'"):
        ArmWorld(ur5(), Scene(name="cell 7", limits={"knee": (0.0, 1.0)}))


@pytest.mark.parametrize("plan", planners())
def test_outside_the_limits_is_a_status_of_its_own_that_names_the_scene_which_narrows(plan):
    world = ArmWorld(ur5(), NARROW)
    result = plan(world, FREE, BENT)
    assert result.status == "goal_outside_limits"
    assert "'elbow_joint' is at 2, 1 outside the limits of scene 'cell 7' [-1, 1]" in result.message
    assert "collision" not in result.message
    assert plan(world, BENT, FREE).status == "start_outside_limits"
    own = plan(ArmWorld(ur5(), Scene(name="empty")), FREE, [4.0] * 6)
    assert own.status == "goal_outside_limits"
    assert "0.858 outside its limits" in own.message


def test_goals_are_outside_where_all_are_and_in_collision_where_one_is():
    ball = Obstacle.of("ball", "sphere", [0.4], FAR[:3])
    world = ArmWorld(ur5(), replace(NARROW, obstacles=(ball,)))
    start, hit = world.space.from_cube(np.random.default_rng(0).random((400, 6))), None
    free = world.valid(start)
    hit, start = start[~free][0], start[free][0]
    outside = plan(world, start, [BENT, BENT])
    assert (outside.status, "all 2 goals are outside the limits" in outside.message) == ("goal_outside_limits", True)
    mixed = plan(world, start, [hit, BENT])
    assert mixed.status == "goal_invalid"
    assert "all 2 goals are in collision or outside the limits" in mixed.message


def test_plan_arm_gives_the_status_and_texts_name_the_scene(tmp_path):
    result = er.plan(NARROW, FREE, BENT, robot=ur5())
    assert result.status == "goal_outside_limits"
    with pytest.raises(
        er.errors.InvalidValue, match=r"elbow_joint' at 2 rad, 1 rad outside the limits of scene 'cell 7'"
    ):
        er.plan(NARROW, FREE, "elbow_joint=2", robot=ur5())


def written():
    """The UR5 with an elbow that ends at pi as it is written, and a wrist that ends at a value of five decimals."""
    return with_limits(ur5(), {"elbow_joint": (-WRITTEN, WRITTEN), "wrist_3_joint": (-2.70526, 2.70526)})


TURNED = np.array([0.5, -1.2, math.pi, 0.4, 0.3, -2.705263])


def test_a_value_beyond_a_limit_by_less_than_five_decimals_is_within_it():
    world = ArmWorld(written(), Scene(name="empty"))
    world = replace(world, robot=replace(world.robot, pairs=()))
    for beyond, within in ((0.0, True), (2.65e-6, True), (0.99e-5, True), (1.01e-5, False), (1e-3, False)):
        q = FREE.copy()
        for sign in (-1.0, 1.0):
            q[2] = sign * (WRITTEN + beyond)
            assert world.valid(q[np.newaxis])[0] == within
            assert world.motion_valid(q[np.newaxis], FREE[np.newaxis])[0] == within
            assert world.validate(np.stack([FREE, q]))[0] == within
            assert world.space.contains(q[np.newaxis])[0] == within
            assert ("outside" in world.explain(q)) != within


@pytest.mark.parametrize("plan", planners())
def test_a_path_ends_where_it_was_asked_to_to_the_last_bit(plan):
    world = ArmWorld(replace(written(), pairs=()), Scene(name="empty"))
    for start, goal in ((FREE, TURNED), (TURNED, FREE), (TURNED, -TURNED)):
        result = plan(world, start, goal)
        assert result.solved, result.message
        assert (result.path[0].tolist(), result.path[-1].tolist()) == (start.tolist(), goal.tolist())
        assert world.validate(result.path).all()
        # Between its ends it keeps to what the robot's maker says.
        assert (np.abs(result.path[1:-1, 2]) <= WRITTEN).all()


def test_trees_around_obstacles_end_there_as_well():
    post = Obstacle.of("post", "box", (0.1, 0.1, 0.6), (0.5, 0.0, 0.4))
    world = ArmWorld(replace(written(), pairs=()), Scene((post,), name="post"))
    q = world.space.from_cube(np.random.default_rng(1).random((4000, 6)))
    q[::2, 2], q[1::2, 5] = WRITTEN + 9e-6, -2.70526 - 9e-6
    starts, goals = (part[world.valid(part)] for part in (q[::2], q[1::2]))
    n = min(len(starts), len(goals))
    rows = np.flatnonzero(~world.motion_valid(starts[:n], goals[:n]))[:4]
    assert len(rows) == 4
    for start, goal in zip(starts[rows], goals[rows], strict=True):
        result = plan(world, start, goal)
        assert result.solved, result.message
        assert (result.path[0].tolist(), result.path[-1].tolist()) == (start.tolist(), goal.tolist())
        assert world.validate(result.path).all()


def test_no_proof_of_absence_comes_from_an_end_that_exceeds_a_limit_by_rounding():
    world = ArmWorld(with_limits(ur5(), {"shoulder_pan_joint": (-WRITTEN, WRITTEN)}), Scene(name="empty"))
    rng = np.random.default_rng(3)
    for sign in (-1.0, 1.0):
        a, b = FREE.copy(), FREE.copy()
        a[0], b[0] = sign * (WRITTEN + 9e-6), rng.uniform(-1.0, 1.0)
        assert world.valid(np.stack([a, b])).all()
        assert may_connect(world, a, b)
        assert may_connect(world, b, a)


def test_states_texts_and_the_command_take_such_values_alike(tmp_path, monkeypatch):
    inside = f"<limit lower='-{WRITTEN}' upper='{WRITTEN}' velocity='1' effort='1'/>"
    text = urdf(
        link("x"), link("y"), link("z"), *(joint(*names, inside=inside, axis="0 0 1") for names in ("axy", "byz"))
    )
    state = "".join(f"<joint name='{name}' value='3.1415927'/>" for name in "ab")
    (tmp_path / "arm.srdf").write_text(
        f"<robot name='arm'><group name='arm'><joint name='a'/><joint name='b'/></group>"
        f"<group_state name='round' group='arm'>{state}</group_state></robot>"
    )
    path = write(tmp_path, text)
    robot = er.load_robot(path, srdf=tmp_path / "arm.srdf")
    scene = Scene(name="s", states={"there": {"a": -math.pi, "b": 0.0}})
    assert configuration(robot, "round").tolist() == [3.1415927, 3.1415927]
    assert configuration(robot, "there", scene).tolist() == [-math.pi, 0.0]
    assert configuration(robot, "180,0", degrees=True)[0] == math.pi
    result = er.plan(scene, "there", [math.pi, 3.1415927], robot=robot)
    assert result.solved
    assert result.path[[0, -1]].tolist() == [[-math.pi, 0.0], [math.pi, 3.1415927]]
    alone = er.load_robot(path, group="a")
    held = er.plan(replace(scene, states={"up": {"a": 0.0, "b": math.pi}}), "up", "1", robot=alone)
    assert held.solved
    monkeypatch.chdir(tmp_path)
    (tmp_path / "desk.yaml").write_text("obstacles: {}\n")
    line = ["plan", "desk.yaml", "--robot", str(path), "--start=0,0", "--goal", "3.141592654,-3.141592654"]
    assert main([*line, "--no-picture", "--out", "p"]) == 0
    assert json.loads((tmp_path / "p.json").read_text())["path"][-1] == [3.141592654, -3.141592654]


def test_an_endless_joint_that_a_scene_ends_at_pi_as_it_is_written_takes_pi():
    # As benchmarks have it of the Fetch: its endless joints within 3.14159, and goals at pi.
    robot = ur5()
    joints = tuple(
        replace(each, kind="continuous", lower=-math.inf, upper=math.inf) if "wrist" in each.name else each
        for each in robot.joints
    )
    scene = Scene(name="problem", limits={f"wrist_{k}_joint": (-WRITTEN, WRITTEN) for k in (1, 2, 3)})
    goal = np.array([0.5, -1.2, 0.5, math.pi, -math.pi, 3.1415927])
    result = er.plan(scene, FREE, goal, robot=replace(robot, joints=joints, pairs=()))
    assert result.solved, result.message
    assert result.path[-1].tolist() == goal.tolist()
