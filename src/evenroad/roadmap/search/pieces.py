"""The connected pieces of a graph, and which of its edges would join two of them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit


def pieces(nodes: int, edges: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
    """Return a label for every node, shape (nodes,): the lowest node of its connected piece."""
    label = np.arange(nodes, dtype=np.int32)
    join(label, edges)
    return label


def join(label: npt.NDArray[np.int32], edges: npt.NDArray[np.int32]) -> npt.NDArray[np.bool_]:
    """Join pieces along edges, one after the other, in place; return for each edge whether it joined two.

    `label` holds for every node the lowest node of its piece, before and after.
    """
    return _join(label, np.array(edges, dtype=np.int32))


@njit(cache=True, nogil=True)
def _join(root, edges):  # type: ignore[no-untyped-def]
    """Union-find; the root of a piece is always its lowest node."""
    joined = np.zeros(edges.shape[0], dtype=np.bool_)
    for e in range(edges.shape[0]):
        a, b = edges[e, 0], edges[e, 1]
        while root[a] != a:
            root[a] = root[root[a]]
            a = root[a]
        while root[b] != b:
            root[b] = root[root[b]]
            b = root[b]
        joined[e] = a != b
        if a < b:
            root[b] = a
        else:
            root[a] = b
    for v in range(root.shape[0]):
        # Roots are lower than their children, so one ascending sweep flattens every tree.
        root[v] = root[root[v]]
    return joined
