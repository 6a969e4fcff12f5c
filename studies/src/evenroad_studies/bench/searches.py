"""Searches of a benchmark, by name: what is asked of a roadmap in its world, with few checks."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Bools, Ints, Ints32
from evenroad._checks import require_known
from evenroad.roadmap.edges import edge_costs
from evenroad.roadmap.search import FINDERS, FREE, UNKNOWN, EdgeStates, join, length_along, search_problem


class Finding(NamedTuple):
    """What a search says: whether there is a path, and what else it knows of an :class:`Outcome`."""

    solved: bool
    valid_at_solution: int | None = None
    length: float = math.nan


def search_named(name: str) -> Callable[[EdgeStates], Finding]:
    """Return the search of this name, of the states of a graph whose last two nodes are start and goal."""
    require_known("search", name, SEARCHES)
    return SEARCHES[name]


def _connect(states: EdgeStates) -> Finding:
    return Finding(is_connected(states))


def _stock(states: EdgeStates) -> Finding:
    needed = milestones_until_connected(states)
    return Finding(needed is not None, needed)


def _shortest(search: str, states: EdgeStates) -> Finding:
    costs = edge_costs(states.world.space, states.configurations, states.edges)
    found = FINDERS[search](search_problem(states, costs), states)
    if not found.nodes.size:
        return Finding(False)
    return Finding(True, length=length_along(costs[found.edges]))


SEARCHES: dict[str, Callable[[EdgeStates], Finding]] = {
    "connect": _connect,
    "stock": _stock,
    "full": partial(_shortest, "full"),
    "lazy": partial(_shortest, "lazy"),
}
"""Name -> search; what they do is said at :class:`~evenroad_studies.bench.task.Task`."""


CHUNK = 64
"""Edges asked about together where order counts: few enough to stop soon, many enough for a batch to pay."""


def is_connected(states: EdgeStates) -> bool:
    """Return whether free edges join the last two nodes, start and goal; all nodes are taken as free.

    The components of start and goal grow in turns, always the one that fewer unknown edges leave, by asking about all
    of these.  A query without an answer ends when one of the two can grow no more, however large the graph.
    """
    label = np.arange(len(states.node_states), dtype=np.int32)
    join(label, states.edges[states.edge_states == FREE])
    while label[-2] != label[-1]:
        asked = min((_edges_leaving(states, label == label[end]) for end in (-2, -1)), key=len)
        if not len(asked):
            return False
        states.evaluate_edges(asked)
        join(label, states.edges[asked[states.edge_states[asked] == FREE]])
    return True


def milestones_until_connected(states: EdgeStates) -> int | None:
    """Return how many of the milestones, added in order, it takes to connect the last two nodes; None if all do not.

    Start and goal are there first, an edge comes with the later of its milestones.  Under ``k earlier``, whose edges
    among the first milestones do not depend on the others, this is where OMPL's PRM stops.
    """
    if not is_connected(states):
        return None
    milestones = len(states.node_states) - 2
    with_ends = states.edges.astype(np.int64)
    with_ends[with_ends >= milestones] = -1
    needed = with_ends.max(axis=1) + 1
    order = np.argsort(needed, kind="stable")
    label = np.arange(milestones + 2, dtype=np.int32)
    for begin in range(0, len(order), CHUNK):
        edges = order[begin : begin + CHUNK]
        # Edges inside one component change nothing, now or later.
        edges = edges[label[states.edges[edges, 0]] != label[states.edges[edges, 1]]]
        states.evaluate_edges(edges)
        free = edges[states.edge_states[edges] == FREE]
        before = label.copy()
        join(label, states.edges[free])
        if label[-2] == label[-1]:
            return int(needed[free[_first_to_connect(before, states.edges[free])]])
    raise AssertionError("is_connected said that there is a path")


def _first_to_connect(label: Ints32, edges: Ints32) -> int:
    """Return the row of the edge that, joined after those before it, connects the last two nodes."""
    row = 0
    while label[-2] != label[-1]:
        join(label, edges[row : row + 1])
        row += 1
    return row - 1


def _edges_leaving(states: EdgeStates, inside: Bools) -> Ints:
    """Return the unknown edges with one end in a component, (n,), and the other outside."""
    edges = states.edges
    return np.flatnonzero((states.edge_states == UNKNOWN) & (inside[edges[:, 0]] != inside[edges[:, 1]]))
