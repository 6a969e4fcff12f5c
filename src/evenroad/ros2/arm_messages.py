"""Messages that an arm's node gives: trajectories, MoveIt's response, markers for RViz."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats
from evenroad.robots.kinematics import link_poses, tip_links
from evenroad.robots.robot import Robot
from evenroad.ros2.arm_query import ArmAnswer
from evenroad.ros2.messages import Make, Message, header_message
from evenroad.trajectory import Trajectory
from evenroad.trajectory.formats import joint_trajectory

_LINE, _BALLS, _ADD = 4, 7, 0
"""Types and the action of ``visualization_msgs/Marker``."""
_SHOWN = 200
"""Largest number of points of the line of a tip."""


def motion_plan_response(make: Make, answer: ArmAnswer, group: str, code: int) -> Message:
    """Return a ``moveit_msgs/MotionPlanResponse``; `code` is the number of the answer's outcome."""
    error = make("moveit_msgs/msg/MoveItErrorCodes", val=code, message=answer.message, source="evenroad")
    fields = {"group_name": group, "planning_time": answer.seconds, "error_code": error}
    if answer.trajectory is None:
        return make("moveit_msgs/msg/MotionPlanResponse", **fields)
    message = joint_trajectory(answer.trajectory, make)
    first = message.points[0]
    state = make("sensor_msgs/msg/JointState", name=list(message.joint_names), position=list(first.positions))
    return make(
        "moveit_msgs/msg/MotionPlanResponse",
        trajectory_start=make("moveit_msgs/msg/RobotState", joint_state=state),
        trajectory=make("moveit_msgs/msg/RobotTrajectory", joint_trajectory=message),
        **fields,
    )


def plan_markers(make: Make, robot: Robot, trajectory: Trajectory, stamp: float) -> Message:
    """Return a ``visualization_msgs/MarkerArray``: the line of the tip, and balls at the waypoints."""
    tip = robot.links.index(tip_links(robot)[-1])
    rows = np.unique(np.linspace(0, len(trajectory.times) - 1, _SHOWN).astype(int))
    line, waypoints = trajectory.positions[rows], trajectory.waypoints

    def marker(number: int, kind: int, states: Floats, width: float) -> Message:
        points = link_poses(robot, states)[:, tip, :3, 3].tolist()
        return make(
            "visualization_msgs/msg/Marker",
            header=header_message(make, robot.links[0], stamp),
            ns="evenroad",
            id=number,
            type=kind,
            action=_ADD,
            scale=make("geometry_msgs/msg/Vector3", x=width, y=width, z=width),
            color=make("std_msgs/msg/ColorRGBA", r=0.1, g=0.5, b=0.9, a=1.0),
            points=[make("geometry_msgs/msg/Point", x=x, y=y, z=z) for x, y, z in points],
        )

    markers = [marker(0, _LINE, line, 0.005), marker(1, _BALLS, waypoints, 0.02)]
    return make("visualization_msgs/msg/MarkerArray", markers=markers)
