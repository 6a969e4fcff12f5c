"""More time buys better paths: plan again in other ways, and keep the best."""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import count

import numpy as np

from evenroad.roadmap.answer import connected
from evenroad.roadmap.anytime import plan_anytime
from evenroad.roadmap.attempt import Attempt
from evenroad.roadmap.result import PlanResult, Stage
from evenroad.world import ConnectsAnew

NO_BETTER = 1e-9
"""A path is not improved on that exceeds the shortest possible by no more than this share."""

LEAST_MOTIONS, LONGER = 1000, 4
"""A round gives up after so many motions, or after so many times those of the first path, whichever is more."""


def improved(attempt: Attempt, first: PlanResult) -> PlanResult:
    """Return the best path within what is left of the budget, or of its rounds; never a worse one than the first.

    A world that connects anew does so again and again, each time driven by another sequence; in any other one a roadmap
    grows beside the first path.

    Parameters
    ----------
    attempt : Attempt
        Which found the first path.
    first : PlanResult
        The result with that path.

    Returns
    -------
    PlanResult
        Its count ``rounds`` says how often it was planned anew, its `stages` when better paths were found.
    """
    assert first.cost is not None
    nodes = first.counts.get("nodes", 0)
    stage = Stage(nodes, nodes, attempt.motions_checked, first.cost, attempt.elapsed())
    if isinstance(attempt.world, ConnectsAnew):
        return _by_rounds(attempt, attempt.world, first, stage)
    return _by_growth(attempt, first, stage)


def _by_rounds(attempt: Attempt, world: ConnectsAnew, first: PlanResult, stage: Stage) -> PlanResult:
    best, stages, least = first, [stage], _least_cost(attempt)
    nodes, counts, done = stage.points, dict(first.counts), 0
    # A round that is much longer than the first was takes the time of many others.
    most = max(LEAST_MOTIONS, LONGER * attempt.motions_checked)
    for variant in count(1):
        if not _goes_on(attempt, best, least, variant):
            break
        connection = attempt.connect(world, variant, most)
        done, nodes = variant, nodes + connection.nodes
        counts["configurations_checked"] += connection.configurations
        if connection.goal < 0:
            continue
        result = connected(attempt, connection)
        counts["shortcut_motions"] = counts.get("shortcut_motions", 0) + result.counts.get(
            "shortcut_motions", 0
        )
        if _cost(result) < _cost(best):
            best = result
            stages.append(Stage(nodes, nodes, attempt.motions_checked, best.cost, attempt.elapsed()))
    counts |= {"nodes": nodes, "edges_checked": attempt.motions_checked, "rounds": done}
    message = f"{best.message}, the best of {done + 1}" if done else best.message
    return replace(best, message=message, counts=counts, stages=tuple(stages), seconds=attempt.watch.seconds)


def _by_growth(attempt: Attempt, first: PlanResult, stage: Stage) -> PlanResult:
    query = attempt.query
    left = attempt.left()
    if left is None or not _goes_on(attempt, first, _least_cost(attempt), 1):
        return replace(first, counts=first.counts | {"rounds": 0}, stages=(stage,))
    before = attempt.elapsed()
    grown = plan_anytime(
        attempt.world,
        query.start,
        query.goals,
        until="budget",
        budget=left,
        shorten=query.shorten,
    )
    stages = [stage, *(replace(each, seconds=before + each.seconds) for each in grown.stages)]
    best = grown if grown.cost is not None and grown.cost < _cost(first) else first
    counts = best.counts | {"rounds": len(grown.stages)}
    return replace(best, counts=counts, stages=tuple(stages))


def _goes_on(attempt: Attempt, best: PlanResult, least: float, variant: int) -> bool:
    budget = attempt.query.budget
    return (
        time.perf_counter() < attempt.deadline
        and (budget.rounds is None or variant <= budget.rounds)
        and (budget.motions is None or attempt.motions_checked < budget.motions)
        and _cost(best) > (1.0 + NO_BETTER) * least
    )


def _least_cost(attempt: Attempt) -> float:
    """Return the distance to the nearest goal, below which no path's length can be."""
    goals = attempt.query.goals[attempt.goals]
    start = np.broadcast_to(attempt.query.start, goals.shape)
    return float(attempt.world.space.distance(start, goals).min())


def _cost(result: PlanResult) -> float:
    assert result.cost is not None
    return result.cost
