"""Exact neighbours in any metric: all distances, a block of rows at a time."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from evenroad.space import Space
from evenroad.space.all_pairs import all_distances

BLOCK = 1 << 16
"""Distances held at once."""


def k_nearest_in(
    space: Space, q: npt.NDArray[np.float64], k: int, *, earlier: bool = False
) -> npt.NDArray[np.int32]:
    """Return what `kdtree.k_nearest` returns, by the distances of all pairs: O(n^2) time, O(n k) memory."""
    n = len(q)
    k = min(k, n - 1)
    if k < 1:
        return np.empty((n, 0), dtype=np.int32)
    nearest = np.full((n, k), -1, dtype=np.int32)
    for rows, distance in _blocks(space, q, earlier=earlier):
        own = np.arange(rows.start, rows.stop)[:, np.newaxis]
        others = np.arange(distance.shape[1])[np.newaxis]
        distance[others >= own if earlier else others == own] = np.inf
        last = min(k, distance.shape[1]) - 1
        furthest = np.partition(distance, last, axis=1)[:, last : last + 1]
        row, column = np.nonzero((distance <= furthest) & np.isfinite(distance))
        # All that tie with the k-th are still here; sorting puts the lower index first.
        order = np.lexsort((column, distance[row, column], row))
        row, column = row[order], column[order]
        rank = np.arange(len(row)) - np.searchsorted(row, row)
        kept = rank < k
        nearest[rows.start + row[kept], rank[kept]] = column[kept]
    return nearest


def pairs_within_in(space: Space, q: npt.NDArray[np.float64], radius: float) -> npt.NDArray[np.int32]:
    """Return every pair i < j with ``space.distance`` <= `radius`, shape (m, 2), ascending."""
    found = [np.empty((0, 2), dtype=np.int32)]
    for rows, distance in _blocks(space, q):
        row, column = np.nonzero(distance <= radius)
        later = column > row + rows.start
        found.append(np.stack([row[later] + rows.start, column[later]], axis=1).astype(np.int32))
    return np.concatenate(found)


def _blocks(
    space: Space, q: npt.NDArray[np.float64], *, earlier: bool = False
) -> Iterator[tuple[slice, npt.NDArray[np.float64]]]:
    """Yield row ranges with their distances to all configurations, (rows, n), or to those up to the range's end."""
    n = len(q)
    step = max(1, BLOCK // max(n, 1))
    for begin in range(0, n, step):
        rows = slice(begin, min(begin + step, n))
        yield rows, all_distances(space, q[rows], q[: rows.stop] if earlier else q)
