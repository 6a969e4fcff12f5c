"""Points as compiled code reads them: a grid of distances that clears most places, and a tree of sixteens for the rest.

All of a cloud is in one array of integers: a header, floats of single precision behind it, and a byte a cell.  The tree
is in its order alone: a leaf is sixteen neighbours in a row, a node sixteen leaves or nodes in a row.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad.robot.kernel.layout import LANES

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Ints = npt.NDArray[np.int64]
Bytes = npt.NDArray[np.uint8]

LEVELS, CELLS_Y, CELLS_Z, GRID, FIRST_NODES = 0, 1, 2, 3, 4
"""Header: how many levels of nodes, cells along y and z, where the bytes begin, counted in bytes; where each level's
nodes begin in the floats, from that above the leaves to that of the one root."""

HEADER, BYTES_OF_HEADER = 16, 128

LOW, ONE_BY_CELL, SIZE, STEP, RADIUS, TOLD, LEAVES = 0, 3, 4, 7, 8, 9, 16
"""Floats: lower corner of the grid (3), one over the side of a cell, extents of the grid (3), what a byte counts in,
radius of the points, by how much a distance is larger at most than a byte says; rows of leaves, x, y and z of 16
points each."""

LEAF_ROW, NODE_ROW = 3 * LANES, 7 * LANES
"""Of a node: centres and half extents (x, y, z each) of boxes around 16 leaves or nodes, radii of balls about the
centres."""

NOWHERE = np.float32(1e9)
"""Where the places to spare of a leaf or node are."""

CELLS, LEAST_CELL = 400_000, 4e-3
"""About so many cells of a grid, none smaller than this [m]."""

FARTHEST_STEPS, STEPS = 64, 4
"""Bounds beyond so many cells are not told apart; a byte counts parts of a cell."""

_WIDER = 1e-6
"""Nodes are wider than what they hold by this share of the places' size, and of one metre."""


def cloud_array(points: Floats, radius: float) -> Ints:
    """Return points, (n, 3), n >= 1, of a radius as compiled code reads them."""
    singles = np.ascontiguousarray(points, dtype=np.float32)
    size = float(np.abs(points).max())
    low, high = singles.min(axis=0).astype(np.float64), singles.max(axis=0).astype(np.float64)
    cell = max(float(np.prod(np.maximum(high - low, LEAST_CELL)) / CELLS) ** (1 / 3), LEAST_CELL)
    # Half a cell beyond the points on each side: rounding takes none of them out.
    counts = np.ceil((high - low) / cell + 1.0).astype(np.int64)
    low -= 0.5 * (counts * cell - (high - low))
    levels: list[int] = []
    count = -(-len(points) // LANES)
    while not levels or count > 1:
        count = -(-count // LANES)
        levels.append(count)
    leaves = LANES * levels[0]
    floats = LEAVES + LEAF_ROW * leaves + NODE_ROW * sum(levels)
    grid = BYTES_OF_HEADER + 4 * floats
    array = np.zeros((grid + int(np.prod(counts)) + 7) // 8, dtype=np.int64)
    array[[LEVELS, CELLS_Y, CELLS_Z, GRID]] = len(levels), counts[1], counts[2], grid
    starts = LEAVES + LEAF_ROW * leaves + NODE_ROW * np.cumsum([0, *levels[:-1]])
    array[FIRST_NODES : FIRST_NODES + len(levels)] = starts
    table = array.view(np.float32)[2 * HEADER : 2 * HEADER + floats]
    table[LOW : LOW + 3], table[ONE_BY_CELL], table[STEP] = low, 1.0 / cell, cell / STEPS * (1.0 - 1e-6)
    # A place on the upper side is in the last cell, not beyond it.
    table[SIZE : SIZE + 3] = counts * cell * (1.0 - 1e-5)
    table[RADIUS], table[TOLD] = radius, cell * (1.0 / STEPS + 2.0 * math.sqrt(3.0)) * (1.0 + 1e-5)
    _write_distances(singles, low, 1.0 / cell, counts, array.view(np.uint8)[grid:])
    ordered = singles.copy()
    _order(ordered)
    _write_tree(ordered, np.array(levels), table, np.float32(_WIDER * (1.0 + size)))
    array.setflags(write=False)
    return array


@njit(cache=True, nogil=True)
def _order(points: Singles) -> None:
    """Bring points into an order in which sixteen, and sixteen times as many, and so on, are near each other."""
    waiting = [(0, len(points))]
    while len(waiting) > 0:
        first, end = waiting.pop()
        if end - first <= LANES:
            continue
        unit = LANES
        while unit * LANES < end - first:
            unit *= LANES
        middle = first + ((end - first + unit - 1) // unit // 2) * unit
        axis, widest = 0, np.float32(-1.0)
        for k in range(3):
            low = high = points[first, k]
            for i in range(first, end):
                low, high = min(low, points[i, k]), max(high, points[i, k])
            if high - low > widest:
                axis, widest = k, high - low
        if widest > 0.0:
            _split(points, first, end - 1, middle, axis)
        waiting.append((first, middle))
        waiting.append((middle, end))


@njit(cache=True, nogil=True)
def _split(points: Singles, low: int, high: int, middle: int, axis: int) -> None:
    """Bring the lesser ones along an axis before place `middle`, of those from `low` to `high` (C. Hoare, 1961)."""
    while low < high:
        a, b, c = points[low, axis], points[(low + high) // 2, axis], points[high, axis]
        pivot = max(min(a, b), min(max(a, b), c))
        i, k = low, high
        while i <= k:
            while points[i, axis] < pivot:
                i += 1
            while points[k, axis] > pivot:
                k -= 1
            if i <= k:
                for entry in range(3):
                    kept = points[i, entry]
                    points[i, entry] = points[k, entry]
                    points[k, entry] = kept
                i += 1
                k -= 1
        if middle <= k:
            high = k
        elif middle >= i:
            low = i
        else:
            return


@njit(cache=True, nogil=True)
def _write_tree(points: Singles, levels: Ints, table: Singles, wider: np.float32) -> None:
    """Write leaves, and level by level what is around sixteen of them."""
    n, leaves = len(points), LANES * levels[0]
    boxes = np.empty((leaves, 7), dtype=np.float32)
    for leaf in range(leaves):
        first, end = LANES * leaf, min(LANES * leaf + LANES, n)
        for axis in range(3):
            row = LEAVES + LEAF_ROW * leaf + LANES * axis
            low, high = np.float32(np.inf), np.float32(-np.inf)
            for i in range(first, end):
                low, high = min(low, points[i, axis]), max(high, points[i, axis])
                table[row + i - first] = points[i, axis]
            for lane in range(max(end - first, 0), LANES):
                table[row + lane] = NOWHERE
            boxes[leaf, axis], boxes[leaf, 3 + axis] = (
                np.float32(0.5) * (low + high),
                np.float32(0.5) * (high - low),
            )
        squared = np.float32(0.0)
        for i in range(first, end):
            apart = np.float32(0.0)
            for axis in range(3):
                apart += (points[i, axis] - boxes[leaf, axis]) ** 2
            squared = max(squared, apart)
        boxes[leaf, 6] = math.sqrt(squared)
    row, used = LEAVES + LEAF_ROW * leaves, (n + LANES - 1) // LANES
    for count in levels:
        parents = np.empty((count, 7), dtype=np.float32)
        for node in range(count):
            first, end = LANES * node, min(LANES * node + LANES, used)
            for lane in range(LANES):
                for entry in range(7):
                    value = NOWHERE if entry < 3 else np.float32(0.0)
                    if first + lane < end:
                        value = boxes[first + lane, entry] + (wider if entry >= 3 else np.float32(0.0))
                    table[row + LANES * entry + lane] = value
            for axis in range(3):
                low, high = np.float32(np.inf), np.float32(-np.inf)
                for i in range(first, end):
                    low = min(low, boxes[i, axis] - boxes[i, 3 + axis])
                    high = max(high, boxes[i, axis] + boxes[i, 3 + axis])
                parents[node, axis], parents[node, 3 + axis] = (
                    np.float32(0.5) * (low + high),
                    np.float32(0.5) * (high - low) + wider,
                )
            farthest = np.float32(0.0)
            for i in range(first, end):
                apart = np.float32(0.0)
                for axis in range(3):
                    apart += (boxes[i, axis] - parents[node, axis]) ** 2
                farthest = max(farthest, math.sqrt(apart) + boxes[i, 6])
            parents[node, 6] = farthest + wider
            row += NODE_ROW
        boxes, used = parents, count


@njit(cache=True, nogil=True)
def _write_distances(points: Singles, low: Floats, one_by_cell: float, counts: Ints, grid: Bytes) -> None:
    """Write for each cell how far all of it is from any cell with a point, in parts of a cell, rounded down.

    Between cells d apart along an axis there are d - 1: so distances, axis by axis, from cells with a point or next to
    one (after P. Felzenszwalb and D. Huttenlocher, Distance Transforms of Sampled Functions, 2012, but each line is
    searched up to the farthest that is told apart, many lines at once).
    """
    nx, ny, nz = counts
    far = np.int32(FARTHEST_STEPS * FARTHEST_STEPS)
    squared = np.full((nx, ny, nz), far, dtype=np.int32)
    taken = np.zeros((nx, ny, nz), dtype=np.bool_)
    for i in range(len(points)):
        x = min(max(int((points[i, 0] - low[0]) * one_by_cell), 0), nx - 1)
        y = min(max(int((points[i, 1] - low[1]) * one_by_cell), 0), ny - 1)
        z = min(max(int((points[i, 2] - low[2]) * one_by_cell), 0), nz - 1)
        if taken[x, y, z]:
            continue
        taken[x, y, z] = True
        squared[max(x - 1, 0) : x + 2, max(y - 1, 0) : y + 2, max(z - 1, 0) : z + 2] = 0
    for x in range(nx):
        for y in range(ny):
            away = FARTHEST_STEPS
            for z in range(nz):
                away = 0 if squared[x, y, z] == 0 else min(away + 1, FARTHEST_STEPS)
                squared[x, y, z] = away * away
            away = FARTHEST_STEPS
            for z in range(nz - 1, -1, -1):
                away = 0 if squared[x, y, z] == 0 else min(away + 1, FARTHEST_STEPS)
                squared[x, y, z] = min(squared[x, y, z], away * away)
    least = np.empty_like(squared)
    _spread(squared.reshape(nx, ny, nz), least, nx, ny, nz)
    _spread(least.reshape(1, nx, ny * nz), squared.reshape(1, nx, ny * nz), 1, nx, ny * nz)
    steps = np.empty(far + 1, dtype=np.uint8)
    for i in range(far + 1):
        steps[i] = min(255, int(STEPS * math.sqrt(i)))
    place = 0
    for x in range(nx):
        for y in range(ny):
            for z in range(nz):
                grid[place] = steps[squared[x, y, z]]
                place += 1


@njit(cache=True, nogil=True)
def _spread(squared: npt.NDArray[np.int32], least: npt.NDArray[np.int32], a: int, b: int, c: int) -> None:
    """Write the squared distances that follow along the middle axis of three, of lengths a, b and c."""
    for i in range(a):
        for j in range(b):
            best = least[i, j]
            farthest = np.int32(0)
            for m in range(c):
                best[m] = squared[i, j, m]
                farthest = max(farthest, best[m])
            for away in range(1, FARTHEST_STEPS):
                added = np.int32(away * away)
                if added >= farthest:
                    break
                for side in range(2):
                    k = j - away if side == 0 else j + away
                    if k < 0 or k >= b:
                        continue
                    other = squared[i, k]
                    for m in range(c):
                        best[m] = min(best[m], other[m] + added)
