"""Random worlds in the unit cube: T, balls on the torus, and X, boxes that bound three random coordinates."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from evenroad.research.bench.task import Problem
from evenroad.research.problems.fair.query import draw_query, far_on_torus
from evenroad.research.problems.fair.streams import Family, Stream, instance_rng
from evenroad.research.worlds.periodic import PeriodicBalls, PeriodicBoxes
from evenroad.world import World

BALLS: Mapping[int, int] = {2: 20, 3: 60, 4: 100, 5: 150, 6: 200, 7: 200, 10: 200}
BOXES: Mapping[int, int] = {2: 20, 3: 40, 4: 60, 5: 60, 6: 60, 7: 60, 10: 60}
"""Dimension -> number of obstacles; how large they are is calibrated.

Many rather than few: few large obstacles must leave so little of the cube free, to be as hard, that what is left of
any set looks random.
"""

BOUNDED_AXES = 3
"""Coordinates that a box bounds, like an obstacle in space; both of them in the plane."""


def draw_balls(d: int, radius: float, rng: np.random.Generator) -> PeriodicBalls:
    """Return balls of one radius with uniform centres."""
    return PeriodicBalls(rng.random((BALLS[d], d)), radius)


def draw_boxes(d: int, half_extent: float, rng: np.random.Generator) -> PeriodicBoxes:
    """Return boxes with uniform centres, in random axes, with half extents uniform in [.5, 1.5] times the given one."""
    count, bounded = BOXES[d], min(BOUNDED_AXES, d)
    axes = np.argsort(rng.random((count, d)), axis=1)[:, :bounded]
    centres = rng.random((count, bounded))
    half_extents = half_extent * (0.5 + rng.random((count, bounded)))
    return PeriodicBoxes(d, axes, centres, np.minimum(half_extents, 0.5))


DRAW: Mapping[Family, Callable[[int, float, np.random.Generator], World]] = {
    Family.BALLS: draw_balls,
    Family.BOXES: draw_boxes,
}
"""Family -> how a world is drawn from dimension, size and generator."""


def cube_problem(
    stream: Stream, family: Family, d: int, difficulty: int, size: float, instance: int
) -> Problem:
    """Return one instance in d dimensions with obstacles of this size: world, start and goal are drawn afresh."""
    rng = instance_rng(stream, family, d, difficulty, instance)
    world, start, goal = draw_query(partial(DRAW[family], d, size), far_on_torus, rng)
    return Problem(world, start, goal, set_dim=d)
