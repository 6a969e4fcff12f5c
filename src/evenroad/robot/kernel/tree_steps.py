"""Steps of a tree: an extension towards the next sample, or ball steps that passed the sieve."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.addresses import integers_at, matrix_at, singles_at
from evenroad.robot.kernel.layout import LANES, quick, quick_inlined
from evenroad.robot.kernel.motion import canonical, distance_and_direction
from evenroad.robot.kernel.motion_checks import Checks, blocked
from evenroad.robot.kernel.motion_states import CONFIGURATIONS, COUNTS, MOTIONS
from evenroad.robot.kernel.tree_nodes import TRIED, Trees, least_tried, nearest

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

NEXT_SAMPLE, NEXT_STEP, GROWING, STRAIGHT, START_NODE, GOAL_NODE, BEGUN = range(COUNTS, COUNTS + 7)
WAYPOINTS, REACHED, STATE = range(COUNTS + 7, COUNTS + 10)
"""What is kept from call to call, behind the counts: places in the two sequences, the tree that grows, how many goals
were tried straight on, where the trees met, whether they have roots, the size of the path and the end it leads to."""

STEPS_AT_ONCE = LANES // 2
EXTENSIONS = 3
"""A node is extended so often before it gets ball steps."""

LONGEST_STEP = 1.5
"""No step is longer [rad]."""

STEP_SHARE = 1.0 / 5.8
"""A step is this share of the ranges of the joints (root of the mean square) where that is less."""

LARGEST_BALL = 2.0
BALL_SHARE = 1.5
"""Ball steps are within this many steps, but for the largest [rad]."""


class Memory(NamedTuple):
    """Room that a call needs, and lengths of steps.

    Attributes
    ----------
    step : float
        No step of a tree is longer.
    radii : float64 array, shape (dim,)
        Of the ball of steps, along each coordinate.
    targets : float64 array, shape (8, dim)
        Where candidates lead.
    origins : int64 array, shape (8,)
        The nodes that they begin at.
    here, there, direction, target : float64 arrays, shape (dim,)
    lanes : float32 array, shape (16 + dim,)
    """

    step: float
    radii: Floats
    targets: Floats
    origins: Ints
    here: Floats
    there: Floats
    direction: Floats
    target: Floats
    lanes: Singles


def memory_for(dim: int) -> int:
    """Return how many doubles `memory_of` takes, periods of the trees included."""
    return (STEPS_AT_ONCE + 7) * dim + STEPS_AT_ONCE + LANES


@quick
def memory_of(buffer: int, bounds: Floats) -> Memory:
    """Return room, and steps as long as the ranges of the joints, (3, dim), ask for."""
    dim = bounds.shape[1]
    squares = 0.0
    for k in range(dim):
        squares += (bounds[1, k] - bounds[0, k]) ** 2 / dim
    step = min(LONGEST_STEP, STEP_SHARE * np.sqrt(squares))
    rows = matrix_at(buffer, (STEPS_AT_ONCE + 5, dim))
    end = buffer + 8 * (STEPS_AT_ONCE + 5) * dim
    radii = rows[4]
    for k in range(dim):
        radii[k] = min(LARGEST_BALL, BALL_SHARE * step, 0.5 * (bounds[1, k] - bounds[0, k]))
    return Memory(
        step,
        radii,
        matrix_at(buffer + 8 * 5 * dim, (STEPS_AT_ONCE, dim)),
        integers_at(end, (STEPS_AT_ONCE,)),
        rows[0],
        rows[1],
        rows[2],
        rows[3],
        singles_at(end + 8 * STEPS_AT_ONCE, (LANES + dim,)),
    )


@quick_inlined
def candidates(
    trees: Trees,
    tree: int,
    state: Ints,
    sequence: Floats,
    ball: Floats,
    most: int,
    memory: Memory,
    checks: Checks,
) -> int:
    """Write where the tree may go next and return how many candidates these are: one extension, or ball steps.

    At most so many steps are offered, all eight but where the budget ends.
    """
    dim, bounds = trees.nodes.shape[2], checks.bounds
    number, shift = state[NEXT_SAMPLE] % len(sequence), state[NEXT_SAMPLE] // len(sequence)
    state[NEXT_SAMPLE] += 1
    for k in range(dim):
        share = sequence[number, k]
        if shift > 0:
            # Shifts of an even sequence of their own: multiples of the golden ratio, one more for each coordinate.
            share = (share + shift * (k + 1) * 0.6180339887498949) % 1.0
        memory.target[k] = min(bounds[0, k] + share * (bounds[1, k] - bounds[0, k]), bounds[1, k])
    closest = nearest(trees, tree, memory.target, memory.lanes)
    tried = trees.links[TRIED, tree]
    if tried[closest] < EXTENSIONS:
        tried[closest] += 1
        here = trees.nodes[tree, closest]
        length = distance_and_direction(here, memory.target, bounds, memory.direction)
        share = min(1.0, memory.step / max(length, 1e-300))
        for k in range(dim):
            memory.targets[0, k] = here[k] + share * memory.direction[k]
        canonical(memory.targets[0], bounds)
        memory.origins[0] = closest
        return 1
    for candidate in range(most):
        origin = closest if candidate % 2 else least_tried(trees, tree)
        tried[origin] += 1
        memory.origins[candidate] = origin
        here, target = trees.nodes[tree, origin], memory.targets[candidate]
        row = state[NEXT_STEP] % len(ball)
        state[NEXT_STEP] += 1
        for k in range(dim):
            target[k] = here[k] + memory.radii[k] * ball[row, k]
        canonical(target, bounds)
        distance_and_direction(here, target, bounds, memory.direction)
        for k in range(dim):
            checks.states[k * LANES + 2 * candidate] = here[k] + 0.5 * memory.direction[k]
            checks.states[k * LANES + 2 * candidate + 1] = target[k]
    touching = blocked(checks)
    state[CONFIGURATIONS] += 2 * most
    kept = 0
    for candidate in range(most):
        if (touching >> (2 * candidate)) & 3:
            # A motion that was asked for, and is blocked.
            state[MOTIONS] += 1
            continue
        memory.origins[kept] = memory.origins[candidate]
        for k in range(dim):
            memory.targets[kept, k] = memory.targets[candidate, k]
        kept += 1
    return kept
