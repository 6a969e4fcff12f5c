"""``evenroad plan --via``: one plan through points on the way, each passed exactly."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import reduce
from operator import and_

import numpy as np

from evenroad._arrays import Floats
from evenroad.cli.plan import PlanArm
from evenroad.collision.arm_world import ArmWorld
from evenroad.constraints.constrained_world import keeps_of
from evenroad.errors import EvenroadError, InvalidValue
from evenroad.planning.finish import finished
from evenroad.planning.make_result import make_result, solution
from evenroad.planning.problem import Problem
from evenroad.planning.read_problem import problem_in
from evenroad.planning.reading import Goal, Reading
from evenroad.planning.result import PlanResult
from evenroad.planning.terminals import SAME
from evenroad.poses.cartesian_line import CartesianLine
from evenroad.poses.constraint import part_of
from evenroad.poses.pose_goal import pose_goal_of
from evenroad.task import MoveTo, Task
from evenroad.task.contact import depth_in
from evenroad.task.solve import plan_task
from evenroad.trajectory import Trajectory


def plan_through(
    plan: PlanArm, problem: Problem, goals: Sequence[Goal]
) -> tuple[PlanResult, Callable[..., Trajectory]]:
    """Return a plan through all points of ``--via``, and what makes its trajectory, which stops there.

    Postures at poses on the way are chosen for the whole plan.  Raises InvalidValue for a point in collision, or
    outside of the limits: which, where, and by how much.
    """
    world, constraints = problem.world, problem.constraints
    assert isinstance(world, ArmWorld), "only arms have points on the way"
    reading = Reading(plan.deg, plan.tip, plan.frame)
    line = part_of(constraints, CartesianLine)
    keeps = keeps_of(constraints)
    kept = reduce(and_, keeps) if keeps else None
    steps = [MoveTo(_point(plan, world, number, reading), constraints=kept) for number in range(len(plan.via))]
    steps.append(MoveTo(list(goals), constraints=kept))
    if line is not None:
        steps[0] = replace(steps[0], retreat=line.retreat, away=line.away)
        steps[-1] = replace(steps[-1], approach=line.approach, away=line.away)
    done = plan_task(
        Task(steps).steps,
        world,
        problem.start,
        reading,
        seconds=problem.budget.seconds,
        smooth=problem.smooth,
        rng=problem.rng,
    )
    if not done.solved:
        step = done.step or 0
        which = f"via point {step + 1}" if step < len(plan.via) else "the goal"
        message = done.message.replace(f"step {step} of the task cannot be done", f"{which} cannot be reached")
        return finished(problem, make_result(problem, done.status, message)), done.trajectory
    path = done.path
    assert path is not None, "a solved task has a path"
    rows = np.flatnonzero(world.space.distance(problem.goals, np.broadcast_to(path[-1], problem.goals.shape)) <= SAME)
    known, row = (problem.goals, int(rows[0])) if len(rows) else (path[-1:], 0)
    order = ("resolution", "certified", "exact")
    proof = min((part.proof or "resolution" for part in done.parts), key=order.index)
    points = f"{len(plan.via)} point{'s' if len(plan.via) > 1 else ''} on the way"
    message = f"path of length {done.cost:.6g} with {len(path)} waypoints through {points}"
    deviation: dict[str, float] = {}
    for part in done.parts:
        deviation |= {name: max(off, deviation.get(name, 0.0)) for name, off in part.deviation.items()}
    result = solution(
        replace(problem, goals=known),
        path,
        row,
        cost=done.cost,
        message=message,
        planner="task",
        proof=proof,
        deviation=deviation,
        timings=dict(done.timings),
    )
    return finished(problem, result), done.trajectory


def _point(plan: PlanArm, world: ArmWorld, number: int, reading: Reading) -> Goal:
    """Return a point on the way, a configuration or a pose; InvalidValue for one that is not free."""
    text = " ".join(plan.via[number])
    try:
        if ":" in text:
            return pose_goal_of(text, plan.tip, plan.frame, degrees=plan.deg)
        q: Floats = problem_in(world, text, text, reading).start
    except EvenroadError as error:
        raise type(error)(f"via point {number + 1}: {error}") from None
    if not world.valid(q):
        deep = depth_in(world, q)
        by = "" if deep is None else f", {1e3 * deep:.3g} mm deep"
        raise InvalidValue(f"via point {number + 1}, {text!r}, is not free: {world.explain(q)}{by}")
    return q
