"""Queries of a robot by itself, without a scene: the functions behind its methods."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats
from evenroad._checks import require_count, require_known
from evenroad._rng import RngLike, generator
from evenroad.collision.prepared_robots import prepared
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.pose import Pose
from evenroad.poses.chain import default_tip
from evenroad.poses.inverse_kinematics import reach
from evenroad.poses.pose_goal import PoseGoal, as_pose_goal
from evenroad.robots.kinematics import link_poses
from evenroad.robots.robot import ConfigurationLike, Robot
from evenroad.scenes.states import as_configuration


@dataclass(frozen=True)
class _Anywhere:
    """A world without obstacles, in which nothing is tested."""

    robot: Robot

    def valid(self, q: Floats) -> Bools:
        """Return that all are valid."""
        return np.ones(len(q), dtype=np.bool_)

    def explain(self, q: Floats) -> str:
        """Return that nothing blocks."""
        return "it is free"


def pose_of_link(robot: Robot, q: ConfigurationLike, link: str = "") -> Pose:
    """Return what :meth:`Robot.fk` does."""
    link = link or default_tip(robot)
    require_known(f"link of {robot.name!r}:", link, robot.links)
    row = as_configuration(robot, q)
    matrix = link_poses(robot, row[np.newaxis])[0, robot.links.index(link)]
    return Pose(tuple(matrix[:3, 3].tolist()), tuple(matrix[:3, :3].ravel().tolist()))


def jacobian_of(robot: Robot, q: ConfigurationLike, link: str = "") -> Floats:
    """Return what :meth:`Robot.jacobian` does."""
    link = link or default_tip(robot)
    require_known(f"link of {robot.name!r}:", link, robot.links)
    poses = dict(zip(robot.links, link_poses(robot, as_configuration(robot, q)[np.newaxis])[0], strict=True))
    carriers = {joint.child: joint for joint in robot.joints}
    point, columns = poses[link][:3, 3], np.zeros((6, robot.dof))
    while link in carriers:
        joint = carriers[link]
        link = joint.parent
        # What follows a joint moves with it, as many times as fast.
        leader, times = (joint.name, 1.0) if joint.mimic is None else (joint.mimic.joint, joint.mimic.multiplier)
        if joint.kind == "fixed" or leader not in robot.group:
            continue
        frame = poses[joint.parent] @ joint.origin.matrix
        axis = times * (frame[:3, :3] @ np.array(joint.axis))
        shift, turn = (axis, 0.0 * axis) if joint.kind == "prismatic" else (np.cross(axis, point - frame[:3, 3]), axis)
        columns[:, robot.group.index(leader)] += np.concatenate([shift, turn])
    return columns


def configurations_at(
    robot: Robot,
    pose: Pose | PoseGoal | npt.ArrayLike,
    link: str = "",
    start: ConfigurationLike = (),
) -> Floats:
    """Return what :meth:`Robot.ik` does."""
    if isinstance(pose, str | Mapping) or (not isinstance(pose, Pose | PoseGoal) and np.shape(pose) != (4, 4)):
        raise InvalidValue(
            f"pose must be a Pose, as er.Pose((x, y, z), rpy=(r, p, y)), a PoseGoal or a 4x4 matrix, got {shown(pose)}"
        )
    goal = as_pose_goal(pose if isinstance(pose, Pose | PoseGoal) else Pose.from_matrix(pose), link)
    goal = replace(goal, tip=link or goal.tip or default_tip(robot))
    nothing = not isinstance(start, str | Mapping) and np.size(start) == 0
    return reach(_Anywhere(robot), goal, as_configuration(robot, {} if nothing else start)).configurations


def random_configurations(robot: Robot, rng: RngLike = 0, n: int | None = None) -> Floats:
    """Return what :meth:`Robot.random` does."""
    space = prepared(robot).space
    count = 1 if n is None else require_count("n", n)
    drawn = space.from_cube(generator(rng).random((count, space.dim)))
    return drawn[0] if n is None else drawn
