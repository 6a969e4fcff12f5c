"""FlightSearch: trees of states at rest and shortcuts in time, for what flies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from evenroad._arrays import Floats
from evenroad._call import explains_calls
from evenroad._native.flight import FlightQuery
from evenroad._rng import variant_of
from evenroad._time_limit import BudgetSpent, until
from evenroad.errors import InvalidValue, shown
from evenroad.flight.flight_world import FlightWorld
from evenroad.planning.answer import failed, in_its_time
from evenroad.planning.attempt import Attempt
from evenroad.planning.make_result import path_message, solution
from evenroad.planning.problem import Problem
from evenroad.planning.refusal import refusal
from evenroad.planning.result import PlanResult, Status
from evenroad.roadmap.budget import BEFORE_REASONS
from evenroad.space.path import path_length

SHORTCUTS, QUICK_SHORTCUTS = 1000, 200
"""Largest numbers of shortcuts that are tried, and of those that are with ``smooth="quick"``."""


@explains_calls
@dataclass(frozen=True)
class FlightSearch:
    """The quickest motion from start to goal if it is free; else two trees of states at rest, and shortcuts in time.

    It is the default for a :class:`evenroad.flight.FlightWorld`.  A shortcut replaces what lies between two instants by
    the quickest motion between their states, if it is quicker and proved free.

    Examples
    --------
    >>> import evenroad as er
    >>> from evenroad.planning import FlightSearch
    >>> world = er.FlightWorld(er.Scene(), speed=6.0, acceleration=8.0)
    >>> er.plan(world, er.State((0, 0, 1)), er.State((9, 0, 1)), FlightSearch()).cost
    2.25
    """

    seconds: ClassVar[float] = 5.0
    is_directed: ClassVar[bool] = True
    """Whether it plans in spaces whose motions differ from their reverse."""

    @in_its_time
    def solve(self, problem: Problem) -> PlanResult:
        """Plan until there is a path, or the budget is spent.

        Parameters
        ----------
        problem : Problem
            Of a :class:`evenroad.flight.FlightWorld`.

        Returns
        -------
        PlanResult
            Its path are states, joined by the quickest motions; its cost is the time of the flight [s].

        Raises
        ------
        InvalidValue
            If the world is another one.
        """
        world = problem.world
        if not isinstance(world, FlightWorld):
            raise InvalidValue(f"FlightSearch plans for what flies, in a FlightWorld, got {shown(world)}")
        attempt = Attempt(problem, "flight")
        if (refused := refusal(attempt)) is not None:
            return refused
        variant, goals = variant_of(problem.rng), attempt.free_goals
        queries = [FlightQuery(world.airspace, problem.start, np.ascontiguousarray(goal), variant) for goal in goals]
        times = world.space.distance(np.broadcast_to(problem.start, goals.shape), goals)
        order: list[int] = np.argsort(times, kind="stable").tolist()
        with attempt.watch("search"), until(attempt.time.part(attempt.began, BEFORE_REASONS)):
            try:
                number = searched(queries, order)
            except BudgetSpent:
                counts = _counts(queries)
                message = (
                    f"no path within {problem.budget.text(samples=False)}: {counts['nodes']} nodes were grown and"
                    f" {counts['edges_checked']} motions checked; give it more time"
                )
                return failed(attempt, Status.BUDGET_SPENT, message, counts=counts)
        return _result(attempt, queries, number)


def searched(queries: Sequence[FlightQuery], order: Sequence[int]) -> int:
    """Return which query found a path first; BudgetSpent if none does in time."""
    while True:
        for number in order:
            if queries[number].search(1):
                return number


def _result(attempt: Attempt, queries: Sequence[FlightQuery], number: int) -> PlanResult:
    """Return the result with the path of a query, made shorter if that is wanted."""
    problem, query = attempt.problem, queries[number]
    tries = 0 if not problem.smooth else QUICK_SHORTCUTS if problem.smooth == "quick" else SHORTCUTS
    goal = int(attempt.goals[number])
    path = raw = query.path
    if tries:
        with attempt.watch("shortcut"), until(attempt.time):
            path = query.shorten(tries)
    counts = _counts(queries) | {"shortcut_motions": query.shortcuts}
    time, raw_time = (_duration(each, attempt) for each in (path, raw))
    return solution(
        problem,
        path,
        goal,
        raw=raw,
        cost=time,
        raw_cost=raw_time,
        message=path_message(path, time, goal, len(problem.goals), "time"),
        planner=attempt.planner,
        counts=counts,
        timings=attempt.watch.seconds,
    )


def _duration(path: Floats, attempt: Attempt) -> float:
    return path_length(path, attempt.world.space)


def _counts(queries: Sequence[FlightQuery]) -> dict[str, int]:
    return {
        "nodes": sum(each.nodes for each in queries),
        "edges_checked": sum(each.motions for each in queries),
    }
