"""Planning a task: motion by motion, with another choice of goals where a later step cannot be done."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from time import perf_counter as now

import numpy as np

from evenroad._call import explains_calls
from evenroad._rng import RngLike
from evenroad.errors import InvalidValue, shown
from evenroad.planning.plan import Options, budget_of, finished, solve
from evenroad.planning.read_request import request_in
from evenroad.planning.request import ConfigurationLike, Reading, Request
from evenroad.roadmap import PlanResult, Status
from evenroad.roadmap.budget import Budget
from evenroad.roadmap.connector import Smooth
from evenroad.robot import ArmWorld
from evenroad.robot.chain import default_tip
from evenroad.task.motion import Motion, PlanBetween, plan_motion
from evenroad.task.result import TaskResult
from evenroad.task.stage import Contacts, Stage, touches
from evenroad.task.steps import Attach, Detach, MoveTo, Step

MOST_PLANS = 64
"""Largest number of motions that are planned for one task beside those that it has."""


@dataclass
class _Search:
    """A depth-first search over the goals of the motions."""

    steps: tuple[Step, ...]
    plan_between: PlanBetween
    reading: Reading
    tried: int = 0
    deepest: int = -1
    failed: PlanResult | None = None

    @property
    def most(self) -> int:
        """Largest number of motions that are planned."""
        return MOST_PLANS + sum(isinstance(step, MoveTo) for step in self.steps)

    def run(self, first: int, stage: Stage) -> tuple[Motion, ...] | None:
        """Return the motions of the steps from `first` on; None where they cannot be done."""
        for number, step in enumerate(self.steps[first:], first):
            where = f"step {number} of the task"
            if isinstance(step, Attach):
                stage = stage.attach(step, where)
            elif isinstance(step, Detach):
                stage = stage.detach(step, where)
            elif isinstance(step, MoveTo):
                break
        else:
            return ()
        # Each line has contacts of its own: what is lifted from a table may not end inside it.
        worlds = stage.with_contacts(stage.near_start), stage.world
        request = request_in(stage.with_contacts(self._at_goal(number, stage)), stage.q, step.goal, self.reading)
        left = np.arange(len(request.goals))
        while len(left) and self.tried < self.most:
            self.tried += 1
            motion = plan_motion(replace(request, goals=request.goals[left]), worlds, step, self.plan_between)
            if motion.goal is None:
                # Of failures the one that comes after most steps says most.
                if number > self.deepest:
                    self.deepest, self.failed = number, motion.parts[-1]
                return None
            later = self.run(number + 1, replace(stage, q=motion.end, near_start=frozenset()))
            if later is not None:
                return (motion, *later)
            # With a goal that is left the rest may be done.
            left = np.delete(left, motion.goal)
        return None

    def _at_goal(self, number: int, stage: Stage) -> Contacts:
        """Return the contacts that are not tested on the line to a goal, because of what the gripper does there."""
        after = self.steps[number + 1] if number + 1 < len(self.steps) else None
        if isinstance(after, Attach):
            robot = stage.world.robot
            return frozenset(
                (link, after.object) for link in (after.link or default_tip(robot), *touches(after, robot))
            )
        if isinstance(after, Detach):
            return frozenset((after.object, name) for name in after.onto)
        return frozenset()


@explains_calls
def plan_task(
    steps: tuple[Step, ...],
    world: ArmWorld,
    start: ConfigurationLike,
    reading: Reading,
    *,
    seconds: float | None = None,
    limits: Budget | Mapping[str, int] | None = None,
    smooth: Smooth = True,
    rng: RngLike = 0,
) -> TaskResult:
    """Return the plan of a task; see :meth:`evenroad.task.Task.plan`."""
    if not isinstance(world, ArmWorld):
        raise InvalidValue(f"a task is planned in an ArmWorld, got {shown(world)}")
    began, budget = now(), budget_of(None, seconds, limits)

    def plan_between(request: Request, step: MoveTo) -> PlanResult:
        options = Options(budget, smooth, rng, constraints=step.constraints)
        return finished(request, solve(request, None, options))[0]

    search = _Search(steps, plan_between, reading)
    first = request_in(world, start, start, reading).start
    motions = search.run(0, Stage(world, first, world.robot))
    timings = {"task": now() - began}
    if motions is not None:
        cost = sum(part.cost or 0.0 for motion in motions for part in motion.parts)
        message = f"{len(motions)} motions of length {cost:.6g}"
        return TaskResult(steps, Status.SOLVED, message, motions, None, timings, search.tried)
    status = Status.NOT_CONNECTED if search.failed is None else search.failed.status
    why = "no goal is left" if search.failed is None else search.failed.message
    message = f"step {search.deepest} of the task cannot be done: {why}"
    if search.tried > 1:
        message += f"; {search.tried} motions were planned in all"
    return TaskResult(steps, status, message, (), search.deepest, timings, search.tried)
