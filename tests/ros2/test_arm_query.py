"""Requests of an arm: goals as MoveIt writes them, answers with its error codes, and trajectories that are free."""

import math
from dataclasses import replace
from types import SimpleNamespace as Fields

import numpy as np
import pytest

import evenroad as er
from evenroad.ros2.arm_messages import motion_plan_response, plan_markers
from evenroad.ros2.arm_query import ArmQuery, Refused, goals_of_request, plan_for_arm, shares_of_request
from evenroad.ros2.follow import rest_is_free
from tests.ros2.stand_ins import header, made

UR5 = er.load_robot("ur5")
HOME, GOAL = [0.0, -1.57, 0.0, -1.57, 0.0, 0.0], [1.2, -1.0, 0.8, -1.57, 0.2, 0.0]
POST = er.Scene([er.Box((0.1, 0.1, 1.0), xyz=(0.5, 0.3, 0.5), name="post")])


def constraints(*, joints=(), positions=(), orientations=()):
    return Fields(
        joint_constraints=list(joints),
        position_constraints=list(positions),
        orientation_constraints=list(orientations),
        visibility_constraints=[],
    )


def request(*goals, group="", path=None, **more):
    return Fields(
        group_name=group,
        goal_constraints=list(goals),
        path_constraints=path or constraints(),
        trajectory_constraints=Fields(constraints=[]),
        reference_trajectories=[],
        **more,
    )


def joints(values, names=UR5.group):
    pairs = zip(names, values, strict=True)
    return constraints(joints=[Fields(joint_name=name, position=value) for name, value in pairs])


def xyz(x, y, z):
    return Fields(x=x, y=y, z=z)


def position(at, link="tool0", frame="base_link", offset=(0.0, 0.0, 0.0)):
    still = Fields(x=0.0, y=0.0, z=0.0, w=1.0)
    region = Fields(primitives=[Fields()], primitive_poses=[Fields(position=xyz(*at), orientation=still)], meshes=[])
    return Fields(
        header=header(frame), link_name=link, target_point_offset=xyz(*offset), constraint_region=region, weight=1.0
    )


def orientation(link="tool0", frame="base_link", wide=""):
    tolerances = {f"absolute_{axis}_axis_tolerance": 4.0 if axis in wide else 0.01 for axis in "xyz"}
    return Fields(header=header(frame), link_name=link, orientation=Fields(x=1.0, y=0.0, z=0.0, w=0.0), **tolerances)


def test_joints_are_a_goal_in_the_order_of_the_group():
    backwards = joints(GOAL[::-1], UR5.group[::-1])
    assert goals_of_request(request(backwards, joints(HOME)), UR5, "arm") == [GOAL, HOME]


@pytest.mark.parametrize(
    ("wide", "offset", "expected"), [("", (0, 0, 0), 0.4), ("z", (0, 0, 0), 0.4), ("", (0.0, 0.0, 0.1), 0.5)]
)
def test_a_position_and_an_orientation_are_a_pose_of_the_link(wide, offset, expected):
    goal = constraints(
        positions=[position((0.4, 0.3, 0.4), offset=tuple(map(float, offset)))], orientations=[orientation(wide=wide)]
    )
    [found] = goals_of_request(request(goal), UR5, "arm")
    result = er.plan(er.ArmWorld(UR5), HOME, found)
    pose = UR5.fk(result.path[-1], "tool0")
    # Turned upside down: the point 0.1 along the link's z is below the link.
    np.testing.assert_allclose(pose.xyz, (0.4, 0.3, expected), atol=1e-5)
    np.testing.assert_allclose(pose.matrix[:3, 2], (0, 0, -1), atol=1e-5)
    assert (found.free_axis is None) == (wide == "")


def test_without_an_orientation_any_is_a_goal():
    [found] = goals_of_request(request(constraints(positions=[position((0.4, 0.3, 0.4))])), UR5, "arm")
    assert found.position_only
    everywhere = constraints(positions=[position((0.4, 0.3, 0.4))], orientations=[orientation(wide="xyz")])
    [also] = goals_of_request(request(everywhere), UR5, "arm")
    assert also.position_only
    assert also.pose.xyz == found.pose.xyz


@pytest.mark.parametrize(
    ("asked", "outcome", "said"),
    [
        (request(joints(GOAL), group="legs"), "INVALID_GROUP_NAME", "plans for the group 'arm', got 'legs'"),
        (request(), "INVALID_GOAL_CONSTRAINTS", "got none"),
        (request(joints(GOAL[:3], UR5.group[:3])), "INVALID_GOAL_CONSTRAINTS", "lacks wrist_1_joint"),
        (request(joints([*GOAL, 0.0], [*UR5.group, "wheel"])), "INVALID_GOAL_CONSTRAINTS", "wheel"),
        (request(joints([math.nan, *GOAL[1:]])), "INVALID_GOAL_CONSTRAINTS", "finite positions"),
        (request(constraints(orientations=[orientation()])), "INVALID_GOAL_CONSTRAINTS", "one position"),
        (request(constraints(positions=[position((0.4, math.inf, 0.4))])), "INVALID_GOAL_CONSTRAINTS", "3 finite"),
        (request(constraints(positions=[position((0, 0, 1.0), "nose")])), "INVALID_GOAL_CONSTRAINTS", "'nose'"),
        (request(constraints(positions=[position((0, 0, 1.0), frame="map")])), "FRAME_TRANSFORM_FAILURE", "'map'"),
        (request(joints(GOAL), path=joints(GOAL)), "INVALID_MOTION_PLAN", "path constraints"),
    ],
)
def test_what_is_not_planned_for_is_refused_with_moveits_code(asked, outcome, said):
    with pytest.raises(Refused, match=said) as refused:
        goals_of_request(asked, UR5, "arm")
    assert refused.value.outcome == outcome


def test_a_free_path_is_timed_and_blocked_ends_have_moveits_codes():
    answer = plan_for_arm(ArmQuery(UR5, POST, HOME, [GOAL], speed=0.5))
    assert answer.outcome == "SUCCESS"
    states = answer.trajectory.positions
    assert er.ArmWorld(UR5, POST).motion_valid(states[:-1], states[1:]).all()
    assert max(answer.trajectory.highest.values()) <= 1.0
    inside = er.Scene([er.Sphere(0.2, xyz=UR5.fk(GOAL, "tool0").xyz, name="ball")])
    assert plan_for_arm(ArmQuery(UR5, inside, HOME, [GOAL])).outcome == "GOAL_IN_COLLISION"
    assert plan_for_arm(ArmQuery(UR5, inside, GOAL, [HOME])).outcome == "START_STATE_IN_COLLISION"
    far = er.Pose((5.0, 0.0, 0.0))
    assert plan_for_arm(ArmQuery(UR5, None, HOME, [far])).outcome == "NO_IK_SOLUTION"
    assert plan_for_arm(ArmQuery(UR5, None, [9.0] * 6, [HOME])).outcome == "START_STATE_INVALID"


def test_a_response_has_the_trajectory_and_where_it_begins():
    answer = plan_for_arm(ArmQuery(UR5, None, HOME, [GOAL]))
    response = motion_plan_response(made, answer, "arm", 1)
    assert response.error_code.val == 1
    assert response.group_name == "arm"
    assert response.trajectory_start.joint_state.position == HOME
    points = response.trajectory.joint_trajectory.points
    np.testing.assert_allclose(points[-1].positions, GOAL, atol=1e-9)
    assert not hasattr(motion_plan_response(made, replace(answer, trajectory=None), "arm", -1), "trajectory")


def test_markers_lie_on_the_way_of_the_tip():
    answer = plan_for_arm(ArmQuery(UR5, None, HOME, [GOAL]))
    line, balls = plan_markers(made, UR5, answer.trajectory, 3.0).markers
    assert {each.header.frame_id for each in (line, balls)} == {"base_link"}
    for states, marker in ((answer.trajectory.positions[[0, -1]], line), (answer.trajectory.waypoints, balls)):
        expected = [UR5.fk(q, "tool0").xyz for q in states]
        rows = [0, -1] if marker is line else slice(None)
        found = np.array([[each.x, each.y, each.z] for each in marker.points])[rows]
        np.testing.assert_allclose(found, expected, atol=1e-9)


def test_scaling_factors_of_zero_are_the_nodes_own():
    zero = Fields(max_velocity_scaling_factor=0.0, max_acceleration_scaling_factor=0.0)
    assert shares_of_request(zero, 0.2) == (0.2, None)
    both = Fields(max_velocity_scaling_factor=0.5, max_acceleration_scaling_factor=0.1)
    assert shares_of_request(both, 0.2) == (0.5, 0.1)
    with pytest.raises(ValueError, match="max_velocity_scaling_factor must be at most 1"):
        shares_of_request(Fields(max_velocity_scaling_factor=2.0, max_acceleration_scaling_factor=0.0), 0.2)
    slow, gentle = (
        plan_for_arm(ArmQuery(UR5, None, HOME, [GOAL], speed=0.5, acceleration=each)) for each in (None, 0.02)
    )
    assert gentle.trajectory.duration > slow.trajectory.duration


def test_what_is_left_of_a_trajectory_is_checked_in_a_new_scene():
    answer = plan_for_arm(ArmQuery(UR5, None, HOME, [GOAL]))
    middle = answer.trajectory.positions[len(answer.trajectory.times) // 2]
    ball = er.Scene([er.Sphere(0.1, xyz=UR5.fk(middle, "tool0").xyz, name="ball")])
    blocked, half = er.ArmWorld(UR5, ball), 0.5 * answer.trajectory.duration
    assert rest_is_free(answer.world, answer, 0.0)
    assert not rest_is_free(blocked, answer, 0.0)
    assert not rest_is_free(blocked, answer, half)
    assert rest_is_free(blocked, answer, answer.trajectory.duration)
