"""Plans of an arm under constraints: straight lines of its tip at start and goal, and bounds along the whole path."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from itertools import pairwise

import numpy as np

from evenroad._arrays import Floats
from evenroad._time_limit import BudgetSpent
from evenroad.collision.arm_world import ArmWorld
from evenroad.constraints.constrained_world import KeptWorld, keeps_of, kept_line, kept_world
from evenroad.constraints.differential_drive import DifferentialDrive, driven_world
from evenroad.errors import InvalidValue
from evenroad.planning.connector import Smooth
from evenroad.planning.make_result import led, make_result, solution
from evenroad.planning.problem import Problem
from evenroad.planning.result import PlanResult, Status
from evenroad.poses.cartesian_line import CartesianLine, line_from
from evenroad.poses.cartesian_path import Followed
from evenroad.poses.chain import Chain, chain_of, default_tip
from evenroad.poses.constraint import part_of
from evenroad.space.path import path_length
from evenroad.world import World

LINES = 16
"""Largest number of nearest goals to which straight lines are planned."""

_TRIED = 0, 1, 4, 16
"""Bounds of the groups of nearest goals to which one motion is tried, group by group, before trees grow."""

PlanOnce = Callable[[Problem], PlanResult]
"""A function that plans without constraints."""


def plan_constrained(problem: Problem, plan_once: PlanOnce) -> PlanResult:
    """Plan under the constraints of a problem by `plan_once`; the result has bounds on the largest deviations.

    Lines are planned first.  The plan then leads from the end of the line at the start to the beginnings of the lines
    to goals.
    """
    world, constraints = problem.world, problem.constraints
    line, keeps, drive = (
        part_of(constraints, CartesianLine),
        keeps_of(constraints),
        part_of(constraints, DifferentialDrive),
    )
    if not isinstance(world, ArmWorld):
        raise InvalidValue(f"constraints are those of an arm, got {world!r}")
    problem = replace(problem, constraints=None)
    if drive is None and not keeps:
        return _between_lines(problem, line, plan_once, world)
    if drive is not None:
        if keeps or line is not None:
            raise InvalidValue("a base that cannot go sideways goes without other constraints")
        kept: KeptWorld = driven_world(world, drive)
    else:
        kept = kept_world(world, keeps, problem.start, problem.tip)
        if (refusal := _off(problem, kept)) is not None:
            return refusal

    def plan_kept(part: Problem) -> PlanResult:
        inside = replace(part, world=kept)
        found = _walked(inside, kept)
        return _through(kept, plan_once(replace(inside, smooth=False)), part.smooth) if found is None else found

    return _between_lines(problem, line, plan_kept, kept)


def _chain(problem: Problem, world: ArmWorld, tip: str) -> Chain:
    """Return the chain of a link: the named one, else that of the goal poses, else the last one."""
    return chain_of(world.robot, tip or problem.tip or default_tip(world.robot))


def _off(problem: Problem, world: KeptWorld) -> PlanResult | None:
    """Return a result if the start, or every goal, is off the constraints."""
    start, goals = world.shares(problem.start[np.newaxis])[0], world.shares(problem.goals)
    if start.max() > 1.0:
        return make_result(problem, Status.START_INVALID, f"at the start {world.exceeded(start)}")
    if goals.max(axis=1).min() > 1.0:
        best = goals[int(goals.max(axis=1).argmin())]
        which = "the goal" if len(goals) == 1 else f"every one of {len(goals)} goals; at the nearest"
        return make_result(problem, Status.GOAL_INVALID, f"at {which} {world.exceeded(best)}")
    return None


def _walked(problem: Problem, world: KeptWorld) -> PlanResult | None:
    """Return the plan along one motion to one of the nearest goals; None where there is none."""
    start, goals = problem.start, problem.goals
    if not world.valid(start[np.newaxis])[0]:
        return None
    away = world.space.distance(np.broadcast_to(start, goals.shape), goals)
    rows = np.flatnonzero(world.valid(goals))
    rows = rows[np.argsort(away[rows], kind="stable")]
    for begin, end in pairwise(_TRIED):
        some = rows[begin:end]
        row, path = world.first_along(np.repeat(start[np.newaxis], len(some), axis=0), goals[some])
        if row >= 0:
            # A single motion is the shortest path.
            result = solution(problem, path, int(some[row]), planner="trees")
            return _with_path(world, result, path, path, world.deviation(world.largest(path)))
    return None


def _through(world: KeptWorld, result: PlanResult, shorten: Smooth) -> PlanResult:
    """Return a plan along projected milestones, with all states of its path and its largest deviations."""
    if result.path is None:
        return result
    raw = world.path_through(result.path)
    path = raw
    with suppress(BudgetSpent):
        path = world.shortened(raw) if shorten else raw
    return _with_path(world, result, path, raw, world.deviation(world.largest(path)))


def _between_lines(
    problem: Problem, straight: CartesianLine | None, plan: PlanOnce, within: ArmWorld | KeptWorld
) -> PlanResult:
    """Plan between the lines that leave the start and lead to goals."""
    if straight is None:
        return plan(problem)
    world, start, goals = problem.world, problem.start, problem.goals
    assert isinstance(world, ArmWorld), "only arms have constraints"
    if problem.given is not None:
        # Other lines may lead to other postures, so nothing is proved about poses.
        between = replace(problem, given=replace(problem.given, poses=(), whole=False))
    else:
        between = problem
    free = within.valid(problem.start_and_goals)
    if not free[0] or not free[1:].any():
        # The planner says what blocks.
        return plan(between)
    chain = _chain(problem, world, straight.tip)
    leaving = Followed(start[np.newaxis])
    if straight.retreat:
        leaving = _line(within, world, chain, straight, start, straight.retreat)
        if leaving.why:
            return make_result(problem, Status.NOT_CONNECTED, f"no straight line from the start: {leaving.why}")
    rows = np.flatnonzero(free[1:])
    first, why = np.broadcast_to(leaving.path[-1], goals[rows].shape), ""
    rows = rows[np.argsort(world.space.distance(first, goals[rows]), kind="stable")]
    coming: dict[int, Followed] = {}
    for row in rows.tolist():
        line = Followed(goals[row : row + 1])
        if straight.approach:
            line = _line(within, world, chain, straight, goals[row], straight.approach)
        if line.why:
            why = why or line.why
            continue
        coming[row] = line
        if len(coming) == LINES:
            break
    if not coming:
        every = "the goal" if len(rows) == 1 else f"any of {len(rows)} goals; to the nearest"
        return make_result(problem, Status.NOT_CONNECTED, f"no straight line to {every}: {why}")
    beginnings = np.array([line.path[-1] for line in coming.values()])
    result = plan(replace(between, start=leaving.path[-1], goals=beginnings))
    result = replace(result, start=start, goals=goals)
    if result.path is None or result.goal_index is None:
        return replace(result, message=f"between the straight lines: {result.message}")
    row, last = list(coming.items())[result.goal_index]
    result = replace(result, goal_index=row)
    raw = result.path if result.milestone_path is None else result.milestone_path
    whole = [np.concatenate([leaving.path[:-1], waypoints, last.path[::-1][1:]]) for waypoints in (result.path, raw)]
    off = {name: max(getattr(leaving, name), getattr(last, name)) for name in ("off_m", "off_rad")}
    deviation = result.deviation | {"line_m": off["off_m"], "line_rad": off["off_rad"]}
    if isinstance(within, KeptWorld):
        deviation |= within.deviation(within.largest(whole[0]))
    return _with_path(world, result, whole[0], whole[1], deviation)


def _line(within: World, world: ArmWorld, chain: Chain, straight: CartesianLine, q: Floats, length: float) -> Followed:
    """Return a straight line, or refuse it if it violates constraints, perhaps those of another link."""
    line = line_from(world, chain, straight, q, length)
    return line if line.why or not isinstance(within, KeptWorld) else kept_line(within, line)


def _with_path(world: World, result: PlanResult, path: Floats, raw: Floats, deviation: dict[str, float]) -> PlanResult:
    """Return a result with another path."""
    cost, raw_cost = (path_length(waypoints, world.space) for waypoints in (path, raw))
    to = f" to goal {result.goal_index}" if len(result.goals) > 1 else ""
    off = ", ".join(f"{name.replace('_', ' [')}] {value:.2g}" for name, value in deviation.items())
    largest = f"; largest deviations: {off}" if off else ""
    changed = replace(
        result,
        path=path,
        milestone_path=raw,
        world=world,
        cost=cost,
        milestone_cost=raw_cost,
        deviation=deviation,
        message=f"path of length {cost:.6g} with {len(path)} waypoints{to}{largest}",
    )
    return led(world, changed)
