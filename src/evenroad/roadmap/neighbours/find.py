"""Neighbours in a space: by kd-tree where its metric is flat, else by all distances."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.roadmap.neighbours.brute import k_nearest_in, pairs_within_in
from evenroad.roadmap.neighbours.kdtree import k_nearest, pairs_within
from evenroad.space import Space
from evenroad.space.flat import FlatMetric


def nearest(
    q: npt.NDArray[np.float64], k: int, space: Space | None = None, *, earlier: bool = False
) -> npt.NDArray[np.int32]:
    """Return the k nearest other rows of every row, nearest first, ties to the lower index.

    Parameters
    ----------
    q : ndarray, shape (n, dim)
        Configurations.
    k : int
        At least 1.
    space : Space, optional
        Whose metric counts; default: the Euclidean one.
    earlier : bool
        Only rows of a lower index count.

    Returns
    -------
    ndarray of int32, shape (n, min(k, n - 1))
        With `earlier`, row i ends with -1 where there are fewer than k.
    """
    metric = flat_metric(space)
    if space is not None and metric is None:
        return k_nearest_in(space, q, k, earlier=earlier)
    points, period = in_metric(q, metric)
    return k_nearest(points, k, period, earlier=earlier)


def within(q: npt.NDArray[np.float64], radius: float, space: Space | None = None) -> npt.NDArray[np.int32]:
    """Return every pair of rows i < j at distance <= `radius`, shape (m, 2), in no particular order."""
    metric = flat_metric(space)
    if space is not None and metric is None:
        return pairs_within_in(space, q, radius)
    points, period = in_metric(q, metric)
    return pairs_within(points, radius, period)


def flat_metric(space: Space | None) -> FlatMetric | None:
    """Return the flat metric of a space, or None where it has none (or says nothing of it)."""
    return getattr(space, "flat", None)


def in_metric(
    q: npt.NDArray[np.float64], metric: FlatMetric | None
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return coordinates and periods in which the metric is Euclidean, wrapping ones in [0, period)."""
    points = np.array(q, dtype=np.float64, order="C")
    if metric is None:
        return points, np.full(points.shape[1], np.inf)
    points *= metric.scale
    period = metric.scale * metric.period
    for axis in np.flatnonzero(metric.wrapping):
        points[:, axis] %= period[axis]
        # The remainder of a tiny negative number rounds up to the period itself.
        points[points[:, axis] >= period[axis], axis] = 0.0
    return points, period
