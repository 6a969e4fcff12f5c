"""A path without a number of points: by the world's own planner where it has one, else with points that grow."""

from __future__ import annotations

import numpy.typing as npt

from evenroad.points.pointset import Origin
from evenroad.roadmap.answer import are_apart, connected, gave_up, proved_apart, refusal
from evenroad.roadmap.anytime import plan_anytime
from evenroad.roadmap.attempt import Attempt
from evenroad.roadmap.budget import Budget
from evenroad.roadmap.hemmed import with_reasons
from evenroad.roadmap.improve import improved
from evenroad.roadmap.query import Query, read_places
from evenroad.roadmap.result import PlanResult
from evenroad.world import World

SECONDS = 5.0
"""Wall time of a budget that is not given."""

NO_POINTS = Origin(family="none", method="no points")


def find_path(
    world: World,
    start: npt.ArrayLike,
    goal: npt.ArrayLike,
    *,
    budget: Budget | None = None,
    shorten: bool = True,
    improve: bool = False,
) -> PlanResult:
    """Plan until there is a path, it is proved that there is none, or the budget is spent.

    A world that connects itself plans.  Where it finds nothing, one that separates components is asked whether there
    can be a path at all.  Then, and with any other world, points are added until they suffice.

    Parameters
    ----------
    world, start, goal, shorten
        As in :func:`plan`.
    budget : Budget, optional
        Default: five seconds.
    improve : bool
        Go on after the first path, until the budget is spent, and return the best of all.

    Returns
    -------
    PlanResult
        ``not_connected`` is proved; without path and proof the status is ``budget_spent``, and the message says
        where start or goal can hardly leave their places.

    Raises
    ------
    InvalidValue
        If start or goal does not have the dimension of the space, or is not finite.
    """
    budget = Budget(seconds=SECONDS) if budget is None else budget
    query = Query(*read_places(start, goal, world.space), shorten=shorten, budget=budget)
    attempt = Attempt(world, query, NO_POINTS, "none", "none")
    if attempt.own_planner is not None:
        attempt.planner = attempt.own_planner.planner
        if (refused := refusal(attempt)) is not None:
            return refused
        connection = attempt.connect(attempt.own_planner)
        if connection.goal >= 0:
            result = connected(attempt, connection)
            return improved(attempt, result) if improve else result
        if are_apart(attempt):
            return proved_apart(attempt)
        left = attempt.left()
        if left is None:
            return with_reasons(world, gave_up(attempt, connection))
        budget = left
    until = "budget" if improve else "solved"
    grown = plan_anytime(world, query.start, query.goals, until=until, budget=budget, shorten=shorten)
    return with_reasons(world, grown)
