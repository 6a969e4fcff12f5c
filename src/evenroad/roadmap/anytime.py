"""Anytime planning: more and more points of one sequence, on which every check made is used again."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_count
from evenroad._rng import RngLike
from evenroad.errors import InvalidValue, UnknownName
from evenroad.points.pointset import PointSet
from evenroad.points.samplers import Sampler, make_sampler
from evenroad.roadmap.answer import count, not_connected, searched_graph, solved
from evenroad.roadmap.budget import Budget
from evenroad.roadmap.cost import EdgeCost
from evenroad.roadmap.ends import end_in_collision, read_ends, require_fitting
from evenroad.roadmap.growth import Growth
from evenroad.roadmap.result import PlanResult, Status
from evenroad.roadmap.rules import Rule, default_rule
from evenroad.world import World

UNTIL = ("solved", "settled", "budget")


def plan_anytime(
    world: World,
    start: npt.ArrayLike,
    goal: npt.ArrayLike,
    sampler: Sampler | None = None,
    *,
    first: int = 64,
    until: str = "solved",
    budget: Budget | None = None,
    rng: RngLike = 0,
    rule: Rule | None = None,
    edge_cost: EdgeCost | None = None,
    shorten: bool = True,
) -> PlanResult:
    """Plan with `first` points, then with twice as many, and so on, lazily, until the answer is good enough.

    Each stage finds what ``plan(..., search="lazy")`` finds with its points, but milestones and motions that an earlier
    stage has checked are not checked again.  The best path of all stages is the answer.

    Parameters
    ----------
    world, start, goal, rule, edge_cost, shorten
        As in :func:`plan`.
    sampler : Sampler, optional
        Whose sets of more points begin with those of fewer; default: scrambled Sobol points.
    first : int
        Points of the first stage.
    until : {"solved", "settled", "budget"}
        Stop with the first path, or when a path has become at most 1 % shorter from one stage to the next, or
        only when the budget is spent.
    budget : Budget, optional
        Default: 65536 samples.
    rng : int or SeedSequence
        For the sampler.

    Returns
    -------
    PlanResult
        ``status`` is ``budget_spent`` when there was no path until then; ``stages`` tells how it went.  Counts are
        those of the last stage, checks those of all.

    Raises
    ------
    InvalidValue
        As in :func:`plan`, and if the sampler's sets do not begin with the smaller ones.
    UnknownName
        If there is no such `until`.
    """
    if until not in UNTIL:
        raise UnknownName.among("until", until, UNTIL)
    first = require_count("first", first)
    rule = default_rule(world.space) if rule is None else rule
    budget = Budget() if budget is None else budget
    growth = Growth(world, read_ends(start, goal, world.space.dim), rule, edge_cost, budget)
    points = _draw(sampler, min(first, budget.samples), world, rng, None)
    answer: dict[str, Any] = dict(
        start=growth.ends[0],
        goal=growth.ends[1],
        origin=points.origin,
        rule=str(rule),
        planner="prm anytime",
    )
    watch = growth.watch
    with watch("validity"):
        free_ends = world.valid(growth.ends)
    if not free_ends.all():
        return PlanResult(**end_in_collision(free_ends, growth.ends, world), **answer, seconds=watch.seconds)

    while growth.take(points) and not growth.is_done(until) and points.n < budget.samples:
        points = _draw(sampler, min(2 * points.n, budget.samples), world, rng, points)

    counts = count(points.n, growth.ledger, 2 + points.n)
    counts["edges_checked"] = growth.motions_checked
    answer |= dict(counts=counts, roadmap=searched_graph(growth.ledger), stages=tuple(growth.stages))
    if growth.best is not None:
        found, costs, ledger = growth.best
        return solved(found, costs, ledger, watch, shorten=shorten, cost=edge_cost, **answer)
    result = not_connected(growth.ledger, watch, **answer)
    return _spent(result, budget)


def _draw(sampler: Sampler | None, n: int, world: World, rng: RngLike, before: PointSet | None) -> PointSet:
    """Draw n points, and make sure that they go on where those `before` ended."""
    # By name: the module of the sequences imports scipy.stats, half a second that only this default needs.
    sampler = make_sampler("sobol") if sampler is None else sampler
    points = sampler.draw(n, world.space.cube_dim, rng=rng)
    require_fitting(points, world.space)
    if before is not None and not np.array_equal(points.points[: before.n], before.points):
        raise InvalidValue(
            f"the {n} points of {sampler.name} do not begin with its {before.n} points: growing needs a sequence"
            " (sobol, halton, uniform) and a seed, not a Generator"
        )
    return points


def _spent(result: PlanResult, budget: Budget) -> PlanResult:
    """Return the answer `not_connected` as one of a budget that was spent."""
    return replace(
        result,
        status=Status.BUDGET_SPENT,
        message=f"no path within {budget}; {result.message.partition(':')[0]}",
    )
