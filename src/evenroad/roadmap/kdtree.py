"""A kd-tree for roadmaps: k nearest with a fixed order among ties, and all pairs within a radius.

SciPy's tree leaves open which of several equally far points it returns; a deterministic roadmap needs the lower
index.  Axes may wrap: a gap is then the shorter of the two ways round.
"""

from __future__ import annotations

import numpy as np

from evenroad._njit import njit

LEAF_SIZE = 12


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
def k_nearest(points, period, k, earlier):  # type: ignore[no-untyped-def]
    """Return the k < n nearest other points of every point, (n, k) int32, nearest first, ties to the lower index.

    Coordinates are finite, those of wrapping axes in [0, period), the other periods inf; the metric is Euclidean.  With
    `earlier` only points of a lower index count, and row i has -1 after its min(k, i) neighbours: parts of the tree
    without a lower index are skipped.
    """
    n = points.shape[0]
    order, spans, boxes, lowest = _build(points)
    wraps = np.isfinite(period).any()
    nearest = np.full((n, k), -1, dtype=np.int32)
    distance = np.empty(k)
    # The depth of the tree bounds the stack: two entries a level.
    nodes, bounds = np.empty(128, dtype=np.int64), np.empty(128)
    # Queries in tree order touch the same leaves one after the other, which keeps them in the cache.
    for query in order:
        point, found = points[query], nearest[query]
        end = query if earlier else n
        count, top = 0, 1
        nodes[0], bounds[0] = 0, 0.0
        while top > 0:
            top -= 1
            node = nodes[top]
            if (count == k and bounds[top] > distance[k - 1]) or lowest[node] >= end:
                continue
            left, right = 2 * node + 1, 2 * node + 2
            if right < boxes.shape[0]:
                to_left = _box_distance(boxes, left, point, period, wraps)
                to_right = _box_distance(boxes, right, point, period, wraps)
                # The nearer child is pushed last, so that it is visited first.
                nodes[top], nodes[top + 1] = (left, right) if to_right < to_left else (right, left)
                bounds[top], bounds[top + 1] = max(to_left, to_right), min(to_left, to_right)
                top += 2
                continue
            for i in range(spans[node, 0], spans[node, 1]):
                other = order[i]
                if other == query or other >= end:
                    continue
                total = _distance(points, other, query, period, wraps)
                last = distance[k - 1]
                if count == k and (total > last or (total == last and other > found[k - 1])):
                    continue
                slot = count if count < k else k - 1
                while slot > 0 and (
                    distance[slot - 1] > total or (distance[slot - 1] == total and found[slot - 1] > other)
                ):
                    distance[slot], found[slot] = distance[slot - 1], found[slot - 1]
                    slot -= 1
                distance[slot], found[slot] = total, other
                count = min(count + 1, k)
    return nearest


@njit(cache=True, nogil=True)
def pairs_within(points, period, radius):  # type: ignore[no-untyped-def]
    """Return every pair i < j at distance <= `radius`, (m, 2), in no particular order; as `k_nearest`, n >= 1."""
    n = points.shape[0]
    order, spans, boxes, _ = _build(points)
    wraps = np.isfinite(period).any()
    limit = radius * radius
    pairs = np.empty((max(16, 4 * n), 2), dtype=np.int32)
    count = 0
    nodes = np.empty(128, dtype=np.int64)
    for query in range(n):
        nodes[0], top = 0, 1
        while top > 0:
            top -= 1
            node = nodes[top]
            if _box_distance(boxes, node, points[query], period, wraps) > limit:
                continue
            if 2 * node + 2 < boxes.shape[0]:
                nodes[top], nodes[top + 1] = 2 * node + 1, 2 * node + 2
                top += 2
                continue
            for i in range(spans[node, 0], spans[node, 1]):
                other = order[i]
                if other > query and _distance(points, other, query, period, wraps) <= limit:
                    if count == pairs.shape[0]:
                        pairs = np.concatenate((pairs, np.empty_like(pairs)))
                    pairs[count] = query, other
                    count += 1
    return pairs[:count].copy()


@njit(cache=True, nogil=True)
def _build(points):  # type: ignore[no-untyped-def]
    """Return the order of the points in the leaves, and by node its span of it, its box and its lowest index.

    Shapes (n,), (nodes, 2), (nodes, 2, d), (nodes,); nodes split at the median of their widest axis, and node v has the
    children 2v + 1 and 2v + 2.
    """
    n, d = points.shape
    depth = 0
    while (n >> depth) > LEAF_SIZE:
        depth += 1
    size = (1 << (depth + 1)) - 1
    order = np.arange(n)
    spans, boxes, lowest = (
        np.empty((size, 2), dtype=np.int64),
        np.empty((size, 2, d)),
        np.empty(size, dtype=np.int64),
    )
    spans[0] = 0, n
    for node in range(size):
        first, last = spans[node]
        lowest[node] = order[first:last].min()
        widest, width = 0, -np.inf
        for axis in range(d):
            low, high = np.inf, -np.inf
            for i in range(first, last):
                x = points[order[i], axis]
                low, high = min(low, x), max(high, x)
            boxes[node, 0, axis], boxes[node, 1, axis] = low, high
            if high - low > width:
                widest, width = axis, high - low
        if 2 * node + 2 < size:
            middle = (first + last) // 2
            _partition(points, order, widest, first, last, middle)
            spans[2 * node + 1] = first, middle
            spans[2 * node + 2] = middle, last
    return order, spans, boxes, lowest


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
