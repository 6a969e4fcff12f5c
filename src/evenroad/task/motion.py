"""One motion of a task: a straight line away, a plan between, a straight line to the goal, each in its own world."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from evenroad._arrays import Floats
from evenroad.planning.request import Request
from evenroad.planning.tip_motion import LINES, refused, unreached
from evenroad.roadmap import PlanResult, Status
from evenroad.roadmap.result import make_result
from evenroad.robot import ArmWorld
from evenroad.robot.cartesian_line import CartesianLine, Line, line_from
from evenroad.robot.chain import chain_of, default_tip
from evenroad.robot.constraint import Constraint, part_of
from evenroad.robot.orientation_constraint import OrientationConstraint, orientation_world
from evenroad.space.path import path_length
from evenroad.task.steps import MoveTo

PlanBetween = Callable[[Request, MoveTo], PlanResult]
"""A function that plans a request without lines, from its start to its goals in its world."""


@dataclass(frozen=True, eq=False)
class Motion:
    """The plans of a motion's parts, one to three, and the row of the goal that it ends at.

    Without a motion the only part says why, and `goal` is None.  `constraints` are those of its step, with the name of
    the link that they constrain.
    """

    parts: tuple[PlanResult, ...]
    goal: int | None = None
    constraints: Constraint | None = None

    @property
    def end(self) -> Floats:
        """Where it ends, (dim,)."""
        path = self.parts[-1].path
        assert path is not None, "only of a motion that was found"
        return path[-1]


def plan_motion(request: Request, worlds: tuple[ArmWorld, ArmWorld], step: MoveTo, plan_between: PlanBetween) -> Motion:
    """Plan one motion: the line from its start and the path between the lines in two `worlds`, the lines to its goals
    in the world of the request.
    """
    at_start, between = worlds
    if (result := unreached(request)) is not None:
        return Motion((result,))
    if (orientation := part_of(step.constraints, OrientationConstraint)) is not None and not orientation.tip:
        # The path between lines has no goal pose to take it from.
        tip = request.tip or default_tip(request.world.robot)
        step = replace(step, constraints=replace(orientation, tip=tip))
    straight = step.line(request.tip or default_tip(request.world.robot))
    if straight is None:
        middle = plan_between(replace(request, world=between), step)
        return Motion((middle,), None if middle.path is None else middle.goal_index, step.constraints)
    leaving = _line(at_start, request, step, straight, request.start, straight.retreat)
    if leaving.why:
        return Motion((refused(request, Status.NOT_CONNECTED, f"no straight line from the start: {leaving.why}"),))
    coming: dict[int, Line] = {}
    why, first = "", np.broadcast_to(leaving.path[-1], request.goals.shape)
    for row in np.argsort(request.world.space.distance(first, request.goals), kind="stable").tolist():
        last = _line(request.world, request, step, straight, request.goals[row], straight.approach)
        why = why or last.why
        if not last.why and len(coming) < LINES:
            coming[row] = last
    if not coming:
        return Motion((refused(request, Status.NOT_CONNECTED, f"no straight line to a goal: {why}"),))
    beginnings = np.array([each.path[-1] for each in coming.values()])
    middle = plan_between(Request(between, leaving.path[-1], beginnings), step)
    if middle.path is None or middle.goal_index is None:
        return Motion((replace(middle, message=f"between the straight lines: {middle.message}"),))
    row = list(coming)[middle.goal_index]
    lines = _along(at_start, leaving), middle, _along(request.world, coming[row], turned=True)
    return Motion(tuple(each for each in lines if each.path is not None and len(each.path) > 1), row, step.constraints)


def _line(world: ArmWorld, request: Request, step: MoveTo, straight: CartesianLine, q: Floats, length: float) -> Line:
    """Return the straight line from a configuration, in the orientation of the step."""
    if not world.valid(q):
        return Line(q[np.newaxis], world.explain(q))
    line = Line(q[np.newaxis])
    if length:
        line = line_from(world, chain_of(world.robot, straight.tip), straight, q, length)
    orientation = part_of(step.constraints, OrientationConstraint)
    if line.why or orientation is None:
        return line
    chain = chain_of(world.robot, orientation.tip)
    upright = orientation_world(world, chain, orientation, request.start)
    tilt = upright.largest_tilt(line.path)
    return line if tilt <= upright.tolerance else Line(line.path[:1], f"along it {upright.tilted(tilt)}")


def _along(world: ArmWorld, line: Line, *, turned: bool = False) -> PlanResult:
    """Return the plan of a straight line, whose motions are proved."""
    path = line.path[::-1].copy() if turned else line.path
    cost = path_length(path, world.space)
    off = {"line_m": line.off_m, "line_rad": line.off_rad}
    found = dict(goal_index=0, path=path, milestone_path=path, proof=world.proof, deviation=off)
    message = f"straight line of length {cost:.6g}"
    return make_result(
        world, path[0], path[-1:], Status.SOLVED, message, planner="line", cost=cost, milestone_cost=cost, **found
    )
