"""The tree itself: every node keeps the tight bounding box of its points and their lowest index."""

from __future__ import annotations

import numpy as np
from numba import njit

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
