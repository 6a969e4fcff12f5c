"""Ways that an arm's tip is told to take: straight to its goal and from its start, upright all along."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from evenroad._arrays import Floats
from evenroad.roadmap import PlanResult, Status
from evenroad.roadmap.find_path import NO_POINTS
from evenroad.roadmap.result import require_ends
from evenroad.robot import ArmWorld
from evenroad.robot.chain import Chain, chain_of, default_tip
from evenroad.robot.straight import Line, Straight, line_from
from evenroad.robot.upright import Upright, UprightWorld, upright_world
from evenroad.space.path import path_length
from evenroad.world import World

LINES = 16
"""Goals that are planned to, the nearest to which a straight line leads."""

Planner = Callable[[World, Floats, Floats, bool], PlanResult]
"""Plans in a world from a start, (dim,), to goals, (g, dim), and shortens the path or not."""


@dataclass(frozen=True, eq=False)
class Ends:
    """A world, a start, (dim,), goals, (g, dim), and the tip that goal poses are of, or nothing."""

    world: ArmWorld
    start: Floats
    goals: Floats
    tip: str = ""

    def chain(self, tip: str) -> Chain:
        """Return the chain of a link: the one named, else that of the goal poses, else the last one."""
        robot = self.world.robot
        return chain_of(robot, tip or self.tip or default_tip(robot))

    def refused(self, status: Status, message: str) -> PlanResult:
        """Return the result of a plan that was not made."""
        places = dict(start=self.start, goals=self.goals, origin=NO_POINTS, rule="none", planner="none")
        return PlanResult(status=status, message=message, **places)  # type: ignore[arg-type]


def plan_ways(
    ends: Ends, straight: Straight | None, upright: Upright | None, plan: Planner, *, shorten: bool = True
) -> PlanResult:
    """Plan with `plan` so that the tip takes the ways it is told to, if any.

    Lines come first: the plan goes from the end of the one that leaves the start to the beginnings of those that lead
    to goals.  The largest deviations, on fine grids, are in the result.
    """
    if upright is None:
        return _between_lines(ends, straight, plan, ends.world, shorten)
    world = upright_world(ends.world, ends.chain(upright.tip), upright, ends.start)
    if (refused := _tilted(ends, world)) is not None:
        return refused

    def plan_upright(_: World, start: Floats, goals: Floats, shorten: bool) -> PlanResult:
        return _through(world, plan(world, start, goals, False), shorten)

    return _between_lines(ends, straight, plan_upright, world, shorten)


def _tilted(ends: Ends, world: UprightWorld) -> PlanResult | None:
    """Return the result where the start, or every goal, is tilted by too much."""
    start, goals = world.tilts(ends.start[np.newaxis])[0], world.tilts(ends.goals)
    if start > world.tolerance:
        return ends.refused(Status.START_INVALID, f"at the start {world.explain(ends.start)}")
    if goals.min() > world.tolerance:
        best = ends.goals[int(goals.argmin())]
        which = "the goal" if len(goals) == 1 else f"every one of {len(goals)} goals; at the nearest"
        return ends.refused(Status.GOAL_INVALID, f"at {which} {world.explain(best)}")
    return None


def _through(world: UprightWorld, result: PlanResult, shorten: bool) -> PlanResult:
    """Return a plan along upright milestones with all states of its path, and its largest tilt."""
    if result.path is None:
        return result
    path, tilt = world.path_through(result.path, shorten=shorten)
    if tilt > world.tolerance:
        message = f"on the path that was found {world.tilted(tilt)}"
        return replace(result, status=Status.NOT_CONNECTED, message=message, path=None, cost=None, proof=None)
    raw = path if not shorten else world.path_through(result.path, shorten=False)[0]
    return _with_path(world, result, path, raw, {"tilt_rad": tilt})


def _between_lines(
    ends: Ends, straight: Straight | None, plan: Planner, within: World, shorten: bool
) -> PlanResult:
    """Plan between the lines that leave the start and lead to goals."""
    if straight is None:
        return plan(ends.world, ends.start, ends.goals, shorten)
    chain, free = ends.chain(straight.tip), within.valid(np.concatenate([ends.start[np.newaxis], ends.goals]))
    if not free[0] or not free[1:].any():
        # The planner says what is in the way.
        return plan(ends.world, ends.start, ends.goals, shorten)
    leaving = Line(ends.start[np.newaxis])
    if straight.retreat:
        leaving = _line(within, ends.world, chain, straight, ends.start, straight.retreat)
        if leaving.why:
            return ends.refused(Status.NOT_CONNECTED, f"no straight way from the start: {leaving.why}")
    rows = np.flatnonzero(free[1:])
    first, why = np.broadcast_to(leaving.path[-1], ends.goals[rows].shape), ""
    rows = rows[np.argsort(ends.world.space.distance(first, ends.goals[rows]), kind="stable")]
    coming: dict[int, Line] = {}
    for row in rows.tolist():
        line = Line(ends.goals[row : row + 1])
        if straight.approach:
            line = _line(within, ends.world, chain, straight, ends.goals[row], straight.approach)
        if line.why:
            why = why or line.why
            continue
        coming[row] = line
        if len(coming) == LINES:
            break
    if not coming:
        every = "the goal" if len(rows) == 1 else f"any of {len(rows)} goals; to the nearest"
        return ends.refused(Status.NOT_CONNECTED, f"no straight way to {every}: {why}")
    beginnings = np.array([line.path[-1] for line in coming.values()])
    result = plan(ends.world, leaving.path[-1], beginnings, shorten)
    result = replace(result, start=ends.start, goals=ends.goals)
    if result.path is None or result.goal_index is None:
        return replace(result, message=f"between the straight lines: {result.message}")
    row, last = list(coming.items())[result.goal_index]
    result = replace(result, goal_index=row)
    raw = result.path if result.milestone_path is None else result.milestone_path
    whole = [np.concatenate([leaving.path[:-1], way, last.path[::-1][1:]]) for way in (result.path, raw)]
    off = {name: max(getattr(leaving, name), getattr(last, name)) for name in ("off_m", "off_rad")}
    deviation = result.deviation | {"line_m": off["off_m"], "line_rad": off["off_rad"]}
    if isinstance(within, UprightWorld):
        tilted = [within.largest_tilt(line.path) for line in (leaving, last)]
        deviation |= {"tilt_rad": max(deviation.get("tilt_rad", 0.0), *tilted)}
    return _with_path(ends.world, result, whole[0], whole[1], deviation)


def _line(within: World, world: ArmWorld, chain: Chain, straight: Straight, q: Floats, length: float) -> Line:
    """Return a straight line, also refused where it tilts what is to be upright: that may be another link."""
    line = line_from(world, chain, straight, q, length)
    if line.why or not isinstance(within, UprightWorld):
        return line
    if (tilt := within.largest_tilt(line.path)) <= within.tolerance:
        return line
    return Line(line.path[:1], f"along it {within.tilted(tilt)}")


def _with_path(
    world: World, result: PlanResult, path: Floats, raw: Floats, deviation: dict[str, float]
) -> PlanResult:
    """Return a result with another path."""
    cost, raw_cost = (path_length(way, world.space) for way in (path, raw))
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
    return require_ends(world.space, changed)
