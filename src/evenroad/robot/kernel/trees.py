"""A planner in compiled code: two trees that grow from the start and from the goals until they meet.

RRT-Connect (J. Kuffner and S. LaValle, 2000), with an even sequence in place of random samples, and with ball steps:
a node whose extensions were tried often enough offers eight steps in evenly spread directions at once; one batch of
sixteen lanes holds the middle and the end of each, and only those free at both are looked at in full.  From a
configuration deep in a shelf few directions are free; this finds them at a sixteenth of the price.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.addresses import integers_at, matrix_at
from evenroad.robot.kernel.layout import LANES, Given, Pair, program, quick, quick_inlined
from evenroad.robot.kernel.motion import canonical, distance_and_direction, enter
from evenroad.robot.kernel.motion_checks import (
    BOTH_ENDPOINTS,
    START,
    Checks,
    blocked,
    checks_of,
    motion_free,
    motion_proved,
)
from evenroad.robot.kernel.motion_states import BATCHES, CONFIGURATIONS, MOTIONS
from evenroad.robot.kernel.tree_nodes import (
    PARENT,
    PROVED,
    Trees,
    add_node,
    nearest,
    remove_branch,
    trees_at,
)
from evenroad.robot.kernel.tree_steps import (
    BEGUN,
    GOAL_NODE,
    GROWING,
    REACHED,
    START_NODE,
    STATE,
    STEPS_AT_ONCE,
    STRAIGHT,
    WAYPOINTS,
    Memory,
    candidates,
    memory_of,
)

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

PAUSED, FULL, SPENT, NOT_FREE, NO_NUMBERS, SOLVED = range(6)
"""What a call of `grow` ends with: its slice used up, no room in the trees, the budget spent, start or goals not free
or not finite, a path found."""

MOST_STEPS = 64
"""So many steps at most are made in one go towards the other tree."""

EXTRA_NODES = (STEPS_AT_ONCE + 1) * (MOST_STEPS + 2)
"""A round may add so many nodes."""

MOST_STRAIGHT = 16
"""So many goals at most are first tried straight on."""

PROOF_TOLERANCE = 1e-6
PROOF_BATCHES = 1024
"""Limits of the proof of a motion of the trees [m]."""


def floats_for(count: int, capacity: int, dim: int) -> int:
    """Return how many doubles the trees take, see `grow`."""
    return STATE + 2 + count * dim + (4 * dim + 8) * capacity


@program
def grow(kept: int, count: int, capacity: int, samples: Pair, steps: Pair, limits: Pair, given: Given) -> int:
    """Grow two trees until they meet and return how the call ended; called again with the same, it goes on.

    Parameters
    ----------
    kept, count, capacity
        Address of `floats_for` doubles, one after the other: counts and what is kept from call to call, sizes of the
        trees, integers that are zeros at first; start and goals, (count, dim), of which the goals become the roots of
        the second tree, and the first are tried straight on; nodes, links and columns of ``Trees``, with room for
        2 count + ROOM nodes at least, and as much as the columns again.  A path that was found is written over the
        columns; how many waypoints it has, and which of the ends it leads to, stand among the counts.
    samples, steps
        Addresses and lengths of points of the unit cube, after the last of which it goes on from the first, each time
        shifted a little further; and of points of the unit ball, used in turn.
    limits
        Motions, proofs among them, after which the budget is spent; batches of sixteen checks, about, after which the
        call returns, for the caller to look at the clock.
    given
        With room for ``memory_of``.
    """
    check, resolution, tables, by_joint, memory, buffer = given
    checks = checks_of(check, resolution, tables, by_joint, memory, kept)
    most_motions, slice_batches = limits
    bounds = checks.bounds
    dim = bounds.shape[1]
    state, terminals = integers_at(kept, (STATE,)), matrix_at(kept + 8 * (STATE + 2), (count, dim))
    sequence, ball = matrix_at(samples[0], (samples[1], dim)), matrix_at(steps[0], (steps[1], dim))
    trees = trees_at(kept + 8 * (STATE + 2 + count * dim), capacity, kept + 8 * STATE, buffer, bounds)
    sizes = trees.sizes
    own = memory_of(buffer + 8 * dim, bounds)
    if state[BEGUN] == 0:
        if not _are_finite(terminals):
            return NO_NUMBERS
        _begin(terminals, trees, own, checks)
        state[BEGUN] = 1
    if sizes[0] == 0 or sizes[1] == 0:
        return NOT_FREE
    pause = state[BATCHES] + slice_batches
    goals = 0
    while goals < sizes[1] and trees.links[PARENT, 1, goals] < 0:
        goals += 1
    while True:
        if state[MOTIONS] >= most_motions:
            return SPENT
        if state[BATCHES] >= pause:
            return PAUSED
        if max(sizes[0], sizes[1]) + EXTRA_NODES > capacity:
            return FULL
        many = 0
        if state[STRAIGHT] < min(goals, MOST_STRAIGHT):
            tree, found, other = 0, 0, state[STRAIGHT]
            state[STRAIGHT] += 1
        else:
            tree = state[GROWING]
            if sizes[tree] > sizes[1 - tree]:
                tree = 1 - tree
            state[GROWING] = tree
            some = min(STEPS_AT_ONCE, most_motions - state[MOTIONS])
            many = candidates(trees, tree, state, sequence, ball, some, own, checks)
            found, other = -1, -1
        # A goal straight on is a round of its own, without a candidate.
        for candidate in range(-1 if found >= 0 else 0, many):
            if candidate >= 0:
                if state[MOTIONS] >= most_motions:
                    return SPENT
                found = _extended(trees, tree, own.origins[candidate], own.targets[candidate], checks)
                if found < 0:
                    continue
                other = nearest(trees, 1 - tree, trees.nodes[tree, found], own.lanes)
            met = _reach(trees, tree, found, other, most_motions, own, checks)
            if met >= 0:
                state[START_NODE + tree], state[GOAL_NODE - tree] = met, other
                if _is_proved(trees, state, most_motions, checks):
                    columns = kept + 8 * (STATE + 2 + count * dim + (2 * dim + 8) * capacity)
                    _write_path(trees, state, matrix_at(columns, (2 * capacity, dim)))
                    return SOLVED
                # Nodes may have been removed: the other candidates know old numbers.
                break


@quick
def _are_finite(terminals: Floats) -> bool:
    for end in range(len(terminals)):
        for k in range(terminals.shape[1]):
            if not np.isfinite(terminals[end, k]):
                return False
    return True


@quick
def _begin(terminals: Floats, trees: Trees, memory: Memory, checks: Checks) -> None:
    """Plant the trees: the start in the first, the goals in the second; leave out what is not free."""
    count, dim = terminals.shape
    for first in range(0, count, LANES):
        some = min(LANES, count - first)
        inside = 0
        for lane in range(LANES):
            # Lanes to spare repeat the last row.
            if enter(terminals[first + min(lane, some - 1)], checks.bounds, memory.here):
                inside |= 1 << lane
            else:
                # What is out of bounds may be too large for single precision.
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
                root = add_node(trees, min(row, 1), memory.here, np.int64(-1))
                # Nothing leads to a root that could be proved: here is which of the ends it is.
                trees.links[PROVED, min(row, 1), root] = row
        if trees.sizes[0] == 0:
            return


@quick_inlined
def _extended(trees: Trees, tree: int, origin: int, target: Floats, checks: Checks) -> int:
    """Return the number of a new node at `target`, or -1 where the motion there from `origin` is blocked."""
    if not motion_free(trees.nodes[tree, origin], target, START, checks):
        return -1
    return add_node(trees, tree, target, origin)


@quick_inlined
def _reach(
    trees: Trees, tree: int, found: int, other: int, most_motions: int, memory: Memory, checks: Checks
) -> int:
    """Go from a node towards one of the other tree in equal steps, each a new node, until one is blocked.

    Return the node from which the last step led to the other, or -1, also once the budget is spent.
    """
    here, there, target, direction = memory.here, memory.there, memory.target, memory.direction
    for k in range(len(here)):
        here[k], there[k] = trees.nodes[tree, found, k], trees.nodes[1 - tree, other, k]
    steps = max(1, int(np.ceil(distance_and_direction(here, there, checks.bounds, direction) / memory.step)))
    for step in range(1, min(steps, MOST_STEPS) + 1):
        for k in range(len(here)):
            target[k] = there[k] if step == steps else here[k] + step / steps * direction[k]
        if step < steps:
            # The other tree's node stays as it is: a root may exceed a limit by the slack.
            canonical(target, checks.bounds)
        if checks.counts[MOTIONS] >= most_motions:
            return -1
        if not motion_free(
            trees.nodes[tree, found], target, BOTH_ENDPOINTS if step == steps else START, checks
        ):
            return -1
        if step == steps:
            return found
        found = add_node(trees, tree, target, found)
    return -1


@quick
def _write_path(trees: Trees, state: Ints, path: Floats) -> None:
    """Write the way from the start to the goal that was reached, its size and which of the ends the goal is."""
    size, node = 0, state[START_NODE]
    while node >= 0:
        size, node = size + 1, trees.links[PARENT, 0, node]
    row, step = size - 1, -1
    for tree in range(2):
        node = state[START_NODE + tree]
        while node >= 0:
            for k in range(path.shape[1]):
                path[row, k] = trees.nodes[tree, node, k]
            state[REACHED] = trees.links[PROVED, tree, node]
            row, node = row + step, trees.links[PARENT, tree, node]
        row, step = size if tree == 0 else row, 1
    state[WAYPOINTS] = row


@quick
def _is_proved(trees: Trees, state: Ints, most_motions: int, checks: Checks) -> bool:
    """Return whether every motion of the path that was found is proved free; remove from the trees those that are not.

    A motion that was proved once is not looked at again; nor is any once the budget is spent.
    """
    if state[MOTIONS] >= most_motions:
        return False
    # The motion between the trees first: it is the only one that can go without taking nodes along.
    a, b = trees.nodes[0, state[START_NODE]], trees.nodes[1, state[GOAL_NODE]]
    proved = motion_proved(a, b, PROOF_TOLERANCE, PROOF_BATCHES, checks)
    for tree in range(2):
        node = state[START_NODE + tree]
        broken = -1
        while trees.links[PARENT, tree, node] >= 0:
            parent = trees.links[PARENT, tree, node]
            if trees.links[PROVED, tree, node] == 0:
                if state[MOTIONS] >= most_motions:
                    return False
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
