"""Configurations for poses: they reach them, all branches are there, and where there are none the answer says why."""

import math
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue, UnknownName
from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.loading.load import load_robot
from evenroad.poses import inverse_kinematics
from evenroad.poses.chain import TURN, chain_of, default_tip
from evenroad.poses.closed_form import closed_form
from evenroad.poses.inverse_kinematics import MOST, reach, reach_quickly, task_of
from evenroad.poses.pose_goal import PoseGoal, as_axis, pose_of
from evenroad.robots.joint import Joint
from evenroad.robots.kinematics import link_poses
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Obstacle, Scene
from tests.refused import refused
from tests.robots.kernel_arms import random_tree

EMPTY = Scene(name="empty")
UR5, ARM7 = load_robot("ur5"), load_robot("arm7")


def tips(robot, q, tip):
    return link_poses(robot, q)[:, robot.links.index(tip)]


def random_free(world, count, seed=0):
    q = world.space.from_cube(np.random.default_rng(seed).random((4 * count, world.space.dim)))
    return q[world.valid(q)][:count]


def same_posture(rows, q):
    gap = rows - q
    return (np.abs(gap - TURN * np.round(gap / TURN)).max(axis=1) < 1e-6).any()


def off(robot, q, tip, pose):
    """Metres and radians between links and a pose, by the angle of the rotation between them."""
    at = tips(robot, np.atleast_2d(q), tip)
    turn = np.einsum("nij,kj->nik", at[:, :3, :3], pose[:3, :3])
    sine = np.linalg.norm(turn - turn.transpose(0, 2, 1), axis=(1, 2)) / math.sqrt(8.0)
    cosine = 0.5 * (np.trace(turn, axis1=1, axis2=2) - 1.0)
    return np.linalg.norm(at[:, :3, 3] - pose[:3, 3], axis=1), np.arctan2(sine, cosine)


@pytest.mark.parametrize("robot", [UR5, ARM7], ids=lambda robot: robot.name)
def test_every_configuration_found_is_free_within_limits_and_reaches_the_pose(robot):
    world, tip = ArmWorld(robot, EMPTY), default_tip(robot)
    own = random_free(world, 60)
    for q, pose in zip(own, tips(robot, own, tip), strict=True):
        found = reach(world, PoseGoal(Pose.from_matrix(pose)), np.zeros(len(q))).configurations
        assert len(found)
        assert world.valid(found).all()
        near, turned = off(robot, found, tip, pose)
        assert max(near.max(), turned.max()) < 1e-6


def test_the_posture_that_made_a_pose_is_among_those_found_without_a_closed_form(monkeypatch):
    monkeypatch.setattr(inverse_kinematics, "closed_form", lambda chain: None)
    world = ArmWorld(UR5, EMPTY)
    own = random_free(world, 100, seed=3)
    hit = [
        same_posture(reach(world, PoseGoal(Pose.from_matrix(pose)), np.zeros(6)).configurations, q)
        for q, pose in zip(own, tips(UR5, own, "tool0"), strict=True)
    ]
    assert np.mean(hit) >= 0.99


@pytest.mark.parametrize("robot", [UR5, ARM7], ids=lambda robot: robot.name)
def test_many_goals_at_once_are_reached_as_each_alone_and_those_that_are_not_say_why(robot):
    world, tip = ArmWorld(robot, "box-reach" if robot is UR5 else EMPTY), default_tip(robot)
    made = tips(robot, random_free(world, 9, seed=5), tip)
    goals = [PoseGoal(Pose.from_matrix(pose), tip, free_axis=axis) for pose in made for axis in (None, "z")]
    goals += [PoseGoal(Pose((9.0, 0.0, 0.0)), tip), PoseGoal(Pose((0.0, 0.0, 0.05)), tip, position_only=True)]
    start = np.full(world.dim, 0.3)
    for goal, found in zip(goals, reach_quickly(world, goals, start), strict=True):
        alone = reach(world, goal, start, quickly=True)
        assert np.array_equal(found.configurations, alone.configurations)
        assert np.array_equal(found.nearest, alone.nearest)
        assert (found.branches, found.blocked, found.solver) == (alone.branches, alone.blocked, alone.solver)
        assert len(found.configurations) or found.why == alone.why


def test_a_closed_form_finds_the_posture_that_made_a_pose_every_time():
    pytest.importorskip("eaik")
    world = ArmWorld(UR5, EMPTY)
    own = random_free(world, 300, seed=4)
    for q, pose in zip(own, tips(UR5, own, "tool0"), strict=True):
        reached = reach(world, PoseGoal(Pose.from_matrix(pose)), np.zeros(6))
        assert reached.solver == "closed form"
        assert same_posture(reached.configurations, q)
        assert np.abs(tips(UR5, reached.configurations, "tool0") - pose).max() < 1e-9


class EaikOf:
    """What EAIK gives, without it: the postures themselves, turned once more, and one that is wrong."""

    def __init__(self, chain, postures):
        wrong = postures[:1] + 0.3
        rows = np.concatenate([postures + TURN, wrong])
        self.Q = rows[:, chain.coordinates] * chain.rows[:6, 12] + chain.rows[:6, 13]

    def has_known_decomposition(self):
        return True

    def calculate_IK(self, pose):
        return self


def test_what_a_closed_form_says_is_checked_and_brought_into_the_limits(monkeypatch):
    q = np.array([[0.3, -1.2, 1.4, -0.8, 0.9, 0.2]])
    world, chain = ArmWorld(UR5, EMPTY), chain_of(UR5, "tool0")
    eaik = SimpleNamespace(Robot=lambda *_: EaikOf(chain, q))
    monkeypatch.setitem(sys.modules, "eaik", SimpleNamespace())
    monkeypatch.setitem(sys.modules, "eaik.pybindings", SimpleNamespace(EAIK=eaik))
    closed_form.cache_clear()
    reached = reach(world, PoseGoal(Pose.from_matrix(tips(UR5, q, "tool0")[0])), q[0])
    assert (reached.solver, reached.branches) == ("closed form", 1)
    closed_form.cache_clear()
    assert reached.configurations[0] == pytest.approx(q[0], abs=1e-9)


def test_whole_turns_are_added_within_the_limits_the_nearest_to_the_start_first():
    world, q = ArmWorld(UR5, EMPTY), np.array([0.3, -1.2, 1.4, -0.8, 0.9, 0.2])
    goal = PoseGoal(Pose.from_matrix(tips(UR5, q[None], "tool0")[0]))
    last = np.array([0.0, 0, 0, 0, 0, -TURN])
    start = q + last
    found = reach(world, goal, start).configurations
    assert len(found) == MOST
    assert (found >= world.space.low).all()
    assert (found <= world.space.high).all()
    assert len(np.unique(found.round(6), axis=0)) == len(found)
    far = np.linalg.norm(found - start, axis=1)
    assert (np.diff(far) >= -1e-12).all()
    assert found[0] == pytest.approx(q + last, abs=1e-6)
    assert same_posture(found[1:], found[0])


def test_a_tip_that_may_turn_about_an_axis_reaches_more_and_keeps_the_axis():
    world = ArmWorld(UR5, EMPTY)
    pose = Pose.from_rpy((0.4, 0.2, 0.3), (math.pi, 0.0, 0.0))
    found = reach(world, PoseGoal(pose, free_axis="z"), np.zeros(6)).configurations
    at = tips(UR5, found, "tool0")
    assert np.abs(at[:, :3, 3] - pose.xyz).max() < 1e-6
    assert np.abs(at[:, :3, 2] - [0.0, 0.0, -1.0]).max() < 1e-6
    assert np.ptp(at[:, 0, 0]) > 0.5


def test_with_the_position_alone_the_rotation_is_whatever_comes():
    world = ArmWorld(ARM7, EMPTY)
    found = reach(world, PoseGoal(Pose((0.5, 0.1, 0.4)), position_only=True), np.zeros(7)).configurations
    at = tips(ARM7, found, "flange")
    assert np.abs(at[:, :3, 3] - [0.5, 0.1, 0.4]).max() < 1e-6
    assert len(found) > 5


def test_tolerances_are_kept_and_used_where_the_pose_itself_is_out_of_reach():
    world = ArmWorld(UR5, EMPTY)
    point, _ = chain_of(UR5, "tool0").reach()
    beyond = Pose(tuple(point + np.array([0.955, 0.0, 0.0])))
    assert not len(reach(world, PoseGoal(beyond, position_only=True), np.zeros(6)).configurations)
    goal = PoseGoal(beyond, position_tolerance=0.05, angle_tolerance=2.5)
    found = reach(world, goal, np.zeros(6)).configurations
    assert len(found)
    near, turned = off(UR5, found, "tool0", beyond.matrix)
    assert near.max() <= 0.05 + 1e-9
    assert turned.max() <= 2.5 + 1e-9
    assert near.max() > 1e-3


def test_a_pose_in_the_frame_of_another_link_is_that_of_the_root():
    robot = replace(
        UR5,
        links=("stand", *UR5.links),
        joints=(
            Joint(
                "foot", "fixed", "stand", "base_link", (0.1, 0.2, 0.3), Pose.from_rpy((0, 0, 0), (0, 0, 1.0)).rotation
            ),
            *UR5.joints,
        ),
    )
    world, q = ArmWorld(robot, EMPTY), np.array([0.3, -1.2, 1.4, -0.8, 0.9, 0.2])
    pose = Pose.from_matrix(tips(UR5, q[None], "tool0")[0])
    found = reach(world, PoseGoal(pose, frame="base_link"), q).configurations
    assert same_posture(found, q)
    with pytest.raises(InvalidValue, match="the group moves the link 'forearm_link'"):
        reach(world, PoseGoal(pose, frame="forearm_link"), q)


def test_coordinates_that_do_not_move_the_tip_stay_as_they_are_at_the_start():
    world = ArmWorld(UR5, EMPTY)
    start = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    pose = Pose.from_matrix(tips(UR5, np.array([[0.3, -1.2, 1.4, 0, 0, 0]]), "forearm_link")[0])
    found = reach(world, PoseGoal(pose, "forearm_link"), start).configurations
    assert len(found)
    assert (found[0, 3:] == start[3:]).all()


def test_joints_that_slide_and_follow_others_are_solved_too():
    solved = 0
    for seed in range(12):
        robot = random_tree(seed)
        world = ArmWorld(replace(robot, pairs=()), EMPTY)
        tip = robot.links[-1]
        try:
            chain = chain_of(world.robot, tip)
        except InvalidValue:
            continue
        q = world.space.from_cube(np.random.default_rng(seed).random((1, world.space.dim)))
        pose = tips(robot, q, tip)[0]
        found = reach(world, PoseGoal(Pose.from_matrix(pose), tip), np.zeros(world.space.dim)).configurations
        assert np.abs(chain.tip_poses(q)[0, 9:] - pose[:3, 3]).max() < 1e-12
        if len(found):
            solved += 1
            near, turned = off(robot, found, tip, pose)
            assert max(near.max(), turned.max()) < 1e-6
    assert solved >= 8


def test_out_of_reach_is_proved_and_said():
    reached = reach(ArmWorld(UR5, EMPTY), PoseGoal(Pose((2.0, 0.0, 0.0))), np.zeros(6))
    assert not len(reached.configurations)
    assert "out of reach: 2.002 m" in reached.why
    q = ArmWorld(UR5, EMPTY).space.from_cube(np.random.default_rng(0).random((5000, 6)))
    point, far = chain_of(UR5, "tool0").reach()
    assert np.linalg.norm(tips(UR5, q, "tool0")[:, :3, 3] - point, axis=1).max() <= far


def test_a_joint_that_would_have_to_leave_its_limits_is_named():
    narrow = replace(
        UR5,
        joints=tuple(
            replace(joint, lower=-0.5, upper=0.5) if joint.name == "elbow_joint" else joint for joint in UR5.joints
        ),
    )
    pose = Pose.from_matrix(tips(UR5, np.array([[0.3, -1.2, 1.9, -0.8, 0.9, 0.2]]), "tool0")[0])
    why = reach(ArmWorld(narrow, EMPTY), PoseGoal(pose), np.zeros(6)).why
    assert "beyond the limits" in why
    assert "outside [-0.5, 0.5]" in why


def test_what_is_in_the_way_of_all_postures_is_named():
    q = np.array([0.3, -1.2, 1.4, -0.8, 0.9, 0.2])
    at = tips(UR5, q[None], "tool0")[0]
    scene = EMPTY.with_(Obstacle.of("ball", "sphere", (0.15,), tuple(at[:3, 3])))
    reached = reach(ArmWorld(UR5, scene), PoseGoal(Pose.from_matrix(at)), q)
    assert reached.in_collision
    assert reached.blocked == reached.branches > 0
    assert "'wrist_3_link' touches 'ball'" in reached.why


def test_what_is_found_does_not_depend_on_what_was_asked_before():
    world = ArmWorld(ARM7, EMPTY)
    goals = [PoseGoal(Pose((0.5, 0.1 * i, 0.4)), position_only=True) for i in range(4)]
    first = [reach(world, goal, np.zeros(7)).configurations.tolist() for goal in goals]
    again = [reach(world, goal, np.zeros(7)).configurations.tolist() for goal in goals[::-1]]
    assert first == again[::-1]


def test_misses_are_those_of_forward_kinematics():
    q, goal = np.array([0.3, -1.2, 1.4, -0.8, 0.9, 0.2]), PoseGoal(Pose((0.4, 0.1, 0.2)), "tool0")
    near, turned = off(UR5, q, "tool0", goal.pose.matrix)
    chain, task = task_of(UR5, goal)
    assert task.misses(chain.tip_poses(q[np.newaxis])[0]) == pytest.approx((near[0], turned[0]), abs=1e-12)


def test_a_tip_that_is_not_there_and_one_that_nothing_moves_are_refused():
    world = ArmWorld(UR5, EMPTY)
    with pytest.raises(UnknownName, match="unknown link of 'ur5': 'hand'; known: base_link"):
        reach(world, PoseGoal(IDENTITY, "hand"), np.zeros(6))
    refused(InvalidValue, "moves the link 'base_link'", reach, world, PoseGoal(IDENTITY, "base_link"), np.zeros(6))


def test_a_robot_with_two_ends_is_asked_which_it_is():
    two = replace(
        UR5,
        links=(*UR5.links, "camera"),
        joints=(*UR5.joints, Joint("mount", "fixed", "wrist_3_link", "camera", (0, 0, 0), IDENTITY.rotation)),
    )
    refused(InvalidValue, "--tip.*tool0, camera", default_tip, two)
    assert isinstance(two, Robot)


def test_poses_are_read_as_ros_writes_them():
    quaternion, turned = pose_of("1 2 3 0 0 0.70710678 0.70710678")
    assert turned
    assert np.abs(quaternion.matrix - Pose.from_rpy((1, 2, 3), (0, 0, math.pi / 2)).matrix).max() < 1e-8
    assert pose_of("1,2,3, 0 0 90", degrees=True)[0] == Pose.from_rpy((1, 2, 3), (0, 0, math.pi / 2))
    assert pose_of("1 2 3") == (Pose((1.0, 2.0, 3.0)), False)


@pytest.mark.parametrize(("text", "match"), [
    ("1 2 3 0 0 0 0", "norm 1, got 0"), ("1 2 3 0 0 0 1.1", "no rotation"), ("1 2", "3 or 6 or 7 finite numbers"),
    ("1 2 nan", "finite numbers, got '1 2 nan'"), ("a b c", "finite numbers, got 'a b c'"),
])  # fmt: skip
def test_a_text_that_is_no_pose_is_refused(text, match):
    refused(InvalidValue, match, pose_of, text)


def test_a_goal_that_is_none_is_refused():
    refused(InvalidValue, "must have a Pose", PoseGoal, (0, 0, 0))
    refused(InvalidValue, "free_axis must be a direction", PoseGoal, IDENTITY, free_axis=(0, 0, 0))
    refused(InvalidValue, "goes without it", PoseGoal, IDENTITY, free_axis="z", position_only=True)
    with pytest.raises(InvalidValue, match="position_tolerance must be a finite number >= 0"):
        PoseGoal(IDENTITY, position_tolerance=math.nan)
    assert as_axis("axis", "-y") == (0.0, -1.0, 0.0)
