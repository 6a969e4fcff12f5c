"""FMT*: the fast marching tree (Janson, Schmerling, Clark and Pavone 2015) on the same points and neighbours."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.points.pointset import PointSet
from evenroad.roadmap.answer import count, searched_graph, solved
from evenroad.roadmap.cost import EdgeCost, edge_costs
from evenroad.roadmap.ends import end_in_collision, read_ends, require_fitting
from evenroad.roadmap.result import PlanResult, Status
from evenroad.roadmap.rules import Rule, default_rule
from evenroad.roadmap.search import FREE, Graph, Ledger, Ruler
from evenroad.roadmap.search.marching import march
from evenroad.roadmap.stopwatch import Stopwatch
from evenroad.world import World


def fmt(
    world: World,
    start: npt.ArrayLike,
    goal: npt.ArrayLike,
    points: PointSet,
    *,
    rule: Rule | None = None,
    edge_cost: EdgeCost | None = None,
    shorten: bool = True,
) -> PlanResult:
    """Find a short free path from start to goal with a tree that grows outwards in the order of cost.

    Each milestone is joined to the tree over the neighbour that would be best if nothing were in the way, and only that
    motion is checked; so the tree is nearly the shortest one, for about one check a milestone.  It can miss a path that
    `plan` finds on the same roadmap.

    Parameters
    ----------
    world, start, goal, points, rule, edge_cost, shorten
        As in :func:`plan`.

    Returns
    -------
    PlanResult
        With ``planner="fmt*"``; when not connected, the count ``start_piece`` is the size of the tree.

    Raises
    ------
    InvalidValue
        As in :func:`plan`.
    """
    rule = default_rule(world.space) if rule is None else rule
    require_fitting(points, world.space)
    ends = read_ends(start, goal, world.space.dim)
    answer: dict[str, Any] = dict(
        start=ends[0], goal=ends[1], origin=points.origin, rule=str(rule), planner="fmt*"
    )
    watch = Stopwatch()

    with watch("validity"):
        free_ends = world.valid(ends)
        if not free_ends.all():
            return PlanResult(**end_in_collision(free_ends, ends, world), **answer, seconds=watch.seconds)
        milestones = world.space.from_cube(points.points)
        milestones = milestones[world.valid(milestones)]
    configurations = np.concatenate([milestones, ends])
    nodes = len(configurations)
    with watch("neighbours"):
        edges = rule.edges(configurations, world.space, ends=2)
    ledger = Ledger(world, configurations, edges, watch)
    ledger.node_states[:] = FREE
    with watch("search"):
        costs = edge_costs(world.space, configurations, edges, edge_cost)
        weights = Ruler.of(float(costs.max(initial=0.0)), nodes).weights(costs)
        found, reached = march(Graph.of(nodes, edges), weights, ledger, nodes - 2, nodes - 1)

    counts = count(points.n, ledger, 2 + points.n)
    answer |= dict(counts=counts, roadmap=searched_graph(ledger))
    if found[0].size:
        return solved(found, costs, ledger, watch, shorten=shorten, cost=edge_cost, **answer)
    counts["start_piece"] = reached - 1
    message = (
        f"the tree reached {reached - 1} of {counts['valid']} valid milestones, but not the goal"
        f" (n={points.n}, {rule}): try n={2 * points.n} or a larger k"
    )
    return PlanResult(status=Status.NOT_CONNECTED, message=message, seconds=watch.seconds, **answer)
