"""A path without a number of points: by the world's own planner where it has one, else with points that grow.

More time buys better paths: `improve` plans again in other ways, and keeps the best.  Without a path, the answer says
whether the start or a goal can hardly leave its place.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from itertools import count, pairwise

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._clock import now
from evenroad.points.pointset import Origin
from evenroad.roadmap.answer import connected, gave_up, refusal, shown_apart
from evenroad.roadmap.anytime import plan_anytime
from evenroad.roadmap.attempt import NO_LIMIT, Attempt
from evenroad.roadmap.budget import Budget
from evenroad.roadmap.query import AsksApart, Query, as_points, read_places
from evenroad.roadmap.result import PlanResult, Stage, Status
from evenroad.world import Connection, ConnectsAnew, ConnectsItself, Explains, Separates, ShowsApart, World

SECONDS = 5.0
"""Wall time of a budget that is not given."""
NO_POINTS = Origin(family="none", method="no points")
NO_BETTER = 1e-9
"""A path is not improved on that exceeds the shortest possible by no more than this share."""
BEFORE_PROOF = 200_000
"""After so many motions a world is asked whether there can be a path at all: more than hard queries take."""
BEFORE_QUICK_PROOF = 4_000
"""After so many, one that can say so quickly: most queries take fewer."""
LEAST_MOTIONS, LONGER = 1000, 4
"""A round gives up after so many motions, or after so many times those of the first path, whichever is more."""
TO_NEAREST = 300
"""Motions that are checked at most on the way to the nearest of several goals alone."""


def find_path(
    world: World,
    start: npt.ArrayLike,
    goal: npt.ArrayLike,
    *,
    budget: Budget | None = None,
    shorten: bool = True,
    improve: bool = False,
    apart: AsksApart | None = None,
) -> PlanResult:
    """Plan until there is a path, it is proved that there is none, or the budget is spent.

    A world that connects itself plans; trees are led to the nearest of several goals first, for a short while, then to
    all.  Where it finds nothing, one that can tell is asked whether there can be a path at all.  Then, and with any
    other world, points are added until they suffice.

    Parameters
    ----------
    world, start, goal, shorten
        As in :func:`plan`.
    budget : Budget, optional
        Default: five seconds.
    improve : bool
        Go on after the first path, until the budget is spent, and return the best of all.  The count ``rounds`` then
        says how often it was planned anew, and `stages` when better paths were found.
    apart : callable, optional
        Asked in place of the world what keeps the start from the goals, where they are not all that would do: it is
        given the start, (dim,), the goals, (g, dim), and whether to be quick, and returns an
        :class:`evenroad.world.Apart` or None.

    The status ``not_connected`` is proved; without path and proof it is ``budget_spent``, and the message says where
    start or goal can hardly leave their places, or what a proof falls short of.  InvalidValue if one of them does not
    have the dimension of the space, or is not finite.
    """
    budget = budget or Budget(seconds=SECONDS)
    query = Query(*read_places(start, goal, world.space), shorten=shorten, budget=budget, apart=apart)
    attempt = Attempt(world, query, NO_POINTS, "none", "none")
    if isinstance(world, ConnectsItself):
        attempt.planner = world.planner
        if (refused := refusal(attempt)) is not None:
            return refused
        connection = _connection(attempt, world, _stages(world)[0][0])
        for (most, quickly), (more, _) in pairwise(_stages(world)):
            if connection.goal >= 0:
                break
            ended = connection.motions < most or attempt.left() is None
            if (apart_for := shown_apart(attempt, quickly=quickly and not ended)) is not None:
                return apart_for
            if ended:
                break
            # The same search again, and further.
            attempt.motions_checked -= connection.motions
            connection = _connection(attempt, world, more)
        if connection.goal >= 0:
            result = connected(attempt, connection)
            return _improved(attempt, result) if improve else result
        if (left := attempt.left()) is None:
            return with_reasons(world, gave_up(attempt, connection))
        budget = left
    until = "budget" if improve else "solved"
    grown = plan_anytime(world, query.start, query.goals, until=until, budget=budget, shorten=shorten)
    return with_reasons(world, grown)


def _stages(world: World) -> list[tuple[int, bool]]:
    """Return after how many motions a world is asked whether there can be a path, and whether quickly; then no more."""
    last = [(NO_LIMIT, False)]
    if isinstance(world, ShowsApart):
        return [(BEFORE_QUICK_PROOF, True), (BEFORE_PROOF, False), *last]
    return [(BEFORE_PROOF, False), *last] if isinstance(world, Separates) else last


def _connection(attempt: Attempt, world: ConnectsItself, most: int) -> Connection:
    """Let the world join the start to a goal, trees to the nearest one first: of many they may meet a far one."""
    start, goals = attempt.query.start, attempt.query.goals[attempt.goals]
    if len(goals) == 1 or not isinstance(world, ConnectsAnew):
        return attempt.connect(world, most=most)
    nearest = int(np.argmin(attempt.world.space.distance(np.broadcast_to(start, goals.shape), goals)))
    near = attempt.connect(world, most=min(most, TO_NEAREST), goal=nearest)
    if near.goal >= 0 or attempt.left() is None:
        return near
    found = attempt.connect(world, most=most - near.motions)
    return replace(
        found,
        nodes=near.nodes + found.nodes,
        configurations=near.configurations + found.configurations,
        motions=near.motions + found.motions,
    )


def _improved(attempt: Attempt, first: PlanResult) -> PlanResult:
    """Return the best path within what is left of the budget, or of its rounds; never a worse one than the first."""
    nodes = first.counts["nodes"]
    stage = Stage(nodes, nodes, attempt.motions_checked, first.cost, attempt.elapsed())
    if isinstance(attempt.world, ConnectsAnew):
        return _by_rounds(attempt, attempt.world, first, stage)
    return _by_growth(attempt, first, stage)


def _by_rounds(attempt: Attempt, world: ConnectsAnew, first: PlanResult, stage: Stage) -> PlanResult:
    """Let the world plan again and again, each time driven by another sequence."""
    best, stages, nodes, counts, done = first, [stage], stage.points, dict(first.counts), 0
    # A round that is much longer than the first was takes the time of many others.
    most = max(LEAST_MOTIONS, LONGER * attempt.motions_checked)
    for variant in count(1):
        if not _goes_on(attempt, best, variant):
            break
        connection = attempt.connect(world, variant, most)
        done, nodes = variant, nodes + connection.nodes
        counts["configurations_checked"] += connection.configurations
        if connection.goal < 0:
            continue
        result = connected(attempt, connection)
        if attempt.query.shorten:
            counts["shortcut_motions"] += result.counts["shortcut_motions"]
        if _cost(result) < _cost(best):
            best = result
            stages.append(Stage(nodes, nodes, attempt.motions_checked, best.cost, attempt.elapsed()))
    counts |= {"nodes": nodes, "edges_checked": attempt.motions_checked, "rounds": done}
    message = f"{best.message}, the best of {done + 1}" if done else best.message
    return replace(best, message=message, counts=counts, stages=tuple(stages), timings=attempt.watch.seconds)


def _by_growth(attempt: Attempt, first: PlanResult, stage: Stage) -> PlanResult:
    """Grow a roadmap beside the first path."""
    query, left = attempt.query, attempt.left()
    if left is None or not _goes_on(attempt, first, 1):
        return replace(first, counts=first.counts | {"rounds": 0}, stages=(stage,))
    before = attempt.elapsed()
    ends = (query.start, query.goals)
    grown = plan_anytime(attempt.world, *ends, until="budget", budget=left, shorten=query.shorten)
    stages = [stage, *(replace(each, seconds=before + each.seconds) for each in grown.stages)]
    best = grown if grown.cost is not None and grown.cost < _cost(first) else first
    return replace(best, counts=best.counts | {"rounds": len(grown.stages)}, stages=tuple(stages))


def _goes_on(attempt: Attempt, best: PlanResult, variant: int) -> bool:
    """Return whether the budget allows this round, and the path exceeds the distance to the nearest goal."""
    budget, start, goals = attempt.query.budget, attempt.query.start, attempt.query.goals[attempt.goals]
    least = float(attempt.world.space.distance(np.broadcast_to(start, goals.shape), goals).min())
    return (
        now() < attempt.deadline
        and (budget.rounds is None or variant <= budget.rounds)
        and (budget.motions is None or attempt.motions_checked < budget.motions)
        and _cost(best) > (1.0 + NO_BETTER) * least
    )


def _cost(result: PlanResult) -> float:
    assert result.cost is not None
    return result.cost


DIRECTIONS = 128
"""Short motions that are tried from a place."""
SHORT = 0.1
"""How long they are, as a share of the distance to an even point of the space at the median."""
HEMMED = 0.1
"""A place is hemmed in from which no more than this share of them is free."""
_SHARES = np.linspace(0.05, 1.0, 20)
"""Where along a short motion something may touch."""


def with_reasons(world: World, result: PlanResult) -> PlanResult:
    """Return a result without a path, its message with what is in the way of the start or the goals.

    Nothing is added where there is a path, a proof that there is none, or nothing to be said.  Costs some hundred
    checks for the start and for each goal.
    """
    if result.path is not None or result.status not in (Status.NOT_CONNECTED, Status.BUDGET_SPENT):
        return result
    several = len(result.goals) > 1
    places = [("the start", result.start)] + [
        (f"goal {i}" if several else "the goal", goal)
        for i, goal in enumerate(result.goals)
        if world.valid(goal[np.newaxis])[0]
    ]
    reasons = [text for name, place in places if (text := why_hemmed(world, name, place)) is not None]
    sentences = [result.message, *(text[0].upper() + text[1:] for text in reasons)]
    return replace(result, message=". ".join(sentences)) if reasons else result


def why_hemmed(world: World, name: str, place: Floats) -> str | None:
    """Return in words how few short motions leave a free place, (dim,), and what touches; None where enough do."""
    samples = world.space.from_cube(as_points(DIRECTIONS, world.space).points)
    here = np.broadcast_to(place, samples.shape)
    distances = world.space.distance(here, samples)
    step = SHORT * float(np.median(distances))
    ends = world.space.interpolate(here, samples, np.minimum(1.0, step / np.maximum(distances, step)))
    free = world.motion_valid(here, ends)
    number = int(np.count_nonzero(free))
    if number > HEMMED * DIRECTIONS:
        return None
    away = distances[world.valid(samples)].min(initial=np.inf)
    can = "cannot leave its place" if number == 0 else "can hardly leave its place"
    text = (
        f"{name} {can}: {number} of {DIRECTIONS} motions of length {step:.2g} from it are free"
        f"{_what_touches(world, here[~free], ends[~free])}"
    )
    return f"{text}; the nearest free sample is {away:.3g} away" if np.isfinite(away) else text


def _what_touches(world: World, a: Floats, b: Floats) -> str:
    """Return what most of the blocked motions meet first, where the world can tell."""
    if not isinstance(world, Explains):
        return ""
    met: Counter[str] = Counter()
    for first, last in zip(a, b, strict=True):
        shape = (len(_SHARES), len(first))
        states = world.space.interpolate(np.broadcast_to(first, shape), np.broadcast_to(last, shape), _SHARES)
        blocked = np.flatnonzero(~world.valid(states))
        if len(blocked):
            met[world.explain(states[blocked[0]])] += 1
    if not met:
        return ""
    reason, times = met.most_common(1)[0]
    return f", {reason} in {times}"
