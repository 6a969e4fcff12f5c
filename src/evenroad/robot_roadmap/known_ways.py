"""Ways in an explored scene, in compiled code: how far it is from milestone to milestone stands in a table."""

from __future__ import annotations

import numpy as np

from evenroad.robot.kernel.layout import quick
from evenroad.robot_roadmap.search_links import choose_close
from evenroad.robot_roadmap.search_memory import (
    BLOCKED,
    BY,
    CAPACITY,
    CLOSE_GOALS,
    CLOSE_START,
    DIM,
    ENDS,
    FOUND,
    FREE,
    LINK,
    LINKS,
    MADE,
    NEXT,
    NONE,
    NUMBER,
    OTHER,
    PENDING,
    TO,
    TOLD,
    UNKNOWN,
    Search,
)
from evenroad.robot_roadmap.search_metric import write
from evenroad.robot_roadmap.search_queue import push, state_of


@quick
def price_links(s: Search) -> None:
    """Write what the shortest way by each link of a goal costs, and which link of the start it begins with."""
    d = s.desk
    for rank in range(d[LINKS]):
        i = s.near[0, rank]
        s.costs[rank] = s.away[i] if _is_told(s, 0, i) else np.inf
    for row in range((d[ENDS] - 1) * d[LINKS]):
        _price_row(s, row)


@quick
def _is_told(s: Search, end: int, i: int) -> bool:
    """Return whether the table knows a milestone, and its link to an end is not known to be blocked."""
    return 0 <= i < s.desk[TOLD] and s.links[end, i] != BLOCKED and s.nodes[i] != BLOCKED


@quick
def _price_row(s: Search, row: int) -> None:
    """Do so for one link of a goal; inf where nothing leads there."""
    d, links = s.desk, s.desk[LINKS]
    end, told, least, best = 1 + row // links, d[TOLD], np.inf, 0
    j = s.near[end, row % links]
    if _is_told(s, end, j):
        far = s.far[j * told : (j + 1) * told]
        for rank in range(links):
            # What does not count, as it is inf, is looked up somewhere.
            i = min(max(s.near[0, rank], 0), told - 1)
            cost = np.float32(s.costs[rank]) + far[i]
            if cost < least:
                least, best = cost, rank
        least += s.away[end * d[CAPACITY] + j]
    s.keys[row], s.items[row] = least, best


@quick
def _best_links(s: Search) -> tuple[int, int, int]:
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
        end, rank = 1 + row // links, s.items[row]
        i, j = s.near[0, rank], s.near[end, row % links]
        if s.links[0, i] == BLOCKED:
            s.costs[rank] = np.inf
        elif s.links[end, j] != BLOCKED:
            return i, j, end
        _price_row(s, row)


@quick
def _write_way(s: Search, i: int, j: int, end: int) -> bool:
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


@quick
def look_up(s: Search) -> int:
    """Return a question for a link of the shortest way that the table knows; FOUND where both are free, or NONE."""
    d = s.desk
    while True:
        i, j, goal = _best_links(s)
        if i < 0:
            return NONE
        # The longer one first: it is rather blocked.
        goal_first = s.away[goal * d[CAPACITY] + j] > s.away[i]
        for side in range(2):
            end, by = (goal, j) if goal_first == (side == 0) else (0, i)
            if s.links[end, by] == UNKNOWN:
                d[TO], d[BY] = end, by
                for k in range(d[DIM]):
                    s.asked[0, k] = s.ends[end, k]
                write(s, by, s.turns[end, by], s.asked[1])
                return LINK
        return FOUND if _write_way(s, i, j, goal) else NONE


@quick
def has_others(s: Search) -> bool:
    """Choose links by displacement for ends of which no link is free, once; return whether there are any."""
    d, chosen = s.desk, False
    for which in (CLOSE_START, CLOSE_GOALS):
        first, last = (0, 1) if which == CLOSE_START else (1, d[ENDS])
        free = False
        for end in range(first, last):
            for rank in range(d[LINKS]):
                i = s.near[end, rank]
                free |= i >= 0 and s.links[end, i] >= FREE
        if d[which] > 0 and not free:
            d[which], chosen = 0, True
            for end in range(first, last):
                choose_close(s, end)
    return chosen
