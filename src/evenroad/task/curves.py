"""The curve of a step, from the tip's pose."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue
from evenroad.geometry.curve import Curve, circle, polyline, spline
from evenroad.geometry.pose import Pose
from evenroad.planning.reading import Reading
from evenroad.poses.cartesian_path import Follower
from evenroad.poses.chain import chain_of, default_tip, frame_pose
from evenroad.poses.pose_goal import as_pose_goal
from evenroad.task.steps import AlongCurve, MoveAlong, MoveCircular, MoveLinear

_THERE = 1e-9
"""Distance below which the tip is already at a pose [m, and of the entries of the rotation]."""


def follower_of(step: AlongCurve, world: ArmWorld, q: Floats, reading: Reading, where: str) -> Follower | None:
    """Return the tip that follows a step's curve from a configuration, (dim,); None if it is already at the end.

    Raises InvalidValue for a circle whose points are on a line, UnknownName for an unknown tip.
    """
    given = {MoveLinear: ("pose",), MoveCircular: ("via", "to")}.get(type(step))
    poses = step.poses if isinstance(step, MoveAlong) else [getattr(step, name) for name in given or ()]
    goals = [as_pose_goal(each, reading.tip, reading.frame) for each in poses]
    robot = world.robot
    chain = chain_of(robot, goals[0].tip or default_tip(robot))
    frame = frame_pose(robot, goals[0].frame)
    row = chain.tip_poses(q[np.newaxis])[0]
    points = [Pose(tuple(row[9:].tolist()), tuple(row[:9].tolist())), *(frame @ goal.pose for goal in goals)]
    if not isinstance(step, MoveCircular):
        points = _apart(points)
        if len(points) < 2:
            return None
    try:
        return Follower(world, chain, _curve(step, points))
    except InvalidValue as error:
        raise InvalidValue(f"{where}: {error}") from None


def _curve(step: AlongCurve, points: list[Pose]) -> Curve:
    if isinstance(step, MoveCircular):
        return circle(*points)
    if isinstance(step, MoveAlong) and step.spline:
        return spline(points)
    return polyline(points, step.blend if isinstance(step, MoveAlong) else 0.0)


def _apart(poses: list[Pose]) -> list[Pose]:
    """Return poses without repetitions of the one before."""
    kept = poses[:1]
    for pose in poses[1:]:
        gap = np.abs(np.subtract([*pose.xyz, *pose.rotation], [*kept[-1].xyz, *kept[-1].rotation])).max()
        if gap > _THERE:
            kept.append(pose)
    return kept
