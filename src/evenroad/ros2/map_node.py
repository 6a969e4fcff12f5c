"""``evenroad ros2 map``: a map and goals in, paths for a disk or a footprint out, as nav2's planner server."""

from __future__ import annotations

import time
from collections.abc import Sequence
from threading import Lock

import numpy as np
import yaml

from evenroad._checks import require_count
from evenroad._time_limit import Stop
from evenroad.errors import InvalidValue, shown
from evenroad.ros2.map_query import CANCELLED, MapAnswer, MapQuery, plan_on_map
from evenroad.ros2.map_state import MapRobot, MapState
from evenroad.ros2.messages import Message, path_message, ros_message, ros_type, time_message
from evenroad.ros2.node import Node, run_node
from evenroad.world import GridMap

ACTION = "nav2_msgs/action/ComputePathToPose"
UPDATE = "map_msgs/msg/OccupancyGridUpdate"
_PATIENCE = 0.5
"""Time after which a goal counts as cancelled although its client's request has not been answered [s]."""


def run_map_node(arguments: Sequence[str] = ()) -> int:
    """Run the node until it is interrupted; errors as :func:`evenroad.ros2.node.run_node`."""
    return run_node("evenroad_map_planner", MapNode, arguments)


class MapNode:
    """Answers goals on the latest map: by topic, by service, and by nav2's action where its type is installed."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._state = MapState(_robot_of(node))
        self._seconds = node.parameter("seconds", 5.0, "largest time of a plan [s]")
        self._spacing = node.parameter("spacing", 0.05, "largest distance between poses of a path, 0: waypoints [m]")
        self._oldest = node.parameter("stale_after", 10.0, "largest age of the stamp of a goal, 0: any [s]")
        self._start: Message | None = None
        self._stops: dict[bytes, Stop] = {}
        self._lock = Lock()
        self._plans = node.publisher("nav_msgs/msg/Path", "plan")
        node.subscribe("nav_msgs/msg/OccupancyGrid", "map", self._take_map, latched=True)
        if node.has(UPDATE, "the topic map_updates"):
            node.subscribe(UPDATE, "map_updates", self._state.take_update)
        node.subscribe("geometry_msgs/msg/PoseWithCovarianceStamped", "initialpose", self._take_start)
        node.plans_for("geometry_msgs/msg/PoseStamped", "goal_pose", self._answer_goal)
        node.serve("nav_msgs/srv/GetPlan", "get_plan", self._answer_service)
        if node.has(ACTION, "the action compute_path_to_pose"):
            node.offer_action(ACTION, "compute_path_to_pose", self._answer_action, self._cancel)
        node.report_health(lambda: "" if self._state.has_map else "no map yet")

    def _take_map(self, message: Message) -> None:
        self._node.info(self._state.take_map(message))

    def _take_start(self, message: Message) -> None:
        start = ros_message("geometry_msgs/msg/PoseStamped", header=message.header, pose=message.pose.pose)
        # Someone who placed the robot once, as in RViz, may ask for plans much later.
        start.header.stamp = ros_message("builtin_interfaces/msg/Time")
        self._start = start

    def _answer_goal(self, goal: Message) -> None:
        if self._start is None:
            raise InvalidValue("there is no start yet: publish it on initialpose")
        self._answered(self._start, goal)

    def _answer_service(self, request: Message, response: Message) -> None:
        if request.tolerance > 0.0:
            raise InvalidValue(f"paths end at the goal itself: tolerance must be 0, got {request.tolerance:g}")
        _, response.plan = self._answered(request.start, request.goal)

    def _answer_action(self, handle: Message) -> Message:
        kind, request, stop = ros_type(ACTION), handle.request, self._stop_of(handle)
        try:
            start = request.start if request.use_start else self._start
            if start is None:
                answer = MapAnswer("TF_ERROR", "there is no start yet: give one, or publish it on initialpose", 0.0)
                self._node.refuse(answer.message)
                path = ros_message("nav_msgs/msg/Path")
            else:
                answer, path = self._answered(start, request.goal, stop)
        finally:
            with self._lock:
                del self._stops[bytes(handle.goal_id.uuid)]
        took = time_message(ros_message, answer.seconds, "builtin_interfaces/msg/Duration")
        result = kind.Result(path=path, planning_time=took)
        if answer.outcome == CANCELLED:
            _wait_until_cancelling(handle)
            handle.canceled()
            return result
        # Before Jazzy nav2 had other numbers, and before Kilted no text.
        result.error_code = getattr(kind.Result, answer.outcome, 0)
        if hasattr(result, "error_msg"):
            result.error_msg = answer.message
        (handle.succeed if answer.poses is not None else handle.abort)()
        return result

    def _stop_of(self, handle: Message) -> Stop:
        """Return what stops the plan of a goal; it may have been cancelled before it began."""
        with self._lock:
            return self._stops.setdefault(bytes(handle.goal_id.uuid), Stop())

    def _cancel(self, handle: Message) -> None:
        self._stop_of(handle).set()

    def _answered(self, start: Message, goal: Message, stop: Stop | None = None) -> tuple[MapAnswer, Message]:
        """Return the answer to a query and its path as a message, logged and published."""
        now = self._node.now()
        query = MapQuery(start, goal, now, self._oldest, self._seconds, self._spacing)
        answer = plan_on_map(self._state, query, stop)
        self._node.counts.add(solved=answer.poses is not None, seconds=answer.seconds)
        if answer.poses is None:
            self._node.refuse(f"{answer.outcome}: {answer.message}")
            return answer, ros_message("nav_msgs/msg/Path")
        self._node.info(answer.message)
        path = path_message(ros_message, answer.poses, answer.frame, now)
        if self._plans.get_subscription_count():
            self._plans.publish(path)
        return answer, path


def _wait_until_cancelling(handle: Message) -> None:
    """Wait until rclpy has answered the request to cancel: only then a goal may be marked as cancelled."""
    waited = 0.0
    while not handle.is_cancel_requested and waited < _PATIENCE:
        time.sleep(1e-3)
        waited += 1e-3


def _robot_of(node: Node) -> MapRobot:
    """Return the robot that the parameters describe; their names are nav2's where it has them."""
    corners = node.parameter("footprint", "", "corners of the robot, as '[[0.3, 0.2], ...]', in place of robot_radius")
    robot = MapRobot(
        radius=node.parameter("robot_radius", 0.25, "radius of the robot [m]"),
        footprint=_corners(corners),
        turning_radius=node.parameter("turning_radius", 0.0, "least radius of a turn of a footprint [m]"),
        reverse=node.parameter("reverse", True, "whether a footprint may drive backwards"),
        holonomic=node.parameter("holonomic", False, "whether a footprint moves in every direction"),
        clearance=node.parameter("clearance", 0.0, "least distance from obstacles [m]"),
        occupied_from=node.parameter("occupied_from", 65, "least percentage of an obstacle"),
        unknown_is_free=node.parameter("allow_unknown", False, "whether unknown cells are free"),
    )
    require_count("the parameter occupied_from", robot.occupied_from)
    # A footprint or a radius that is none is refused now, and not with the first map.
    robot.on(GridMap(np.zeros((64, 64), dtype=bool), resolution=1e3))
    return robot


def _corners(text: str) -> tuple[tuple[float, float], ...]:
    try:
        return tuple((float(x), float(y)) for x, y in yaml.safe_load(text) or ())
    except (yaml.YAMLError, TypeError, ValueError):
        raise InvalidValue(
            f"the parameter footprint must be corners as '[[0.3, 0.2], ...]', got {shown(text)}"
        ) from None
