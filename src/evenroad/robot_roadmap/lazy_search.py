"""The search of a roadmap in compiled code that asks before it goes on: whoever knows the world answers.

A lazy A* (Cohen, Phillips and Likhachev 2015): a motion is asked about when the search would go along it, a milestone
before the first motion to it.  Whether there is any way to a goal from outside is asked first.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.addresses import matrix_at
from evenroad.robot.kernel.layout import quick
from evenroad.robot_roadmap.search_links import choose_links
from evenroad.robot_roadmap.search_memory import (
    AIM,
    AIMED_END,
    ASK_GOALS,
    ASK_STRAIGHT,
    BLOCKED,
    BY,
    CAPACITY,
    CUT_OFF,
    DIM,
    EDGE,
    ENDS,
    ENTRIES,
    FOUND,
    FREE,
    FULL,
    GREED,
    LEAST,
    LEFT,
    LIFTED,
    LIFTING,
    LINK,
    LINKS,
    MADE,
    MEASURED,
    NEARBY,
    NEXT,
    NODE,
    NODES,
    NONE,
    NUMBER,
    OF,
    ONLY_KNOWN,
    OPEN,
    OTHER,
    PARENT,
    PENDING,
    PHASE,
    REACHED,
    SEARCH,
    SIZE,
    STATE,
    STATES,
    STRAIGHT,
    TO,
    UNKNOWN,
    VIA,
    WAITING,
    Search,
    join,
)
from evenroad.robot_roadmap.search_metric import distance, measure, write
from evenroad.robot_roadmap.search_queue import pop, push, state_of

Floats = npt.NDArray[np.float64]

ENDS_TAKEN, SPENT, PAUSED = range(FULL + 1, FULL + 4)
"""What whoever answers ends with besides: start or goals not free, motions or time over, its slice used up."""

AIMED = 4
"""A goal of which so many links were blocked before a free one was found is approached by that one."""


@quick
def begin(s: Search) -> None:
    """Measure how far milestones are from the ends, and choose those that each is tried to be linked to."""
    d = s.desk
    for end in range(d[ENDS]):
        measure(s, end, d[MEASURED])
    d[MEASURED] = d[NODES]
    for end in range(d[ENDS]):
        choose_links(s, end)
    clear(s)
    d[AIM], d[AIMED_END], d[PHASE] = -1, -1, ASK_STRAIGHT


@quick
def clear(s: Search) -> None:
    """Forget what the search has got to."""
    d = s.desk
    for state in range(d[SIZE]):
        s.heads[s.states[state, OF]] = -1
    d[SIZE], d[MADE], d[WAITING], d[PENDING] = 0, 0, 0, -1


@quick
def step(s: Search) -> int:
    """Go on until something has to be asked about, there is a way, or there is none."""
    d = s.desk
    if d[PHASE] == ASK_STRAIGHT:
        d[PHASE] = ASK_GOALS
        for end in range(1, d[ENDS]):
            if s.straight[end] == UNKNOWN:
                d[TO], d[PHASE] = end, ASK_STRAIGHT
                for k in range(d[DIM]):
                    s.asked[0, k], s.asked[1, k] = s.ends[0, k], s.ends[end, k]
                return STRAIGHT
            if s.straight[end] >= FREE:
                d[PHASE] = OPEN
    if d[PHASE] == ASK_GOALS:
        question = _goal_link(s)
        if question != NONE:
            return question
        d[PHASE] = OPEN
    if d[PHASE] == OPEN:
        _open(s)
        d[PHASE] = SEARCH
    while True:
        if d[PENDING] < 0:
            if d[WAITING] == 0:
                if d[AIM] < 0:
                    return NONE
                # Not by the milestone that was aimed at: once more with all links of the goals.
                clear(s)
                d[AIM] = -1
                _open(s)
                continue
            d[PENDING] = pop(s)
        entry = d[PENDING]
        state, question = s.entries[entry, STATE], question_of(s, entry)
        verdict = verdict_of(s, question)
        if state >= 0:
            node = s.states[state, OF]
            if s.states[state, REACHED] >= 0 or s.nodes[node] == BLOCKED:
                verdict = BLOCKED
            if question == EDGE and verdict != BLOCKED and s.nodes[node] == UNKNOWN:
                d[TO] = node
                write(s, node, s.states[state, LIFTED], s.asked[0])
                return NODE
        if verdict == UNKNOWN:
            write_asked(s, entry, question)
            return question
        if verdict >= FREE and state < 0:
            return FOUND
        d[PENDING] = -1
        if verdict >= FREE:
            s.states[state, REACHED] = entry
            if not _expand(s, state, entry):
                return FULL


@quick
def _goal_link(s: Search) -> int:
    """Return NONE where a free link of a goal is known; else the question for one, or CUT_OFF."""
    d = s.desk
    for end in range(1, d[ENDS]):
        missed = 0
        for rank in range(d[LINKS]):
            i = s.near[end, rank]
            if i < 0 or s.nodes[i] == BLOCKED:
                continue
            if s.links[end, i] == BLOCKED:
                missed += 1
                continue
            if s.links[end, i] == UNKNOWN:
                d[TO], d[BY] = end, i
                for k in range(d[DIM]):
                    s.asked[0, k] = s.ends[end, k]
                write(s, i, s.turns[end, i], s.asked[1])
                return LINK
            if s.rules[GREED, 0] > 1.0 and missed >= AIMED:
                d[AIM], d[AIMED_END] = i, end
            return NONE
    return CUT_OFF


@quick
def _open(s: Search) -> None:
    """Put the motions straight to goals and the links of the start into the queue."""
    d = s.desk
    for end in range(1, d[ENDS]):
        if s.straight[end] != BLOCKED:
            push(s, -end, -1, -1, distance(s, s.ends[0], s.ends[end]), 0.0)
    for rank in range(d[LINKS]):
        i = s.near[0, rank]
        if i >= 0 and (s.links[0, i] >= FREE or (s.links[0, i] == UNKNOWN and d[ONLY_KNOWN] == 0)):
            state = state_of(s, i, s.turns[0, i])
            if state >= 0:
                push(s, state, -1, -1, s.away[i], s.bounds[state, LEFT] + s.rules[NEARBY, 0] * s.away[i])


@quick
def question_of(s: Search, entry: int) -> int:
    """Return what kind of motion an entry came by, and write which one."""
    d, state, parent = s.desk, s.entries[entry, STATE], s.entries[entry, PARENT]
    if parent >= 0 and state >= 0:
        d[BY] = s.entries[entry, VIA]
        return EDGE
    if parent < 0 and state < 0:
        d[TO] = -state
        return STRAIGHT
    if parent < 0:
        d[TO], d[BY] = 0, s.states[state, OF]
    else:
        d[TO], d[BY] = -state, s.states[s.entries[parent, STATE], OF]
    return LINK


@quick
def verdict_of(s: Search, question: int) -> int:
    """Return what is known of what `question_of` wrote."""
    if question == EDGE:
        return s.edges[s.desk[BY]]
    return s.straight[s.desk[TO]] if question == STRAIGHT else s.links[s.desk[TO], s.desk[BY]]


@quick
def write_asked(s: Search, entry: int, question: int) -> None:
    """Write the ends of the motion that an entry came by; of a link the end of the query first."""
    from_goal = question == LINK and s.entries[entry, STATE] < 0
    _write_place(s, 1 if from_goal else 0, s.entries[entry, PARENT])
    _write_place(s, 0 if from_goal else 1, entry)


@quick
def _write_place(s: Search, row: int, entry: int) -> None:
    """Write where an entry leads to; -1 is the start."""
    state = s.entries[entry, STATE] if entry >= 0 else 0
    if entry < 0 or state < 0:
        for k in range(s.desk[DIM]):
            s.asked[row, k] = s.ends[-state, k]
    else:
        write(s, s.states[state, OF], s.states[state, LIFTED], s.asked[row])


@quick
def answer(s: Search, question: int, verdict: int) -> None:
    """Write what a question was answered with."""
    to, by = s.desk[TO], s.desk[BY]
    if question == STRAIGHT:
        s.straight[to] = verdict
    elif question == NODE:
        s.nodes[to] = verdict
    elif question == EDGE:
        s.edges[by] = verdict
        if verdict == FREE:
            entry = s.desk[PENDING]
            join(
                s,
                s.states[s.entries[entry, STATE], OF],
                s.states[s.entries[s.entries[entry, PARENT], STATE], OF],
            )
    else:
        s.links[to, by] = verdict
        if verdict >= FREE:
            s.nodes[by] = FREE


@quick
def hear(s: Search, answered: int, verdict: int) -> None:
    """Take the answer to a question, or begin where there was none."""
    if answered < 0:
        begin(s)
    else:
        answer(s, answered, verdict)


@quick
def tell(s: Search, path: int, rows: int) -> None:
    """Write the waypoints of the way that was found, and in place of a question its goal and how many they are."""
    s.desk[TO] = -s.entries[s.desk[PENDING], STATE]
    s.desk[BY] = way_back(s, matrix_at(path, (rows, s.desk[DIM])))


@quick
def way_back(s: Search, path: Floats) -> int:
    """Write the way that was found, from the goal back to the start, and return of how many waypoints."""
    entry, rows = s.desk[PENDING], 0
    while True:
        _write_place(s, 0, entry)
        for k in range(s.desk[DIM]):
            path[rows, k] = s.asked[0, k]
        rows += 1
        if entry < 0:
            return rows
        entry = s.entries[entry, PARENT]


@quick
def _expand(s: Search, state: int, entry: int) -> bool:
    """Put all that a state leads to into the queue; return whether there was room."""
    d, node, packed, cost = s.desk, s.states[state, OF], s.states[state, LIFTED], s.costs[entry]
    if d[MADE] + d[ENDS] > d[ENTRIES]:
        return False
    for end in range(1, d[ENDS]):
        link, away = s.links[end, node], s.away[end * d[CAPACITY] + node]
        wanted = d[AIM] < 0 and away <= s.radius[end] and d[ONLY_KNOWN] == 0
        if s.turns[end, node] == packed and (link >= FREE or (link == UNKNOWN and wanted)):
            push(s, -end, entry, -1, cost + away, 0.0)
    half = s.first[node]
    while half >= 0:
        there, edge, reached = s.halves[half, OTHER], s.halves[half, NUMBER], cost + s.lengths[half]
        turned = packed + s.leads[half] if d[LIFTING] != 0 else packed
        half = s.halves[half, NEXT]
        if s.edges[edge] == BLOCKED or s.nodes[there] == BLOCKED:
            continue
        if d[ONLY_KNOWN] != 0 and s.edges[edge] == UNKNOWN:
            continue
        if d[SIZE] >= d[STATES] or d[MADE] >= d[ENTRIES]:
            return False
        other = state_of(s, there, turned)
        if other < 0 or s.states[other, REACHED] >= 0 or reached >= s.bounds[other, LEAST]:
            continue
        if s.edges[edge] >= FREE and s.nodes[there] == FREE:
            s.bounds[other, LEAST] = reached
        push(s, other, entry, edge, reached, s.bounds[other, LEFT])
    return True
