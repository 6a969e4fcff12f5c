"""Searches for a path that evaluate edges: all of them, lazily, for any path, or by a marching tree.

The last function confirms a path: its world checks every motion.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable
from typing import Any, TypeAlias

import numpy as np

from evenroad._arrays import Bools, Floats, Ints32
from evenroad._native import roadmap as native
from evenroad.roadmap.search.edge_states import BLOCKED, FREE, UNKNOWN, EdgeStates
from evenroad.roadmap.search.shortest import NOT_FOUND, FixedPoint, Found, SearchProblem, Terminals, best_path, graph_of
from evenroad.world import ValidatesPaths, World

Finder: TypeAlias = Callable[[Any, EdgeStates], Found]
"""A search; its first argument is a `SearchProblem`, or only `Terminals`."""


def search_problem(states: EdgeStates, costs: Floats, goals: int = 1, *, bound: float = 1.0) -> SearchProblem:
    """Return the search problem over all edges of `states`; its last nodes are the start and this number of goals.

    `costs`, (m,), are at least `bound` times the distances in the space.
    """
    nodes = len(states.configurations)
    terminals = Terminals.last(nodes, goals)
    unit = FixedPoint.of(float(costs.max(initial=0.0)), nodes)
    bounds = unit.bounds(bound * _away(states, terminals.goals))
    return SearchProblem(terminals.start, terminals.goals, graph_of(nodes, states.edges), unit.weights(costs), bounds)


def _away(states: EdgeStates, nodes: Iterable[int]) -> Floats:
    """Return the distance of every node from the nearest of some, (nodes,)."""
    q, space = states.configurations, states.world.space
    away = [space.distance(q, np.broadcast_to(q[node], q.shape)) for node in nodes]
    return np.min(away, axis=0) if len(away) > 1 else away[0]


def find_after_all(problem: SearchProblem, states: EdgeStates) -> Found:
    """Evaluate every node, then every edge between free ones, and return the shortest path."""
    states.evaluate_nodes(np.arange(len(states.node_states)))
    open_edges = (states.node_states[states.edges] == FREE).all(axis=1)
    states.evaluate_edges(np.flatnonzero(open_edges))
    return best_path(problem, states.edge_states, states.node_states)


def find_lazily(problem: SearchProblem, states: EdgeStates) -> Found:
    """Return the same path as `find_after_all`, but evaluate only what could lie on it.

    The shortest path over edges that are not blocked is evaluated from its start to the first blocked edge.  When all
    of it is free, no path of free edges is shorter (Bohlin and Kavraki 2000).
    """
    while True:
        found = best_path(problem, states.edge_states, states.node_states)
        if _all_free(found.edges, states):
            return found


FINDERS: dict[str, Finder] = {"full": find_after_all, "lazy": find_lazily}
"""The searches by name; both find the same path."""


def _all_free(edges: Ints32, states: EdgeStates) -> bool:
    """Evaluate the unknown edges of a path until one is blocked; return whether all are free."""
    for number in edges[states.edge_states[edges] == UNKNOWN]:
        states.evaluate_edges(number[np.newaxis])
        if states.edge_states[number] == BLOCKED:
            return False
    return True


def find_any(terminals: Terminals, states: EdgeStates) -> Found:
    """Return some path of free edges if there is one; evaluate no more edges than the full search.

    Two trees grow from the start and from the goals until they meet.  Each evaluates the edges that lead nearest to the
    root of the other.  A search without an answer ends when one of the two can grow no further.  Edges between two
    nodes of one tree are not evaluated.
    """
    edges = states.edges
    away = np.stack([_away(states, terminals.goals), _away(states, [terminals.start])])
    tree = np.zeros(len(states.configurations), dtype=np.int8)
    tree[terminals.start], tree[terminals.goals] = 1, 2
    parent_edge = np.full(len(tree), -1, dtype=np.int32)
    evaluated, most = np.empty(0, dtype=np.int32), _FIRST
    known = states.edge_states, states.node_states
    while True:
        met, evaluated = native.grow(edges, known, tree, parent_edge, away, evaluated, most)
        if met >= 0:
            a, b = sorted(edges[met].tolist(), key=lambda node: tree[node])
            there, back = _path_back(parent_edge, edges, a), _path_back(parent_edge, edges, b)
            along = np.concatenate([there.edges, np.array([met], dtype=np.int32), back.edges[::-1]])
            return Found(np.concatenate([there.nodes, back.nodes[::-1]]), along)
        if not len(evaluated):
            return NOT_FOUND
        most += len(evaluated) // 4
        states.evaluate_edges(evaluated)


_FIRST = 16
"""Number of edges that each tree of `find_any` evaluates at first; it grows with time."""


def march(problem: SearchProblem, states: EdgeStates) -> Found:
    """Grow a fast marching tree until it reaches a goal; return the path and the number of nodes of the tree.

    It is Algorithm 2 of Janson, Schmerling, Clark and Pavone (2015).  All nodes are free; ties go to the lower node.  A
    blocked edge is not evaluated again, but remains the best edge of its node, as in the original.
    """
    goals = set(problem.goals.tolist())
    stage = np.full(problem.graph.nodes, _UNVISITED)
    cost = np.zeros(problem.graph.nodes, dtype=np.int64)
    parent_edge = np.full(problem.graph.nodes, -1, dtype=np.int32)
    stage[problem.start] = _OPEN
    frontier = [(0, problem.start)]
    while frontier:
        _, node = heapq.heappop(frontier)
        if node in goals:
            return _path_back(parent_edge, states.edges, node)._replace(reached=int(np.count_nonzero(stage)))
        fresh, offers = native.best_offers(problem.graph, node, problem.weights, cost, stage)
        states.evaluate_edges(offers)
        free = states.edge_states[offers] == FREE
        fresh, offers = fresh[free], offers[free]
        # Nodes are added after all were evaluated, so that no new node offers an edge to another new one.
        pairs = states.edges[offers]
        giver = np.where(pairs[:, 0] == fresh, pairs[:, 1], pairs[:, 0])
        cost[fresh] = cost[giver] + problem.weights[offers]
        parent_edge[fresh] = offers
        stage[fresh] = _OPEN
        stage[node] = _CLOSED
        for newcomer in fresh.tolist():
            heapq.heappush(frontier, (int(cost[newcomer]), newcomer))
    return NOT_FOUND._replace(reached=int(np.count_nonzero(stage)))


_UNVISITED, _OPEN, _CLOSED = np.int8(0), np.int8(1), np.int8(2)


def _path_back(parent_edge: Ints32, edges: Ints32, node: int) -> Found:
    """Return the nodes and edges from the root of a tree to a node in it."""
    nodes, along = [node], []
    while (edge := int(parent_edge[nodes[-1]])) >= 0:
        a, b = edges[edge].tolist()
        along.append(edge)
        nodes.append(b if a == nodes[-1] else a)
    return Found(np.array(nodes[::-1], dtype=np.int32), np.array(along[::-1], dtype=np.int32))


def confirmed(world: World, path: Floats, uncertain: Bools) -> Bools:
    """Return which motions of a path, (p, dim), pass the world's strict check, (p - 1,); all if it has none.

    Only the `uncertain` ones, (p - 1,), are checked, because the others passed before.
    """
    passed = ~uncertain
    if not isinstance(world, ValidatesPaths):
        return np.ones_like(passed)
    # Consecutive motions are checked in one call.
    edges = np.flatnonzero(np.diff(np.concatenate([[False], uncertain, [False]])))
    for first, last in edges.reshape(-1, 2):
        passed[first:last] = world.validate(path[first : last + 1])
    return passed


def confirm(states: EdgeStates, found: Found) -> bool:
    """Return whether the world confirms all motions of a path; those that fail become blocked."""
    nodes, along, _ = found
    passed = confirmed(states.world, states.configurations[nodes], ~states.confirmed[along])
    states.confirmed[along] = passed
    states.edge_states[along[~passed]] = BLOCKED
    return bool(passed.all())
