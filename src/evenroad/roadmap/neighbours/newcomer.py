"""The milestones near one more configuration."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad.roadmap.neighbours.find import flat_metric, in_metric
from evenroad.space import Space


class Surroundings:
    """Milestones, ready to be asked which of them are near a configuration, in O(n).

    Parameters
    ----------
    q : ndarray, shape (n, dim)
        Their configurations.
    space : Space
        Whose metric counts.
    """

    def __init__(self, q: npt.NDArray[np.float64], space: Space) -> None:
        self._q, self._space = q, space
        self._metric = flat_metric(space)
        self._points, self._period = in_metric(q, self._metric)

    def distances(self, newcomer: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return the distance of a configuration, (dim,), from each milestone, (n,)."""
        if self._metric is None:
            return self._space.distance(np.broadcast_to(newcomer, self._q.shape), self._q)
        point, _ = in_metric(newcomer[np.newaxis], self._metric)
        return _distances(self._points, self._period, point)


def nearest_of(
    distances: npt.NDArray[np.float64],
    usable: npt.NDArray[np.bool_],
    k: int | None = None,
    radius: float | None = None,
) -> npt.NDArray[np.int32]:
    """Return the rows that are usable, the `k` nearest of them, at most `radius` away, nearest first.

    Ties go to the lower row; without a `k` all rows come, in their order.
    """
    if k is None:
        return np.flatnonzero(usable if radius is None else usable & (distances <= radius)).astype(np.int32)
    return _k_smallest(distances, usable, min(k, len(distances)), np.inf if radius is None else radius)


@njit(cache=True, nogil=True)
def _distances(points, period, point):  # type: ignore[no-untyped-def]
    distance = np.empty(points.shape[0])
    for i in range(points.shape[0]):
        total = 0.0
        for axis in range(points.shape[1]):
            gap = abs(points[i, axis] - point[0, axis])
            gap = min(gap, period[axis] - gap)
            total += gap * gap
        distance[i] = np.sqrt(total)
    return distance


@njit(cache=True, nogil=True)
def _k_smallest(distances, usable, k, radius):  # type: ignore[no-untyped-def]
    rows = np.empty(k, dtype=np.int32)
    nearest = np.empty(k)
    count = 0
    for row in range(distances.shape[0]):
        distance = distances[row]
        if not usable[row] or distance > radius or k == 0 or (count == k and distance >= nearest[k - 1]):
            continue
        slot = min(count, k - 1)
        while slot > 0 and nearest[slot - 1] > distance:
            nearest[slot] = nearest[slot - 1]
            rows[slot] = rows[slot - 1]
            slot -= 1
        nearest[slot] = distance
        rows[slot] = row
        count = min(count + 1, k)
    return rows[:count].copy()
