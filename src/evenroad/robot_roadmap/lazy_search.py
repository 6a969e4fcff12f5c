"""The search of a robot's roadmap: the shortest way first, by compiled code, then the world is asked about it."""

from __future__ import annotations

import heapq
import itertools
import time
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad._arrays import Bools, Floats, Ints
from evenroad.robot.arm_world import RECHECK_TOLERANCE, ArmWorld
from evenroad.robot_roadmap.turns import TURN

Verdicts = npt.NDArray[np.int8]
UNKNOWN, FREE, BLOCKED = 0, 1, 2

NONE, GAVE_UP = -1, -2
"""In place of a goal: there is no path, or motions or time were over before."""

_EASY, _ANEW = 4, 16
"""A query that so many searches have not answered is worth a closer bound, made anew after so many more."""

_BITS = 4
_ROOM = 1024
"""States that there is room for at first; doubled when it is used up."""


class Ways(NamedTuple):
    """A roadmap by node, as compiled code reads it.

    Of milestone i, the half edges ``first[i]`` to ``first[i + 1]`` lead to ``other``, by ``turns``, (h, dim), over
    ``length``; ``edge`` is the number of the edge.  The rest is of the joints: see :class:`OneTurn`.
    """

    milestones: Floats
    first: Ints
    other: Ints
    edge: Ints
    turns: Any
    length: Floats
    weights: Floats
    limits: Floats
    lifts: Bools
    endless: Bools
    edges: int


class Ends(NamedTuple):
    """A start, (dim,), goals, (g, dim), and their links: to which milestone, by which turns and how long.

    ``turns``, (1 + g, n), are packed; ``length``, (1 + g, n), is inf where there is no link.
    """

    start: Floats
    goals: Floats
    turns: Ints
    length: Floats
    straight: Floats


@njit(cache=True, nogil=True)
def ends_of(ways, start, goals, links):  # type: ignore[no-untyped-def]
    """Return start and goals linked to the nearest milestones, `links` of each or all of them."""
    n, dim = ways.milestones.shape
    turns, length = np.zeros((1 + len(goals), n), dtype=np.int64), np.full((1 + len(goals), n), np.inf)
    away, straight = np.empty(n), np.empty(len(goals))
    for end in range(1 + len(goals)):
        q = start if end == 0 else goals[end - 1]
        for i in range(n):
            squared = 0.0
            for k in range(dim):
                apart = ways.milestones[i, k] - q[k]
                if ways.endless[k]:
                    apart -= TURN * np.rint(apart / TURN)
                elif ways.lifts[k]:
                    turn = np.rint(-apart / TURN)
                    turn = max(turn, np.ceil((ways.limits[0, k] - ways.milestones[i, k]) / TURN))
                    turn = min(turn, np.floor((ways.limits[1, k] - ways.milestones[i, k]) / TURN))
                    apart += TURN * turn
                    turns[end, i] += np.int64(turn) << (_BITS * k)
                squared += (ways.weights[k] * apart) ** 2
            away[i] = np.sqrt(squared)
        furthest = np.inf if links >= n else np.partition(away, links)[links]
        for i in range(n):
            if away[i] < furthest:
                length[end, i] = away[i]
        if end:
            straight[end - 1] = _distance(ways, start, q)
    return Ends(start, goals, turns, length, straight)


def lazy_path(
    ways: Ways,
    ends: Ends,
    milestones: Verdicts,
    edges: Verdicts,
    motions_left: int,
    deadline: float,
    day: ArmWorld,
    full: ArmWorld,
) -> tuple[Floats, int, int, int]:
    """Return the shortest path that the world calls free: waypoints, its goal or -1, and what was checked.

    A lazy shortest-path search (Dellin and Srinivasa 2016): the best path over all that is not known to be blocked is
    asked about, its milestones first and then its motions, until all of one path is free or there is none.

    Parameters
    ----------
    ways, ends : Ways, Ends
        The roadmap, and what is asked.
    milestones, edges : int8 arrays
        What is known of them so far, written to.  Behind the edges come the links of the start, those of each goal, and
        the straight motions to the goals.
    motions_left : int
        Give up when so many motions were checked.
    deadline : float
        Or then, on the clock of ``time.perf_counter``.
    day, full : ArmWorld
        Of the day's obstacles alone, enough for what was proved free of the rest beforehand; and of everything.

    Returns
    -------
    path : float64 array, shape (p, dim)
    goal : int
        NONE without a path, GAVE_UP where motions or time were over before.
    configurations, motions : int
        How many were checked.
    """
    configurations = motions = 0
    nothing, left = np.empty((0, ways.milestones.shape[1])), np.zeros(len(ways.milestones))
    for search in itertools.count():
        if search % _ANEW == _EASY:
            _write_way_left(ways, ends, milestones, edges, left)
        nodes, between, along, goal = _shortest(ways, ends, milestones, edges, left)
        if goal < 0 or time.perf_counter() >= deadline:
            return nothing, NONE if goal < 0 else GAVE_UP, configurations, motions
        path = np.concatenate([ends.start[np.newaxis], between, ends.goals[goal : goal + 1]])
        unknown = milestones[nodes] == UNKNOWN
        if unknown.any():
            free = day.valid(between[unknown])
            configurations += len(free)
            milestones[nodes[unknown]] = np.where(free, FREE, BLOCKED)
            if not free.all():
                continue
        # The links of start and goal are the likeliest to be blocked, so that they come first.
        for i in sorted(range(len(along)), key=lambda i: min(i, len(along) - 1 - i)):
            if edges[along[i]] == UNKNOWN:
                if motions >= motions_left:
                    return nothing, GAVE_UP, configurations, motions
                motions += 1
                world = day if along[i] < ways.edges else full
                free = world.motion_certified(path[i : i + 1], path[i + 1 : i + 2], RECHECK_TOLERANCE)
                edges[along[i]] = FREE if free[0] else BLOCKED
            if edges[along[i]] == BLOCKED:
                break
        else:
            return path, goal, configurations, motions
    raise AssertionError("the count of searches never ends")


@njit(cache=True, nogil=True)
def _write_way_left(ways, ends, milestones, edges, left):  # type: ignore[no-untyped-def]
    """Write how far it is from each milestone to a goal at least, (n,), with turns left out: Dijkstra (1959)."""
    n = len(left)
    queue: Any = [(0.0, np.int64(0)) for _ in range(0)]
    left[:] = np.inf
    for i in range(n):
        for g in range(len(ends.goals)):
            if edges[ways.edges + n * (1 + g) + i] != BLOCKED and milestones[i] != BLOCKED:
                left[i] = min(left[i], ends.length[1 + g, i])
        if left[i] < np.inf:
            heapq.heappush(queue, (left[i], np.int64(i)))
    while len(queue):
        cost, i = heapq.heappop(queue)
        if cost > left[i]:
            continue
        for half in range(ways.first[i], ways.first[i + 1]):
            there: Any = ways.other[half]
            reached = cost + ways.length[half]
            if reached < left[there] and edges[ways.edge[half]] != BLOCKED and milestones[there] != BLOCKED:
                left[there] = reached
                heapq.heappush(queue, (reached, there))


@njit(cache=True, nogil=True)
def _shortest(ways, ends, milestones, edges, left):  # type: ignore[no-untyped-def]
    """Return milestones, configurations and edges of the shortest path not known to be blocked, and its goal or -1.

    A* (Hart, Nilsson and Raphael 1968) over milestones with turns, with the distance to the nearest goal as its bound,
    or the way that is `left`, (n,), at least, where that is longer.
    """
    n, dim = ways.milestones.shape
    q, room = np.empty(dim), _ROOM
    node, turned = np.empty(room, dtype=np.int64), np.empty(room, dtype=np.int64)
    cost, bound = np.empty(room), np.empty(room)
    parent, via = np.empty(room, dtype=np.int64), np.empty(room, dtype=np.int64)
    closed = np.zeros(room, dtype=np.bool_)
    slots = np.full(4 * room, -1, dtype=np.int64)
    size = 0
    open_states = [(0.0, np.int64(0)) for _ in range(0)]
    last: Any = -1
    best, goal, last_edge = np.inf, -1, -1
    for g in range(len(ends.goals)):
        straight = ways.edges + n * (1 + len(ends.goals)) + g
        if edges[straight] != BLOCKED and ends.straight[g] < best:
            best, goal, last, last_edge = ends.straight[g], g, -1, straight
    state: Any = -1
    while True:
        # The start has no milestone: its links are its half edges.
        begin, end = (0, n) if state < 0 else (ways.first[node[state]], ways.first[node[state] + 1])
        for half in range(begin, end):
            if state < 0:
                there, edge = half, ways.edges + half
                length, packed = ends.length[0, half], ends.turns[0, half]
            else:
                there, edge = ways.other[half], ways.edge[half]
                length, packed = ways.length[half], turned[state] + ways.turns[half]
            if length == np.inf or edges[edge] == BLOCKED or milestones[there] == BLOCKED:
                continue
            if not _write_state(ways, there, packed, q):
                continue
            reached = length if state < 0 else cost[state] + length
            slot = (there * 2654435761 + packed * 40503) % len(slots)
            while slots[slot] >= 0 and (node[slots[slot]] != there or turned[slots[slot]] != packed):
                slot = (slot + 1) % len(slots)
            found = slots[slot]
            if found < 0:
                found = slots[slot] = size
                size += 1
                node[found], turned[found], cost[found] = there, packed, np.inf
                nearest = np.inf
                for g in range(len(ends.goals)):
                    nearest = min(nearest, _distance(ways, q, ends.goals[g]))
                bound[found] = max(nearest, left[there])
            if reached < cost[found] and not closed[found]:
                cost[found], parent[found], via[found] = reached, state, edge
                heapq.heappush(open_states, (reached + bound[found], found))
            if size == len(node):
                room = 2 * size
                node, turned = _longer(node, room), _longer(turned, room)
                cost, bound = _longer(cost, room), _longer(bound, room)
                parent, via, closed = _longer(parent, room), _longer(via, room), _longer(closed, room)
                closed[size:] = False
                slots = np.full(4 * room, -1, dtype=np.int64)
                for i in range(size):
                    slot = (node[i] * 2654435761 + turned[i] * 40503) % len(slots)
                    while slots[slot] >= 0:
                        slot = (slot + 1) % len(slots)
                    slots[slot] = i
        state = -1
        while len(open_states):
            least, candidate = heapq.heappop(open_states)
            if least >= best:
                break
            if not closed[candidate]:
                state = candidate
                break
        if state < 0:
            break
        closed[state] = True
        i = node[state]
        for g in range(len(ends.goals)):
            edge = ways.edges + n * (1 + g) + i
            there = cost[state] + ends.length[1 + g, i]
            if turned[state] == ends.turns[1 + g, i] and edges[edge] != BLOCKED and there < best:
                best = there
                goal, last, last_edge = g, state, edge
    count, state = 0, last
    while state >= 0:
        count, state = count + 1, parent[state]
    nodes, between = np.empty(count, dtype=np.int64), np.empty((count, dim))
    along = np.empty(count + 1, dtype=np.int64)
    along[count], state = last_edge, last
    for i in range(count - 1, -1, -1):
        nodes[i], along[i] = node[state], via[state]
        _write_state(ways, nodes[i], turned[state], between[i])
        state = parent[state]
    return nodes, between, along, goal


@njit(cache=True, nogil=True)
def _write_state(ways, node, packed, q):  # type: ignore[no-untyped-def]
    """Write the configuration of a milestone after turns, and return whether it is within the limits."""
    inside = True
    for k in range(len(q)):
        q[k] = ways.milestones[node, k]
        if ways.lifts[k]:
            q[k] += TURN * _turn(packed, k)
            inside &= ways.limits[0, k] <= q[k] <= ways.limits[1, k]
    return inside


@njit(cache=True, nogil=True)
def _turn(packed, k):  # type: ignore[no-untyped-def]
    """Return the turns of one joint from those of all, whose sum ``sum_k turn_k 16^k`` is their packed form."""
    # Each is brought to 0 .. 15 first, so that a negative one does not borrow from the next.
    shifted = packed + _OFFSETS
    return ((shifted >> (_BITS * k)) & (2**_BITS - 1)) - 2 ** (_BITS - 1)


_OFFSETS = sum(2 ** (_BITS - 1) << (_BITS * k) for k in range(14))


@njit(cache=True, nogil=True)
def _distance(ways, a, b):  # type: ignore[no-untyped-def]
    squared = 0.0
    for k in range(len(a)):
        apart = b[k] - a[k]
        if ways.endless[k]:
            apart -= TURN * np.rint(apart / TURN)
        squared += (ways.weights[k] * apart) ** 2
    return np.sqrt(squared)


@njit(cache=True, nogil=True)
def _longer(array, size):  # type: ignore[no-untyped-def]
    longer = np.empty(size, dtype=array.dtype)
    longer[: len(array)] = array
    return longer
