"""Ways in an explored scene, in compiled code: how far it is from milestone to milestone stands in a table."""

from __future__ import annotations

import numpy as np

from evenroad.robot.kernel.layout import quick
from evenroad.robot_roadmap.search_memory import (
    BLOCKED,
    CAPACITY,
    ENDS,
    FREE,
    LINKS,
    MADE,
    NEXT,
    NUMBER,
    OTHER,
    PENDING,
    TOLD,
    Search,
)
from evenroad.robot_roadmap.search_queue import push, state_of

@quick
def price_links(s: Search) -> None:
    """Write what the shortest way by each link of a goal costs, and which link of the start it begins with."""
    for row in range((s.desk[ENDS] - 1) * s.desk[LINKS]):
        _price_row(s, row)


@quick
def _price_row(s: Search, row: int) -> None:
    """Do so for one link of a goal; inf where nothing leads there."""
    d, links = s.desk, s.desk[LINKS]
    end, least, best = 1 + row // links, np.inf, 0
    j = s.near[end, row % links]
    if 0 <= j < d[TOLD] and s.links[end, j] != BLOCKED and s.nodes[j] != BLOCKED:
        for rank in range(links):
            i = s.near[0, rank]
            if 0 <= i < d[TOLD] and s.links[0, i] != BLOCKED and s.nodes[i] != BLOCKED:
                cost = s.away[i] + s.far[j * d[TOLD] + i]
                if cost < least:
                    least, best = cost, rank
        least += s.away[end * d[CAPACITY] + j]
    s.keys[row], s.items[row] = least, best


@quick
def best_links(s: Search) -> tuple[int, int, int]:
    """Return the milestones that start and a goal are to be linked to for the shortest way, and the goal; -1 for none.

    What is known to be blocked is left out.
    """
    links = s.desk[LINKS]
    while True:
        least, row = np.inf, -1
        for other in range((s.desk[ENDS] - 1) * links):
            if s.keys[other] < least:
                least, row = s.keys[other], other
        if row < 0:
            return -1, -1, -1
        end, i = 1 + row // links, s.near[0, s.items[row]]
        j = s.near[end, row % links]
        if s.links[end, j] != BLOCKED and s.links[0, i] != BLOCKED:
            return i, j, end
        _price_row(s, row)


@quick
def write_known_way(s: Search, i: int, j: int, end: int) -> bool:
    """Write entries of the way by two milestones, the last one to be looked at; return whether there is one."""
    d, packed, cost = s.desk, s.turns[0, i], np.float64(s.away[i])
    state = state_of(s, i, packed)
    if state < 0:
        return False
    push(s, state, -1, -1, cost, 0.0)
    while i != j:
        there, half = s.steps[j, i], s.first[i]
        while half >= 0 and not (s.halves[half, OTHER] == there and s.edges[s.halves[half, NUMBER]] >= FREE):
            half = s.halves[half, NEXT]
        state = state_of(s, there, packed) if half >= 0 else -1
        if state < 0:
            return False
        cost += s.lengths[half]
        push(s, state, d[MADE] - 1, s.halves[half, NUMBER], cost, 0.0)
        i = there
    push(s, -end, d[MADE] - 1, -1, cost + s.away[end * d[CAPACITY] + j], 0.0)
    d[PENDING] = d[MADE] - 1
    return True
