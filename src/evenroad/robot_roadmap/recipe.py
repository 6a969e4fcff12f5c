"""What milestones are chosen by: a recipe, and what it needs to know of robot and cell."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad.errors import InvalidValue
from evenroad.points import draw
from evenroad.robot import ArmWorld, Robot
from evenroad.robot_roadmap.free_probability import free_probability
from evenroad.robot_roadmap.narrow_passages import FIRST, Visibility, hard_queries
from evenroad.robot_roadmap.spread import displacement_weights, spread_order
from evenroad.robot_roadmap.turns import TURN, OneTurn

CHOICE = 16
"""Free configurations that one milestone is chosen from; of few milestones FIRST in all."""

MOST_DRAWN = 1 << 20
"""Where fewer than the wanted ones are free among so many, the robot is said to be hardly ever free."""

EXPLAINED = 100
"""Of these it is found out what blocks them, and what blocks most is named."""

GAMMA = 4.0
"""Power of the chance of being free that milestones are as dense as, before the ends count."""

HARD_QUERIES = 3000
"""Ends in pockets at random that milestones learn from."""

PAIRS, FEWEST_HARD_QUERIES = 60, 300
"""Of robots with more pairs of capsules than that fewer in proportion, since each costs more, but so many at least."""

SCENES = 400
"""Random scenes by which the chance of being free is measured."""

MEASURED = 1500
"""Configurations that the weights of the metric are measured on."""


class Recipe(NamedTuple):
    """The power of the chance of being free, >= 0, and how many ends in pockets are learned from."""

    gamma: float = GAMMA
    hard_queries: int = HARD_QUERIES


class Precomputed(NamedTuple):
    """What milestones are chosen by: free configurations, (n, dim), the weights and periods of the metric, (dim,) each,
    the chance of each to be free among random boxes, (n,), and which of them ends in pockets see.
    """

    pool: Floats
    weights: Floats
    periods: Floats
    chance: Floats
    seen: Visibility


def recipe_for(robot: Robot) -> Recipe:
    """Return the recipe for a robot: the more pairs it has, the fewer ends in pockets are tried."""
    return Recipe(
        GAMMA, min(HARD_QUERIES, max(FEWEST_HARD_QUERIES, HARD_QUERIES * PAIRS // max(len(robot.pairs), 1)))
    )


def precomputed(
    world: ArmWorld,
    one: OneTurn,
    n: int,
    recipe: Recipe,
    streams: Sequence[np.random.Generator],
    progress: Callable[[str, float], None],
) -> Precomputed:
    """Find out what a recipe for n milestones needs; the streams draw pool, scenes and pockets."""
    pool_rng, scene_rng, passage_rng = streams
    progress("drawing configurations", 0.0)
    pool = _free_pool(world, one, max(CHOICE * n, FIRST), pool_rng)
    weights = displacement_weights(world.robot, pool[:MEASURED])
    chance = np.ones(len(pool))
    if recipe.gamma > 0.0:
        chance = free_probability(
            world.robot, pool, SCENES, scene_rng, lambda share: progress("random scenes", share)
        )
    seen = hard_queries(
        world.robot,
        world.scene,
        pool,
        weights * pool,
        recipe.hard_queries,
        passage_rng,
        lambda share: progress("pockets", share),
    )
    # A joint with stops repeats after its range.
    periods = np.where(one.wraps, TURN, one.high - one.low)
    return Precomputed(pool, weights, periods, chance, seen)


def chosen(data: Precomputed, recipe: Recipe, n: int) -> Ints:
    """Return which rows of the pool are the n milestones of a recipe, in order."""
    preference = np.maximum(data.chance, 1.0 / SCENES) ** recipe.gamma
    first = data.seen.first[: recipe.hard_queries + 1]
    weights = data.weights
    return spread_order(
        weights * data.pool, weights * data.periods, preference, n, first, data.seen.which[: first[-1]]
    )


def _free_pool(world: ArmWorld, one: OneTurn, count: int, rng: np.random.Generator) -> Floats:
    """Return the first free ones of a low-discrepancy sequence, (count, dim), or the fewer that MOST_DRAWN hold."""
    drawn = 2 * count
    while True:
        cube = draw("sobol", drawn, world.space.dim, rng=rng.spawn(1)[0]).points
        q = one.low + cube * (one.high - one.low)
        free = q[world.valid(q)]
        if len(free) >= count or drawn >= MOST_DRAWN:
            break
        drawn *= 2
    if not len(free):
        blocked = Counter(world.explain(each) for each in q[-EXPLAINED:])
        often, count = blocked.most_common(1)[0]
        raise InvalidValue(
            f"the robot is never free: of {drawn} configurations none; in {count} of the last"
            f" {blocked.total()} {often}"
        )
    return free[:count]
