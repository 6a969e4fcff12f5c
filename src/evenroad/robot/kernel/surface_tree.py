"""Surfaces, points or triangles, as compiled code reads them: a grid of distances and a tree of sixteens.

All of a surface is in one array of integers: a header, floats of single precision behind it, and a byte or two a cell.
The tree is in its order alone: a leaf is sixteen neighbours in a row, a node sixteen leaves or nodes in a row.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from evenroad._njit import njit
from evenroad.robot.kernel.layout import LANES
from evenroad.robot.kernel.surface_grid import STEPS, Grid

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Ints = npt.NDArray[np.int64]

LEVELS, CELLS_X, CELLS_Y, CELLS_Z, GRID, WINDINGS, IS_MESH, TURNED, FIRST_NODES = range(9)
"""Header: how many levels of nodes, cells along the axes, where the bytes of distances begin and those of windings, or
0 where nothing is inside, counted in bytes; whether leaves hold triangles, and whether inside is what they wind around,
or else what they wind around an odd number of times; where each level's nodes begin in the floats, from that above the
leaves to that of the one root."""

HEADER, BYTES_OF_HEADER = 16, 128

LOW, ONE_BY_CELL, SIZE, STEP, RADIUS, EXCESS, LEAVES = 0, 3, 4, 7, 8, 9, 16
"""Floats: lower corner of the grid (3), one over the side of a cell, extents of the grid (3), what a byte counts in,
radius of the points, by how much a distance is larger at most than a byte says; rows of leaves."""

POINT_ROW, TRIANGLE_ROW = 3 * LANES, 12 * LANES
"""Of a leaf: x, y and z of 16 points; or a corner of 16 triangles, the ways to the other two, and their unit normals,
or 0 where they have none."""

NODE_ROW = 7 * LANES
"""Of a node: centres and half extents (x, y, z each) of boxes around 16 leaves or nodes, radii of balls about the
centres."""

NOWHERE = np.float32(1e9)
"""Where the places to spare of a leaf or node are."""

_WIDER = 1e-6
"""Nodes are wider than what they hold by this share of the places' size, and of one metre."""


def surface_array(corners: Floats, radius: float, grid: Grid) -> Ints:
    """Return points, (n, 1, 3), or triangles, (n, 3, 3), n >= 1, widened by a radius, as compiled code reads them."""
    order = np.arange(len(corners))
    _order(corners.mean(axis=1).astype(np.float32), order)
    ordered = corners[order]
    levels: list[int] = []
    count = -(-len(corners) // LANES)
    while not levels or count > 1:
        count = -(-count // LANES)
        levels.append(count)
    leaves, row = LANES * levels[0], POINT_ROW if corners.shape[1] == 1 else TRIANGLE_ROW
    floats = LEAVES + row * leaves + NODE_ROW * sum(levels)
    first = BYTES_OF_HEADER + 4 * floats
    cells = grid.taken.size
    array = np.zeros((first + 2 * cells + 7) // 8, dtype=np.int64)
    array[[LEVELS, CELLS_X, CELLS_Y, CELLS_Z, GRID]] = len(levels), *grid.taken.shape, first
    array[WINDINGS] = 0 if grid.windings is None else first + cells
    array[[IS_MESH, TURNED]] = row == TRIANGLE_ROW, grid.turned
    starts = LEAVES + row * leaves + NODE_ROW * np.cumsum([0, *levels[:-1]])
    array[FIRST_NODES : FIRST_NODES + len(levels)] = starts
    table = array.view(np.float32)[2 * HEADER : 2 * HEADER + floats]
    table[LOW : LOW + 3], table[ONE_BY_CELL] = grid.low, 1.0 / grid.cell
    table[STEP], table[RADIUS], table[EXCESS] = grid.cell / STEPS * (1.0 - 1e-6), radius, grid.excess
    # A place on the upper side is in the last cell, not beyond it.
    table[SIZE : SIZE + 3] = np.array(grid.taken.shape) * grid.cell * (1.0 - 1e-5)
    centres = array.view(np.uint8)[first:]
    centres[:cells] = grid.distances.ravel()
    if grid.windings is not None:
        centres[cells : 2 * cells] = grid.windings.ravel().view(np.uint8)
    _write_leaves(ordered, row, table[LEAVES : int(starts[0])])
    wider = np.float32(_WIDER * (1.0 + float(np.abs(corners).max())))
    _write_nodes(ordered.astype(np.float32), np.array(levels), table[int(starts[0]) :], wider)
    array.setflags(write=False)
    return array


def _write_leaves(corners: Floats, row: int, table: Singles) -> None:
    """Write the rows of leaves."""
    rows = len(table) // row
    columns = np.zeros((rows * LANES, row // LANES))
    columns[:, :3] = NOWHERE
    columns[: len(corners), :3] = corners[:, 0]
    if row == TRIANGLE_ROW:
        edges = corners[:, 1:] - corners[:, :1]
        normals = np.cross(edges[:, 0], edges[:, 1])
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        columns[: len(corners), 3:9] = edges.reshape(-1, 6)
        columns[: len(corners), 9:] = np.where(lengths > 0.0, normals / np.where(lengths > 0.0, lengths, 1.0), 0.0)
    by_leaf = columns.reshape(rows, LANES, -1).transpose(0, 2, 1)
    table[:] = by_leaf.ravel()


@njit(cache=True, nogil=True)
def _order(centres: Singles, order: Ints) -> None:
    """Bring places, and their numbers, into an order in which sixteen, or 256, ... neighbours are near each other."""
    waiting = [(0, len(centres))]
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
            low = high = centres[first, k]
            for i in range(first, end):
                low, high = min(low, centres[i, k]), max(high, centres[i, k])
            if high - low > widest:
                axis, widest = k, high - low
        if widest > 0.0:
            _split(centres, order, first, end - 1, middle, axis)
        waiting.append((first, middle))
        waiting.append((middle, end))


@njit(cache=True, nogil=True)
def _split(centres: Singles, order: Ints, low: int, high: int, middle: int, axis: int) -> None:
    """Bring the lesser ones along an axis before place `middle`, of those from `low` to `high` (C. Hoare, 1961)."""
    while low < high:
        a, b, c = centres[low, axis], centres[(low + high) // 2, axis], centres[high, axis]
        pivot = max(min(a, b), min(max(a, b), c))
        i, k = low, high
        while i <= k:
            while centres[i, axis] < pivot:
                i += 1
            while centres[k, axis] > pivot:
                k -= 1
            if i <= k:
                for entry in range(3):
                    kept = centres[i, entry]
                    centres[i, entry] = centres[k, entry]
                    centres[k, entry] = kept
                number = order[i]
                order[i] = order[k]
                order[k] = number
                i += 1
                k -= 1
        if middle <= k:
            high = k
        elif middle >= i:
            low = i
        else:
            return


@njit(cache=True, nogil=True)
def _write_nodes(corners: Singles, levels: Ints, table: Singles, wider: np.float32) -> None:
    """Write, level by level, what is around sixteen leaves or nodes."""
    used = (len(corners) + LANES - 1) // LANES
    boxes = np.empty((used, 7), dtype=np.float32)
    for leaf in range(used):
        first, end = LANES * leaf, min(LANES * leaf + LANES, len(corners))
        for axis in range(3):
            low, high = np.float32(np.inf), np.float32(-np.inf)
            for i in range(first, end):
                for corner in range(corners.shape[1]):
                    coordinate = corners[i, corner, axis]
                    low, high = min(low, coordinate), max(high, coordinate)
            boxes[leaf, axis] = np.float32(0.5) * (low + high)
            boxes[leaf, 3 + axis] = np.float32(0.5) * (high - low)
        squared = np.float32(0.0)
        for i in range(first, end):
            for corner in range(corners.shape[1]):
                apart = np.float32(0.0)
                for axis in range(3):
                    apart += (corners[i, corner, axis] - boxes[leaf, axis]) ** 2
                squared = max(squared, apart)
        boxes[leaf, 6] = math.sqrt(squared)
    row = 0
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
                parents[node, axis] = np.float32(0.5) * (low + high)
                parents[node, 3 + axis] = np.float32(0.5) * (high - low) + wider
            farthest = np.float32(0.0)
            for i in range(first, end):
                apart = np.float32(0.0)
                for axis in range(3):
                    apart += (boxes[i, axis] - parents[node, axis]) ** 2
                farthest = max(farthest, math.sqrt(apart) + boxes[i, 6])
            parents[node, 6] = farthest + wider
            row += NODE_ROW
        boxes, used = parents, count
