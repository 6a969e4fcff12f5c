"""Finding a path while asking the world: everything first, only what matters, any path, or by a marching tree."""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad._arrays import Floats, Ints, Ints32
from evenroad.roadmap.search.edge_states import BLOCKED, FREE, UNKNOWN, EdgeStates
from evenroad.roadmap.search.graph import Graph
from evenroad.roadmap.search.shortest import FixedPoint, best_path

Found = tuple[Ints32, Ints32]
"""The nodes of a path, start first, and its edges; both empty when there is none."""

NOT_FOUND: Found = np.empty(0, dtype=np.int32), np.empty(0, dtype=np.int32)


@dataclass(frozen=True, eq=False)
class SearchProblem:
    """From which node to which goals in which graph; the arrays are those of :func:`best_path`."""

    graph: Graph
    weights: Ints
    bounds: Ints
    start: int
    goals: Ints


def search_problem(states: EdgeStates, costs: Floats, goals: int = 1, *, bound: float = 1.0) -> SearchProblem:
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
    """Return some path of free edges if there is one, asking about no more edges than the full search.

    Two trees grow, from the start and from the goals, always the one that has asked less: each asks about the edges
    that lead nearest to where the other began, until they meet.  A search without an answer ends when one of the two
    can grow no more.  Edges between two nodes of one tree are not asked about.
    """
    q, space = states.configurations, states.world.space
    from_start = space.distance(q, np.broadcast_to(q[problem.start], q.shape))
    trees = (
        _Tree(problem.graph, states, np.array([problem.start]), problem.bounds.astype(np.float64)),
        _Tree(problem.graph, states, problem.goals, from_start),
    )
    while True:
        tree = min(trees, key=lambda tree: tree.asked)
        if not tree.grow():
            return NOT_FOUND
        meeting = np.flatnonzero(trees[0].member & trees[1].member)
        if meeting.size:
            there, back = (tree.path_from_root(int(meeting[0])) for tree in trees)
            return np.concatenate([there[0], back[0][-2::-1]]), np.concatenate([there[1], back[1][::-1]])


class _Heap(NamedTuple):
    """A binary heap of edges that lead out of a tree, by the nearness of the nodes that they lead to."""

    keys: Floats
    edges: Ints32
    targets: Ints32


class _Tree:
    """Nodes joined to its roots by free edges; grows towards the nodes of the least `nearness`."""

    def __init__(self, graph: Graph, states: EdgeStates, roots: Ints, nearness: Floats) -> None:
        self.graph, self.states, self.nearness = graph, states, nearness
        self.member = np.zeros(graph.nodes, dtype=np.bool_)
        self.parent_edge = np.full(graph.nodes, -1, dtype=np.int32)
        self.asked = self._size = 0
        # Every arc enters the heap once at most.
        arcs = len(graph.fixed.edge) + len(graph.links.edge)
        self._heap = _Heap(np.empty(arcs), np.empty(arcs, dtype=np.int32), np.empty(arcs, dtype=np.int32))
        self._take_up(roots)

    def grow(self) -> bool:
        """Ask about the most promising edges, the more the longer it takes; return whether there were any."""
        states, most = self.states, min(16 + self.asked // 4, _LARGEST_BATCH)
        edges, targets, self._size = _next_edges(
            most, self._heap, self._size, self.member, states.edge_states, states.node_states
        )
        if not len(edges):
            return False
        states.ask_nodes(targets)
        free = states.node_states[targets] == FREE
        edges, targets = edges[free], targets[free]
        states.ask_edges(edges)
        self.asked += len(edges)
        free = states.edge_states[edges] == FREE
        self.parent_edge[targets[free]] = edges[free]
        self._take_up(targets[free])
        return True

    def path_from_root(self, node: int) -> Found:
        """Return the nodes and edges from a root of the tree to a node in it."""
        return _path_back(self.parent_edge, self.states.edges, node)

    def _take_up(self, nodes: npt.NDArray[np.integer]) -> None:
        self.member[nodes] = True
        for rows in (self.graph.fixed, self.graph.links):
            self._size = _add_arcs(nodes, rows, self.nearness, self.member, self._heap, self._size)


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
            return _path_back(parent_edge, states.edges, node), int(np.count_nonzero(stage))
        fresh, offers = _best_offers(node, graph, weights, cost, stage)
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


_LARGEST_BATCH = 32
"""Edges that `find_any` asks about together: enough for a batch to pay."""

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


def _all_free(nodes: Ints32, along: Ints32, states: EdgeStates) -> bool:
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


def _path_back(parent_edge: Ints32, edges: Ints32, node: int) -> Found:
    """Return the nodes and edges from the root of a tree to a node in it."""
    nodes, along = [node], []
    while (edge := int(parent_edge[nodes[-1]])) >= 0:
        a, b = edges[edge].tolist()
        along.append(edge)
        nodes.append(b if a == nodes[-1] else a)
    return np.array(nodes[::-1], dtype=np.int32), np.array(along[::-1], dtype=np.int32)


@njit(cache=True, nogil=True)
def _add_arcs(nodes, rows, nearness, member, heap, size):  # type: ignore[no-untyped-def]
    """Put the arcs that lead from nodes out of the tree into its heap; return the heap's size."""
    for node in nodes:
        if node + 1 >= rows.first.shape[0]:
            continue
        for slot in range(rows.first[node], rows.first[node + 1]):
            target = rows.other[slot]
            if not member[target]:
                size = _push(heap, size, nearness[target], rows.edge[slot], target)
    return size


@njit(cache=True, nogil=True)
def _next_edges(most, heap, size, member, edge_states, node_states):  # type: ignore[no-untyped-def]
    """Take up to `most` edges to different nodes outside of the tree out of its heap, not known to be blocked."""
    found = np.empty(most, dtype=np.int32)
    leading_to = np.empty(most, dtype=np.int32)
    count = 0
    # Other edges to the same nodes wait for the verdicts on these; they go back into the heap.
    chosen = np.zeros(member.shape[0], dtype=np.bool_)
    waiting = [(0.0, np.int32(0), np.int32(0)) for _ in range(0)]
    while size > 0 and count < most:
        key, e, target = heap.keys[0], heap.edges[0], heap.targets[0]
        size = _drop_first(heap, size)
        if member[target] or edge_states[e] == BLOCKED or node_states[target] == BLOCKED:
            continue
        if chosen[target]:
            waiting.append((key, e, target))
            continue
        chosen[target] = True
        found[count], leading_to[count] = e, target
        count += 1
    for key, e, target in waiting:
        size = _push(heap, size, key, e, target)
    return found[:count].copy(), leading_to[:count].copy(), size


@njit(cache=True, nogil=True)
def _push(heap, size, key, edge, target):  # type: ignore[no-untyped-def]
    keys, edges, targets = heap
    hole = size
    while hole > 0 and keys[(hole - 1) // 2] > key:
        above = (hole - 1) // 2
        keys[hole], edges[hole], targets[hole] = keys[above], edges[above], targets[above]
        hole = above
    keys[hole], edges[hole], targets[hole] = key, edge, target
    return size + 1


@njit(cache=True, nogil=True)
def _drop_first(heap, size):  # type: ignore[no-untyped-def]
    keys, edges, targets = heap
    size -= 1
    key, edge, target = keys[size], edges[size], targets[size]
    hole = 0
    while 2 * hole + 1 < size:
        child = 2 * hole + 1
        if child + 1 < size and keys[child + 1] < keys[child]:
            child += 1
        if key <= keys[child]:
            break
        keys[hole], edges[hole], targets[hole] = keys[child], edges[child], targets[child]
        hole = child
    keys[hole], edges[hole], targets[hole] = key, edge, target
    return size


@njit(cache=True, nogil=True)
def _best_offers(node, rows, weights, cost, stage):  # type: ignore[no-untyped-def]
    """Return the unvisited neighbours of a node, and the edge from the open node that is the best for each."""
    first, other, edge = rows
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
