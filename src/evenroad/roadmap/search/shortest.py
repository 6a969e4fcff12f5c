"""The shortest path by A* (Hart, Nilsson and Raphael 1968), over integer lengths.

With floats, two paths over the same lengths can differ in the last bit by the order of their edges, and which one
is shortest then depends on which edges were searched.  Integer lengths make the shortest path, with ties to the
lower node, one well-defined path: a lazy search and a full one must find the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad._arrays import Floats, Ints, Ints32
from evenroad.roadmap.search.edge_states import BLOCKED, FREE
from evenroad.roadmap.search.graph import Graph

MOST = 1 << 61
"""What bounds are cut to: the sum of one and any path is still a 64-bit integer."""

_NEXT_TO_ZERO = 1e-280
"""A quantum of a shorter length would lose its digits, or be 0."""


@dataclass(frozen=True)
class FixedPoint:
    """Lengths as integer multiples of a quantum of such a size that every path fits into 61 bits.

    The quantum is ``longest / 2^bits`` with up to 52 bits: as fine as floats are for the longest edge while a
    graph has fewer than 512 nodes, a bit coarser with each doubling (2^-41 of it at a million).
    """

    quantum: float

    @classmethod
    def of(cls, longest: float, nodes: int) -> FixedPoint:
        """Return the quantum for paths of up to `nodes` edges, none above `longest`."""
        bits = min(52, 61 - max(nodes, 1).bit_length())
        # Nothing but zero lengths, or what is next to it: any quantum does.
        return cls(longest / 2.0**bits if longest > _NEXT_TO_ZERO else 1.0)

    def weights(self, lengths: Floats) -> Ints:
        """Return lengths rounded up, at least 1, so that no cycle is free."""
        return np.maximum(np.ceil(lengths / self.quantum), 1.0).astype(np.int64)

    def bounds(self, distances: Floats) -> Ints:
        """Return lower bounds, rounded down by a little more than the rounding of a distance."""
        within = np.minimum(distances, self.quantum * MOST)
        least = np.floor(within / self.quantum * (1.0 - 2.0**-45)) - 2.0
        return np.clip(least, 0.0, float(MOST)).astype(np.int64)


def best_path(
    graph: Graph,
    weights: Ints,
    edge_states: npt.NDArray[np.int8],
    node_states: npt.NDArray[np.int8],
    bounds: Ints,
    start: int,
    goals: Ints,
) -> tuple[Ints32, Ints32]:
    """Return the one shortest path from start to the nearest goal over nodes and edges that are not `BLOCKED`.

    The goals are one virtual node: each has an edge of length 0 to it, and the path to it is the answer.  Among
    equally short paths it is the one that, followed back from there, always goes to the lowest node.
    So it depends on the graph alone, and stays the answer when edges off it are removed: if all of a path
    found among unchecked edges turns out to be free, it is the path that a search of the free edges finds.

    Parameters
    ----------
    graph : Graph
        With the nodes `start` and `goals`.
    weights : ndarray of int64, shape (m,)
        Length of each edge, >= 1 (see `FixedPoint`).
    edge_states, node_states : ndarray of int8, shape (m,) and (nodes,)
        `UNKNOWN`, `FREE` or `BLOCKED`.
    bounds : ndarray of int64, shape (nodes,)
        Lower bounds of the path from each node to the nearest goal.
    start : int
        Node number.
    goals : ndarray of int64, shape (g,)
        Node numbers.

    Returns
    -------
    nodes : ndarray of int32, shape (p,)
        Start first, a goal last; empty when there is no path.
    edges : ndarray of int32, shape (max(p - 1, 0),)
        The edges along it.
    """
    return _a_star(
        graph.nodes, graph.fixed, graph.links, weights, edge_states, node_states, bounds, start, goals
    )


def shortest_path(
    nodes: int, edges: Ints32, lengths: Floats, bounds: Floats, start: int, goal: int
) -> tuple[Ints32, float]:
    """Return the shortest path from start to goal over edges, (m, 2), that are all free, and its length.

    Parameters
    ----------
    lengths : ndarray, shape (m,)
        Length of each edge, >= 0.
    bounds : ndarray, shape (nodes,)
        Consistent lower bound of the path from each node to the goal, e.g. its distance in the space.

    Returns
    -------
    path : ndarray of int32, shape (p,)
        Node numbers, start first; empty when the goal cannot be reached.  Of equally short paths, the one of
        :func:`best_path`.
    length : float
        Its length, summed from the start; inf when there is none.
    """
    fixed_point = FixedPoint.of(float(lengths.max(initial=0.0)), nodes)
    path, along = best_path(
        Graph.of(nodes, edges),
        fixed_point.weights(lengths),
        np.full(len(edges), FREE),
        np.full(nodes, FREE),
        fixed_point.bounds(bounds),
        start,
        np.array([goal]),
    )
    return path, length_along(lengths, along) if path.size else np.inf


def length_along(lengths: Floats, along: Ints32) -> float:
    """Return the sum of the lengths of the edges `along` a path, from its start on."""
    total = 0.0
    for length in lengths[along].tolist():
        total += length
    return total


@njit(cache=True, nogil=True)
def _a_star(nodes, fixed, links, weights, edge_states, node_states, bounds, start, goals):  # type: ignore[no-untyped-def]
    unseen = np.iinfo(np.int64).max
    is_goal = np.zeros(nodes, dtype=np.bool_)
    is_goal[goals] = True
    reached_goal = -1
    cost = np.full(nodes, unseen)
    parent = np.full(nodes, -1, dtype=np.int32)
    via = np.full(nodes, -1, dtype=np.int32)
    # A binary heap of nodes by estimate, with the place of each node in it, -1 while it is not there.
    heap = np.empty(nodes, dtype=np.int32)
    keys = np.empty(nodes, dtype=np.int64)
    place = np.full(nodes, -1, dtype=np.int32)
    cost[start] = 0
    heap[0], keys[0], place[start] = start, bounds[start], 0
    size = 1
    # Ties with the goal are looked at too: one of them may have the lower node.
    while size > 0 and (reached_goal < 0 or keys[0] <= cost[reached_goal]):
        node = heap[0]
        place[node] = -1
        size -= 1
        if size > 0:
            _sink(heap, keys, place, heap[size], keys[size], size)
        if is_goal[node]:
            if (
                reached_goal < 0
                or cost[node] < cost[reached_goal]
                or (cost[node] == cost[reached_goal] and node < reached_goal)
            ):
                reached_goal = node
            continue
        fixed_slot = fixed.first[node] if node + 1 < fixed.first.shape[0] else 0
        fixed_end = fixed.first[node + 1] if node + 1 < fixed.first.shape[0] else 0
        link_slot = links.first[node] if node + 1 < links.first.shape[0] else 0
        link_end = links.first[node + 1] if node + 1 < links.first.shape[0] else 0
        while fixed_slot < fixed_end or link_slot < link_end:
            if fixed_slot < fixed_end:
                e, neighbour = fixed.edge[fixed_slot], fixed.other[fixed_slot]
                fixed_slot += 1
            else:
                e, neighbour = links.edge[link_slot], links.other[link_slot]
                link_slot += 1
            if edge_states[e] == BLOCKED or node_states[neighbour] == BLOCKED:
                continue
            reached = cost[node] + weights[e]
            if reached < cost[neighbour]:
                cost[neighbour] = reached
                parent[neighbour] = node
                via[neighbour] = e
                hole = place[neighbour]
                if hole < 0:
                    hole = size
                    size += 1
                _rise(heap, keys, place, neighbour, reached + bounds[neighbour], hole)
            elif reached == cost[neighbour] and node < parent[neighbour]:
                parent[neighbour] = node
                via[neighbour] = e
    if reached_goal < 0:
        return np.empty(0, dtype=np.int32), np.empty(0, dtype=np.int32)
    steps = 0
    node = reached_goal
    while node != start:
        node = parent[node]
        steps += 1
    path_nodes = np.empty(steps + 1, dtype=np.int32)
    path_edges = np.empty(steps, dtype=np.int32)
    node = reached_goal
    for i in range(steps, 0, -1):
        path_nodes[i] = node
        path_edges[i - 1] = via[node]
        node = parent[node]
    path_nodes[0] = start
    return path_nodes, path_edges


@njit(cache=True, nogil=True, inline="always")
def _rise(heap, keys, place, node, key, hole):  # type: ignore[no-untyped-def]
    """Put a node where it belongs at or above `hole`."""
    while hole > 0:
        above = (hole - 1) // 2
        if keys[above] <= key:
            break
        heap[hole], keys[hole] = heap[above], keys[above]
        place[heap[hole]] = hole
        hole = above
    heap[hole], keys[hole], place[node] = node, key, hole


@njit(cache=True, nogil=True, inline="always")
def _sink(heap, keys, place, node, key, size):  # type: ignore[no-untyped-def]
    """Fill the hole at the top of a heap of so many entries with a node, and put it where it belongs."""
    hole = 0
    while 2 * hole + 1 < size:
        child = 2 * hole + 1
        if child + 1 < size and keys[child + 1] < keys[child]:
            child += 1
        if key <= keys[child]:
            break
        heap[hole], keys[hole] = heap[child], keys[child]
        place[heap[hole]] = hole
        hole = child
    heap[hole], keys[hole], place[node] = node, key, hole
