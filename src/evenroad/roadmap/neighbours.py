"""Nearest neighbours in a space, by kd-tree if its metric is flat, else by all distances."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from evenroad._arrays import Bools, Floats, Ints32
from evenroad._native.roadmap import distances_from, k_nearest, k_smallest, pairs_within
from evenroad._time_limit import look_at_clock
from evenroad.space import Space
from evenroad.space.flat import FlatMetric
from evenroad.space.protocol import all_distances

BLOCK = 1 << 16
"""Number of distances held at once."""


def nearest(q: Floats, k: int, space: Space | None = None, *, earlier: bool = False) -> Ints32:
    """Return the k nearest other rows of every row of `q`, (n, dim), nearest first, ties to the lower index.

    Distances are those of the space, by default Euclidean.  The shape is (n, min(k, n - 1)).  With `earlier` only rows
    of a lower index count, and row i ends with -1 if there are fewer than k.
    """
    n, metric = len(q), flat_metric(space)
    k = min(k, n - 1)
    if k < 1:
        return np.empty((n, 0), dtype=np.int32)
    if space is None or metric is not None:
        return k_nearest(*in_metric(q, metric), k, earlier)
    found = np.full((n, k), -1, dtype=np.int32)
    for rows, distances in _blocks(space, q, earlier=earlier):
        columns = np.arange(distances.shape[1])
        for row, away in zip(range(n)[rows], distances, strict=True):
            near = nearest_of(away, columns < row if earlier else columns != row, k)
            found[row, : len(near)] = near
    return found


def within(q: Floats, radius: float, space: Space | None = None) -> Ints32:
    """Return every pair of rows i < j at distance <= `radius`, shape (m, 2), in no particular order."""
    metric = flat_metric(space)
    found = [np.empty((0, 2), dtype=np.int32)]
    if space is None or metric is not None:
        return pairs_within(*in_metric(q, metric), radius) if len(q) else found[0]
    for rows, distances in _blocks(space, q):
        row, column = np.nonzero(distances <= radius)
        later = column > row + rows.start
        found.append(np.stack([row[later] + rows.start, column[later]], axis=1).astype(np.int32))
    return np.concatenate(found)


def flat_metric(space: Space | None) -> FlatMetric | None:
    """Return the flat metric of a space, or None if it has none."""
    return getattr(space, "flat", None)


def in_metric(q: Floats, metric: FlatMetric | None) -> tuple[Floats, Floats]:
    """Return coordinates and periods for which the metric is Euclidean; wrapping coordinates are in [0, period)."""
    points = np.array(q, dtype=np.float64, order="C")
    if metric is None:
        return points, np.full(points.shape[1], np.inf)
    points *= metric.scale
    period = metric.scale * metric.period
    for axis in np.flatnonzero(metric.wrapping):
        points[:, axis] %= period[axis]
        # The remainder of a tiny negative number can round up to the period itself.
        points[points[:, axis] >= period[axis], axis] = 0.0
    return points, period


def _blocks(space: Space, q: Floats, *, earlier: bool = False) -> Iterator[tuple[slice, Floats]]:
    """Yield row ranges with their distances to all configurations, (rows, n), or to those up to the range's end."""
    n = len(q)
    step = max(1, BLOCK // max(n, 1))
    for begin in range(0, n, step):
        look_at_clock()
        rows = slice(begin, min(begin + step, n))
        yield rows, all_distances(space, q[rows], q[: rows.stop] if earlier else q)


class Surroundings:
    """Milestones, (n, dim), with a query for those near a configuration, in O(n)."""

    def __init__(self, q: Floats, space: Space) -> None:
        self._q, self._space = q, space
        self._metric = flat_metric(space)
        self._points, self._period = in_metric(q, self._metric)

    def distances(self, newcomer: Floats) -> Floats:
        """Return the distance of a configuration, (dim,), from each milestone, (n,)."""
        if self._metric is None:
            return self._space.distance(np.broadcast_to(newcomer, self._q.shape), self._q)
        point, _ = in_metric(newcomer[np.newaxis], self._metric)
        return distances_from(self._points, self._period, point[0])


def nearest_of(distances: Floats, usable: Bools, k: int | None = None, radius: float | None = None) -> Ints32:
    """Return the rows that are usable, the `k` nearest of them, at most `radius` away, nearest first.

    Ties go to the lower row.  Without a `k`, all rows are returned in their order.
    """
    if k is None:
        return np.flatnonzero(usable if radius is None else usable & (distances <= radius)).astype(np.int32)
    return k_smallest(distances, usable, min(k, len(distances)), np.inf if radius is None else radius)
