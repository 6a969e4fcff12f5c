"""Finding a path while asking the world: everything first, only what matters, any path, or by a marching tree."""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad.roadmap.search.edge_states import BLOCKED, FREE, UNKNOWN, EdgeStates
from evenroad.roadmap.search.graph import Graph, join
from evenroad.roadmap.search.shortest import FixedPoint, best_path

Found = tuple[npt.NDArray[np.int32], npt.NDArray[np.int32]]
"""The nodes of a path, start first, and its edges; both empty when there is none."""

NOT_FOUND: Found = np.empty(0, dtype=np.int32), np.empty(0, dtype=np.int32)


@dataclass(frozen=True, eq=False)
class SearchProblem:
    """From which node to which goals in which graph; the arrays are those of :func:`best_path`."""

    graph: Graph
    weights: npt.NDArray[np.int64]
    bounds: npt.NDArray[np.int64]
    start: int
    goals: npt.NDArray[np.int64]


def search_problem(
    states: EdgeStates, costs: npt.NDArray[np.float64], goals: int = 1, *, bound: float = 1.0
) -> SearchProblem:
    """Return the search over all edges of `states`, (m,) `costs`, from the start to the nearest goal.

    Parameters
    ----------
    states : EdgeStates
        Whose last nodes are the start and then the goals.
    goals : int
        How many goals there are.
    bound : float
        Costs are at least this share of the distances in the space.
    """
    q, space = states.configurations, states.world.space
    nodes = len(q)
    rows = np.arange(nodes - goals, nodes)
    fixed_point = FixedPoint.of(float(costs.max(initial=0.0)), nodes)
    to_goal = np.min([space.distance(q, np.broadcast_to(q[goal], q.shape)) for goal in rows], axis=0)
    return SearchProblem(
        Graph.of(nodes, states.edges),
        fixed_point.weights(costs),
        fixed_point.bounds(bound * to_goal),
        nodes - goals - 1,
        rows,
    )


def find_after_all(problem: SearchProblem, states: EdgeStates) -> Found:
    """Ask about every node, then about every edge between free ones, and return the shortest path."""
    states.ask_nodes(np.arange(len(states.node_states)))
    open_edges = (states.node_states[states.edges] == FREE).all(axis=1)
    states.ask_edges(np.flatnonzero(open_edges))
    return _best(problem, states.edge_states, states)


def find_lazily(problem: SearchProblem, states: EdgeStates) -> Found:
    """Return the same path as `find_after_all`, asking only about what could lie on it.

    The shortest path over whatever is not known to be blocked is tested from its start on, up to the first thing
    that is blocked; when all of it is free, no path of free edges is shorter (Bohlin and Kavraki 2000).
    """
    while True:
        nodes, along = _best(problem, states.edge_states, states)
        if _all_free(nodes, along, states):
            return nodes, along


def find_any(problem: SearchProblem, states: EdgeStates) -> Found:
    """Return some path of free edges if there is one.

    The components of the start and of the goals grow in turns, always the one that fewer unknown edges leave, by
    asking about all of these.  A search without an answer ends when one of the two can grow no more.
    """
    if not are_joined(states, problem.start, problem.goals):
        return NOT_FOUND
    known = np.where(states.edge_states == FREE, FREE, BLOCKED)
    return _best(problem, known, states)


def are_joined(states: EdgeStates, start: int, goals: npt.NDArray[np.int64]) -> bool:
    """Return whether free edges join the start to one of the goals; what `find_any` asks."""
    label = np.arange(len(states.node_states), dtype=np.int32)
    # The goals are one virtual node.
    join(label, np.stack([goals, np.roll(goals, 1)], axis=1).astype(np.int32))
    join(label, states.edges[states.edge_states == FREE])
    while label[start] != label[goals[0]]:
        leaving = (
            _edges_leaving(states.edges, states.edge_states, states.node_states, label, label[node])
            for node in (start, goals[0])
        )
        asked = min(leaving, key=len)
        if not len(asked):
            return False
        states.ask_nodes(np.unique(states.edges[asked]))
        asked = asked[(states.node_states[states.edges[asked]] == FREE).all(axis=1)]
        states.ask_edges(asked)
        join(label, states.edges[asked[states.edge_states[asked] == FREE]])
    return True


def march(problem: SearchProblem, states: EdgeStates) -> tuple[Found, int]:
    """Grow a fast marching tree until it takes up a goal; return the path, and the nodes in the tree.

    Janson, Schmerling, Clark and Pavone 2015, Algorithm 2.  All nodes are free; ties go to the lower node.  An edge
    found to be blocked is not asked about again, but keeps its place as the best offer of its node, as in the original.
    """
    graph, weights = problem.graph.fixed, problem.weights
    goals = set(problem.goals.tolist())
    stage = np.full(problem.graph.nodes, _UNVISITED)
    cost = np.zeros(problem.graph.nodes, dtype=np.int64)
    parent_edge = np.full(problem.graph.nodes, -1, dtype=np.int32)
    stage[problem.start] = _OPEN
    frontier = [(0, problem.start)]
    while frontier:
        _, node = heapq.heappop(frontier)
        if node in goals:
            return _way_back(parent_edge, states.edges, problem.start, node), int(np.count_nonzero(stage))
        fresh, offers = _best_offers(node, graph.first, graph.other, graph.edge, weights, cost, stage)
        states.ask_edges(offers)
        free = states.edge_states[offers] == FREE
        fresh, offers = fresh[free], offers[free]
        # Taken up after all have been asked: none of the fresh ones is an offer to another one of them.
        pairs = states.edges[offers]
        giver = np.where(pairs[:, 0] == fresh, pairs[:, 1], pairs[:, 0])
        cost[fresh] = cost[giver] + weights[offers]
        parent_edge[fresh] = offers
        stage[fresh] = _OPEN
        stage[node] = _CLOSED
        for newcomer in fresh.tolist():
            heapq.heappush(frontier, (int(cost[newcomer]), newcomer))
    return NOT_FOUND, int(np.count_nonzero(stage))


FINDERS: dict[str, Callable[[SearchProblem, EdgeStates], Found]] = {
    "full": find_after_all,
    "lazy": find_lazily,
}
"""The searches by name; both find the same path."""

_UNVISITED, _OPEN, _CLOSED = np.int8(0), np.int8(1), np.int8(2)


def _best(problem: SearchProblem, edge_states: npt.NDArray[np.int8], states: EdgeStates) -> Found:
    return best_path(
        problem.graph,
        problem.weights,
        edge_states,
        states.node_states,
        problem.bounds,
        problem.start,
        problem.goals,
    )


def _all_free(nodes: npt.NDArray[np.int32], along: npt.NDArray[np.int32], states: EdgeStates) -> bool:
    """Ask along a path, nodes before edges, until something is blocked; an empty path is free."""
    for node in nodes[states.node_states[nodes] == UNKNOWN]:
        states.ask_nodes(node[np.newaxis])
        if states.node_states[node] == BLOCKED:
            return False
    for edge in along[states.edge_states[along] == UNKNOWN]:
        states.ask_edges(edge[np.newaxis])
        if states.edge_states[edge] == BLOCKED:
            return False
    return True


def _way_back(
    parent_edge: npt.NDArray[np.int32], edges: npt.NDArray[np.int32], start: int, goal: int
) -> Found:
    """Return the nodes and edges from the start to a goal in the tree."""
    nodes, along = [goal], []
    while nodes[-1] != start:
        edge = int(parent_edge[nodes[-1]])
        a, b = edges[edge].tolist()
        along.append(edge)
        nodes.append(b if a == nodes[-1] else a)
    return np.array(nodes[::-1], dtype=np.int32), np.array(along[::-1], dtype=np.int32)


@njit(cache=True, nogil=True)
def _edges_leaving(edges, states, node_states, label, component):  # type: ignore[no-untyped-def]
    """Return the unknown edges with one end in this component and the other outside, no end known to be blocked."""
    leaving = np.empty(edges.shape[0], dtype=np.int64)
    count = 0
    for e in range(edges.shape[0]):
        a, b = edges[e, 0], edges[e, 1]
        if states[e] != UNKNOWN or (label[a] == component) == (label[b] == component):
            continue
        if node_states[a] != BLOCKED and node_states[b] != BLOCKED:
            leaving[count] = e
            count += 1
    return leaving[:count].copy()


@njit(cache=True, nogil=True)
def _best_offers(node, first, other, edge, weights, cost, stage):  # type: ignore[no-untyped-def]
    """Return the unvisited neighbours of a node, and the edge from the open node that is the best for each."""
    fresh = np.empty(first[node + 1] - first[node], dtype=np.int32)
    offers = np.empty_like(fresh)
    count = 0
    for slot in range(first[node], first[node + 1]):
        neighbour = other[slot]
        if stage[neighbour] != _UNVISITED:
            continue
        best = -1
        least = np.int64(0)
        giver = -1
        for back in range(first[neighbour], first[neighbour + 1]):
            candidate = other[back]
            if stage[candidate] != _OPEN:
                continue
            reached = cost[candidate] + weights[edge[back]]
            if best < 0 or reached < least or (reached == least and candidate < giver):
                best, least, giver = edge[back], reached, candidate
        fresh[count], offers[count] = neighbour, best
        count += 1
    return fresh[:count].copy(), offers[:count].copy()
