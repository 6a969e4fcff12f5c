"""Reasons for no path: whether obstacles enclose the start or a goal, and which ones."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np

from evenroad._arrays import Floats
from evenroad._time_limit import BudgetSpent, look_at_clock
from evenroad.planning.result import PlanResult, Status
from evenroad.points.reversed_halton import cube_points
from evenroad.world import Explains, World

DIRECTIONS = 128
"""Number of short motions to try from a configuration."""
SHORT = 0.1
"""Length of these motions, as a share of the median distance to an even point of the space."""
ENCLOSED = 0.1
"""Share of free short motions up to which a configuration counts as enclosed."""
_SHARES = np.linspace(0.05, 1.0, 20)
"""Shares along a short motion at which contacts are tested."""


def with_reasons(world: World, result: PlanResult) -> PlanResult:
    """Return a result without a path, with a message that also names the obstacles that enclose start or goals.

    The message does not change if there is a path or a proof that there is none, or no time is left.  The reasons cost
    some hundred checks for the start and for each goal.
    """
    if result.path is not None or result.status not in (Status.NOT_CONNECTED, Status.BUDGET_SPENT):
        return result
    if result.message.startswith("proved"):
        return result
    try:
        return _with_sentences(world, result)
    except BudgetSpent:
        return result


def _with_sentences(world: World, result: PlanResult) -> PlanResult:
    look_at_clock()
    # Imported late: most plans have no constraints.
    from evenroad.constraints.constrained_world import KeptWorld

    # Most short motions violate constraints, so they say nothing about obstacles.
    if isinstance(world, KeptWorld):
        return result
    several = len(result.goals) > 1
    named = [("the start", result.start)] + [
        (f"goal {i}" if several else "the goal", goal)
        for i, goal in enumerate(result.goals)
        if world.valid(goal[np.newaxis])[0]
    ]
    reasons = [text for name, configuration in named if (text := why_enclosed(world, name, configuration)) is not None]
    sentences = [result.message, *(text[0].upper() + text[1:] for text in reasons)]
    return replace(result, message=". ".join(sentences)) if reasons else result


def why_enclosed(world: World, name: str, configuration: Floats) -> str | None:
    """Return how few short motions from a configuration, (dim,), are free, and what blocks them; None if enough are."""
    samples = world.space.from_cube(cube_points(world.space.cube_dim)[:DIRECTIONS])
    here = np.broadcast_to(configuration, samples.shape)
    distances = world.space.distance(here, samples)
    step = SHORT * float(np.sort(distances)[DIRECTIONS // 2])
    reached = world.space.interpolate(here, samples, np.minimum(1.0, step / np.maximum(distances, step)))
    free = world.motion_valid(here, reached)
    number = int(np.count_nonzero(free))
    if number > ENCLOSED * DIRECTIONS:
        return None
    away = distances[world.valid(samples)].min(initial=np.inf)
    can = "is enclosed" if number == 0 else "is nearly enclosed"
    text = (
        f"{name} {can}: {number} of {DIRECTIONS} motions of length {step:.2g} from it are free"
        f"{_what_touches(world, here[~free], reached[~free])}"
    )
    return f"{text}; the nearest free sample is {away:.3g} away" if np.isfinite(away) else text


def _what_touches(world: World, a: Floats, b: Floats) -> str:
    """Return the contact that most of the blocked motions reach first, if the world can explain it."""
    if not isinstance(world, Explains):
        return ""
    met: Counter[str] = Counter()
    for first, last in zip(a, b, strict=True):
        look_at_clock()
        shape = (len(_SHARES), len(first))
        states = world.space.interpolate(np.broadcast_to(first, shape), np.broadcast_to(last, shape), _SHARES)
        blocked = np.flatnonzero(~world.valid(states))
        if len(blocked):
            met[world.explain(states[blocked[0]])] += 1
    if not met:
        return ""
    reason, times = met.most_common(1)[0]
    return f", {reason} in {times}"
