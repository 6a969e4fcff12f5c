"""One query on a map: stamped poses in, poses along a path out, with the outcome in nav2's words."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter

import numpy as np

from evenroad._arrays import Floats
from evenroad._time_limit import Stop, stopped_by
from evenroad.driving.car_world import CarWorld
from evenroad.errors import EvenroadError, InvalidValue
from evenroad.planning.plan import plan
from evenroad.planning.result import PlanResult, Status
from evenroad.ros2.map_state import MapState
from evenroad.ros2.messages import Message, planar_pose, require_recent, seconds_of

OUTCOMES = {
    Status.SOLVED: "NONE",
    Status.START_INVALID: "START_OCCUPIED",
    Status.GOAL_INVALID: "GOAL_OCCUPIED",
    Status.START_OUTSIDE_LIMITS: "START_OUTSIDE_MAP",
    Status.GOAL_OUTSIDE_LIMITS: "GOAL_OUTSIDE_MAP",
    Status.NOT_CONNECTED: "NO_VALID_PATH",
    Status.BUDGET_SPENT: "TIMEOUT",
}
"""Status of a plan -> the error code of ``nav2_msgs/ComputePathToPose``; of all others UNKNOWN."""
CANCELLED = "CANCELLED"
"""Outcome of a query that was stopped from outside; nav2 has no error code for it."""


@dataclass(frozen=True)
class MapQuery:
    """Two ``geometry_msgs/PoseStamped``, and how to plan between them.

    `now` is the node's clock [s], `oldest` the largest age of a stamp [s], 0 for any.  `spacing` is the largest
    distance between poses of the path [m], 0 for waypoints alone.
    """

    start: Message
    goal: Message
    now: float = 0.0
    oldest: float = 0.0
    seconds: float = 5.0
    spacing: float = 0.05


@dataclass(frozen=True)
class MapAnswer:
    """Poses of a path, (p, 3): x, y, angle, or None; its frame, the outcome, and in words why [s]."""

    outcome: str
    message: str
    seconds: float
    frame: str = ""
    poses: Floats | None = None


def plan_on_map(state: MapState, query: MapQuery, stop: Stop | None = None) -> MapAnswer:
    """Return the answer to one query; invalid input is an answer, too, as nav2 has it."""
    began = perf_counter()
    try:
        found = state.world()
    except EvenroadError as error:
        return MapAnswer("UNKNOWN", str(error), perf_counter() - began)
    try:
        _require_frames(query, found.frame)
    except InvalidValue as error:
        return MapAnswer("TF_ERROR", str(error), perf_counter() - began)
    try:
        start, goal = planar_pose(query.start.pose, "the start"), planar_pose(query.goal.pose, "the goal")
        dim = 3 if isinstance(found.world, CarWorld) else 2
        with stopped_by(Stop() if stop is None else stop):
            result = plan(found.world, start[:dim], goal[:dim], seconds=query.seconds)
    except EvenroadError as error:
        return MapAnswer("UNKNOWN", str(error), perf_counter() - began)
    took = perf_counter() - began
    if stop is not None and stop.is_set:
        return MapAnswer(CANCELLED, "the query was cancelled", took)
    outcome = OUTCOMES.get(result.status, "UNKNOWN")
    if result.path is None or not result.solved:
        return MapAnswer(outcome, result.message, took)
    poses = poses_along(result, query.spacing, goal[2])
    return MapAnswer(outcome, result.message, took, found.frame, poses)


def _require_frames(query: MapQuery, frame: str) -> None:
    stamped = {"the start": query.start.header, "the goal": query.goal.header}
    for what, header in stamped.items():
        if header.frame_id != frame:
            raise InvalidValue(f"{what} is in frame {str(header.frame_id)!r}, the map in {frame!r}")
    stamps = [(what, seconds_of(header.stamp)) for what, header in stamped.items()]
    require_recent(stamps, query.now, query.oldest)


def poses_along(result: PlanResult, spacing: float, last: float) -> Floats:
    """Return the poses of a path, (p, 3), at most `spacing` apart.

    Those of a disk face the next one, and the last is turned to the angle `last`.
    """
    assert result.path is not None
    path = result.path if spacing == 0.0 else result.resample(spacing)
    if path.shape[1] == 3:
        return path
    steps = np.diff(path, axis=0)
    return np.column_stack([path, [*np.arctan2(steps[:, 1], steps[:, 0]), last]])
