"""The search of a roadmap where questions are dear: it plans a whole way, and asks about what is not known of it.

A lazy search after Dellin and Srinivasa 2016, in which a motion that nobody has asked about counts as longer than it
is: so it goes along what is known, and asks about short motions that lead there.
"""

from __future__ import annotations

import numpy as np

from evenroad.robot.kernel.layout import program, quick
from evenroad.robot_roadmap import search_memory as at
from evenroad.robot_roadmap.lazy_search import (
    clear,
    hear,
    question_of,
    tell,
    verdict_of,
    write_asked,
)
from evenroad.robot_roadmap.search_memory import (
    BLOCKED,
    DOUBTED,
    FOUND,
    FREE,
    FULL,
    LINK,
    NODE,
    NONE,
    STRAIGHT,
    UNKNOWN,
    Search,
)
from evenroad.robot_roadmap.search_metric import distance, write
from evenroad.robot_roadmap.search_queue import pop, push, state_of

NOT_ASKED, NOT_PROVED = 5.0, 20.0
"""How many times as long as it is a motion counts that nobody has asked about, and one that is not proved soon."""

DEARLY = 16
"""Added to a question about a motion that was not proved soon."""


@program
def next_dear_question(
    desk: int, answered: int, verdict: int, unknown: float, doubted: float, path: int, rows: int
) -> int:
    """Do what ``ask._next_question`` does for this search; DEARLY is added where the motion was not proved soon."""
    s = at.search_at(desk)
    hear(s, answered, verdict)
    d = s.desk
    d[at.AIM] = -1
    for end in range(1, d[at.ENDS]):
        if s.straight[end] == UNKNOWN and d[at.ONLY_KNOWN] == 0:
            # Whoever goes straight needs no roadmap; most of what is blocked is found out soon.
            d[at.TO] = end
            for k in range(d[at.DIM]):
                s.asked[0, k], s.asked[1, k] = s.ends[0, k], s.ends[end, k]
            return STRAIGHT
    entry = _cheapest_way(s, unknown, doubted)
    if entry < 0:
        return NONE if entry == -1 else FULL
    d[at.PENDING] = entry
    question = _first_open(s, entry)
    if question == FOUND:
        tell(s, path, rows)
    return question


@quick
def _cheapest_way(s: Search, unknown: float, doubted: float) -> int:
    """Return the entry at the end of the way that counts least, -1 where there is none, -2 where there is no room."""
    d = s.desk
    clear(s)
    for end in range(1, d[at.ENDS]):
        price = _price(s, s.straight[end], unknown, doubted)
        if price < np.inf:
            push(s, -end, -1, -1, price * distance(s, s.ends[0], s.ends[end]), 0.0)
    for rank in range(d[at.LINKS]):
        i = s.near[0, rank]
        if i >= 0 and s.nodes[i] != BLOCKED:
            price = _price(s, s.links[0, i], unknown, doubted)
            state = state_of(s, i, s.turns[0, i]) if price < np.inf else -1
            if state >= 0:
                _offer(s, state, -1, -1, price * s.away[i])
    while d[at.WAITING] > 0:
        entry = pop(s)
        state = s.entries[entry, at.STATE]
        if state < 0:
            return entry
        if s.states[state, at.REACHED] < 0:
            s.states[state, at.REACHED] = entry
            if not _expand(s, state, entry, unknown, doubted):
                return -2
    return -1


@quick
def _price(s: Search, verdict: int, unknown: float, doubted: float) -> float:
    """Return what a unit of length of a motion counts of which this is known."""
    if verdict >= FREE:
        return 1.0
    if verdict == BLOCKED or s.desk[at.ONLY_KNOWN] != 0:
        return np.inf
    return unknown if verdict == UNKNOWN else doubted


@quick
def _offer(s: Search, state: int, parent: int, via: int, cost: float) -> None:
    """Put what a state is reached by into the queue, if nothing better was."""
    if cost < s.bounds[state, at.LEAST]:
        s.bounds[state, at.LEAST] = cost
        push(s, state, parent, via, cost, s.bounds[state, at.LEFT])


@quick
def _expand(s: Search, state: int, entry: int, unknown: float, doubted: float) -> bool:
    """Put all that a state leads to into the queue; return whether there was room."""
    d, node, packed, cost = s.desk, s.states[state, at.OF], s.states[state, at.LIFTED], s.costs[entry]
    if d[at.MADE] + d[at.ENDS] > d[at.ENTRIES]:
        return False
    for end in range(1, d[at.ENDS]):
        link, away = s.links[end, node], s.away[end * d[at.CAPACITY] + node]
        price = _price(s, link, unknown, doubted)
        if price < np.inf and s.turns[end, node] == packed and (link >= FREE or away <= s.radius[end]):
            push(s, -end, entry, -1, cost + price * away, 0.0)
    half = s.first[node]
    while half >= 0:
        there, edge = s.halves[half, at.OTHER], s.halves[half, at.NUMBER]
        turned = packed + s.leads[half] if d[at.LIFTING] != 0 else packed
        reached = cost + _price(s, s.edges[edge], unknown, doubted) * s.lengths[half]
        half = s.halves[half, at.NEXT]
        if reached == np.inf or s.nodes[there] == BLOCKED:
            continue
        if d[at.SIZE] >= d[at.STATES] or d[at.MADE] >= d[at.ENTRIES]:
            return False
        other = state_of(s, there, turned)
        if other >= 0 and s.states[other, at.REACHED] < 0:
            _offer(s, other, entry, edge, reached)
    return True


@quick
def _first_open(s: Search, entry: int) -> int:
    """Return the first question about a way: about its milestones first, then its links, then its edges, what was not
    proved soon at the end; FOUND where it is all known to be free.
    """
    d, best, chosen = s.desk, np.inf, -1
    here = entry
    while here >= 0:
        state, question = s.entries[here, at.STATE], question_of(s, here)
        verdict = verdict_of(s, question)
        if verdict < FREE and state >= 0 and s.nodes[s.states[state, at.OF]] == UNKNOWN:
            d[at.TO] = s.states[state, at.OF]
            write(s, d[at.TO], s.states[state, at.LIFTED], s.asked[0])
            return NODE
        if verdict < FREE:
            rank = (2.0 if verdict == DOUBTED else 0.0) + (0.0 if question == LINK else 1.0)
            if rank < best:
                best, chosen = rank, here
        here = s.entries[here, at.PARENT]
    if chosen < 0:
        return FOUND
    d[at.PENDING] = chosen
    question = question_of(s, chosen)
    write_asked(s, chosen, question)
    return question + (DEARLY if verdict_of(s, question) == DOUBTED else 0)
