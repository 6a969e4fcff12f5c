"""Constraints along a whole path: their derivatives, their bounds between states, and plans that keep them."""

import math

import numpy as np
import pytest

import evenroad as er
from evenroad.constraints.constrained_world import kept_world
from evenroad.errors import EvenroadError
from evenroad.poses.inverse_kinematics import reach
from evenroad.robot import with_group
from tests.constraints.residuals import residuals
from tests.robots import oracle

ROBOTS = {"ur5": er.load_robot("ur5"), "arm7": er.load_robot("arm7")}
BENT = {"ur5": [0.3, -1.2, 1.4, -0.8, 0.9, 0.2], "arm7": [0.3, 0.6, 0.1, 1.2, 0.3, 0.7, -0.4]}
TIPS = {"ur5": "tool0", "arm7": "flange"}
FORWARD = (math.pi / 2, 0.0, math.pi / 2)

KEEPS = [
    er.constraints.KeepUpright(0.1),
    er.constraints.KeepOrientation(1e-3),
    er.constraints.KeepInPlane((0.0, 0.6, 0.8)),
    er.constraints.KeepOnLine("x"),
    er.constraints.KeepInBox((0.0, -0.5, 0.0), (0.4, 0.1, 0.5)),
    er.constraints.KeepOnCircle((0.9, 0.1, 0.0), (0.0, 0.6, 0.8)),
    "together",
    "joints",
]


def kept(name, keep):
    """A world that keeps a constraint from a bent start on."""
    robot = ROBOTS[name]
    if keep == "together":
        keep = er.constraints.KeepTogether(TIPS[name], robot.links[3])
    if keep == "joints":
        keep = er.constraints.KeepJoints({robot.group[1]: (-1.3, 0.7)})
    return kept_world(er.ArmWorld(robot), (keep,), np.array(BENT[name]), TIPS[name])


@pytest.mark.parametrize("keep", KEEPS, ids=lambda keep: keep if isinstance(keep, str) else type(keep).__name__)
@pytest.mark.parametrize("name", ["ur5", "arm7"])
class TestEachConstraint:
    def test_its_residual_is_as_defined_and_its_length_a_share_of_the_limit(self, name, keep):
        world, rng = kept(name, keep), np.random.default_rng(0)
        q = BENT[name] + rng.uniform(-0.5, 0.5, (30, len(BENT[name])))
        defined = residuals(ROBOTS[name], world.keeps[0], q)
        np.testing.assert_allclose(world.native.residuals(q), defined, atol=1e-12)
        shares = np.linalg.norm(defined, axis=1) / world.keeps[0].limit
        np.testing.assert_allclose(world.shares(q)[:, 0], shares, rtol=1e-9, atol=1e-9 / world.keeps[0].limit)

    def test_its_derivative_is_that_of_its_residual(self, name, keep):
        world, rng = kept(name, keep), np.random.default_rng(0)
        for q in BENT[name] + rng.uniform(-0.3, 0.3, (20, len(BENT[name]))):
            steps = 1e-6 * np.eye(len(q))
            ahead, behind = world.native.residuals(q + steps), world.native.residuals(q - steps)
            np.testing.assert_allclose(world.native.derivative(q), (ahead - behind).T / 2e-6, atol=1e-7)

    def test_configurations_are_projected_to_well_within_it(self, name, keep):
        world, rng = kept(name, keep), np.random.default_rng(1)
        q, kept_ = world.projected(BENT[name] + rng.uniform(-0.4, 0.4, (50, len(BENT[name]))))
        assert kept_.mean() > 0.9
        assert world.shares(q[kept_]).max() <= 0.5

    def test_no_state_between_two_is_farther_off_than_its_bound(self, name, keep):
        world, rng = kept(name, keep), np.random.default_rng(2)
        q, kept_ = world.projected(BENT[name] + rng.uniform(-0.4, 0.4, (40, len(BENT[name]))))
        nearest = np.inf
        for first in q[kept_]:
            for size in (0.003, 0.03):
                last = first + rng.uniform(-size, size, len(first))
                worst = world.shares(np.linspace(first, last, 101))[:, 0].max()
                bound = world.bounds(np.array([first, last]))[0, 0]
                assert worst <= bound + 1e-12
                nearest = min(nearest, bound - worst)
        assert nearest < 0.2, "the bound is far from the truth"


def origins(robot, path, tip):
    """Rotations and origins of a link by the oracle, at ten states of each motion."""
    return oracle.link_poses(robot, np.linspace(path[:-1], path[1:], 10).reshape(-1, path.shape[1]))[tip]


def test_a_flange_stays_on_its_line_and_in_its_orientation():
    world = er.ArmWorld("ur5")
    start = reach(world, er.PoseGoal(er.Pose((0.4, -0.3, 0.4), rpy=FORWARD)), np.zeros(6)).configurations[0]
    keeps = er.constraints.KeepOnLine("y") & er.constraints.KeepOrientation(1e-3)
    result = er.plan(world, start, er.Pose((0.4, 0.3, 0.4), rpy=FORWARD), constraints=keeps)
    assert result.solved
    turns, at = origins(world.robot, result.path, "tool0")
    assert np.hypot(at[:, 0] - 0.4, at[:, 2] - 0.4).max() <= result.deviation["off_line_m"] <= 1e-4
    assert np.abs(turns - er.Pose(rpy=FORWARD).rotation_matrix).max() <= result.deviation["turn_rad"] <= 1e-3
    assert world.validate(result.path).all()
    # As it is driven, too.
    driven = result.trajectory(speed=0.5)
    _, at = origins(world.robot, driven.positions, "tool0")
    assert np.hypot(at[:, 0] - 0.4, at[:, 2] - 0.4).max() <= 1e-4


def test_a_handle_stays_on_its_circle_and_turns_as_the_door_does():
    world, hinge, ends = er.ArmWorld("ur5"), np.array([0.8, 0.35, 0.0]), []
    for angle in (-1.6, -1.6 - math.pi / 3):
        turn = er.Pose(rpy=(0.0, 0.0, angle + 1.6)).rotation_matrix @ er.Pose(rpy=FORWARD).rotation_matrix
        ends.append(er.Pose(hinge + 0.45 * np.array([math.cos(angle), math.sin(angle), 1.0]), turn))
    for start in reach(world, er.PoseGoal(ends[0]), np.zeros(6)).configurations[:8]:
        result = er.plan(world, start, ends[1], constraints=er.constraints.KeepOnCircle(hinge, "z"), seconds=2.0)
        if result.solved:
            break
    assert result.solved
    turns, at = origins(world.robot, result.path, "tool0")
    gap = at - hinge
    assert np.abs(np.hypot(gap[:, 0], gap[:, 1]) - 0.45).max() <= 1e-4
    assert np.abs(gap[:, 2] - 0.45).max() <= 1e-4
    angles = np.arctan2(gap[:, 1], gap[:, 0]) + 1.6
    for turn, angle in zip(turns, angles, strict=True):
        door = er.Pose(rpy=(0.0, 0.0, angle)).rotation_matrix @ er.Pose(rpy=FORWARD).rotation_matrix
        assert np.abs(turn - door).max() <= 1e-3


def test_two_hands_keep_their_pose_to_each_other():
    arm = ROBOTS["ur5"]
    both = arm.with_tool(arm, "base_link", pose=er.Pose((0.0, 0.9, 0.0), rpy=(0.0, 0.0, math.pi)), prefix="left_")
    both = with_group(both, (*arm.group, *(f"left_{joint}" for joint in arm.group)))
    world, goals = er.ArmWorld(both), []
    for xyz in ((0.4, 0.45, 0.3), (0.45, 0.4, 0.5)):
        right, left = (
            er.PoseGoal(er.Pose(xyz) @ er.Pose((0.0, side * 0.15, 0.0), rpy=(side * math.pi / 2, 0.0, 0.0)), tip=tip)
            for side, tip in ((-1.0, "tool0"), (1.0, "left_tool0"))
        )
        goals.append(right & left)
    start = reach(world, goals[0], np.zeros(12)).configurations[0]
    result = er.plan(world, start, goals[1], constraints=er.constraints.KeepTogether("tool0", "left_tool0"))
    assert result.solved
    (turn, at), (_, other) = (origins(both, result.path, tip) for tip in ("tool0", "left_tool0"))
    np.testing.assert_allclose(other[-1], goals[1].others[0].pose.xyz, atol=1e-9)
    held = np.einsum("nji,nj->ni", turn, other - at)
    assert np.linalg.norm(held - held[0], axis=1).max() <= 2e-4
    assert result.deviation["together_m"] <= 1e-4


def test_poses_that_links_cannot_reach_together_are_refused_with_the_reason():
    goal = er.PoseGoal(er.Pose((0.4, 0.1, 0.4)), "tool0") & er.PoseGoal(er.Pose((0.4, 0.1, 0.6)), "wrist_3_link")
    result = er.plan(er.ArmWorld("ur5"), "home", goal)
    assert result.status is er.Status.GOAL_UNREACHABLE
    assert "is reached, but not with the others: the links share joints" in result.message
    with pytest.raises(EvenroadError, match="a pose goal goes with another one"):
        goal & "home"


def test_constraints_of_both_kinds_of_tip_go_together_and_those_of_one_do_not():
    assert len((er.constraints.KeepUpright(0.1, tip="a") & er.constraints.KeepUpright(0.1, tip="b")).parts) == 2
    with pytest.raises(EvenroadError, match="of one kind must be of different tips"):
        er.constraints.KeepUpright(0.1) & er.constraints.KeepUpright(0.2)


def test_a_goal_off_the_line_is_refused_with_the_distance():
    world, start = er.ArmWorld("ur5"), np.array(BENT["ur5"])
    result = er.plan(world, start, start + 0.3, constraints=er.constraints.KeepOnLine("x"))
    assert result.status is er.Status.GOAL_INVALID
    assert "at the goal 'tool0' is 0." in result.message
    assert "m off its line, more than 0.0001" in result.message


def planned(keep):
    """The plan of an arm that keeps a constraint."""
    return er.plan(er.ArmWorld("ur5"), "home", "zero", constraints=keep)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: er.constraints.KeepInPlane("w"), "normal must be"),
        (lambda: er.constraints.KeepOnLine("x", within=0.0), "within must be"),
        (lambda: er.constraints.KeepInBox((1, 0, 0), (0, 1, 1)), "low <= high"),
        (lambda: er.constraints.KeepOrientation(4.0), "at most"),
        (lambda: er.constraints.KeepJoints({"elbow": (1.0, 0.0)}), "must be low <= high"),
        (
            lambda: er.plan(
                er.ArmWorld("ur5"), "home", "zero", constraints=er.constraints.KeepJoints({"knee": (0, 1)})
            ),
            "'knee'",
        ),
        (
            lambda: er.plan(
                er.ArmWorld("ur5"), "home", "zero", constraints=er.constraints.KeepInPlane("z", tip="hand")
            ),
            "'hand'",
        ),
    ],
)
def test_a_constraint_that_makes_no_sense_is_refused_in_one_line(make, says):
    with pytest.raises(EvenroadError, match=says) as caught:
        make()
    assert "\n" not in str(caught.value)
