"""Motions of a task: the fixed lines and curves of each, and the plan of the path between."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from evenroad._arrays import Floats
from evenroad._time_limit import look_at_clock
from evenroad.collision.arm_world import ArmWorld
from evenroad.constraints.constrained_world import keeps_of, kept_line, kept_world
from evenroad.planning.make_result import led, make_result, solution, unreached
from evenroad.planning.problem import Problem
from evenroad.planning.result import PlanResult, Status
from evenroad.poses.cartesian_line import CartesianLine, line_from
from evenroad.poses.cartesian_path import Followed
from evenroad.poses.chain import chain_of, default_tip
from evenroad.poses.constraint import Constraint, with_tip
from evenroad.space.path import continued, path_length
from evenroad.task.steps import MoveTo

PlanBetween = Callable[[Problem, Constraint | None], PlanResult]
"""A function that plans a problem without lines, from its start to its goals in its world."""


@dataclass(frozen=True, eq=False)
class Motion:
    """The plans of a motion's parts, and the row of the goal that it ends at.

    If there is no motion, the only part says why, and `goal` is None.  `constraints` are those of its step, with the
    name of the constrained link.  `speed` is the largest speed of the link `tip`, if its step has one [m/s].  If the
    arm stays and `fingers` move, these are their last values, joint -> value, and the parts are plans of these joints.
    """

    parts: tuple[PlanResult, ...]
    goal: int | None = None
    constraints: Constraint | None = None
    speed: float | None = None
    tip: str = ""
    fingers: Mapping[str, float] = field(default_factory=dict)

    @property
    def end(self) -> Floats:
        """Its last configuration, (dim,)."""
        path = self.parts[-1].path
        assert path is not None, "only of a motion that was found"
        last: Floats = path[-1]
        return last

    def gone_on(self, at: Floats) -> Motion:
        """Return the motion shifted by whole turns to begin at the exact numbers of a configuration, (dim,)."""
        parts: list[PlanResult] = []
        for part in () if self.fingers else self.parts:
            parts.append(_turned(part, at))
            path = parts[-1].path
            assert path is not None, "only of a motion that was found"
            at = path[-1]
        return self if self.fingers else replace(self, parts=tuple(parts))


@dataclass(eq=False)
class Leg:
    """A choice for one motion: its fixed parts before and after the path that is planned between them.

    Without a `between`, all is fixed.  `planned` stores the motion once it is planned.
    """

    end: Floats
    before: tuple[PlanResult, ...] = ()
    between: Problem | None = None
    after: tuple[PlanResult, ...] = ()
    motion: Motion = field(default_factory=lambda: Motion(()))
    planned: Motion | None = None

    @cached_property
    def cost(self) -> float:
        """Length of the fixed parts and of the straight motion between; no motion of this choice is shorter."""
        total = sum(each.cost or 0.0 for each in (*self.before, *self.after))
        if self.between is not None:
            space = self.between.world.space
            start = np.broadcast_to(self.between.start, self.between.goals.shape)
            total += float(space.distance(start, self.between.goals).min())
        return total

    def plan(self, plan_between: PlanBetween) -> Motion:
        """Return the motion, planned once."""
        if self.planned is None:
            middle: tuple[PlanResult, ...] = ()
            if self.between is not None:
                found = plan_between(self.between, self.motion.constraints)
                if found.path is None:
                    prefix = "between the straight lines: " if self.before or self.after else ""
                    self.planned = Motion((replace(found, message=prefix + found.message),))
                    return self.planned
                middle = (found,)
                self.motion = replace(
                    self.motion, goal=found.goal_index if self.motion.goal is None else self.motion.goal
                )
            self.planned = replace(self.motion, parts=(*self.before, *middle, *self.after))
        return self.planned


def choices(
    problem: Problem, worlds: tuple[ArmWorld, ArmWorld], step: MoveTo, tip: str, *, last: bool
) -> Iterator[Leg | PlanResult]:
    """Yield the choices of a motion to goals, nearest first, or why there is none.

    Each pose gets one choice before any pose gets a second.  The line from the start and the path between the lines are
    in two `worlds`; lines to goals are in that of the problem.  They are lines of `tip`; default: that of the goals, or
    the last link.  Nothing depends on the end of a task's `last` motion, so without lines the planner chooses it.
    """
    look_at_clock()
    at_start, between = worlds
    if (result := unreached(problem)) is not None:
        yield result
        return
    tip = problem.tip or tip
    straight = step.line(tip or default_tip(problem.arm.robot)) if step.approach or step.retreat else None
    if step.constraints is not None:
        # The path between lines has no goal pose, and therefore no tip.
        last_link = tip or default_tip(problem.arm.robot)
        step = replace(step, constraints=with_tip(step.constraints, last_link))
    if straight is None and last:
        yield Leg(problem.goals[0], (), replace(problem, world=between), (), Motion((), None, step.constraints))
        return
    leaving = Followed(problem.start[np.newaxis])
    if straight is not None:
        leaving = _line(at_start, problem, step, straight, problem.start, straight.retreat)
        if leaving.why:
            yield make_result(problem, Status.NOT_CONNECTED, f"no straight line from the start: {leaving.why}")
            return
    before, why, any_ = _along(at_start, leaving), "", False
    for row in _in_turn(problem, leaving.path[-1]):
        coming = Followed(problem.goals[row : row + 1])
        if straight is not None:
            coming = _line(problem.arm, problem, step, straight, problem.goals[row], straight.approach)
        why = why or coming.why
        if coming.why:
            continue
        any_ = True
        middle = replace(problem, world=between, start=leaving.path[-1], goals=coming.path[-1:], given=None)
        after = _along(problem.arm, coming, turned=True)
        yield Leg(problem.goals[row], before, middle, after, Motion((), row, step.constraints))
    if not any_:
        yield make_result(problem, Status.NOT_CONNECTED, f"no straight line to a goal: {why}")


def along(world: ArmWorld, followed: Followed, motion: Motion) -> Leg:
    """Return the motion along a curve; it has one part between two stops."""
    rows = [0, *followed.stops, len(followed.path) - 1]
    parts = [_part(world, replace(followed, path=followed.path[a : b + 1]), "curve") for a, b in pairwise(rows)]
    return Leg(followed.path[-1], tuple(parts), None, (), motion)


def _turned(part: PlanResult, at: Floats) -> PlanResult:
    """Return a plan shifted by whole turns to begin at the exact numbers of a configuration, (dim,)."""
    assert part.world is not None, "only of a motion that was planned"
    assert part.path is not None, "only of a motion that was found"
    path = continued(part.path, part.world.space, at)
    if path is part.path:
        return part
    return led(part.world, replace(part, start=path[0], goals=part.goals + (path[0] - part.start), path=path))


def _in_turn(problem: Problem, first: Floats) -> list[int]:
    """Return the rows of goals: the nearest one for each pose, nearest first, then the second one, and so on."""
    goals = problem.goals
    away = problem.world.space.distance(np.broadcast_to(first, goals.shape), goals)
    poses = [] if problem.given is None else [len(reached.configurations) for _, reached in problem.given.poses]
    of_pose = np.arange(len(goals)) if sum(poses) != len(goals) else np.repeat(np.arange(len(poses)), poses)
    order = np.argsort(away, kind="stable")
    rank, seen = np.zeros(len(goals), dtype=np.int64), dict.fromkeys(of_pose.tolist(), 0)
    for row in order.tolist():
        rank[row] = seen[of_pose[row]]
        seen[of_pose[row]] += 1
    return [int(row) for row in np.lexsort((away, rank))]


def _line(
    world: ArmWorld, problem: Problem, step: MoveTo, straight: CartesianLine, q: Floats, length: float
) -> Followed:
    """Return the straight line from a configuration that keeps the constraints of the step."""
    look_at_clock()
    if not world.valid(q):
        return Followed(q[np.newaxis], world.explain(q))
    line = Followed(q[np.newaxis])
    if length:
        line = line_from(world, chain_of(world.robot, straight.tip), straight, q, length)
    keeps = keeps_of(step.constraints)
    return line if line.why or not keeps else kept_line(kept_world(world, keeps, problem.start, ""), line)


def _along(world: ArmWorld, line: Followed, *, turned: bool = False) -> tuple[PlanResult, ...]:
    """Return the plan of a straight line, if it has a length."""
    if len(line.path) < 2:
        return ()
    return (_part(world, replace(line, path=line.path[::-1].copy()) if turned else line, "line"),)


def _part(world: ArmWorld, line: Followed, kind: str) -> PlanResult:
    """Return the plan of a line or a curve, whose motions are proved."""
    path, cost = line.path, path_length(line.path, world.space)
    message = f"{'straight line' if kind == 'line' else 'curve'} of length {cost:.6g}"
    off = {f"{kind}_m": line.off_m, f"{kind}_rad": line.off_rad}
    return solution(Problem(world, path[0], path[-1:]), path, cost=cost, message=message, planner=kind, deviation=off)
