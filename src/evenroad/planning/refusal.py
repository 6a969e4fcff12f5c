"""Refusals: the results of problems whose start, or every goal, is blocked."""

from __future__ import annotations

from evenroad._time_limit import BudgetSpent
from evenroad.planning.answer import failed
from evenroad.planning.attempt import Attempt
from evenroad.planning.result import PlanResult, Status
from evenroad.world import Explains, ExplainsStarts


def refusal(attempt: Attempt) -> PlanResult | None:
    """Return the result if the start or all goals are in collision; else None, and the attempt keeps the free goals."""
    terminals, world = attempt.problem.start_and_goals, attempt.world
    free = attempt.valid_terminals()
    if free[0] and attempt.goals.size:
        return None
    row = int(free[0])
    try:
        reason = f": {world.explain(terminals[row])}" if isinstance(world, Explains) else ""
        if not row and isinstance(world, ExplainsStarts):
            reason = f": {world.explain_start(terminals[0])}"
    except BudgetSpent:
        reason = "; there was no time to say what blocks it"
    within = world.space.contains(terminals[1:] if row else terminals[:1])
    if within.any():
        status = (Status.START_INVALID, Status.GOAL_INVALID)[row]
        where = "in collision" if within.all() else "in collision or outside the limits"
    else:
        status, where = (Status.START_OUTSIDE_LIMITS, Status.GOAL_OUTSIDE_LIMITS)[row], "outside the limits"
    if row and len(terminals) > 2:
        return failed(attempt, status, f"all {len(terminals) - 1} goals are {where}; the first{reason}")
    return failed(attempt, status, f"the {('start', 'goal')[row]} is {where}{reason}")
