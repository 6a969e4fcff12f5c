"""The shortest path over edges that are all free."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.roadmap.search.a_star import FREE, best_path
from evenroad.roadmap.search.graph import Graph
from evenroad.roadmap.search.whole import Ruler


def shortest_path(
    nodes: int,
    edges: npt.NDArray[np.int32],
    lengths: npt.NDArray[np.float64],
    bounds: npt.NDArray[np.float64],
    start: int,
    goal: int,
) -> tuple[npt.NDArray[np.int32], float]:
    """Return the shortest path from start to goal, and its length.

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
        Node numbers, start first; empty when the goal cannot be reached.  Of equally short paths, the one of
        :func:`best_path`.
    length : float
        Its length, summed from the start; inf when there is none.
    """
    ruler = Ruler.of(float(lengths.max(initial=0.0)), nodes)
    edge_states = np.full(len(edges), FREE)
    node_states = np.full(nodes, FREE)
    path, along = best_path(
        Graph.of(nodes, edges),
        ruler.weights(lengths),
        edge_states,
        node_states,
        ruler.bounds(bounds),
        start,
        goal,
    )
    return path, length_along(lengths, along) if path.size else np.inf


def length_along(lengths: npt.NDArray[np.float64], along: npt.NDArray[np.int32]) -> float:
    """Return the sum of the lengths of the edges `along` a path, from its start on."""
    total = 0.0
    for length in lengths[along].tolist():
        total += length
    return total
