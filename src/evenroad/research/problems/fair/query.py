"""Start and goal of a random world, by a rule that knows of no sampler."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from evenroad.world import World

Array = npt.NDArray[np.float64]

PAIRS = 512
"""Pairs of configurations that are tried in one world."""

BATCH = 32
"""Pairs whose validity is asked about together: few, since most worlds need no more."""


def draw_query(
    draw_world: Callable[[np.random.Generator], World],
    far_apart: Callable[[Array, Array], npt.NDArray[np.bool_]],
    rng: np.random.Generator,
) -> tuple[World, Array, Array]:
    """Draw a world, a start and a goal.

    Start and goal are two uniform configurations: the first pair of which both are free, that is far apart, and
    between which the straight motion is blocked.  A world in which none of 512 pairs will do is replaced by the next.

    Parameters
    ----------
    draw_world : callable
        From a generator to a world.
    far_apart : callable
        From the rows of two (m, cube_dim) arrays of the space's unit cube to which are far enough apart: (m,).
    rng : Generator
        Is consumed.

    Returns
    -------
    world : World
    start, goal : ndarray, shape (dim,)
    """
    while True:
        world = draw_world(rng)
        cube = rng.random((2, PAIRS, world.space.cube_dim))
        rows = np.flatnonzero(far_apart(cube[0], cube[1]))
        for begin in range(0, len(rows), BATCH):
            some = rows[begin : begin + BATCH]
            first, second = (world.space.from_cube(each[some]) for each in cube)
            both_free = world.valid(first) & world.valid(second)
            for start, goal in zip(first[both_free], second[both_free], strict=True):
                # One by one: the first pair nearly always does.
                if not world.motion_valid(start[np.newaxis], goal[np.newaxis])[0]:
                    return world, start, goal


def far_on_torus(a: Array, b: Array) -> npt.NDArray[np.bool_]:
    """Return which rows of two (m, d) arrays in the unit cube are at least sqrt(d / 12) apart on the torus: (m,).

    That is the root of the mean square for two uniform points.  Measured in the cube instead, far ends would be
    ends near its faces; on the torus each end alone stays uniform.
    """
    step = np.abs(b - a)
    step = np.minimum(step, 1.0 - step)
    return np.asarray((step**2).sum(axis=1) >= a.shape[1] / 12.0)
