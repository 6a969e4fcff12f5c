"""A planner in compiled code: two trees that grow from the start and from the goals until they meet.

RRT-Connect (J. Kuffner and S. LaValle, 2000), with an even sequence in place of random samples, and with ball steps:
a node whose extensions were tried often enough offers eight steps in evenly spread directions at once; one batch of
sixteen lanes holds the middle and the end of each, and only those free at both are looked at in full.  From a
configuration deep in a shelf few directions are free; this finds them at a sixteenth of the price.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad.robot.kernel.layout import LANES, inner, quick
from evenroad.robot.kernel.motion import canonical, distance_and_way, enter
from evenroad.robot.kernel.motion_checks import (
    BATCHES,
    BOTH_ENDS,
    CONFIGURATIONS,
    COUNTS,
    MOTIONS,
    START,
    Checks,
    blocked,
    checks_of,
    motion_free,
    motion_proved,
)
from evenroad.robot.kernel.tree_nodes import (
    PARENT,
    PROVED,
    TRIED,
    Trees,
    add_node,
    least_tried,
    nearest,
    remove_branch,
)

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

PAUSED, FULL, SPENT, NOT_FREE, SOLVED = range(5)
"""What a call of `grow` ends with: its slice used up, no room in the trees, the budget spent, start or goals not free,
a path found."""

NEXT_SAMPLE, NEXT_STEP, GROWING, STRAIGHT, START_NODE, GOAL_NODE, BEGUN, STATE = range(COUNTS, COUNTS + 8)
"""What is kept from call to call, behind the counts: places in the two sequences, the tree that grows, how many goals
were tried straight on, where the trees met, and whether they have roots."""

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

MOST_STEPS = 64
"""So many steps at most are made in one go towards the other tree."""

ROOM = (STEPS_AT_ONCE + 1) * (MOST_STEPS + 2)
"""A round may add so many nodes."""

MOST_STRAIGHT = 16
"""So many goals at most are first tried straight on."""

PROOF_TOLERANCE = 1e-6
PROOF_BATCHES = 1024
"""Limits of the proof of a motion of the trees [m]."""


class Memory(NamedTuple):
    """Room that a call needs, and lengths of steps.

    Attributes
    ----------
    step : float
        No step of a tree is longer.
    radii : float64 array, shape (dim,)
        Of the ball of steps, along each coordinate.
    origins : int64 array, shape (8,)
        The nodes that candidates begin at.
    targets : float64 array, shape (8, dim)
        Where they lead.
    here, there, way, target : float64 arrays, shape (dim,)
    lanes : float32 array, shape (16 + dim,)
    """

    step: float
    radii: Floats
    origins: Ints
    targets: Floats
    here: Floats
    there: Floats
    way: Floats
    target: Floats
    lanes: Singles


@inner
def _memory(bounds: Floats) -> Memory:
    dim = bounds.shape[1]
    squares = 0.0
    for k in range(dim):
        squares += (bounds[1, k] - bounds[0, k]) ** 2 / dim
    step = min(LONGEST_STEP, STEP_SHARE * np.sqrt(squares))
    radii = np.empty(dim)
    for k in range(dim):
        radii[k] = min(LARGEST_BALL, BALL_SHARE * step, 0.5 * (bounds[1, k] - bounds[0, k]))
    room = np.empty((STEPS_AT_ONCE + 4, dim))
    return Memory(
        step,
        radii,
        np.empty(STEPS_AT_ONCE, dtype=np.int64),
        room[4:],
        room[0],
        room[1],
        room[2],
        room[3],
        np.empty(LANES + dim, dtype=np.float32),
    )


@njit(cache=True, nogil=True, error_model="numpy")
def grow(
    ends: Floats,
    nodes: Floats,
    columns: Singles,
    links: Ints,
    sizes: Ints,
    state: Ints,
    sequence: Floats,
    ball: Floats,
    most_motions: int,
    slice_batches: int,
    addresses: tuple[int, int],
    resolution: float,
    bounds: Floats,
    tables: Ints,
    arms: Floats,
    pair_arms: Floats,
) -> int:
    """Grow two trees until they meet and return how the call ended; called again with the same, it goes on.

    Parameters
    ----------
    ends : float64 array, shape (1 + g, dim)
        The start, and the goals, which become the roots of the second tree; the first are tried straight on.
    nodes, columns, links, sizes : arrays
        The fields of ``Trees``; sizes are 0 at first.  Room for 2 g + ROOM nodes at least.
    state : int64 array, shape (STATE,)
        Zeros at first; counts, and what is kept from call to call.
    sequence : float64 array, shape (n, dim)
        Points of the unit cube.  After the last one it goes on from the first, each time shifted a little further.
    ball : float64 array, shape (m, dim)
        Points of the unit ball, used in turn.
    most_motions : int
        After so many motions the budget is spent.
    slice_batches : int
        After about so many batches of sixteen checks the call returns, for the caller to look at the clock.
    addresses, resolution, bounds, tables, arms, pair_arms
        As ``motion_checks.checks_of`` takes them.
    """
    trees = Trees(nodes, columns, links, sizes, np.empty(bounds.shape[1], dtype=np.float32))
    for k in range(bounds.shape[1]):
        trees.periods[k] = min(bounds[2, k], 1e30)
    checks = checks_of(addresses, resolution, bounds, tables, arms, pair_arms, state[:COUNTS])
    memory = _memory(bounds)
    if state[BEGUN] == 0:
        _begin(ends, trees, memory, checks)
        state[BEGUN] = 1
    if sizes[0] == 0 or sizes[1] == 0:
        return NOT_FREE
    pause = state[BATCHES] + slice_batches
    goals = 0
    while goals < sizes[1] and links[PARENT, 1, goals] < 0:
        goals += 1
    while True:
        if state[MOTIONS] >= most_motions:
            return SPENT
        if state[BATCHES] >= pause:
            return PAUSED
        if max(sizes[0], sizes[1]) + ROOM > nodes.shape[1]:
            return FULL
        count = 0
        if state[STRAIGHT] < min(goals, MOST_STRAIGHT):
            tree, found, other = 0, 0, state[STRAIGHT]
            state[STRAIGHT] += 1
        else:
            tree = state[GROWING]
            if sizes[tree] > sizes[1 - tree]:
                tree = 1 - tree
            state[GROWING] = tree
            count = _candidates(trees, tree, state, sequence, ball, memory, checks)
            found, other = -1, -1
        # A goal straight on is a round of its own, without a candidate.
        for candidate in range(-1 if found >= 0 else 0, count):
            if candidate >= 0:
                found = _extended(trees, tree, memory.origins[candidate], memory.targets[candidate], checks)
                if found < 0:
                    continue
                other = nearest(trees, 1 - tree, trees.nodes[tree, found], memory.lanes)
            met = _reach(trees, tree, found, other, memory, checks)
            if met >= 0:
                state[START_NODE + tree], state[GOAL_NODE - tree] = met, other
                if _is_proved(trees, state, checks):
                    return SOLVED
                # Nodes may have been removed: the other candidates know old numbers.
                break


@quick
def _begin(ends: Floats, trees: Trees, memory: Memory, checks: Checks) -> None:
    """Plant the trees: the start in the first, the goals in the second; leave out what is not free."""
    count, dim = ends.shape
    for first in range(0, count, LANES):
        some = min(LANES, count - first)
        inside = 0
        for lane in range(LANES):
            # Lanes to spare repeat the last row.
            if enter(ends[first + min(lane, some - 1)], checks.bounds, memory.here):
                inside |= 1 << lane
            canonical(memory.here, checks.bounds)
            for k in range(dim):
                checks.states[k * LANES + lane] = memory.here[k]
        free = inside & ~blocked(checks)
        checks.counts[CONFIGURATIONS] += some
        for lane in range(some):
            if (free >> lane) & 1:
                row = first + lane
                for k in range(dim):
                    memory.here[k] = checks.states[k * LANES + lane]
                root = add_node(trees, min(row, 1), memory.here, -1)
                # Nothing leads to a root that could be proved: here is which of the ends it is.
                trees.links[PROVED, min(row, 1), root] = row
        if trees.sizes[0] == 0:
            return


@quick
def _candidates(
    trees: Trees, tree: int, state: Ints, sequence: Floats, ball: Floats, memory: Memory, checks: Checks
) -> int:
    """Write where the tree may go next and return how many candidates these are: one extension, or ball steps."""
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
        length = distance_and_way(here, memory.target, bounds, memory.way)
        share = min(1.0, memory.step / max(length, 1e-300))
        for k in range(dim):
            memory.targets[0, k] = here[k] + share * memory.way[k]
        canonical(memory.targets[0], bounds)
        memory.origins[0] = closest
        return 1
    for candidate in range(STEPS_AT_ONCE):
        origin = closest if candidate % 2 else least_tried(trees, tree)
        tried[origin] += 1
        memory.origins[candidate] = origin
        here, target = trees.nodes[tree, origin], memory.targets[candidate]
        row = state[NEXT_STEP] % len(ball)
        state[NEXT_STEP] += 1
        for k in range(dim):
            target[k] = here[k] + memory.radii[k] * ball[row, k]
        canonical(target, bounds)
        distance_and_way(here, target, bounds, memory.way)
        for k in range(dim):
            checks.states[k * LANES + 2 * candidate] = here[k] + 0.5 * memory.way[k]
            checks.states[k * LANES + 2 * candidate + 1] = target[k]
    touching = blocked(checks)
    state[CONFIGURATIONS] += LANES
    kept = 0
    for candidate in range(STEPS_AT_ONCE):
        if (touching >> (2 * candidate)) & 3:
            # A motion that was asked for, and is blocked.
            state[MOTIONS] += 1
            continue
        memory.origins[kept] = memory.origins[candidate]
        for k in range(dim):
            memory.targets[kept, k] = memory.targets[candidate, k]
        kept += 1
    return kept


@quick
def _extended(trees: Trees, tree: int, origin: int, target: Floats, checks: Checks) -> int:
    """Return the number of a new node at `target`, or -1 where the motion there from `origin` is blocked."""
    if not motion_free(trees.nodes[tree, origin], target, START, checks):
        return -1
    return add_node(trees, tree, target, origin)


@quick
def _reach(trees: Trees, tree: int, found: int, other: int, memory: Memory, checks: Checks) -> int:
    """Go from a node towards one of the other tree in equal steps, each a new node, until one is blocked.

    Return the node from which the last step led to the other, or -1.
    """
    here, there, target, way = memory.here, memory.there, memory.target, memory.way
    for k in range(len(here)):
        here[k], there[k] = trees.nodes[tree, found, k], trees.nodes[1 - tree, other, k]
    steps = max(1, int(np.ceil(distance_and_way(here, there, checks.bounds, way) / memory.step)))
    for step in range(1, min(steps, MOST_STEPS) + 1):
        for k in range(len(here)):
            target[k] = there[k] if step == steps else here[k] + step / steps * way[k]
        canonical(target, checks.bounds)
        if not motion_free(trees.nodes[tree, found], target, BOTH_ENDS if step == steps else START, checks):
            return -1
        if step == steps:
            return found
        found = add_node(trees, tree, target, found)
    return -1


@quick
def _is_proved(trees: Trees, state: Ints, checks: Checks) -> bool:
    """Return whether every motion of the path that was found is proved free; remove from the trees those that are not.

    A motion that was proved once is not looked at again.
    """
    # The motion between the trees first: it is the only one that can go without taking nodes along.
    a, b = trees.nodes[0, state[START_NODE]], trees.nodes[1, state[GOAL_NODE]]
    proved = motion_proved(a, b, PROOF_TOLERANCE, PROOF_BATCHES, checks)
    for tree in range(2):
        node = state[START_NODE + tree]
        broken = -1
        while trees.links[PARENT, tree, node] >= 0:
            parent = trees.links[PARENT, tree, node]
            if trees.links[PROVED, tree, node] == 0:
                a, b = trees.nodes[tree, parent], trees.nodes[tree, node]
                if motion_proved(a, b, PROOF_TOLERANCE, PROOF_BATCHES, checks):
                    trees.links[PROVED, tree, node] = 1
                else:
                    broken = node
            node = parent
        if broken >= 0:
            remove_branch(trees, tree, broken)
            proved = False
    return proved
