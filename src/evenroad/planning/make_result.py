"""The makers of results. Every result belongs to a problem, and its path leads from the start to a goal."""

from __future__ import annotations

from dataclasses import MISSING, fields, replace

from evenroad._arrays import Floats
from evenroad.planning.problem import Problem
from evenroad.planning.result import NO_POINTS, PlanResult, Status
from evenroad.planning.terminals import from_start_to_goal, joins, turns, turns_at_end
from evenroad.space.path import path_length
from evenroad.world import World

_DEFAULTS = {each.name: each.default for each in fields(PlanResult) if each.default is not MISSING}
_DEFAULTS |= {"origin": NO_POINTS, "rule": "none", "planner": "none"}


def make_result(problem: Problem, status: Status, message: str, **more: object) -> PlanResult:
    """Return the result of a problem.

    `more` are attributes of the result; by default there is no path, and there are no points, no rule and no planner.
    """
    return _made(problem, {"status": status, "message": message, **more})


def solution(
    problem: Problem,
    path: Floats,
    goal: int = 0,
    *,
    raw: Floats | None = None,
    cost: float | None = None,
    raw_cost: float | None = None,
    message: str = "",
    proof: str = "",
    **more: object,
) -> PlanResult:
    """Return the result with a path to one of the goals, and with the `raw` path before smoothing.

    Costs are lengths by default; the message says which they are.  Paths with `pieces` lead from the very start to
    the very goal already.
    """
    world = problem.world
    cost = path_length(path, world.space) if cost is None else cost
    if raw is None:
        raw, raw_cost = path, cost
    elif raw_cost is None:
        raw_cost = path_length(raw, world.space)
    return _made(
        problem,
        {
            "status": Status.SOLVED,
            "message": message or path_message(path, cost, goal, len(problem.goals)),
            "goal_index": goal,
            "path": path,
            "milestone_path": raw,
            "proof": proof or proof_of(world),
            "cost": cost,
            "milestone_cost": raw_cost,
            **more,
        },
    )


def _made(problem: Problem, attributes: dict[str, object]) -> PlanResult:
    # Set at once. A frozen class sets one field after the other, which takes twice as long.
    result = object.__new__(PlanResult)
    world = problem.world
    vars(result).update(_DEFAULTS, counts={}, timings={}, deviation={}, start=problem.start, goals=problem.goals)
    given = problem.given
    poses = () if given is None else tuple(goal for goal, _ in given.poses)
    vars(result).update(attributes, world=world, poses=poses)
    return result if "pieces" in attributes else led(world, result)


def unreached(problem: Problem) -> PlanResult | None:
    """Return the result if no posture reaches a pose among the goals; else None."""
    given = problem.given
    if given is None or not given.unreached:
        return None
    status = Status.GOAL_INVALID if given.in_collision else Status.GOAL_UNREACHABLE
    if given.spent:
        status = Status.BUDGET_SPENT
    return make_result(problem, status, given.unreached, timings={"goals": given.seconds})


def out_of_time(problem: Problem) -> PlanResult:
    """Return the result of a problem whose time ran out before a search."""
    within = problem.budget.text(samples=False)
    message = f"no path within {within}: the time was over before a search was; give it more"
    return make_result(problem, Status.BUDGET_SPENT, message)


def path_message(
    path: Floats, cost: float, goal: int, goals: int, named: str = "length", *, is_cut: bool = False
) -> str:
    """Return a result's message about its path; `is_cut`: there was no time to finish smoothing."""
    to = f" to goal {goal}" if goals > 1 else ""
    cut = ", not smoothed to the end: the time was spent" if is_cut else ""
    return f"path of {named} {cost:.6g} with {len(path)} waypoints{to}{cut}"


def proof_of(world: World) -> str:
    """Return the kind of proof of this world's checks: ``exact``, ``certified`` or, by default, ``resolution``."""
    # `isinstance` would take as long as some checks.
    return str(getattr(world, "proof", "resolution"))


def led(world: World, result: PlanResult) -> PlanResult:
    """Return a result whose paths lead from the exact numbers of its start to its goal.

    Its message says which repeating coordinates end at other numbers than the goal's.  Raises AssertionError if a path
    does not lead there.  That is a bug of evenroad, and no robot must drive such a path.
    """
    given, milestones, space = result.path, result.milestone_path, world.space
    wraps = turns(space)
    if not wraps and (given is None or joins(given, milestones, result.start, result.goal)):
        return result
    path = None if given is None else from_start_to_goal(space, given, result.start, result.goal)
    raw = path
    if milestones is not given and milestones is not None:
        raw = from_start_to_goal(space, milestones, result.start, result.goal)
    said = "" if path is None or not wraps else turns_at_end(world, path, result.goal)
    if said and said not in result.message:
        result = replace(result, message=result.message + said)
    if path is given and (raw is milestones or milestones is None):
        return result
    return replace(result, path=path, milestone_path=None if milestones is None else raw)
