"""The fast marching tree on a graph (Janson, Schmerling, Clark and Pavone 2015, Algorithm 2)."""

from __future__ import annotations

import heapq

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad.roadmap.search.a_star import FREE
from evenroad.roadmap.search.find import Found
from evenroad.roadmap.search.graph import Graph
from evenroad.roadmap.search.ledger import Ledger

UNVISITED, OPEN, CLOSED = np.int8(0), np.int8(1), np.int8(2)


def march(
    graph: Graph, weights: npt.NDArray[np.int64], ledger: Ledger, start: int, goal: int
) -> tuple[Found, int]:
    """Grow the tree from the start until it takes up the goal; return the path, and the nodes in the tree.

    All nodes are free; ties go to the lower node.  An edge found to be blocked is not asked about again, but keeps its
    place as the best offer of its node, as in the original.
    """
    stage = np.full(graph.nodes, UNVISITED)
    cost = np.zeros(graph.nodes, dtype=np.int64)
    parent_edge = np.full(graph.nodes, -1, dtype=np.int32)
    stage[start] = OPEN
    frontier = [(0, start)]
    while frontier:
        _, node = heapq.heappop(frontier)
        if node == goal:
            break
        fresh, offers = _best_offers(node, graph.first, graph.other, graph.edge, weights, cost, stage)
        ledger.ask_edges(offers)
        free = ledger.edge_states[offers] == FREE
        fresh, offers = fresh[free], offers[free]
        # Taken up after all have been asked: none of the fresh ones is an offer to another one of them.
        pairs = ledger.edges[offers]
        giver = np.where(pairs[:, 0] == fresh, pairs[:, 1], pairs[:, 0])
        cost[fresh] = cost[giver] + weights[offers]
        parent_edge[fresh] = offers
        stage[fresh] = OPEN
        stage[node] = CLOSED
        for newcomer in fresh.tolist():
            heapq.heappush(frontier, (int(cost[newcomer]), newcomer))
    return _way_back(parent_edge, ledger.edges, start, goal), int(np.count_nonzero(stage))


def _way_back(
    parent_edge: npt.NDArray[np.int32], edges: npt.NDArray[np.int32], start: int, goal: int
) -> Found:
    """Return the nodes and edges from the start to the goal; empty if the goal is not in the tree."""
    nodes, along = [goal], []
    while nodes[-1] != start:
        edge = int(parent_edge[nodes[-1]])
        if edge < 0:
            return np.empty(0, dtype=np.int32), np.empty(0, dtype=np.int32)
        a, b = edges[edge].tolist()
        along.append(edge)
        nodes.append(b if a == nodes[-1] else a)
    return np.array(nodes[::-1], dtype=np.int32), np.array(along[::-1], dtype=np.int32)


@njit(cache=True, nogil=True)
def _best_offers(node, first, other, edge, weights, cost, stage):  # type: ignore[no-untyped-def]
    """Return the unvisited neighbours of a node, and the edge from the open node that is the best for each."""
    fresh = np.empty(first[node + 1] - first[node], dtype=np.int32)
    offers = np.empty_like(fresh)
    count = 0
    for slot in range(first[node], first[node + 1]):
        neighbour = other[slot]
        if stage[neighbour] != UNVISITED:
            continue
        best = -1
        least = np.int64(0)
        giver = -1
        for back in range(first[neighbour], first[neighbour + 1]):
            candidate = other[back]
            if stage[candidate] != OPEN:
                continue
            reached = cost[candidate] + weights[edge[back]]
            if best < 0 or reached < least or (reached == least and candidate < giver):
                best, least, giver = edge[back], reached, candidate
        fresh[count], offers[count] = neighbour, best
        count += 1
    return fresh[:count].copy(), offers[:count].copy()
