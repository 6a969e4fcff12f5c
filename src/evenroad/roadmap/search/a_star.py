"""A* (Hart, Nilsson and Raphael 1968) over the edges that are not known to be blocked."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad.roadmap.search.graph import Graph

UNKNOWN, FREE, BLOCKED = np.int8(0), np.int8(1), np.int8(2)
"""What is known of an edge or a node."""


def best_path(
    graph: Graph,
    weights: npt.NDArray[np.int64],
    edge_states: npt.NDArray[np.int8],
    node_states: npt.NDArray[np.int8],
    bounds: npt.NDArray[np.int64],
    start: int,
    goal: int,
) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.int32]]:
    """Return the one shortest path from start to goal over nodes and edges that are not `BLOCKED`.

    Among equally short paths it is the one that, followed back from the goal, always goes to the lowest node.
    So it depends on the graph alone, and stays the answer when edges off it are removed: if all of a path
    found among unchecked edges turns out to be free, it is the path that a search of the free edges finds.

    Parameters
    ----------
    graph : Graph
        With the nodes `start` and `goal`.
    weights : ndarray of int64, shape (m,)
        Length of each edge, >= 1 (see `Ruler`).
    edge_states, node_states : ndarray of int8, shape (m,) and (nodes,)
        `UNKNOWN`, `FREE` or `BLOCKED`.
    bounds : ndarray of int64, shape (nodes,)
        Lower bounds of the way from each node to the goal.

    Returns
    -------
    nodes : ndarray of int32, shape (p,)
        Start first; empty when there is no path.
    edges : ndarray of int32, shape (max(p - 1, 0),)
        The edges along it.
    """
    return _a_star(
        graph.first, graph.other, graph.edge, weights, edge_states, node_states, bounds, start, goal
    )


@njit(cache=True, nogil=True)
def _a_star(first, other, edge, weights, edge_states, node_states, bounds, start, goal):  # type: ignore[no-untyped-def]
    nodes = first.shape[0] - 1
    unseen = np.iinfo(np.int64).max
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
    while size > 0 and (cost[goal] == unseen or keys[0] <= cost[goal]):
        node = heap[0]
        place[node] = -1
        size -= 1
        if size > 0:
            _sink(heap, keys, place, heap[size], keys[size], size)
        if node == goal:
            continue
        for slot in range(first[node], first[node + 1]):
            e = edge[slot]
            if e < 0 or edge_states[e] == BLOCKED:
                continue
            neighbour = other[slot]
            if node_states[neighbour] == BLOCKED:
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
    if cost[goal] == unseen:
        return np.empty(0, dtype=np.int32), np.empty(0, dtype=np.int32)
    steps = 0
    node = goal
    while node != start:
        node = parent[node]
        steps += 1
    path_nodes = np.empty(steps + 1, dtype=np.int32)
    path_edges = np.empty(steps, dtype=np.int32)
    node = goal
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
