"""ps-PRM (Chahine et al. 2025, Algorithm 1) and FMT*: plan on points that were drawn beforehand."""

from __future__ import annotations

from dataclasses import replace

import numpy.typing as npt

from evenroad.errors import InvalidValue
from evenroad.points.pointset import PointSet
from evenroad.roadmap.answer import answer, refusal
from evenroad.roadmap.attempt import Attempt
from evenroad.roadmap.budget import Budget
from evenroad.roadmap.certify import certify_graph
from evenroad.roadmap.query import LINKS, EdgeCost, Query, as_points, read_places
from evenroad.roadmap.result import PlanResult, Status
from evenroad.roadmap.rules import Rule, default_rule
from evenroad.roadmap.search import FREE, Finder, march
from evenroad.world import World


def plan(
    world: World,
    start: npt.ArrayLike,
    goal: npt.ArrayLike,
    points: PointSet | int,
    *,
    rule: Rule | None = None,
    search: str = "full",
    lazy_milestones: bool = False,
    success_only: bool = False,
    edge_cost: EdgeCost | None = None,
    shorten: bool = True,
    links: int | None = LINKS,
    budget: Budget | None = None,
    certify: bool = False,
) -> PlanResult:
    """Find a short free path from start to goal over the given points.

    Parameters
    ----------
    world : World
        Says which configurations and motions are free, and in which space.
    start : array_like, shape (dim,)
        A configuration, in the units of the space.
    goal : array_like, shape (dim,) or (g, dim)
        A configuration, or several: the path ends at the one that is cheapest to reach.
    points : PointSet or int
        Points of the unit cube; the space maps them to configurations.  Or how many even points to draw.
    rule : Rule, optional
        Which pairs to try; default: that of :func:`default_rule`.
    search : {"full", "lazy"}
        Check every edge before the search, or only those that could lie on the shortest path.  Both find the
        same path, bit for bit.
    lazy_milestones : bool
        Check milestones, too, only where they could lie on the path.  The rule then joins all points, valid or not,
        so it is another roadmap than that of the valid ones alone.
    success_only : bool
        Only find out whether there is a path; the one returned is not the shortest.
    edge_cost : callable, optional
        Cost of the motions between the rows of two (m, dim) arrays, at least their lengths; default: the length.
    shorten : bool
        Also shortcut the path (the raw one is kept).
    links : int or None
        To how many of the nearest milestones start and goals are linked, besides those of the rule; to all up to 256.
        None: as the rule says, which is what published protocols do.
    budget : Budget, optional
        Default: a minute.
    certify : bool
        Put a :class:`Certificate` into the result: how much longer than the best path the one along the roadmap can
        be, and what clearance a path would have had to have that was not found.  Not with `edge_cost` or
        `success_only`.

    Where there is no path, the result's status and message say why.  Raises InvalidValue if start, goal or points do
    not have the dimension of the space, or are not finite, or an edge costs less than its length, or a certificate is
    asked for of what has none; NotAvailable if it is asked for where the metric is not flat; UnknownName if there is no
    such search.
    """
    query = Query(
        *read_places(start, goal, world.space),
        search=search,
        success_only=success_only,
        shorten=shorten,
        edge_cost=edge_cost,
        links=links,
        budget=budget or Budget(),
    )
    if certify and (success_only or edge_cost is not None):
        raise InvalidValue("certify speaks of shortest paths: it goes without edge_cost and success_only")
    planner, find = query.planner(lazy_milestones), query.find
    return _on_points(
        world, query, points, rule, planner, find, lazy_milestones=lazy_milestones, certify=certify
    )


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
    """Find a short free path with a tree that grows outwards in the order of cost: FMT* (Janson et al. 2015).

    Each milestone is joined to the tree over the neighbour that would be best if nothing were in the way, and only that
    motion is checked; so the tree is nearly the shortest one, for about one check a milestone.  It can miss a path that
    `plan` finds on the same roadmap.  When not connected, the count ``start_component`` is the size of the tree.
    Parameters and errors are those of :func:`plan`.
    """
    places = read_places(start, goal, world.space)
    query = Query(*places, shorten=shorten, edge_cost=edge_cost, links=links, budget=budget or Budget())
    return _on_points(world, query, points, rule, "fmt*", march)


def _on_points(
    world: World,
    query: Query,
    points: PointSet | int,
    rule: Rule | None,
    planner: str,
    find: Finder,
    *,
    lazy_milestones: bool = False,
    certify: bool = False,
) -> PlanResult:
    """Map the points into the space, join them by the rule, and find a path along what the world calls free."""
    points = as_points(points, world.space, rule)
    rule = default_rule(world.space) if rule is None else rule
    attempt = Attempt(world, query, points.origin, str(rule), planner)
    if (refused := refusal(attempt)) is not None:
        return refused
    milestones = world.space.from_cube(points.points)
    if not lazy_milestones:
        milestones = milestones[attempt.valid(milestones)]
    states = attempt.candidates(rule, milestones)
    states.node_states[len(milestones) if lazy_milestones else 0 :] = FREE
    certificate = None
    if certify:
        ends = 1 + len(attempt.goals)
        certificate = certify_graph(points, world.space, states.configurations, states.edges, ends)
    result = answer(attempt, attempt.search(find, states), points.n)
    if certificate is None or result.status not in (Status.SOLVED, Status.NOT_CONNECTED):
        return result
    message = result.message
    if not result.solved and certificate.complete:
        message += f"; certified: no path has a clearance of {certificate.dispersion:.6g}"
    return replace(result, certificate=certificate, message=message)
