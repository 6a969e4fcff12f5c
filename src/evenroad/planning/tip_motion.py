"""Constraints of an arm's tip: straight lines at its start and goal, and an upright axis all along."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue
from evenroad.planning.request import Request
from evenroad.roadmap import PlanResult, Status
from evenroad.roadmap.connector import Smooth
from evenroad.roadmap.result import make_result, require_start_and_goal
from evenroad.robot import ArmWorld
from evenroad.robot.cartesian_line import CartesianLine, line_from
from evenroad.robot.cartesian_path import Followed
from evenroad.robot.chain import Chain, chain_of, default_tip
from evenroad.robot.constraint import Constraint, part_of
from evenroad.robot.orientation_constraint import OrientationConstraint, OrientationWorld, orientation_world
from evenroad.space.path import path_length
from evenroad.world import World

LINES = 16
"""Largest number of goals, the nearest to which a straight line leads."""

PlanOnce = Callable[[World, Floats, Floats, Smooth], PlanResult]
"""A function that plans in a world from a start, (dim,), to goals, (g, dim), and shortens the path or not."""


def refused(request: Request, status: Status, message: str) -> PlanResult:
    """Return the result of a plan that was not made."""
    return make_result(request.world, request.start, request.goals, status, message)


def unreached(request: Request) -> PlanResult | None:
    """Return the result where no posture reaches a pose among the goals; else None."""
    given = request.given
    if given is None or not given.unreached:
        return None
    status = Status.GOAL_INVALID if given.in_collision else Status.GOAL_UNREACHABLE
    return replace(refused(request, status, given.unreached), timings={"goals": given.seconds})


def _chain(request: Request, tip: str) -> Chain:
    """Return the chain of a link: the named one, else that of the goal poses, else the last one."""
    robot = request.world.robot
    return chain_of(robot, tip or request.tip or default_tip(robot))


@dataclass(frozen=True)
class TipMotion:
    """How an arm moves under constraints of its tip: along Cartesian lines, with an orientation, or both."""

    line: CartesianLine | None = None
    orientation: OrientationConstraint | None = None

    @classmethod
    def of(cls, constraints: Constraint | None) -> TipMotion:
        """Return the motion under these constraints; InvalidValue for what is no constraint."""
        return cls(part_of(constraints, CartesianLine), part_of(constraints, OrientationConstraint))

    def plan(self, request: Request, plan_once: PlanOnce, smooth: Smooth) -> PlanResult:
        """Plan with `plan_once` under the constraints.

        Lines come first: the plan leads from the end of the line at the start to the beginnings of the lines to goals.
        The result has the largest deviations, measured on fine grids.
        """
        world = request.world
        if not isinstance(world, ArmWorld):
            raise InvalidValue(f"constraints are those of an arm's tip, got {world!r}")
        if self.orientation is None:
            return _between_lines(request, self.line, plan_once, world, smooth)
        oriented = orientation_world(world, _chain(request, self.orientation.tip), self.orientation, request.start)
        if (tilted := _tilted(request, oriented)) is not None:
            return tilted

        def plan_with_orientation(_: World, start: Floats, goals: Floats, smooth: Smooth) -> PlanResult:
            return _through(oriented, plan_once(oriented, start, goals, False), smooth)

        return _between_lines(request, self.line, plan_with_orientation, oriented, smooth)


def _tilted(request: Request, world: OrientationWorld) -> PlanResult | None:
    """Return a result if the start, or every goal, is tilted too much."""
    start, goals = world.tilts(request.start[np.newaxis])[0], world.tilts(request.goals)
    if start > world.tolerance:
        return refused(request, Status.START_INVALID, f"at the start {world.explain(request.start)}")
    if goals.min() > world.tolerance:
        best = request.goals[int(goals.argmin())]
        which = "the goal" if len(goals) == 1 else f"every one of {len(goals)} goals; at the nearest"
        return refused(request, Status.GOAL_INVALID, f"at {which} {world.explain(best)}")
    return None


def _through(world: OrientationWorld, result: PlanResult, shorten: Smooth) -> PlanResult:
    """Return a plan along upright milestones with all states of its path, and its largest tilt."""
    if result.path is None:
        return result
    path, tilt = world.path_through(result.path, shorten=bool(shorten))
    if tilt > world.tolerance:
        message = f"on the path that was found {world.tilted(tilt)}"
        return replace(result, status=Status.NOT_CONNECTED, message=message, path=None, cost=None, proof=None)
    raw = path if not shorten else world.path_through(result.path, shorten=False)[0]
    return _with_path(world, result, path, raw, {"tilt_rad": tilt})


def _between_lines(
    request: Request, straight: CartesianLine | None, plan: PlanOnce, within: World, shorten: Smooth
) -> PlanResult:
    """Plan between the lines that leave the start and lead to goals."""
    if straight is None:
        return plan(request.world, request.start, request.goals, shorten)
    chain = _chain(request, straight.tip)
    free = within.valid(np.concatenate([request.start[np.newaxis], request.goals]))
    if not free[0] or not free[1:].any():
        # The planner says what blocks.
        return plan(request.world, request.start, request.goals, shorten)
    leaving = Followed(request.start[np.newaxis])
    if straight.retreat:
        leaving = _line(within, request.world, chain, straight, request.start, straight.retreat)
        if leaving.why:
            return refused(request, Status.NOT_CONNECTED, f"no straight line from the start: {leaving.why}")
    rows = np.flatnonzero(free[1:])
    first, why = np.broadcast_to(leaving.path[-1], request.goals[rows].shape), ""
    rows = rows[np.argsort(request.world.space.distance(first, request.goals[rows]), kind="stable")]
    coming: dict[int, Followed] = {}
    for row in rows.tolist():
        line = Followed(request.goals[row : row + 1])
        if straight.approach:
            line = _line(within, request.world, chain, straight, request.goals[row], straight.approach)
        if line.why:
            why = why or line.why
            continue
        coming[row] = line
        if len(coming) == LINES:
            break
    if not coming:
        every = "the goal" if len(rows) == 1 else f"any of {len(rows)} goals; to the nearest"
        return refused(request, Status.NOT_CONNECTED, f"no straight line to {every}: {why}")
    beginnings = np.array([line.path[-1] for line in coming.values()])
    result = plan(request.world, leaving.path[-1], beginnings, shorten)
    result = replace(result, start=request.start, goals=request.goals)
    if result.path is None or result.goal_index is None:
        return replace(result, message=f"between the straight lines: {result.message}")
    row, last = list(coming.items())[result.goal_index]
    result = replace(result, goal_index=row)
    raw = result.path if result.milestone_path is None else result.milestone_path
    whole = [np.concatenate([leaving.path[:-1], waypoints, last.path[::-1][1:]]) for waypoints in (result.path, raw)]
    off = {name: max(getattr(leaving, name), getattr(last, name)) for name in ("off_m", "off_rad")}
    deviation = result.deviation | {"line_m": off["off_m"], "line_rad": off["off_rad"]}
    if isinstance(within, OrientationWorld):
        tilted = [within.largest_tilt(line.path) for line in (leaving, last)]
        deviation |= {"tilt_rad": max(deviation.get("tilt_rad", 0.0), *tilted)}
    return _with_path(request.world, result, whole[0], whole[1], deviation)


def _line(within: World, world: ArmWorld, chain: Chain, straight: CartesianLine, q: Floats, length: float) -> Followed:
    """Return a straight line, or refuse it where it tilts what has to stay upright, maybe another link."""
    line = line_from(world, chain, straight, q, length)
    if line.why or not isinstance(within, OrientationWorld):
        return line
    if (tilt := within.largest_tilt(line.path)) <= within.tolerance:
        return line
    return Followed(line.path[:1], f"along it {within.tilted(tilt)}")


def _with_path(world: World, result: PlanResult, path: Floats, raw: Floats, deviation: dict[str, float]) -> PlanResult:
    """Return a result with another path."""
    cost, raw_cost = (path_length(waypoints, world.space) for waypoints in (path, raw))
    to = f" to goal {result.goal_index}" if len(result.goals) > 1 else ""
    off = ", ".join(f"{name.replace('_', ' [')}] {value:.2g}" for name, value in deviation.items())
    changed = replace(
        result,
        path=path,
        milestone_path=raw,
        world=world,
        cost=cost,
        milestone_cost=raw_cost,
        deviation=deviation,
        message=f"path of length {cost:.6g} with {len(path)} waypoints{to}; largest deviations: {off}",
    )
    return require_start_and_goal(world.space, changed)
