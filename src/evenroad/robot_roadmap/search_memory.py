"""Where the search of a roadmap keeps what it knows: a table of counts and addresses, and arrays that it tells of."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.addresses import (
    byte_table_at,
    bytes_at,
    doubles_at,
    integers_at,
    matrix_at,
    singles_at,
    small_table_at,
    table_at,
)
from evenroad.robot.kernel.layout import quick

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Ints32 = npt.NDArray[np.int32]
Bytes = npt.NDArray[np.uint8]
Singles = npt.NDArray[np.float32]

UNKNOWN, BLOCKED, DOUBTED, FREE, PROVED = range(5)
"""Verdicts; DOUBTED is a motion that was not proved soon, FREE is a motion at its states, PROVED one throughout."""

CAPACITY, HALVES, EDGES, DIM, ENDS, LINKS, STATES, ENTRIES = range(8)
"""Desk: for how many milestones, half edges and edges there is room; how many coordinates, ends and links of each; room
for states and entries."""

NODES, HALVES_MADE, EDGES_MADE, BASE = range(8, 12)
"""Desk: how many milestones, half edges and edges there are, and how many of the edges are known to be free of robot
and cell."""

PHASE, SIZE, MADE, WAITING, PENDING, TO, BY, AIM, AIMED_END = range(12, 21)
"""Desk: what the search has got to: states, entries, those in the queue, the one at hand; of a question the milestone
or end, and the edge or the milestone it is linked to; the milestone by which a goal is approached, or -1, and which."""

ASK_STRAIGHT, ASK_GOALS, OPEN, SEARCH = range(4)
"""Phases of a search."""

KNOWN, GRAPH, RULES, QUERY = range(21, 25)
"""Desk: addresses of milestones, of half edges, of the rules of the joints, and of what one query needs."""

ONLY_KNOWN, MEASURED = 25, 26
"""Desk: 1 where only what is known to be free is gone along; from how many milestones the ends are measured."""

VERDICTS, LIFTING = 27, 28
"""Desk: address of the verdicts of edges; 1 where joints are lifted by whole turns."""

UNTURNED = 29
"""Desk: 1 where ends are linked to milestones as these are, 0 where these are turned to be near."""

DESK = 30

NODE, EDGE, LINK, STRAIGHT, FOUND, NONE, CUT_OFF, FULL = range(8)
"""What `step` ends with: a milestone, a motion of the roadmap, a link of an end or the motion straight to a goal to be
asked about; a way, none, no free link of a goal, no room."""

OTHER, NEXT, NUMBER, HALF = range(4)
"""Of a half edge: where it leads, the next one of the same milestone or -1, its edge; how many things that is."""

LOW, HIGH, LIFTS, ENDLESS, MIDDLE, GREED, NEARBY, RULE_ROWS = range(8)
"""Rows of the rules: limits; 1 for joints that are lifted by whole turns, or turn on for ever; the middle of the range
of milestones; what the bound is multiplied by, 1 for the shortest way; by how many times their length links of the
start are put off.  And how many rows that is."""

OF, LIFTED, SIBLING, REACHED = range(4)
"""Of a state: milestone, packed turns, the next state of the same milestone or -1, the entry it was reached by."""

LEFT, LEAST = range(2)
"""Of a state: how far it is to a goal by the bound, and the least cost along what is known to be free."""

STATE, PARENT, VIA = range(3)
"""Of an entry: a state, or a goal as minus its row; the entry before, or -1; and the edge, or -1 of a link."""

ROWS, MILESTONES, MOTIONS, GOAL, CHECKS, REPORT = range(6)
"""Of the report of a query: waypoints written, milestones and motions that were asked about, the goal that was reached,
batches of sixteen checks; and how many things that is."""


class Search(NamedTuple):
    """A roadmap in a scene, and a query in it, as compiled code reads them.

    Attributes
    ----------
    desk : int64 array
        Counts and addresses.
    milestones, columns : float64 array, shape (capacity, dim), and float32 array, shape (dim capacity,)
        The same by coordinate.
    nodes, first, groups : uint8 array and int64 arrays, shape (capacity,)
        Verdicts of milestones, their first half edges, and another one that free motions lead to, or itself.
    halves, leads, lengths, edges : arrays
        Half edges, (h, 3), their turns, packed, their lengths, verdicts of edges.
    rules : float64 array, shape (7, dim)
    ends, asked : float64 arrays, shapes (e + 1, dim) and (2, dim)
        Start, goals and a place that is learned; the two ends of the motion that is asked about.
    turns, near, away : arrays, shape (e + 1, capacity); the last in one piece
        Of each end: after which turns milestones are nearest, which are to be tried, and how far all are; behind
        these is a row to work in.
    links : uint8 array, shape (e + 1, capacity)
        Verdicts of links.
    straight, radius : uint8 and float64 arrays, shape (e + 1,)
        Verdicts of the motions straight to the goals, and how far the farthest milestone is that is to be tried.
    heads : int64 array, shape (capacity,)
        The first state of each milestone, or -1: of all that no state is of.
    states, bounds, entries, costs, keys, items : arrays
        What the search has got to, and its queue.
    """

    desk: Ints
    milestones: Floats
    columns: Singles
    nodes: Bytes
    first: Ints
    groups: Ints
    halves: Ints32
    leads: Ints
    lengths: Singles
    edges: Bytes
    rules: Floats
    ends: Floats
    asked: Floats
    turns: Ints
    near: Ints
    away: Singles
    links: Bytes
    straight: Bytes
    radius: Floats
    heads: Ints
    states: Ints
    bounds: Floats
    entries: Ints32
    costs: Floats
    keys: Floats
    items: Ints


def known_room(capacity: int, dim: int) -> int:
    """Return how many doubles milestones need."""
    return (dim + (dim + 1) // 2 + 2) * capacity + (capacity + 7) // 8


def graph_room(halves: int) -> int:
    """Return how many doubles so many half edges need, an even number."""
    return (HALF * halves) // 2 + halves + halves // 2


def query_room(desk: Ints) -> int:
    """Return how many doubles a query needs."""
    ends, capacity, dim = int(desk[ENDS]) + 1, int(desk[CAPACITY]), int(desk[DIM])
    return (
        (ends + 2) * dim + ends + (3 * ends + 1) * capacity + 6 * int(desk[STATES]) + 6 * int(desk[ENTRIES])
    )


@quick
def search_at(desk: int) -> Search:
    """Return what lies at the addresses of a desk."""
    d = integers_at(desk, (DESK,))
    capacity, dim, ends, states, entries = d[CAPACITY], d[DIM], d[ENDS] + 1, d[STATES], d[ENTRIES]
    columns = d[KNOWN] + 8 * dim * capacity
    first = columns + 8 * ((dim + 1) // 2) * capacity
    leads = d[GRAPH] + 4 * HALF * d[HALVES]
    asked = d[QUERY] + 8 * ends * dim
    turns = asked + 8 * 2 * dim
    row = 8 * ends * capacity
    away = turns + 2 * row
    # These, with a row to work in, and the two that follow take no more than a third row.
    links = away + row // 2 + 4 * capacity
    radius = away + row
    heads = radius + 8 * ends
    found = heads + 8 * capacity
    bounds = found + 8 * 4 * states
    made = bounds + 8 * 2 * states
    costs = made + 8 * 3 * entries
    return Search(
        d,
        matrix_at(d[KNOWN], (capacity, dim)),
        singles_at(columns, (dim * capacity,)),
        bytes_at(first + 16 * capacity, (capacity,)),
        integers_at(first, (capacity,)),
        integers_at(first + 8 * capacity, (capacity,)),
        small_table_at(d[GRAPH], (d[HALVES], HALF)),
        integers_at(leads, (d[HALVES],)),
        singles_at(leads + 8 * d[HALVES], (d[HALVES],)),
        bytes_at(d[VERDICTS], (d[EDGES],)),
        matrix_at(d[RULES], (RULE_ROWS, dim)),
        matrix_at(d[QUERY], (ends, dim)),
        matrix_at(asked, (2, dim)),
        table_at(turns, (ends, capacity)),
        table_at(turns + row, (ends, capacity)),
        singles_at(away, ((ends + 1) * capacity,)),
        byte_table_at(links, (ends, capacity)),
        bytes_at(links + ends * capacity, (ends,)),
        doubles_at(radius, (ends,)),
        integers_at(heads, (capacity,)),
        table_at(found, (states, 4)),
        matrix_at(bounds, (states, 2)),
        small_table_at(made, (entries, 3)),
        doubles_at(costs, (entries,)),
        doubles_at(costs + 8 * entries, (entries,)),
        integers_at(costs + 16 * entries, (entries,)),
    )


@quick
def kept_in_order(keys: Floats, items: Ints, count: int, most: int, key: float, item: int) -> int:
    """Put an item among the so many with the least keys, if it is one of these, and return how many there are now."""
    if count == most and key >= keys[count - 1]:
        return count
    count = min(count + 1, most)
    place = count - 1
    while place > 0 and keys[place - 1] > key:
        keys[place], items[place] = keys[place - 1], items[place - 1]
        place -= 1
    keys[place], items[place] = key, item
    return count


@quick
def group_of(s: Search, node: int) -> int:
    """Return by which milestone the group of a milestone is known: all that free motions join."""
    while s.groups[node] != node:
        s.groups[node] = s.groups[s.groups[node]]
        node = s.groups[node]
    return node


@quick
def join(s: Search, a: int, b: int) -> None:
    """Make one group of those of two milestones."""
    s.groups[group_of(s, a)] = group_of(s, b)
