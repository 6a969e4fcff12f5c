"""A kd-tree for roadmaps: k nearest with a fixed order among ties, and all pairs within a radius.

SciPy's tree leaves open which of several equally far points it returns; a deterministic roadmap needs the lower
index.  Axes may wrap: a gap is then the shorter of the two ways round.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from evenroad._arrays import Floats, Ints32


def k_nearest(points: Floats, k: int, period: Floats | None = None, *, earlier: bool = False) -> Ints32:
    """Return the k nearest other points of every point, nearest first, ties to the lower index.

    Parameters
    ----------
    points : ndarray, shape (n, d)
        Finite coordinates; the metric is Euclidean, those of wrapping axes lie in [0, period).
    k : int
        At least 1.
    period : ndarray, shape (d,), optional
        After how much each axis repeats, inf where it does not; default: none does.
    earlier : bool
        Only points of a lower index count.  A tree over all points serves here too: parts of it without
        a lower index are skipped.

    Returns
    -------
    ndarray of int32, shape (n, min(k, n - 1))
        With `earlier`, row i has -1 after its min(k, i) neighbours.
    """
    n, d = points.shape
    k = min(k, n - 1)
    if k < 1:
        return np.empty((n, 0), dtype=np.int32)
    period = np.full(d, np.inf) if period is None else period.copy()
    order, boxes, lowest = build(points, LEAF_SIZE)
    return _k_nearest(points, period, order, boxes, lowest, k, earlier, LEAF_SIZE)


def pairs_within(points: Floats, radius: float, period: Floats | None = None) -> Ints32:
    """Return every pair i < j at distance <= `radius`, shape (m, 2), in no particular order.

    `points` and `period` are those of :func:`k_nearest`.
    """
    n, d = points.shape
    if n < 2:
        return np.empty((0, 2), dtype=np.int32)
    period = np.full(d, np.inf) if period is None else period.copy()
    order, boxes, _ = build(points, LEAF_SIZE)
    return _pairs_within(points, period, order, boxes, radius, LEAF_SIZE)


@njit(cache=True, nogil=True, inline="always")
def _box_distance(boxes, node, point, period, wraps):  # type: ignore[no-untyped-def]
    """Squared distance from a point to a node's box, rounded like `_distance` in each step, so never too large."""
    total = 0.0
    for axis in range(point.shape[0]):
        to_low = boxes[node, 0, axis] - point[axis]
        to_high = point[axis] - boxes[node, 1, axis]
        gap = max(to_low, to_high, 0.0)
        if wraps and gap > 0.0:
            # The way round ends at the other side of the box.
            gap = min(gap, period[axis] + min(to_low, to_high))
        total += gap * gap
    return total


@njit(cache=True, nogil=True, inline="always")
def _distance(points, i, j, period, wraps):  # type: ignore[no-untyped-def]
    """Squared distance of two points, by number: a row of its own costs more than the sum."""
    total = 0.0
    # The test stands outside of the loop: without wrapping axes it would cost as much as the sum.
    if wraps:
        for axis in range(points.shape[1]):
            gap = abs(points[i, axis] - points[j, axis])
            gap = min(gap, period[axis] - gap)
            total += gap * gap
    else:
        for axis in range(points.shape[1]):
            gap = points[i, axis] - points[j, axis]
            total += gap * gap
    return total


@njit(cache=True, nogil=True)
def _k_nearest(points, period, order, boxes, lowest, k, earlier, leaf_size):  # type: ignore[no-untyped-def]
    n = points.shape[0]
    wraps = np.isfinite(period).any()
    nearest = np.full((n, k), -1, dtype=np.int32)
    distance = np.empty(k)
    # The depth of the tree bounds the stack: two entries a level.
    nodes = np.empty(128, dtype=np.int64)
    firsts = np.empty(128, dtype=np.int64)
    lasts = np.empty(128, dtype=np.int64)
    bounds = np.empty(128)
    # Queries in tree order touch the same leaves one after the other, which keeps them in the cache.
    for position in range(n):
        query = order[position]
        point = points[query]
        found = nearest[query]
        end = query if earlier else n
        count = 0
        nodes[0], firsts[0], lasts[0], bounds[0] = 0, 0, n, 0.0
        top = 1
        while top > 0:
            top -= 1
            node, first, last = nodes[top], firsts[top], lasts[top]
            if (count == k and bounds[top] > distance[k - 1]) or lowest[node] >= end:
                continue
            if 2 * node + 2 < boxes.shape[0]:
                middle = (first + last) // 2
                left, right = 2 * node + 1, 2 * node + 2
                to_left = _box_distance(boxes, left, point, period, wraps)
                to_right = _box_distance(boxes, right, point, period, wraps)
                nearer_last = to_right < to_left
                for turn in range(2):
                    # The nearer child is pushed last, so that it is visited first.
                    if (turn == 1) == nearer_last:
                        nodes[top], firsts[top], lasts[top], bounds[top] = right, middle, last, to_right
                    else:
                        nodes[top], firsts[top], lasts[top], bounds[top] = left, first, middle, to_left
                    top += 1
                continue
            for i in range(first, last):
                other = order[i]
                if other == query or other >= end:
                    continue
                total = _distance(points, other, query, period, wraps)
                if count == k and (
                    total > distance[k - 1] or (total == distance[k - 1] and other > found[k - 1])
                ):
                    continue
                slot = count if count < k else k - 1
                while slot > 0 and (
                    distance[slot - 1] > total or (distance[slot - 1] == total and found[slot - 1] > other)
                ):
                    distance[slot] = distance[slot - 1]
                    found[slot] = found[slot - 1]
                    slot -= 1
                distance[slot] = total
                found[slot] = other
                count = min(count + 1, k)
    return nearest


@njit(cache=True, nogil=True)
def _pairs_within(points, period, order, boxes, radius, leaf_size):  # type: ignore[no-untyped-def]
    n = points.shape[0]
    wraps = np.isfinite(period).any()
    limit = radius * radius
    pairs = np.empty((max(16, 4 * n), 2), dtype=np.int32)
    count = 0
    for query in range(n):
        point = points[query]
        stack = [(0, 0, n)]
        while stack:
            node, first, last = stack.pop()
            if _box_distance(boxes, node, point, period, wraps) > limit:
                continue
            if 2 * node + 2 < boxes.shape[0]:
                middle = (first + last) // 2
                stack.append((2 * node + 1, first, middle))
                stack.append((2 * node + 2, middle, last))
                continue
            for i in range(first, last):
                other = order[i]
                if other <= query:
                    continue
                if _distance(points, other, query, period, wraps) <= limit:
                    if count == pairs.shape[0]:
                        grown = np.empty((2 * count, 2), dtype=np.int32)
                        grown[:count] = pairs
                        pairs = grown
                    pairs[count, 0] = query
                    pairs[count, 1] = other
                    count += 1
    return pairs[:count].copy()


LEAF_SIZE = 12


@njit(cache=True, nogil=True)
def build(points, leaf_size):  # type: ignore[no-untyped-def]
    """Return the order of the points in the leaves, and boxes (nodes, 2, d) and lowest indices (nodes,) by node.

    Nodes split at the median of their widest axis; node v has the children 2v + 1 and 2v + 2.
    """
    n, d = points.shape
    depth = 0
    while (n >> depth) > leaf_size:
        depth += 1
    order = np.arange(n)
    boxes = np.empty(((1 << (depth + 1)) - 1, 2, d))
    lowest = np.empty(boxes.shape[0], dtype=np.int64)
    stack = [(0, 0, n)]
    while stack:
        node, first, last = stack.pop()
        lowest[node] = order[first:last].min()
        for axis in range(d):
            low = np.inf
            high = -np.inf
            for i in range(first, last):
                x = points[order[i], axis]
                low = min(low, x)
                high = max(high, x)
            boxes[node, 0, axis] = low
            boxes[node, 1, axis] = high
        if 2 * node + 2 < boxes.shape[0]:
            axis = 0
            for other in range(1, d):
                if (
                    boxes[node, 1, other] - boxes[node, 0, other]
                    > boxes[node, 1, axis] - boxes[node, 0, axis]
                ):
                    axis = other
            middle = (first + last) // 2
            _partition(points, order, axis, first, last, middle)
            stack.append((2 * node + 1, first, middle))
            stack.append((2 * node + 2, middle, last))
    return order, boxes, lowest


@njit(cache=True, nogil=True)
def _partition(points, order, axis, first, last, middle):  # type: ignore[no-untyped-def]
    """Quickselect: afterwards order[first:middle] has the smaller coordinates along `axis`."""
    low, high = first, last - 1
    while low < high:
        pivot = points[order[(low + high) // 2], axis]
        i, j = low, high
        while i <= j:
            while points[order[i], axis] < pivot:
                i += 1
            while points[order[j], axis] > pivot:
                j -= 1
            if i <= j:
                order[i], order[j] = order[j], order[i]
                i += 1
                j -= 1
        if middle <= j:
            high = j
        elif middle >= i:
            low = i
        else:
            return
