"""Memory of the compiled search of a roadmap: a header of counts and addresses, and the arrays."""

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

UNKNOWN, BLOCKED, FREE, PROVED = range(4)
"""States of a milestone or an edge: an edge is FREE if its states are, PROVED if it is free throughout."""

CAPACITY, HALVES, EDGES, DIM, TERMINALS, LINKS, STATES, ENTRIES = range(8)
"""Header: capacities of milestones, half edges and edges; coordinates; start and goals, and links of each; capacities
of states and entries."""

NODES, HALVES_MADE, EDGES_MADE, BASE, ANY_MULTI_TURN = range(8, 13)
"""Header: numbers of milestones, half edges and edges; number of edges that are known to be free of robot and static
scene; 1 where joints have more than one turn."""

PHASE, SIZE, MADE, WAITING, PENDING, TO, BY = range(13, 20)
"""Header: the phase of the search, its states, entries, those in the queue, the current one; of an edge to be evaluated
the milestone or terminal, and the edge or the milestone that it is linked to."""

ROWS, GOAL, CONFIGURATIONS, MOTIONS, BATCHES = range(20, 25)
"""Header: waypoints of the path, the goal it leads to; numbers of configurations, motions and batches checked."""

CHECK_STRAIGHT, CHECK_GOALS, OPEN, SEARCH = range(4)
"""Phases of a search."""

NODE, EDGE, LINK, STRAIGHT, FOUND, NONE, FULL, TAKEN, SPENT, PAUSED = range(10)
"""What a search needs evaluated: a milestone, an edge, a link of a start or goal, the motion straight to a goal.  And
how it ends: a path, none, memory full, start or goals in collision, budget spent, its slice of checks used up."""

OTHER, NEXT, NUMBER, HALF = range(4)
"""Columns of a half edge: where it leads, the next one of the same milestone or -1, its edge; their number."""

LOW, HIGH, MULTI_TURN, ENDLESS, MIDDLE, GREED, CHECK_COST, RULE_ROWS = range(8)
"""Rows of the rules: limits; 1 for joints of more than one turn, or endless ones; the middle of the range of
milestones; the factor of the bound, 1 for the shortest path; the cost of a unit of length of an edge that is not
evaluated yet, 1 where evaluations are cheap.  And the number of rows."""

OF, WINDINGS, SIBLING, REACHED = range(4)
"""Columns of a state: milestone, packed turns, the next state of the same milestone or -1, the entry
that reached it."""

LEFT, LEAST = range(2)
"""Columns of a state's bounds: its distance to a goal by the bound, and the least cost it was offered."""

STATE, PARENT, VIA = range(3)
"""Columns of an entry: a state, or a goal as minus its row; the entry before, or -1; and the edge, or -1 of a link."""


class Search(NamedTuple):
    """A roadmap in a scene, and a query in it, as compiled code reads them.

    Attributes
    ----------
    header : int64 array
        Counts and addresses.
    milestones, columns : float64 array, shape (capacity, dim), and float32 array, shape (dim capacity,)
        The same by coordinate.
    nodes, first : uint8 and int64 arrays, shape (capacity,)
        What is known of milestones, and their first half edges.
    halves, leads, lengths, edges : arrays
        Half edges, (h, 3), their turns, packed, their lengths; what is known of edges.
    rules : float64 array, shape (7, dim)
    terminals, motion : float64 arrays, shapes (t + 1, dim) and (2, dim)
        Start, goals and a configuration to be inserted; the two ends of the motion to be evaluated.
    turns, near, away : arrays, shape (t + 1, capacity); the last in one piece, with a row to work in
        Of each terminal: after which turns milestones are nearest, which are to be tried, and how far all are.
    links : uint8 array, shape (t + 1, capacity)
        What is known of links.
    straight, radius : uint8 and float64 arrays, shape (t + 1,)
        What is known of the motions straight to the goals, and how far the farthest milestone is that is to be tried.
    heads : int64 array, shape (capacity,)
        The first state of each milestone, or -1.
    states, bounds, entries, costs, keys, items : arrays
        What the search has reached, and its queue.
    path : float64 array
        The path that was found, from the goal back to the start.
    """

    header: Ints
    milestones: Floats
    columns: Singles
    nodes: Bytes
    first: Ints
    halves: Ints32
    leads: Ints
    lengths: Singles
    edges: Bytes
    rules: Floats
    terminals: Floats
    motion: Floats
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
    path: Floats


HEADER_INDEX = {name: i for i, name in enumerate(Search._fields[1:], start=BATCHES + 1)}
"""Position of each array's address in the header."""

FIRST_INDEX, HEADER = BATCHES + 1, BATCHES + 1 + len(HEADER_INDEX)


@quick
def search_at(header: int) -> Search:
    """Return the arrays at the addresses of a header."""
    h = integers_at(header, (HEADER,))
    capacity, dim, rows, states, entries = h[CAPACITY], h[DIM], h[TERMINALS] + 1, h[STATES], h[ENTRIES]
    at = h[FIRST_INDEX:]
    return Search(
        h,
        matrix_at(at[0], (capacity, dim)),
        singles_at(at[1], (dim * capacity,)),
        bytes_at(at[2], (capacity,)),
        integers_at(at[3], (capacity,)),
        small_table_at(at[4], (h[HALVES], HALF)),
        integers_at(at[5], (h[HALVES],)),
        singles_at(at[6], (h[HALVES],)),
        bytes_at(at[7], (h[EDGES],)),
        matrix_at(at[8], (RULE_ROWS, dim)),
        matrix_at(at[9], (rows, dim)),
        matrix_at(at[10], (2, dim)),
        table_at(at[11], (rows, capacity)),
        table_at(at[12], (rows, capacity)),
        singles_at(at[13], ((rows + 1) * capacity,)),
        byte_table_at(at[14], (rows, capacity)),
        bytes_at(at[15], (rows,)),
        doubles_at(at[16], (rows,)),
        integers_at(at[17], (capacity,)),
        table_at(at[18], (states, 4)),
        matrix_at(at[19], (states, 2)),
        small_table_at(at[20], (entries, 3)),
        doubles_at(at[21], (entries,)),
        doubles_at(at[22], (entries,)),
        integers_at(at[23], (entries,)),
        matrix_at(at[24], (states + 2, dim)),
    )


@quick
def kept_in_order(keys: Floats, items: Ints, count: int, most: int, key: float, item: int) -> int:
    """Insert an item among the `count` least keys, if it belongs there, and return their number."""
    if count == most and key >= keys[count - 1]:
        return count
    count = min(count + 1, most)
    slot = count - 1
    while slot > 0 and keys[slot - 1] > key:
        keys[slot], items[slot] = keys[slot - 1], items[slot - 1]
        slot -= 1
    keys[slot], items[slot] = key, item
    return count
