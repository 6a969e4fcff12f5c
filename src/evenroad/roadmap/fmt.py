"""FMT*: the fast marching tree (Janson, Schmerling, Clark and Pavone 2015) on the same points and neighbours."""

from __future__ import annotations

import numpy.typing as npt

from evenroad.points.pointset import PointSet
from evenroad.roadmap.answer import answer, refusal
from evenroad.roadmap.attempt import Attempt
from evenroad.roadmap.budget import Budget
from evenroad.roadmap.cost import EdgeCost
from evenroad.roadmap.query import LINKS, Query, as_points, read_places
from evenroad.roadmap.result import PlanResult
from evenroad.roadmap.rules import Rule, default_rule
from evenroad.roadmap.search import FREE, EdgeStates, Found, SearchProblem, march
from evenroad.world import World


def fmt(
    world: World,
    start: npt.ArrayLike,
    goal: npt.ArrayLike,
    points: PointSet | int,
    *,
    rule: Rule | None = None,
    edge_cost: EdgeCost | None = None,
    shorten: bool = True,
    links: int | None = LINKS,
    budget: Budget | None = None,
) -> PlanResult:
    """Find a short free path from start to goal with a tree that grows outwards in the order of cost.

    Each milestone is joined to the tree over the neighbour that would be best if nothing were in the way, and only that
    motion is checked; so the tree is nearly the shortest one, for about one check a milestone.  It can miss a path that
    `plan` finds on the same roadmap.

    Parameters
    ----------
    world, start, goal, points, rule, edge_cost, shorten, links, budget
        As in :func:`plan`.

    Returns
    -------
    PlanResult
        With ``planner="fmt*"``; when not connected, the count ``start_component`` is the size of the tree.

    Raises
    ------
    InvalidValue
        As in :func:`plan`.
    """
    budget = Budget() if budget is None else budget
    places = read_places(start, goal, world.space)
    query = Query(*places, shorten=shorten, edge_cost=edge_cost, links=links, budget=budget)
    points = as_points(points, world.space)
    rule = default_rule(world.space) if rule is None else rule
    attempt = Attempt(world, query, points.origin, str(rule), "fmt*")
    if (refused := refusal(attempt)) is not None:
        return refused
    milestones = world.space.from_cube(points.points)
    milestones = milestones[attempt.valid(milestones)]
    states = attempt.candidates(rule, milestones)
    states.node_states[:] = FREE
    reached = 1

    def grow(problem: SearchProblem, states: EdgeStates) -> Found:
        nonlocal reached
        found, reached = march(problem, states)
        return found

    searched = attempt.search(grow, states)
    return answer(attempt, searched, points.n, reached=reached)
