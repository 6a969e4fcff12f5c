"""Searches for better paths while time is left: below a bound for arms, else by other sequences or a roadmap."""

from __future__ import annotations

from dataclasses import replace
from itertools import count

import numpy as np

from evenroad._time_limit import BudgetSpent, until
from evenroad.planning.answer import connected
from evenroad.planning.attempt import NO_LIMIT, Attempt
from evenroad.planning.connector import Connector
from evenroad.planning.connectors import ArmTrees
from evenroad.planning.make_result import led, path_message
from evenroad.planning.planners.growing import GrowingPRM
from evenroad.planning.problem import Interrupted
from evenroad.planning.result import PlanResult, Stage
from evenroad.roadmap.budget import BEFORE_REASONS
from evenroad.space.path import path_length

NO_BETTER = 1e-9
"""Share by which a path may exceed the shortest possible one before it is improved."""
LEAST_MOTIONS, LONGER = 1000, 4
"""Largest number of motions of a round: the larger of a number and a multiple of the first path's motions."""
_SLICE = 250
"""Number of batches of sixteen checks between two checks of the clock: about 1 ms."""


def improved(attempt: Attempt, connector: Connector, first: PlanResult, variant: int) -> PlanResult:
    """Return the best path within the rest of the budget or its rounds; it is never worse than the first."""
    nodes = first.counts["nodes"]
    stage = Stage(nodes, nodes, attempt.motions_checked, first.cost, attempt.elapsed())
    if isinstance(connector, ArmTrees):
        return _below_bounds(attempt, connector, first, stage, variant)
    if connector.varies:
        return _by_rounds(attempt, connector, first, stage, variant)
    return _by_growth(attempt, first, stage)


def _below_bounds(attempt: Attempt, connector: ArmTrees, first: PlanResult, stage: Stage, variant: int) -> PlanResult:
    """Plan in native code, each time below a bound on the length; see `evenroad._native.planning.Improver`."""
    assert first.path is not None
    problem, counts, space = attempt.problem, dict(first.counts), attempt.world.space
    budget = problem.budget
    goal = int(np.flatnonzero(attempt.goals == first.goal_index)[0])
    improver = connector.improver(
        attempt.world,
        attempt.start_and_goals,
        (first.path, goal, attempt.motions_checked),
        variant=variant,
        is_smoothing=bool(problem.smooth),
    )
    rounds = NO_LIMIT if budget.rounds is None else budget.rounds
    motions = NO_LIMIT if budget.motions is None else max(budget.motions - attempt.motions_checked, 0)
    stages, length, stopped = [stage], improver.length, False
    with attempt.watch("search"), until(attempt.time.part(attempt.began, BEFORE_REASONS)):
        state = "paused"
        while state == "paused":
            try:
                state = improver.improve(rounds, motions, _SLICE)
            except BudgetSpent:
                state = "spent"
            except KeyboardInterrupt:
                state, stopped = "spent", True
            if improver.length < length:
                length, nodes = improver.length, stage.points + improver.nodes
                checked = attempt.motions_checked + improver.motions
                stages.append(Stage(nodes, nodes, checked, length, attempt.elapsed()))
    attempt.motions_checked += improver.motions
    counts |= {
        "nodes": stage.points + improver.nodes,
        "edges_checked": attempt.motions_checked,
        "rounds": improver.rounds,
    }
    if problem.smooth:
        counts["shortcut_motions"] += improver.smoothing_motions
    best = replace(first, counts=counts, timings=attempt.watch.seconds)
    if len(stages) > 1:
        path, row = improver.path, int(attempt.goals[improver.goal])
        raw = improver.along_trees
        cost = path_length(path, space)
        # The kernel sums lengths in another order: its last bit may differ.
        stages[-1] = replace(stages[-1], cost=cost)
        message = path_message(path, cost, row, len(problem.goals))
        best = replace(best, path=path, cost=cost, goal_index=row, message=message)
        if not np.array_equal(raw, first.path):
            best = replace(best, milestone_path=raw, milestone_cost=path_length(raw, space))
    best = led(attempt.world, replace(best, stages=tuple(stages)))
    if improver.rounds:
        best = replace(best, message=f"{best.message}, the best of {improver.rounds + 1}: {_gap(best)}")
    return _unless_stopped(best, stopped)


def _unless_stopped(best: PlanResult, stopped: bool) -> PlanResult:
    """Return the best path, or raise it as `Interrupted` after a Ctrl-C."""
    if stopped:
        raise Interrupted(replace(best, message=f"{best.message}; interrupted"))
    return best


def _gap(result: PlanResult) -> str:
    """Return in words how much longer than the shortest path it can be."""
    try:
        assert result.gap is not None
        return f"at most {100.0 * result.gap:.3g} % longer than the shortest"
    except BudgetSpent:
        return "there was no time to say how much longer than the shortest it may be"


def _by_rounds(attempt: Attempt, connector: Connector, first: PlanResult, stage: Stage, variant: int) -> PlanResult:
    """Plan repeatedly, each time with another sequence."""
    best, stages, nodes, counts, done, stopped = first, [stage], stage.points, dict(first.counts), 0, False
    # A round much longer than the first would take the time of many others.
    most = max(LEAST_MOTIONS, LONGER * attempt.motions_checked)
    for number in count(1):
        if not _goes_on(attempt, best, number):
            break
        try:
            connection = attempt.connect(connector, variant + number, most)
            result = None if connection.goal < 0 else connected(attempt, connection)
        except KeyboardInterrupt:
            stopped = True
            break
        if connection.spent:
            break
        done, nodes = number, nodes + connection.nodes
        counts["configurations_checked"] += connection.configurations
        if result is None:
            continue
        if attempt.problem.smooth:
            counts["shortcut_motions"] += result.counts["shortcut_motions"]
        if _cost(result) < _cost(best):
            best = result
            stages.append(Stage(nodes, nodes, attempt.motions_checked, best.cost, attempt.elapsed()))
    counts |= {"nodes": nodes, "edges_checked": attempt.motions_checked, "rounds": done}
    message = f"{best.message}, the best of {done + 1}: {_gap(best)}" if done else best.message
    best = replace(best, message=message, counts=counts, stages=tuple(stages), timings=attempt.watch.seconds)
    return _unless_stopped(best, stopped)


def _by_growth(attempt: Attempt, first: PlanResult, stage: Stage) -> PlanResult:
    """Grow a roadmap beside the first path."""
    left = attempt.left()
    if left is None or not _goes_on(attempt, first, 1):
        return replace(first, counts=first.counts | {"rounds": 0}, stages=(stage,))
    before, stopped = attempt.elapsed(), True
    try:
        with until(attempt.time.part(attempt.began, BEFORE_REASONS)):
            grown = GrowingPRM(until="budget", informed=True).solve(replace(attempt.problem, budget=left, rng=0))
        stopped = False
    except Interrupted as stop:
        grown = stop.best
    except KeyboardInterrupt:
        return _unless_stopped(first, stopped)
    stages = [stage, *(replace(each, seconds=before + each.seconds) for each in grown.stages)]
    best = grown if grown.cost is not None and grown.cost < _cost(first) else first
    message = f"{best.message}: {_gap(best)}"
    best = replace(best, message=message, counts=best.counts | {"rounds": len(grown.stages)}, stages=tuple(stages))
    return _unless_stopped(best, stopped)


def _goes_on(attempt: Attempt, best: PlanResult, number: int) -> bool:
    """Return whether the budget allows this round and the path exceeds the distance to the nearest goal."""
    budget, start, goals = attempt.problem.budget, attempt.problem.start, attempt.free_goals
    least = float(attempt.world.space.distance(np.broadcast_to(start, goals.shape), goals).min())
    return (
        not attempt.time.is_over
        and (budget.rounds is None or number <= budget.rounds)
        and (budget.motions is None or attempt.motions_checked < budget.motions)
        and _cost(best) > (1.0 + NO_BETTER) * least
    )


def _cost(result: PlanResult) -> float:
    assert result.cost is not None
    return result.cost
