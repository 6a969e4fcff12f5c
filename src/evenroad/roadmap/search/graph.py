"""A graph as compressed rows, with links that come and go; its connected components."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from evenroad._arrays import Ints, Ints32
from evenroad._njit import njit


class Rows(NamedTuple):
    """For each node the arcs that leave it, side by side; compiled code takes it as it is.

    Those of node v are the slots ``first[v] .. first[v + 1] - 1``; for each slot, `other` is the node that the arc
    leads to and `edge` its edge.
    """

    first: Ints
    other: Ints32
    edge: Ints32

    @classmethod
    def of(cls, nodes: int, edges: Ints32, numbered_from: int = 0) -> Rows:
        """Return the rows of undirected edges, (m, 2), whose numbers begin with `numbered_from`."""
        return cls(*_rows(nodes, np.array(edges, dtype=np.int32), numbered_from))


class Graph(NamedTuple):
    """Undirected edges, by node: fixed ones, and links of one query beside them.

    Both may be rows of the first nodes only: the others have no arcs there.
    """

    nodes: int
    fixed: Rows
    links: Rows

    @classmethod
    def of(cls, nodes: int, edges: Ints32) -> Graph:
        """Return the graph of these edges, without links."""
        return cls(nodes, Rows.of(nodes, edges), _NO_LINKS)

    def with_links(self, nodes: int, edges: Ints32, numbered_from: int) -> Graph:
        """Return this graph with so many nodes, and links instead of those that it has; O(nodes)."""
        return Graph(nodes, self.fixed, Rows.of(nodes, edges, numbered_from))


def components(nodes: int, edges: Ints32) -> Ints32:
    """Return a label for every node, shape (nodes,): the lowest node of its connected component."""
    label = np.arange(nodes, dtype=np.int32)
    join(label, edges)
    return label


def join(label: Ints32, edges: Ints32) -> None:
    """Join components along edges, in place: `label` holds for every node the lowest node of its component."""
    _join(label, np.array(edges, dtype=np.int32))


@njit(cache=True, nogil=True)
def _rows(nodes, edges, numbered_from):  # type: ignore[no-untyped-def]
    first = np.zeros(nodes + 1, dtype=np.int64)
    for v in edges.ravel():
        first[v + 1] += 1
    first = np.cumsum(first)
    slot = first[:-1].copy()
    other = np.empty(first[nodes], dtype=np.int32)
    edge = np.empty(first[nodes], dtype=np.int32)
    for e in range(edges.shape[0]):
        for side in range(2):
            v = edges[e, side]
            other[slot[v]] = edges[e, 1 - side]
            edge[slot[v]] = numbered_from + e
            slot[v] += 1
    return first, other, edge


_NO_LINKS = Rows(np.zeros(1, dtype=np.int64), np.empty(0, dtype=np.int32), np.empty(0, dtype=np.int32))


@njit(cache=True, nogil=True)
def _join(root, edges):  # type: ignore[no-untyped-def]
    """Union-find; the root of a component is always its lowest node."""
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
    for v in range(root.shape[0]):
        # Roots are lower than their children, so one ascending sweep flattens every tree.
        root[v] = root[root[v]]
