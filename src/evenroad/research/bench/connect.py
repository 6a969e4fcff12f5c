"""Success by connectivity: are start and goal in one piece, and since which milestone, with few checks."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad.roadmap.search import FREE, UNKNOWN, EdgeStates, join

CHUNK = 64
"""Edges asked about together where order counts: few enough to stop soon, many enough for a batch to pay."""


def is_connected(ledger: EdgeStates) -> bool:
    """Return whether free edges join the last two nodes, start and goal.

    The pieces of start and goal grow in turns, always the one that fewer unknown edges leave, by asking about all of
    these.  A query without an answer ends when one of the two pieces can grow no more, however large the graph.

    Parameters
    ----------
    ledger : EdgeStates
        All nodes are taken as free; what is asked is written down there.
    """
    label = np.arange(len(ledger.node_states), dtype=np.int32)
    join(label, ledger.edges[ledger.edge_states == FREE])
    while label[-2] != label[-1]:
        asked = min((_leaving(ledger, label, end) for end in (-2, -1)), key=len)
        if not len(asked):
            return False
        ledger.ask_edges(asked)
        join(label, ledger.edges[asked[ledger.edge_states[asked] == FREE]])
    return True


def milestones_until_connected(ledger: EdgeStates) -> int | None:
    """Return how many of the milestones, added in order, it takes to connect the last two nodes; None if all do not.

    Start and goal are there first, an edge comes with the later of its milestones.  Under ``k earlier``, whose edges
    among the first milestones do not depend on the others, this is where OMPL's PRM stops.

    Parameters
    ----------
    ledger : EdgeStates
        As for :func:`is_connected`, which is asked first: most queries without an answer end there.
    """
    if not is_connected(ledger):
        return None
    milestones = len(ledger.node_states) - 2
    with_ends = ledger.edges.astype(np.int64)
    with_ends[with_ends >= milestones] = -1
    needed = with_ends.max(axis=1) + 1
    order = np.argsort(needed, kind="stable")
    label = np.arange(milestones + 2, dtype=np.int32)
    for begin in range(0, len(order), CHUNK):
        edges = order[begin : begin + CHUNK]
        # Edges inside one piece change nothing, now or later.
        edges = edges[label[ledger.edges[edges, 0]] != label[ledger.edges[edges, 1]]]
        ledger.ask_edges(edges)
        free = edges[ledger.edge_states[edges] == FREE]
        before = label.copy()
        join(label, ledger.edges[free])
        if label[-2] == label[-1]:
            return int(needed[free[_first_to_connect(before, ledger.edges[free])]])
    raise AssertionError("is_connected said that there is a path")


def _leaving(ledger: EdgeStates, label: npt.NDArray[np.int32], node: int) -> npt.NDArray[np.int64]:
    """Return the unknown edges with one end in the piece of this node and the other outside."""
    return _edges_leaving(ledger.edges, ledger.edge_states, label, label[node])


def _first_to_connect(label: npt.NDArray[np.int32], edges: npt.NDArray[np.int32]) -> int:
    """Return the row of the edge that, joined after those before it, connects the last two nodes."""
    row = 0
    while label[-2] != label[-1]:
        join(label, edges[row : row + 1])
        row += 1
    return row - 1


@njit(cache=True, nogil=True)
def _edges_leaving(edges, states, label, piece):  # type: ignore[no-untyped-def]
    leaving = np.empty(edges.shape[0], dtype=np.int64)
    count = 0
    for e in range(edges.shape[0]):
        if states[e] == UNKNOWN and (label[edges[e, 0]] == piece) != (label[edges[e, 1]] == piece):
            leaving[count] = e
            count += 1
    return leaving[:count].copy()
