"""A graph by node, with links that come and go; its connected components."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Ints32
from evenroad._native import roadmap as native
from evenroad._native.roadmap import Graph as Graph


def graph_of(nodes: int, edges: Ints32) -> Graph:
    """Return the graph of undirected edges, (m, 2), that are numbered from 0, without links."""
    return Graph(nodes, np.ascontiguousarray(edges, dtype=np.int32))


def components(nodes: int, edges: Ints32) -> Ints32:
    """Return a label for every node, shape (nodes,): the lowest node of its connected component."""
    label = np.arange(nodes, dtype=np.int32)
    join(label, edges)
    return label


def join(label: Ints32, edges: Ints32) -> None:
    """Join components along edges, in place: `label` holds for every node the lowest node of its component."""
    native.join(label, np.ascontiguousarray(edges, dtype=np.int32))
