"""Finding a path while asking the world: everything first, only what matters, or only whether there is one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad.roadmap.search.a_star import BLOCKED, FREE, UNKNOWN, best_path
from evenroad.roadmap.search.graph import Graph
from evenroad.roadmap.search.ledger import Ledger

Found = tuple[npt.NDArray[np.int32], npt.NDArray[np.int32]]
"""The nodes of a path, start first, and its edges; both empty when there is none."""


@dataclass(frozen=True, eq=False)
class Question:
    """Where to go in which graph; the arrays are those of :func:`best_path`."""

    graph: Graph
    weights: npt.NDArray[np.int64]
    bounds: npt.NDArray[np.int64]
    start: int
    goal: int


def find_after_all(question: Question, ledger: Ledger) -> Found:
    """Ask about every node, then about every edge between free ones, and return the shortest path."""
    ledger.ask_nodes(np.arange(len(ledger.node_states)))
    open_edges = (ledger.node_states[ledger.edges] == FREE).all(axis=1)
    ledger.ask_edges(np.flatnonzero(open_edges))
    return _path(question, ledger)


def find_lazily(question: Question, ledger: Ledger) -> Found:
    """Return the same path as `find_after_all`, asking only about what could lie on it.

    The shortest path over whatever is not known to be blocked is tested from its start on, up to the first thing
    that is blocked; when all of it is free, no path of free edges is shorter (Bohlin and Kavraki 2000).
    """
    while True:
        nodes, along = _path(question, ledger)
        if _all_free(nodes, along, ledger):
            return nodes, along


def find_any(question: Question, ledger: Ledger) -> Found:
    """Return some path of free edges if there is one: of those left, the one with the least length to be asked.

    Each time such a path turns out to be blocked, the shortest unknown edges are asked about as well, twice as many as
    the time before: a hard query then ends after a few searches instead of one for every blocked edge.
    """
    no_bounds = np.zeros_like(question.bounds)
    shortest_first = np.argsort(question.weights, kind="stable")
    extra = 1
    while True:
        weights = np.where(ledger.edge_states == FREE, 1, question.weights)
        nodes, along = _path(
            Question(question.graph, weights, no_bounds, question.start, question.goal), ledger
        )
        if _all_free(nodes, along, ledger):
            return nodes, along
        _ask_shortest(shortest_first, extra, ledger)
        extra *= 2


def _ask_shortest(shortest_first: npt.NDArray[np.intp], count: int, ledger: Ledger) -> None:
    """Ask about so many of the shortest edges that could still matter; edges of unknown nodes wait for these."""
    ends_free = (ledger.node_states[ledger.edges[shortest_first]] == FREE).all(axis=1)
    open_edges = shortest_first[ends_free & (ledger.edge_states[shortest_first] == UNKNOWN)]
    ledger.ask_edges(open_edges[:count])


FINDERS: dict[str, Callable[[Question, Ledger], Found]] = {"full": find_after_all, "lazy": find_lazily}
"""The searches by name; both find the same path."""


def _path(question: Question, ledger: Ledger) -> Found:
    return best_path(
        question.graph,
        question.weights,
        ledger.edge_states,
        ledger.node_states,
        question.bounds,
        question.start,
        question.goal,
    )


def _all_free(nodes: npt.NDArray[np.int32], along: npt.NDArray[np.int32], ledger: Ledger) -> bool:
    """Ask along a path, nodes before edges, until something is blocked; an empty path is free."""
    for node in nodes[ledger.node_states[nodes] == UNKNOWN]:
        ledger.ask_nodes(node[np.newaxis])
        if ledger.node_states[node] == BLOCKED:
            return False
    for edge in along[ledger.edge_states[along] == UNKNOWN]:
        ledger.ask_edges(edge[np.newaxis])
        if ledger.edge_states[edge] == BLOCKED:
            return False
    return True
