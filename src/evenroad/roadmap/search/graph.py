"""A graph as compressed rows: the neighbours of each node, side by side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit


@dataclass(frozen=True, eq=False)
class Graph:
    """Undirected edges, by node.

    Attributes
    ----------
    edges : ndarray of int32, shape (m, 2)
        Pairs of nodes.
    first : ndarray of int64, shape (nodes + 1,)
        The arcs that leave node v are the slots first[v] .. first[v + 1] - 1.
    other, edge : ndarray of int32, shape (slots,)
        For each slot the node that the arc leads to, and its edge; edge -1 where the slot is not in use.
    """

    edges: npt.NDArray[np.int32]
    first: npt.NDArray[np.int64]
    other: npt.NDArray[np.int32]
    edge: npt.NDArray[np.int32]

    @classmethod
    def of(
        cls, nodes: int, edges: npt.NDArray[np.int32], spare: npt.NDArray[np.int64] | None = None
    ) -> Graph:
        """Return the graph of these edges, with `spare[v]` slots not in use at the end of each row v."""
        spare = np.zeros(nodes, dtype=np.int64) if spare is None else spare
        return cls(edges, *_rows(nodes, np.array(edges, dtype=np.int32), spare))

    @property
    def nodes(self) -> int:
        """Number of nodes."""
        return len(self.first) - 1


@njit(cache=True, nogil=True)
def _rows(nodes, edges, spare):  # type: ignore[no-untyped-def]
    first = np.zeros(nodes + 1, dtype=np.int64)
    for e in range(edges.shape[0]):
        first[edges[e, 0] + 1] += 1
        first[edges[e, 1] + 1] += 1
    for v in range(nodes):
        first[v + 1] += first[v] + spare[v]
    place = first[:-1].copy()
    other = np.zeros(first[nodes], dtype=np.int32)
    edge = np.full(first[nodes], -1, dtype=np.int32)
    for e in range(edges.shape[0]):
        for side in range(2):
            v = edges[e, side]
            other[place[v]] = edges[e, 1 - side]
            edge[place[v]] = e
            place[v] += 1
    return first, other, edge
