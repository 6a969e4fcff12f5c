"""The queue of a search in compiled code, and the states that it has reached."""

from __future__ import annotations

import numpy as np

from evenroad.robot.kernel.layout import quick
from evenroad.robot_roadmap.memory import (
    ANY_MULTI_TURN,
    CAPACITY,
    DIM,
    GREED,
    HIGH,
    LEAST,
    LEFT,
    LOW,
    MADE,
    MULTI_TURN,
    OF,
    PARENT,
    REACHED,
    SIBLING,
    SIZE,
    STATE,
    TERMINALS,
    VIA,
    WAITING,
    WINDINGS,
    Search,
)
from evenroad.robot_roadmap.metric import distance, write


@quick
def state_of(s: Search, node: int, packed: int) -> int:
    """Return the state of a milestone after turns, a new one if there was none; -1 where limits forbid it."""
    state = s.heads[node]
    while state >= 0:
        if s.states[state, WINDINGS] == packed:
            return state if s.bounds[state, LEFT] < np.inf else -1
        state = s.states[state, SIBLING]
    h, state = s.header, s.header[SIZE]
    h[SIZE] += 1
    s.states[state, OF], s.states[state, WINDINGS] = node, packed
    s.states[state, SIBLING], s.states[state, REACHED] = s.heads[node], -1
    s.heads[node] = state
    least, inside = np.inf, True
    if h[ANY_MULTI_TURN] != 0:
        write(s, node, packed, s.motion[1])
        for k in range(h[DIM]):
            if s.rules[MULTI_TURN, k] > 0.0:
                inside &= s.rules[LOW, k] <= s.motion[1, k] <= s.rules[HIGH, k]
    for terminal in range(1, h[TERMINALS]):
        if h[ANY_MULTI_TURN] != 0 and packed != s.turns[terminal, node]:
            least = min(least, distance(s, s.motion[1], s.terminals[terminal]))
        else:
            # As the goal's link was measured.
            least = min(least, s.away[terminal * h[CAPACITY] + node])
    s.bounds[state, LEFT], s.bounds[state, LEAST] = s.rules[GREED, 0] * least, np.inf
    if not inside:
        s.bounds[state, LEFT] = np.inf
    return state if inside else -1


@quick
def push(s: Search, state: int, parent: int, via: int, cost: float, left: float) -> None:
    """Make an entry and put it into the queue, a heap with the least key first."""
    h, entry = s.header, s.header[MADE]
    h[MADE] += 1
    s.entries[entry, STATE], s.entries[entry, PARENT], s.entries[entry, VIA] = state, parent, via
    s.costs[entry] = cost
    key, slot = cost + left, h[WAITING]
    h[WAITING] += 1
    while slot > 0:
        above = (slot - 1) // 2
        if s.keys[above] <= key:
            break
        s.keys[slot], s.items[slot] = s.keys[above], s.items[above]
        slot = above
    s.keys[slot], s.items[slot] = key, entry


@quick
def pop(s: Search) -> int:
    """Take the entry with the least key out of the queue."""
    first = s.items[0]
    s.header[WAITING] -= 1
    size = s.header[WAITING]
    key, item, slot = s.keys[size], s.items[size], 0
    while True:
        below = 2 * slot + 1
        if below + 1 < size and s.keys[below + 1] < s.keys[below]:
            below += 1
        if below >= size or s.keys[below] >= key:
            break
        s.keys[slot], s.items[slot] = s.keys[below], s.items[below]
        slot = below
    s.keys[slot], s.items[slot] = key, item
    return first
