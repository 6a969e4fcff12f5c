"""Shortest paths on a roadmap (A*), and the pieces it falls into."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit


def shortest_path(
    nodes: int,
    edges: npt.NDArray[np.int32],
    lengths: npt.NDArray[np.float64],
    bounds: npt.NDArray[np.float64],
    start: int,
    goal: int,
) -> tuple[npt.NDArray[np.int32], float]:
    """Return the shortest path from start to goal by A* (Hart, Nilsson and Raphael 1968), and its length.

    Parameters
    ----------
    nodes : int
        Number of nodes.
    edges : ndarray of int32, shape (m, 2)
        Undirected edges.
    lengths : ndarray, shape (m,)
        Length of each edge, >= 0.
    bounds : ndarray, shape (nodes,)
        Consistent lower bound of the way from each node to the goal, e.g. its distance in the space.
    start, goal : int
        Node numbers.

    Returns
    -------
    path : ndarray of int32, shape (p,)
        Node numbers, start first; empty when the goal cannot be reached.  Among equally good entries of the queue
        the lower node goes first, so the answer does not depend on anything but the arguments.
    length : float
        Its length, summed from the start; inf when there is none.
    """
    first, other, weight = _adjacency(nodes, edges, lengths)
    return _a_star(first, other, weight, bounds, start, goal)


def pieces(nodes: int, edges: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
    """Return a label for every node, shape (nodes,): the lowest node of its connected piece."""
    return _pieces(nodes, edges)


@njit(cache=True, nogil=True)
def _adjacency(nodes, edges, lengths):  # type: ignore[no-untyped-def]
    """Compressed rows: the neighbours of v are other[first[v]:first[v + 1]]."""
    first = np.zeros(nodes + 1, dtype=np.int64)
    for e in range(edges.shape[0]):
        first[edges[e, 0] + 1] += 1
        first[edges[e, 1] + 1] += 1
    for v in range(nodes):
        first[v + 1] += first[v]
    place = first[:-1].copy()
    other = np.empty(2 * edges.shape[0], dtype=np.int32)
    weight = np.empty(2 * edges.shape[0])
    for e in range(edges.shape[0]):
        for side in range(2):
            v = edges[e, side]
            other[place[v]] = edges[e, 1 - side]
            weight[place[v]] = lengths[e]
            place[v] += 1
    return first, other, weight


@njit(cache=True, nogil=True)
def _a_star(first, other, weight, bounds, start, goal):  # type: ignore[no-untyped-def]
    nodes = first.shape[0] - 1
    cost = np.full(nodes, np.inf)
    parent = np.full(nodes, -1, dtype=np.int32)
    done = np.zeros(nodes, dtype=np.bool_)
    # A binary heap of (estimate, node); an entry that a shorter way has overtaken is skipped when it comes up.
    keys = np.empty(other.shape[0] + 1)
    heap = np.empty(other.shape[0] + 1, dtype=np.int32)
    cost[start] = 0.0
    keys[0], heap[0] = bounds[start], start
    size = 1
    while size > 0:
        node = heap[0]
        size -= 1
        key, last = keys[size], heap[size]
        hole = 0
        while 2 * hole + 1 < size:
            child = 2 * hole + 1
            right = child + 1
            if right < size and (
                keys[right] < keys[child] or (keys[right] == keys[child] and heap[right] < heap[child])
            ):
                child = right
            if keys[child] < key or (keys[child] == key and heap[child] < last):
                keys[hole], heap[hole] = keys[child], heap[child]
                hole = child
            else:
                break
        keys[hole], heap[hole] = key, last
        if done[node]:
            continue
        done[node] = True
        if node == goal:
            break
        for slot in range(first[node], first[node + 1]):
            neighbour = other[slot]
            if done[neighbour]:
                continue
            reached = cost[node] + weight[slot]
            if reached < cost[neighbour]:
                cost[neighbour] = reached
                parent[neighbour] = node
                key = reached + bounds[neighbour]
                hole = size
                size += 1
                while hole > 0:
                    above = (hole - 1) // 2
                    if keys[above] < key or (keys[above] == key and heap[above] <= neighbour):
                        break
                    keys[hole], heap[hole] = keys[above], heap[above]
                    hole = above
                keys[hole], heap[hole] = key, neighbour
    if not done[goal]:
        return np.empty(0, dtype=np.int32), np.inf
    steps = 1
    node = goal
    while node != start:
        node = parent[node]
        steps += 1
    path = np.empty(steps, dtype=np.int32)
    node = goal
    for i in range(steps - 1, -1, -1):
        path[i] = node
        node = parent[node]
    return path, cost[goal]


@njit(cache=True, nogil=True)
def _pieces(nodes, edges):  # type: ignore[no-untyped-def]
    """Union-find; the root of a piece is always its lowest node."""
    root = np.arange(nodes).astype(np.int32)
    for e in range(edges.shape[0]):
        a, b = edges[e, 0], edges[e, 1]
        while root[a] != a:
            root[a] = root[root[a]]
            a = root[a]
        while root[b] != b:
            root[b] = root[root[b]]
            b = root[b]
        if a < b:
            root[b] = a
        else:
            root[a] = b
    for v in range(nodes):
        # Roots are lower than their children, so one ascending sweep flattens every tree.
        root[v] = root[root[v]]
    return root
