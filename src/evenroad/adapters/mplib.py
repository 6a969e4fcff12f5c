"""The planner of mplib by its own names, for scripts that were written for it, such as ManiSkill's.

mplib itself is not imported.  Names and answers are those of its version 0.1.1.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._checks import as_row, require_known, require_positive
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue
from evenroad.geometry.mesh_shape import PointCloud
from evenroad.geometry.pose import Pose
from evenroad.loading.load import load_robot
from evenroad.planning.plan import plan
from evenroad.planning.result import PlanResult
from evenroad.poses.pose_goal import PoseGoal
from evenroad.robots.robot import Robot
from evenroad.robots.variants import with_group
from evenroad.scenes.scene import Scene
from evenroad.task.result import TaskResult
from evenroad.task.steps import MoveLinear
from evenroad.task.task import Task
from evenroad.trajectory.limits import Limits

Answer: TypeAlias = dict[str, Any]
"""``status``, and where it is ``"Success"`` also ``time``, ``position``, ``velocity`` and ``duration``."""

APART = 1e-4
"""Fingers stand where they are, rounded to this [m or rad], so that one robot serves many calls."""

IGNORED = frozenset({"rrt_range", "planner_name", "qpos_step", "fix_joint_limits", "verbose"})
"""Options of mplib's search, which ours does not have."""


class Planner:
    """Plans for one arm, as ``mplib.Planner`` does.  Paths are proved, also against the point cloud.

    Parameters
    ----------
    urdf, srdf : str or path-like
        Files of the robot; an empty text where there is no SRDF.
    user_link_names : sequence of str
        Not used: links have the names of the URDF.
    user_joint_names : sequence of str
        Joints of the simulator, in the order of its configurations.  It plans for those without ``finger`` and
        ``gripper`` in their names.
    move_group : str
        The link that is placed.
    joint_vel_limits, joint_acc_limits : array_like, optional
        Of each joint that it plans for, > 0 [rad/s, rad/s^2].  Default: 1.

    Raises
    ------
    InvalidValue, UnknownName, BrokenFile
        For files, names or limits that cannot be used.

    Examples
    --------
    >>> import sys
    >>> import evenroad.adapters.mplib
    >>> sys.modules["mplib"] = evenroad.adapters.mplib  # before ManiSkill's scripts are imported
    >>> from mplib import Planner
    >>> del sys.modules["mplib"]
    """

    def __init__(
        self,
        urdf: str | os.PathLike[str],
        srdf: str | os.PathLike[str],
        user_link_names: Sequence[str],
        user_joint_names: Sequence[str],
        move_group: str,
        joint_vel_limits: npt.ArrayLike | None = None,
        joint_acc_limits: npt.ArrayLike | None = None,
    ) -> None:
        self.joints = tuple(user_joint_names)
        group = tuple(name for name in self.joints if "finger" not in name and "gripper" not in name)
        self.robot = load_robot(os.fspath(urdf), srdf=srdf or None, group=group)
        require_known("link", move_group, self.robot.links)
        self.move_group = move_group
        ones = np.ones(len(group))
        self.joint_vel_limits = ones if joint_vel_limits is None else np.asarray(joint_vel_limits, np.float64)
        self.joint_acc_limits = ones if joint_acc_limits is None else np.asarray(joint_acc_limits, np.float64)
        self._base = Pose()
        self._points: tuple[Floats, float] | None = None
        self._robots: dict[tuple[float, ...], Robot] = {}

    def set_base_pose(self, pose: npt.ArrayLike) -> None:
        """Say where the root link is in the world's frame, (7,): position [m] and quaternion (w, x, y, z)."""
        self._base = _pose("the base", pose)

    def update_point_cloud(self, pc: npt.ArrayLike, radius: float = 1e-3) -> None:
        """Keep points, (n, 3), in the world's frame, as balls of a radius > 0 [m]; InvalidValue for others."""
        cloud = PointCloud(pc, radius)
        self._points = cloud.points, cloud.radius

    def _scene(self) -> Scene:
        """Return the points in the frame of the root link, wherever it is now."""
        if self._points is None:
            return Scene([])
        to_root, (points, radius) = self._base.inverse().matrix, self._points
        return Scene([PointCloud(points @ to_root[:3, :3].T + to_root[:3, 3], radius, name="cloud")])

    def plan_screw(self, target_pose: npt.ArrayLike, qpos: npt.ArrayLike, **options: Any) -> Answer:
        """Move the tip in a straight line, at a constant rate of rotation; mplib's tip follows a screw.

        Parameters
        ----------
        target_pose : array_like, shape (7,)
            Position and quaternion (w, x, y, z), in the world's frame, or the base's with ``wrt_world=False``.
        qpos : array_like
            Values of all joints of the simulator.
        **options
            ``time_step`` (0.1 s; the last step may be shorter), ``planning_time`` (1 s), ``use_point_cloud`` (False),
            ``wrt_world`` (True).

        Returns
        -------
        dict
            ``status`` says why there is no motion, if there is none.

        Raises
        ------
        UnknownName
            For another option.
        InvalidValue
            For ``use_attach``, or arrays of other lengths.
        """
        return self._answer(target_pose, qpos, options, straight=True)

    def plan_qpos_to_pose(self, goal_pose: npt.ArrayLike, current_qpos: npt.ArrayLike, **options: Any) -> Answer:
        """Move to a pose by a short path; arguments are those of `plan_screw`."""
        return self._answer(goal_pose, current_qpos, options, straight=False)

    def _answer(self, target: npt.ArrayLike, qpos: npt.ArrayLike, options: dict[str, Any], *, straight: bool) -> Answer:
        known = {"time_step": 0.1, "planning_time": 1.0, "use_point_cloud": False, "use_attach": False}
        known["wrt_world"] = True
        for name in options:
            require_known("option", name, {*known, *IGNORED})
        given = {**known, **options}
        if given["use_attach"]:
            raise InvalidValue("use_attach: hold things by robot.holding(...) of evenroad instead")
        step = require_positive("time_step", given["time_step"])
        world, start = self._world(qpos, self._scene() if given["use_point_cloud"] else Scene([]))
        pose = _pose("the goal", target)
        goal = PoseGoal(self._base.inverse() @ pose if given["wrt_world"] else pose, tip=self.move_group)
        seconds = require_positive("planning_time", given["planning_time"])
        planned: PlanResult | TaskResult
        if straight:
            planned = Task([MoveLinear(goal)]).plan(world, start, seconds=seconds)
        else:
            planned = plan(world, start, goal, seconds=seconds)
        if not planned.solved:
            return {"status": planned.message}
        return self._timed(planned, step) if planned.cost else _standing(start)

    def _world(self, qpos: npt.ArrayLike, scene: Scene) -> tuple[ArmWorld, Floats]:
        """Return the world with the fingers where they are, and the arm's configuration within its limits."""
        values = dict(zip(self.joints, as_row("qpos", np.ravel(qpos).tolist(), len(self.joints)), strict=True))
        held = {}
        for joint in self.robot.joints:
            if joint.name in values and joint.name not in self.robot.group and joint.mimic is None:
                value = round(values[joint.name] / APART) * APART
                held[joint.name] = min(max(value, joint.lower), joint.upper)
        key = tuple(held.values())
        robot = self._robots.get(key)
        if robot is None:
            # Grippers stand in few places; more than these would only fill memory.
            if len(self._robots) >= 32:
                self._robots.clear()
            robot = self._robots[key] = with_group(self.robot, self.robot.group, held)
        world = ArmWorld(robot, scene)
        # Simulated joints are beyond their limits by a little.
        start = np.array([values[name] for name in self.robot.group])
        return world, np.clip(start, world.space.low, world.space.high)

    def _timed(self, planned: PlanResult | TaskResult, step: float) -> Answer:
        limits = Limits(
            as_row("joint_vel_limits", self.joint_vel_limits.tolist(), len(self.robot.group)),
            as_row("joint_acc_limits", self.joint_acc_limits.tolist(), len(self.robot.group)),
        )
        trajectory = planned.trajectory(limits=limits)
        count = max(1, math.ceil(trajectory.duration / step - 1e-9))
        times = np.minimum(step * np.arange(1, count + 1), trajectory.duration)
        velocity = np.array([np.interp(times, trajectory.times, column) for column in trajectory.velocities.T]).T
        return {
            "status": "Success",
            "time": times,
            "position": trajectory.at(times),
            "velocity": velocity,
            "duration": trajectory.duration,
        }


def _standing(q: Floats) -> Answer:
    """Return a motion of an arm that is at its goal."""
    still = q[np.newaxis]
    return {"status": "Success", "time": np.zeros(1), "position": still, "velocity": 0.0 * still, "duration": 0.0}


def _pose(what: str, values: npt.ArrayLike) -> Pose:
    """Return a pose of a position and a quaternion whose real part comes first."""
    x, y, z, w, i, j, k = as_row(what, np.ravel(values).tolist(), 7)
    return Pose((x, y, z), xyzw=(i, j, k, w))
