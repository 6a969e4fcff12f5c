"""The search of a roadmap, in compiled code that stops where an edge has to be evaluated.

A lazy A* (Cohen, Phillips and Likhachev 2015): an edge is evaluated when the search would go along it, a milestone
before the first edge to it.  The weight of an edge that is not evaluated yet is CHECK_COST times its length.  Where
that is above 1, evaluations are expensive: a whole path is planned first, and only its unknown edges are evaluated
(Dellin and Srinivasa 2016).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.layout import program, quick
from evenroad.robot_roadmap.links import choose_links
from evenroad.robot_roadmap.memory import (
    ANY_MULTI_TURN,
    BLOCKED,
    BY,
    CAPACITY,
    CHECK_COST,
    CHECK_GOALS,
    CHECK_STRAIGHT,
    DIM,
    EDGE,
    ENTRIES,
    FOUND,
    FREE,
    FULL,
    GOAL,
    GREED,
    LEAST,
    LEFT,
    LINK,
    LINKS,
    MADE,
    NEXT,
    NODE,
    NONE,
    NUMBER,
    OF,
    OPEN,
    OTHER,
    PARENT,
    PENDING,
    PHASE,
    REACHED,
    ROWS,
    SEARCH,
    SIZE,
    STATE,
    STATES,
    STRAIGHT,
    TERMINALS,
    TO,
    UNKNOWN,
    VIA,
    WAITING,
    WINDINGS,
    Search,
    search_at,
)
from evenroad.robot_roadmap.metric import distance, measure, write
from evenroad.robot_roadmap.queue import pop, push, state_of

Floats = npt.NDArray[np.float64]

NEARBY = 2.0
"""Factor of the length of the start's links in the queue, except for a shortest path: near ones are tried first, which
halves the number of checks."""


@program
def next_check(header: int, checked: int, result: int) -> int:
    """Record the result of a check, or begin if `checked` is negative; return the next check, or how the
    search ended.
    """
    s = search_at(header)
    if checked < 0:
        begin(s)
    else:
        record(s, checked, result)
    check = step(s)
    if check == FOUND:
        write_path(s)
    return check


@quick
def begin(s: Search) -> None:
    """Measure the distances of milestones from start and goals, and choose the links to try."""
    for terminal in range(s.header[TERMINALS]):
        measure(s, terminal)
    for terminal in range(s.header[TERMINALS]):
        choose_links(s, terminal)
    begin_again(s)


@quick
def begin_again(s: Search) -> None:
    """Search again, with all states that are known by now."""
    _clear(s)
    s.header[PHASE] = CHECK_STRAIGHT


@quick
def _clear(s: Search) -> None:
    """Delete what the search has reached."""
    h = s.header
    for state in range(h[SIZE]):
        s.heads[s.states[state, OF]] = -1
    h[SIZE], h[MADE], h[WAITING], h[PENDING] = 0, 0, 0, -1


@quick
def step(s: Search) -> int:
    """Search until something has to be evaluated, there is a path, or there is none."""
    h, cheap = s.header, s.rules[CHECK_COST, 0] <= 1.0
    if h[PHASE] == CHECK_STRAIGHT:
        h[PHASE] = CHECK_GOALS
        for goal in range(1, h[TERMINALS]):
            if s.straight[goal] == UNKNOWN:
                h[TO], h[PHASE] = goal, CHECK_STRAIGHT
                for k in range(h[DIM]):
                    s.motion[0, k], s.motion[1, k] = s.terminals[0, k], s.terminals[goal, k]
                return STRAIGHT
            if s.straight[goal] >= FREE:
                h[PHASE] = OPEN
    if h[PHASE] == CHECK_GOALS:
        check = _goal_link(s) if cheap else FOUND
        if check != FOUND:
            return check
        h[PHASE] = OPEN
    if h[PHASE] == OPEN or not cheap:
        _clear(s)
        _open(s)
        h[PHASE] = SEARCH
    while True:
        if h[PENDING] < 0:
            if h[WAITING] == 0:
                return NONE
            h[PENDING] = pop(s)
        entry = h[PENDING]
        state, check = s.entries[entry, STATE], check_of(s, entry)
        result = result_of(s, check)
        if state >= 0:
            node = s.states[state, OF]
            if s.states[state, REACHED] >= 0 or s.nodes[node] == BLOCKED:
                result = BLOCKED
            if cheap and check == EDGE and result != BLOCKED and s.nodes[node] == UNKNOWN:
                return _node_check(s, state)
        if cheap and result == UNKNOWN:
            write_motion(s, entry, check)
            return check
        if result != BLOCKED and state < 0:
            return FOUND if cheap else _first_unknown(s, entry)
        h[PENDING] = -1
        if result != BLOCKED:
            s.states[state, REACHED] = entry
            if not _expand(s, state, entry, cheap):
                return FULL


@quick
def _node_check(s: Search, state: int) -> int:
    """Write the milestone of a state to be evaluated."""
    s.header[TO] = s.states[state, OF]
    write(s, s.states[state, OF], s.states[state, WINDINGS], s.motion[0])
    return NODE


@quick
def _goal_link(s: Search) -> int:
    """Return FOUND where a free link of a goal is known, the check of the next one, or NONE where all are blocked."""
    h = s.header
    for goal in range(1, h[TERMINALS]):
        for rank in range(h[LINKS]):
            i = s.near[goal, rank]
            if i < 0 or s.nodes[i] == BLOCKED or s.links[goal, i] == BLOCKED:
                continue
            if s.links[goal, i] >= FREE:
                return FOUND
            h[TO], h[BY] = goal, i
            for k in range(h[DIM]):
                s.motion[0, k] = s.terminals[goal, k]
            write(s, i, s.turns[goal, i], s.motion[1])
            return LINK
    return NONE


@quick
def _weight(s: Search, result: int) -> float:
    """Return the weight of a unit of length of an edge in this state."""
    return 1.0 if result >= FREE else np.inf if result == BLOCKED else s.rules[CHECK_COST, 0]


@quick
def _open(s: Search) -> None:
    """Push the motions straight to goals and the links of the start."""
    h, nearby = s.header, NEARBY if s.rules[GREED, 0] > 1.0 else 0.0
    for goal in range(1, h[TERMINALS]):
        if s.straight[goal] != BLOCKED:
            cost = _weight(s, s.straight[goal]) * distance(s, s.terminals[0], s.terminals[goal])
            push(s, -goal, -1, -1, cost, 0.0)
    for rank in range(h[LINKS]):
        i = s.near[0, rank]
        if i >= 0 and s.links[0, i] != BLOCKED and s.nodes[i] != BLOCKED:
            state = state_of(s, i, s.turns[0, i])
            if state >= 0:
                cost = _weight(s, s.links[0, i]) * s.away[i]
                push(s, state, -1, -1, cost, s.bounds[state, LEFT] + nearby * s.away[i])


@quick
def _expand(s: Search, state: int, entry: int, cheap: bool) -> bool:
    """Push all successors of a state; return whether memory was enough."""
    h, node, packed, cost = s.header, s.states[state, OF], s.states[state, WINDINGS], s.costs[entry]
    if h[MADE] + h[TERMINALS] > h[ENTRIES]:
        return False
    for goal in range(1, h[TERMINALS]):
        link, away = s.links[goal, node], s.away[goal * h[CAPACITY] + node]
        if s.turns[goal, node] == packed and (link >= FREE or (link == UNKNOWN and away <= s.radius[goal])):
            push(s, -goal, entry, -1, cost + _weight(s, link) * away, 0.0)
    half = s.first[node]
    while half >= 0:
        there, edge = s.halves[half, OTHER], s.halves[half, NUMBER]
        reached = cost + _weight(s, s.edges[edge]) * s.lengths[half]
        turned = packed + s.leads[half] if h[ANY_MULTI_TURN] != 0 else packed
        half = s.halves[half, NEXT]
        if s.edges[edge] == BLOCKED or s.nodes[there] == BLOCKED:
            continue
        if h[SIZE] >= h[STATES] or h[MADE] >= h[ENTRIES]:
            return False
        other = state_of(s, there, turned)
        if other < 0 or s.states[other, REACHED] >= 0 or reached >= s.bounds[other, LEAST]:
            continue
        if not cheap or (s.edges[edge] >= FREE and s.nodes[there] >= FREE):
            s.bounds[other, LEAST] = reached
        push(s, other, entry, edge, reached, s.bounds[other, LEFT])
    return True


@quick
def _first_unknown(s: Search, goal: int) -> int:
    """Return the check of the first unknown part of a path: its milestones first, then its links and
    edges; else FOUND.
    """
    here, chosen, is_edge = goal, -1, True
    while here >= 0:
        state, check = s.entries[here, STATE], check_of(s, here)
        if state >= 0 and result_of(s, check) == UNKNOWN and s.nodes[s.states[state, OF]] == UNKNOWN:
            return _node_check(s, state)
        if result_of(s, check) == UNKNOWN and (chosen < 0 or (is_edge and check == LINK)):
            chosen, is_edge = here, check != LINK
        here = s.entries[here, PARENT]
    if chosen < 0:
        return FOUND
    check = check_of(s, chosen)
    write_motion(s, chosen, check)
    return check


@quick
def check_of(s: Search, entry: int) -> int:
    """Return the kind of motion that led to an entry, and write which one."""
    h, state, parent = s.header, s.entries[entry, STATE], s.entries[entry, PARENT]
    if parent >= 0 and state >= 0:
        h[BY] = s.entries[entry, VIA]
        return EDGE
    if parent < 0 and state < 0:
        h[TO] = -state
        return STRAIGHT
    if parent < 0:
        h[TO], h[BY] = 0, s.states[state, OF]
    else:
        h[TO], h[BY] = -state, s.states[s.entries[parent, STATE], OF]
    return LINK


@quick
def result_of(s: Search, check: int) -> int:
    """Return the state of what `check_of` wrote."""
    if check == EDGE:
        return s.edges[s.header[BY]]
    return s.straight[s.header[TO]] if check == STRAIGHT else s.links[s.header[TO], s.header[BY]]


@quick
def write_motion(s: Search, entry: int, check: int) -> None:
    """Write both endpoints of the motion that led to an entry; of a link the terminal first."""
    from_goal = check == LINK and s.entries[entry, STATE] < 0
    _write_configuration(s, s.entries[entry, PARENT], s.motion[1 if from_goal else 0])
    _write_configuration(s, entry, s.motion[0 if from_goal else 1])


@quick
def _write_configuration(s: Search, entry: int, q: Floats) -> None:
    """Write the configuration of an entry; -1 is the start."""
    state = s.entries[entry, STATE] if entry >= 0 else 0
    if entry < 0 or state < 0:
        for k in range(s.header[DIM]):
            q[k] = s.terminals[-state, k]
    else:
        write(s, s.states[state, OF], s.states[state, WINDINGS], q)


@quick
def record(s: Search, check: int, result: int) -> None:
    """Write the result of a check."""
    to, by = s.header[TO], s.header[BY]
    if check == STRAIGHT:
        s.straight[to] = result
    elif check == NODE:
        s.nodes[to] = result
    elif check == EDGE:
        s.edges[by] = result
    else:
        s.links[to, by] = result
        if result >= FREE:
            s.nodes[by] = FREE


@quick
def write_path(s: Search) -> None:
    """Write the path, from the goal back to the start."""
    entry, rows = s.header[PENDING], 0
    s.header[GOAL] = -s.entries[entry, STATE] - 1
    while entry >= 0:
        _write_configuration(s, entry, s.path[rows])
        entry, rows = s.entries[entry, PARENT], rows + 1
    _write_configuration(s, -1, s.path[rows])
    s.header[ROWS] = rows + 1
