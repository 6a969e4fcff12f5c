"""ps-PRM: plan on a roadmap of points that were drawn beforehand (Chahine et al. 2025, Algorithm 1)."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.errors import UnknownName
from evenroad.points.pointset import PointSet
from evenroad.roadmap.answer import count, not_connected, searched_graph, solved
from evenroad.roadmap.cost import EdgeCost, edge_costs
from evenroad.roadmap.ends import end_in_collision, read_ends, require_fitting
from evenroad.roadmap.result import PlanResult
from evenroad.roadmap.rules import Rule, default_rule
from evenroad.roadmap.search import FREE, Graph, Ledger, Question, Ruler
from evenroad.roadmap.search.find import FINDERS, find_any
from evenroad.roadmap.stopwatch import Stopwatch
from evenroad.world import World


def plan(
    world: World,
    start: npt.ArrayLike,
    goal: npt.ArrayLike,
    points: PointSet,
    *,
    rule: Rule | None = None,
    search: str = "full",
    lazy_milestones: bool = False,
    success_only: bool = False,
    edge_cost: EdgeCost | None = None,
    shorten: bool = True,
) -> PlanResult:
    """Find a short free path from start to goal over the given points.

    Parameters
    ----------
    world : World
        Says which configurations and motions are free, and in which space.
    start, goal : array_like, shape (dim,)
        Configurations, in the units of the space.
    points : PointSet
        Points of the unit cube; the space maps them to configurations.
    rule : Rule, optional
        Which pairs to try; default: that of :func:`default_rule`.
    search : {"full", "lazy"}
        Check every edge before the search, or only those that could lie on the shortest path.  Both find the
        same path, bit for bit.
    lazy_milestones : bool
        Check milestones, too, only where they could lie on the path.  The rule then joins all points, valid or not,
        so it is another roadmap than that of the valid ones alone.
    success_only : bool
        Only find out whether there is a path, with few checks; the one returned is not the shortest.
    edge_cost : callable, optional
        Cost of the motions between the rows of two (m, dim) arrays, at least their lengths; default: the length.
    shorten : bool
        Also shortcut the path (the raw one is kept).

    Returns
    -------
    PlanResult
        Also when there is no path: the status and the message then say why.

    Raises
    ------
    InvalidValue
        If start, goal or points do not have the dimension of the space, or are not finite, or an edge costs
        less than its length.
    UnknownName
        If there is no such search.
    """
    if search not in FINDERS:
        raise UnknownName.among("search", search, FINDERS)
    rule = default_rule(world.space) if rule is None else rule
    find = find_any if success_only else FINDERS[search]
    require_fitting(points, world.space)
    ends = read_ends(start, goal, world.space.dim)
    planner = f"prm {'any' if success_only else search}{' + lazy milestones' if lazy_milestones else ''}"
    answer: dict[str, Any] = dict(
        start=ends[0], goal=ends[1], origin=points.origin, rule=str(rule), planner=planner
    )
    watch = Stopwatch()

    with watch("validity"):
        free_ends = world.valid(ends)
        if not free_ends.all():
            return PlanResult(**end_in_collision(free_ends, ends, world), **answer, seconds=watch.seconds)
        milestones = world.space.from_cube(points.points)
        if not lazy_milestones:
            milestones = milestones[world.valid(milestones)]
    configurations = np.concatenate([milestones, ends])
    with watch("neighbours"):
        edges = rule.edges(configurations, world.space, ends=2)
    ledger = Ledger(world, configurations, edges, watch)
    ledger.node_states[len(milestones) if lazy_milestones else 0 :] = FREE
    with watch("search"):
        costs = edge_costs(world.space, configurations, edges, edge_cost)
        found = find(question_between_last_two(ledger, costs), ledger)

    counts = count(points.n, ledger, 2 + (0 if lazy_milestones else points.n))
    answer |= dict(counts=counts, roadmap=searched_graph(ledger))
    if not found[0].size:
        return not_connected(ledger, watch, **answer)
    return solved(found, costs, ledger, watch, shorten=shorten, cost=edge_cost, **answer)


def question_between_last_two(ledger: Ledger, costs: npt.NDArray[np.float64]) -> Question:
    """Return the search from the last but one node, the start, to the last, the goal."""
    configurations = ledger.configurations
    nodes = len(configurations)
    ruler = Ruler.of(float(costs.max(initial=0.0)), nodes)
    to_goal = ledger.world.space.distance(
        configurations, np.broadcast_to(configurations[-1], configurations.shape)
    )
    graph = Graph.of(nodes, ledger.edges)
    return Question(graph, ruler.weights(costs), ruler.bounds(to_goal), nodes - 2, nodes - 1)
