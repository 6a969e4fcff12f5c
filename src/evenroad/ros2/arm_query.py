"""One query of an arm: MoveIt's request or a plain goal in, a trajectory out, with the outcome in MoveIt's words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import perf_counter

from evenroad._checks import require_positive
from evenroad._time_limit import Stop, stopped_by
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import EvenroadError, InvalidValue, shown
from evenroad.geometry.pose import Pose
from evenroad.planning.plan import plan
from evenroad.planning.reading import Goal
from evenroad.planning.result import Status
from evenroad.poses.pose_goal import PoseGoal
from evenroad.robots.robot import Robot
from evenroad.ros2.messages import Message, pose_of, xyz_of, xyzw_of
from evenroad.scenes.scene import Scene
from evenroad.trajectory import Trajectory
from evenroad.trajectory.arm import arm_trajectory
from evenroad.trajectory.limits import limits_of

OUTCOMES = {
    Status.SOLVED: "SUCCESS",
    Status.START_INVALID: "START_STATE_IN_COLLISION",
    Status.GOAL_INVALID: "GOAL_IN_COLLISION",
    Status.START_OUTSIDE_LIMITS: "START_STATE_INVALID",
    Status.GOAL_OUTSIDE_LIMITS: "GOAL_STATE_INVALID",
    Status.GOAL_UNREACHABLE: "NO_IK_SOLUTION",
    Status.NOT_CONNECTED: "PLANNING_FAILED",
    Status.BUDGET_SPENT: "TIMED_OUT",
}
"""Status of a plan -> the error code of ``moveit_msgs/MoveItErrorCodes``; of all others FAILURE."""


class Refused(InvalidValue):
    """A request that is not planned; `outcome` is its error code in MoveIt's words."""

    outcome = "INVALID_MOTION_PLAN"


class WrongGroup(Refused):
    """A group of joints that the node does not plan for."""

    outcome = "INVALID_GROUP_NAME"


class WrongGoal(Refused):
    """Goal constraints that are no configuration and no pose."""

    outcome = "INVALID_GOAL_CONSTRAINTS"


class WrongFrame(Refused):
    """A frame that is no link of the robot."""

    outcome = "FRAME_TRANSFORM_FAILURE"


class StaleState(Refused):
    """Joint states that are too old, or that lack a joint."""

    outcome = "ROBOT_STATE_STALE"


@dataclass(frozen=True)
class ArmQuery:
    """A start and goals of an arm in a scene.

    `speed` is the share of full speed; accelerations are those of that speed, unless `acceleration` is a share of their
    limits.
    """

    robot: Robot
    scene: Scene | None
    start: Sequence[float]
    goals: Sequence[Goal]
    seconds: float = 5.0
    speed: float = 0.2
    acceleration: float | None = None
    clearance: float = 0.0


@dataclass(frozen=True)
class ArmAnswer:
    """A trajectory and the world that it is free in, or None; the outcome, and in words why [s]."""

    outcome: str
    message: str
    seconds: float
    trajectory: Trajectory | None = None
    world: ArmWorld | None = None


def plan_for_arm(query: ArmQuery, stop: Stop | None = None) -> ArmAnswer:
    """Return the answer to one query; invalid input is an answer, too, as MoveIt has it."""
    began = perf_counter()
    try:
        with stopped_by(Stop() if stop is None else stop):
            scene = Scene() if query.scene is None else query.scene
            result = plan(
                scene,
                query.start,
                list(query.goals),
                robot=query.robot,
                clearance=query.clearance,
                seconds=query.seconds,
            )
        if stop is not None and stop.is_set:
            return ArmAnswer("PREEMPTED", "the query was cancelled", perf_counter() - began)
        if result.path is None or not result.solved or not isinstance(result.world, ArmWorld):
            return ArmAnswer(OUTCOMES.get(result.status, "FAILURE"), result.message, perf_counter() - began)
        limits = limits_of(query.robot)
        within = limits.at_speed(query.speed)
        if query.acceleration is not None:
            within = replace(within, acceleration=tuple(query.acceleration * each for each in limits.acceleration))
        trajectory = arm_trajectory(result.world, result.path, within)
    except Refused as error:
        return ArmAnswer(error.outcome, str(error), perf_counter() - began)
    except EvenroadError as error:
        return ArmAnswer("FAILURE", str(error), perf_counter() - began)
    return ArmAnswer("SUCCESS", result.message, perf_counter() - began, trajectory, result.world)


def goals_of_request(request: Message, robot: Robot, group: str) -> list[Goal]:
    """Return the goals of a ``moveit_msgs/MotionPlanRequest``, which are alternatives.

    WrongGroup, WrongGoal or Refused for a request of more than a path to a configuration or a pose.
    """
    if request.group_name not in ("", group):
        raise WrongGroup(f"this node plans for the group {group!r}, got {shown(request.group_name)}")
    path = request.path_constraints
    if path.joint_constraints or path.position_constraints or path.orientation_constraints:
        raise Refused("path constraints are not planned for: plan without, or use evenroad.constraints in Python")
    if request.trajectory_constraints.constraints or request.reference_trajectories:
        raise Refused("trajectory constraints and reference trajectories are not planned for")
    if not request.goal_constraints:
        raise WrongGoal("a request must have goal constraints, got none")
    return [_goal(each, robot) for each in request.goal_constraints]


def _goal(constraints: Message, robot: Robot) -> Goal:
    joints, positions = constraints.joint_constraints, constraints.position_constraints
    turns = constraints.orientation_constraints
    if constraints.visibility_constraints:
        raise WrongGoal("a goal of visibility is not planned for")
    if joints and not positions and not turns:
        values = {str(each.joint_name): float(each.position) for each in joints}
        if missing := [name for name in robot.group if name not in values]:
            raise WrongGoal(f"a goal of joints must have all of the group, it lacks {', '.join(missing)}")
        if unknown := [name for name in values if name not in robot.group]:
            raise WrongGoal(f"a goal of joints has {', '.join(unknown)}, which are not in the group")
        if not all(map(math.isfinite, values.values())):
            raise WrongGoal(f"a goal of joints must have finite positions, got {values}")
        return [values[name] for name in robot.group]
    if joints or len(positions) != 1 or len(turns) > 1:
        raise WrongGoal("a goal must be all joints of the group, or one position with at most one orientation")
    try:
        return _pose_goal(positions[0], turns[0] if turns else None, robot)
    except Refused:
        raise
    except InvalidValue as error:
        raise WrongGoal(str(error)) from None


def _pose_goal(position: Message, turn: Message | None, robot: Robot) -> PoseGoal:
    """Return the pose of a link: the middle of a region, and an orientation that may be free about one axis."""
    region = position.constraint_region
    if len(region.primitive_poses) != 1 or region.meshes:
        raise WrongGoal("the region of a position must be one primitive; its middle is the goal")
    centre = pose_of(region.primitive_poses[0], "the goal").xyz
    offset = xyz_of(position.target_point_offset, "the target_point_offset")
    link, frame = str(position.link_name), frame_of(position.header, robot)
    if link not in robot.links:
        raise WrongGoal(f"the robot has no link {shown(link)}")
    if turn is None:
        if any(offset):
            raise WrongGoal("a target_point_offset goes with an orientation")
        return PoseGoal(Pose(centre), link, frame, position_only=True)
    if (str(turn.link_name), frame_of(turn.header, robot)) != (link, frame):
        raise WrongGoal("position and orientation of a goal must be of one link, in one frame")
    pose = Pose(centre, xyzw=xyzw_of(turn.orientation, "the goal's orientation"))
    pose = pose @ Pose((-offset[0], -offset[1], -offset[2]))
    wide = [name for name in "xyz" if getattr(turn, f"absolute_{name}_axis_tolerance") >= math.pi]
    if len(wide) == 3:
        return PoseGoal(pose, link, frame, position_only=True)
    if len(wide) == 2:
        raise WrongGoal(f"an orientation may be free about one axis or all, got {' and '.join(wide)}")
    return PoseGoal(pose, link, frame, free_axis=wide[0]) if wide else PoseGoal(pose, link, frame)  # type: ignore[arg-type]


def frame_of(header: Message, robot: Robot) -> str:
    """Return the link whose frame a header names, "" of the root; "world" and no name stand for the root."""
    name = str(header.frame_id)
    if name in ("", "world", robot.links[0]):
        return ""
    if name not in robot.links:
        raise WrongFrame(f"the frame {shown(name)} is no link of the robot; its root is {robot.links[0]!r}")
    return name


def shares_of_request(request: Message, speed: float) -> tuple[float, float | None]:
    """Return the shares of full speed and of the acceleration limits; MoveIt's zeros stand for the node's own."""
    fast = request.max_velocity_scaling_factor or speed
    require_positive("max_velocity_scaling_factor", fast, at_most=1.0)
    if not request.max_acceleration_scaling_factor:
        return fast, None
    push = require_positive(
        "max_acceleration_scaling_factor", float(request.max_acceleration_scaling_factor), at_most=1.0
    )
    return fast, push
