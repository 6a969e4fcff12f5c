"""The recipe by which milestones are chosen, and what it precomputes for robot and static scene."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad._native import roadmap as native
from evenroad.errors import InvalidValue
from evenroad.robot import ArmWorld, Robot
from evenroad.robot.kinematics import KinematicTree, capsule_endpoints
from evenroad.robot.tree_sequences import reversed_halton
from evenroad.robot_roadmap.free_probability import free_probability
from evenroad.robot_roadmap.narrow_passages import Visibility, hard_queries
from evenroad.robot_roadmap.turns import TURN, OneTurn

CHOICE, FEWEST = 8, 4096
"""Number of free configurations per milestone to choose from, and the least number of all."""

LIKELY, FEWEST_LIKELY = 0.3, 2048
"""Share of them, the most probably free ones, that hard queries are tried to be joined to, and their least number:
hardly another is chosen.
"""

MOST_DRAWN = 1 << 20
"""Number of configurations after which no more are drawn; fewer free ones than wanted are then enough."""

EXPLAINED = 100
"""Number of configurations for which an error finds out what blocks most."""

GAMMA = 4.0
"""Power of the probability of being free in the density of milestones, before hard queries count."""

HARD_QUERIES = 1500
"""Number of random hard queries that milestones are chosen for."""

PAIRS, FEWEST_HARD_QUERIES = 120, 300
"""Number of capsule pairs above which a robot gets fewer hard queries in proportion, and their least number."""

SCENES = 400
"""Number of random scenes by which the probability of being free is measured."""

MEASURED = 1500
"""Number of configurations that the weights of the metric are measured on."""


class Recipe(NamedTuple):
    """The power of the probability of being free, >= 0, and the number of hard queries."""

    gamma: float = GAMMA
    hard_queries: int = HARD_QUERIES


class Precomputed(NamedTuple):
    """What milestones are chosen by: free configurations, (n, dim), the weights and periods of the metric, (dim,) each,
    the probability of each to be free among random boxes, (n,), and which are visible from hard queries.
    """

    pool: Floats
    weights: Floats
    periods: Floats
    chance: Floats
    seen: Visibility


def recipe_for(robot: Robot) -> Recipe:
    """Return the recipe for a robot: the more pairs it has, the fewer hard queries are tried."""
    return Recipe(GAMMA, min(HARD_QUERIES, max(FEWEST_HARD_QUERIES, HARD_QUERIES * PAIRS // max(len(robot.pairs), 1))))


def precomputed(
    world: ArmWorld,
    one: OneTurn,
    n: int,
    recipe: Recipe,
    streams: Sequence[np.random.Generator],
    progress: Callable[[str, float], None],
) -> Precomputed:
    """Precompute what a recipe for n milestones needs; the streams draw pool, scenes and passages."""
    pool_rng, scene_rng, passage_rng = streams
    progress("drawing configurations", 0.0)
    pool = _free_pool(world, one, max(CHOICE * n, FEWEST), pool_rng)
    weights = displacement_weights(world.robot, pool[:MEASURED])
    chance = np.ones(len(pool))
    if recipe.gamma > 0.0:
        chance = free_probability(world.robot, pool, SCENES, scene_rng, lambda share: progress("random scenes", share))
    seen = hard_queries(
        world.robot,
        world.scene,
        pool,
        np.flatnonzero(chance >= np.quantile(chance, max(1.0 - max(LIKELY, FEWEST_LIKELY / len(pool)), 0.0))),
        recipe.hard_queries,
        passage_rng,
        lambda share: progress("narrow passages", share),
    )
    # A joint with limits repeats after its range.
    periods = np.where(one.wraps, TURN, one.high - one.low)
    return Precomputed(pool, weights, periods, chance, seen)


def chosen(data: Precomputed, recipe: Recipe, n: int) -> Ints:
    """Return which rows of the pool are the n milestones of a recipe, in order."""
    preference = np.maximum(data.chance, 1.0 / SCENES) ** recipe.gamma
    first = data.seen.first[: recipe.hard_queries + 1]
    weights = data.weights
    return spread_order(weights * data.pool, weights * data.periods, preference, n, first, data.seen.which[: first[-1]])


def _free_pool(world: ArmWorld, one: OneTurn, count: int, rng: np.random.Generator) -> Floats:
    """Return the first free ones of Halton's sequence, shifted at random, or fewer if MOST_DRAWN hold no more:
    (count, dim).
    """
    drawn, shift = 2 * count, rng.random(world.space.dim)
    while True:
        cube = (reversed_halton(drawn, world.space.dim) + shift) % 1.0
        q = one.low + cube * (one.high - one.low)
        free = q[world.valid(q)]
        if len(free) >= count or drawn >= MOST_DRAWN:
            break
        drawn *= 2
    if not len(free):
        blocked = Counter(world.explain(each) for each in q[-EXPLAINED:])
        often, count = blocked.most_common(1)[0]
        raise InvalidValue(
            f"the robot is never free: of {drawn} configurations none; in {count} of the last {blocked.total()} {often}"
        )
    return free[:count]


STEP = 1e-4
"""Step of the difference quotient that measures how far a joint moves the body [rad or m]."""

LEAST_WEIGHT = 0.01
"""Smallest weight of a joint, as a share of that of the joint that moves the body most."""

SERVED = 1.5
"""Power by which hard queries count less: one that sees m of the chosen points counts (1 + m)^-SERVED."""

LEAST_SEEN = 1e-3
"""Share of hard queries that every point counts to be seen by at least, so that spreading goes on in the end."""

_NONE = np.empty(0, dtype=np.int64)


def displacement_weights(robot: KinematicTree, q: Floats) -> Floats:
    """Return the weight of each joint, by how far it moves the robot's body: (dim,), of mean 1.

    ``w_j = sqrt(m_j)`` up to a factor, where m_j is the mean over the configurations `q`, (n, dim), of the longest
    displacement of any endpoint or middle of a capsule per unit of joint j [m/rad, or 1].
    """
    moved = np.empty(q.shape[1])
    body = _body_points(robot, q)
    for joint in range(len(moved)):
        there = q.copy()
        there[:, joint] += STEP
        x, y, z = np.moveaxis(_body_points(robot, there) - body, 2, 0)
        moved[joint] = np.sqrt((x * x + y * y + z * z).max(axis=1)).mean() / STEP
    if not moved.any():
        return np.ones(len(moved))
    weights = np.sqrt(np.maximum(moved, LEAST_WEIGHT * moved.max()))
    return weights / weights.mean()


def _body_points(robot: KinematicTree, q: Floats) -> Floats:
    """Return the endpoints and middles of all capsules, (n, 3 capsules, 3) [m]."""
    queries = capsule_endpoints(robot, q)
    return np.concatenate([queries[:, :, 0], queries[:, :, 1], queries.mean(axis=2)], axis=1)


def spread_order(
    points: Floats, period: Floats, preference: Floats, count: int, first: Ints = _NONE, which: Ints = _NONE
) -> Ints:
    """Return the first rows of `points`, (n, dim), in an order whose first n are well spread for every n: (count,).

    Farthest-point order (Gonzalez 1985) with a preference, (n,) > 0: the next point has the largest product of its
    distance to those before and its preference, so spacing is in proportion to 1 / preference.  Axes repeat after
    `period`, (dim,); inf where they do not.  From hard query e the points ``which[first[e]:first[e + 1]]`` are visible.
    The preference is also in proportion to LEAST_SEEN plus the share of queries that see a point, each of which counts
    (1 + m)^-SERVED after m of its points were chosen.
    """
    served = LEAST_SEEN, SERVED
    return native.spread_order((points, period), preference, count, (first, which), served)
