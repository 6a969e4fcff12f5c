"""A trajectory that a controller follows, by ros2_control's action, and that stops when the scene blocks it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from importlib import import_module
from threading import Lock

import numpy as np

from evenroad._arrays import Floats
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import NotAvailable
from evenroad.ros2.arm_query import ArmAnswer
from evenroad.ros2.messages import Message, ros_message, ros_type
from evenroad.ros2.node import Node
from evenroad.ros2.scene_state import standing_at_values
from evenroad.scenes.robot_in_scene import in_scene
from evenroad.scenes.scene import Scene
from evenroad.trajectory.formats import joint_trajectory

ACTION = "control_msgs/action/FollowJointTrajectory"
_STEP = 10
"""Number of states of a trajectory between two that a check of its rest takes: 80 ms."""


class Follower:
    """Sends trajectories to a controller; at most one is under way."""

    def __init__(self, node: Node) -> None:
        clients = import_module("rclpy.action")
        self._node, self._lock = node, Lock()
        self._client = clients.ActionClient(node.ros, ros_type(ACTION), "follow_joint_trajectory")
        self._answer: ArmAnswer | None = None
        self._handle: Message | None = None
        self._began = 0.0

    @classmethod
    def made(cls, node: Node) -> Follower | None:
        """Return one if the parameter `execute` says so, else None."""
        if not node.parameter("execute", False, "whether plans to goals are sent to follow_joint_trajectory"):
            return None
        if not node.has(ACTION, "the action follow_joint_trajectory"):
            raise NotAvailable("the parameter execute needs the package control_msgs")
        return cls(node)

    def follow(self, answer: ArmAnswer) -> None:
        """Send a trajectory; NotAvailable if another one is under way, or no controller listens."""
        assert answer.trajectory is not None
        if not self._client.server_is_ready():
            raise NotAvailable("no controller offers follow_joint_trajectory: the plan is not driven")
        with self._lock:
            if self._answer is not None:
                raise NotAvailable("the arm still follows the last trajectory: the new plan is not driven")
            self._answer, self._handle, self._began = answer, None, self._node.now()
        goal = ros_type(ACTION).Goal(trajectory=joint_trajectory(answer.trajectory, ros_message))
        self._client.send_goal_async(goal).add_done_callback(self._accepted)

    def scene_changed(self, scene: Scene, joints: Mapping[str, float]) -> None:
        """Stop the arm if what is left of its trajectory is not free in a scene."""
        with self._lock:
            answer, elapsed = self._answer, self._node.now() - self._began
        if answer is None or answer.world is None or answer.trajectory is None:
            return
        try:
            robot, _ = standing_at_values(joints, answer.world.robot, "the joint state")
            free = rest_is_free(replace(answer.world, robot=in_scene(robot, scene), scene=scene), answer, elapsed)
        except Exception:
            # A scene that cannot be checked is no reason to drive on.
            self._stop("the new scene could not be checked")
            raise
        if not free:
            self._stop("the new scene blocks what is left of its trajectory")

    def _stop(self, why: str) -> None:
        with self._lock:
            handle = self._handle
            stopped, self._answer = self._answer is not None, None
        if stopped:
            self._node.refuse(f"stopped the arm: {why}")
        if handle is not None:
            handle.cancel_goal_async()

    def _accepted(self, future: Message) -> None:
        handle = future.result()
        if not handle.accepted:
            self._node.refuse("the controller refused the trajectory")
            with self._lock:
                self._answer = None
            return
        with self._lock:
            goes_on = self._answer is not None
            self._handle = handle if goes_on else None
        if not goes_on:
            # The scene blocked it while the controller was accepting it.
            handle.cancel_goal_async()
        handle.get_result_async().add_done_callback(self._finished)

    def _finished(self, future: Message) -> None:
        ended, result = future.result().status, future.result().result
        with self._lock:
            self._answer = self._handle = None
        if ended == ros_type("action_msgs/msg/GoalStatus").STATUS_CANCELED:
            self._node.info("the controller stopped")
        elif result.error_code == ros_type(ACTION).Result.SUCCESSFUL:
            self._node.info("the controller reached the goal")
        else:
            self._node.refuse(f"the controller ended with error {result.error_code}: {result.error_string}")


def rest_is_free(world: ArmWorld, answer: ArmAnswer, elapsed: float) -> bool:
    """Return whether what is left of a trajectory after some seconds is free in a world."""
    assert answer.trajectory is not None
    states: Floats = answer.trajectory.positions
    first = int(np.searchsorted(answer.trajectory.times, elapsed, side="right")) - 1
    rest = states[max(first, 0) :]
    rows = rest[[*range(0, len(rest) - 1, _STEP), len(rest) - 1]]
    return bool(world.valid(rows).all() and world.motion_valid(rows[:-1], rows[1:]).all())
