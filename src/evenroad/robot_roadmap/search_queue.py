"""The queue of a search in compiled code, and the states that it has got to."""

from __future__ import annotations

import numpy as np

from evenroad.robot.kernel.layout import quick
from evenroad.robot_roadmap.search_memory import (
    AIM,
    AIMED_END,
    CAPACITY,
    DIM,
    ENDS,
    GREED,
    HIGH,
    LEAST,
    LEFT,
    LIFTED,
    LIFTING,
    LIFTS,
    LOW,
    MADE,
    OF,
    PARENT,
    REACHED,
    SIBLING,
    SIZE,
    STATE,
    VIA,
    WAITING,
    Search,
)
from evenroad.robot_roadmap.search_metric import distance, write


@quick
def state_of(s: Search, node: int, packed: int) -> int:
    """Return the state of a milestone after turns, a new one where there was none; -1 where limits forbid it."""
    state = s.heads[node]
    while state >= 0:
        if s.states[state, LIFTED] == packed:
            return state if s.bounds[state, LEFT] < np.inf else -1
        state = s.states[state, SIBLING]
    d, state = s.desk, s.desk[SIZE]
    d[SIZE] += 1
    s.states[state, OF], s.states[state, LIFTED] = node, packed
    s.states[state, SIBLING], s.states[state, REACHED] = s.heads[node], -1
    s.heads[node] = state
    least, inside = np.inf, True
    if d[LIFTING] != 0 or d[AIM] >= 0:
        write(s, node, packed, s.asked[1])
        for k in range(d[DIM]):
            if s.rules[LIFTS, k] > 0.0:
                inside &= s.rules[LOW, k] <= s.asked[1, k] <= s.rules[HIGH, k]
    if d[AIM] >= 0:
        write(s, d[AIM], s.turns[d[AIMED_END], d[AIM]], s.asked[0])
        least = distance(s, s.asked[1], s.asked[0]) + s.away[d[AIMED_END] * d[CAPACITY] + d[AIM]]
    else:
        for end in range(1, d[ENDS]):
            if d[LIFTING] != 0 and packed != s.turns[end, node]:
                least = min(least, distance(s, s.asked[1], s.ends[end]))
            else:
                # Where the goal's link would be, as it was measured.
                least = min(least, s.away[end * d[CAPACITY] + node])
    s.bounds[state, LEFT], s.bounds[state, LEAST] = s.rules[GREED, 0] * least, np.inf
    if not inside:
        s.bounds[state, LEFT] = np.inf
    return state if inside else -1


@quick
def push(s: Search, state: int, parent: int, via: int, cost: float, left: float) -> None:
    """Make an entry and put it into the queue, a heap with the least key first."""
    d, entry = s.desk, s.desk[MADE]
    d[MADE] += 1
    s.entries[entry, STATE], s.entries[entry, PARENT], s.entries[entry, VIA] = state, parent, via
    s.costs[entry] = cost
    key, place = cost + left, d[WAITING]
    d[WAITING] += 1
    while place > 0:
        above = (place - 1) // 2
        if s.keys[above] <= key:
            break
        s.keys[place], s.items[place] = s.keys[above], s.items[above]
        place = above
    s.keys[place], s.items[place] = key, entry


@quick
def pop(s: Search) -> int:
    """Take the entry with the least key out of the queue."""
    first = s.items[0]
    s.desk[WAITING] -= 1
    size = s.desk[WAITING]
    key, item, place = s.keys[size], s.items[size], 0
    while True:
        below = 2 * place + 1
        if below + 1 < size and s.keys[below + 1] < s.keys[below]:
            below += 1
        if below >= size or s.keys[below] >= key:
            break
        s.keys[place], s.items[place] = s.keys[below], s.items[below]
        place = below
    s.keys[place], s.items[place] = key, item
    return first
