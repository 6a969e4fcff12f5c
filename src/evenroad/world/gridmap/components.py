"""Which places of a disk on a grid hang together for certain not: components of cells, and gates between them.

The grid is the padded one (see `cells`), whose ring is blocked.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad._arrays import Bools, Ints32
from evenroad.world.gridmap.cells import BLOCKED, FREE, UNDECIDED, DiskTables

_AROUND = 3
"""Cells around a place where two components come close that belong to the gate."""

PARTS = 16
"""A cell at a gate is looked at in so many by so many parts, to tell whether the gate is shut."""


@njit(cache=True, nogil=True)
def find_gates(cells: npt.NDArray[np.uint8]) -> Bools:
    """Return the cells around places where a path may lead through cells that are not surely free.

    From every component of surely free cells the undecided ones are visited outwards.  Along a wall they are a strip
    of one or two.  Where they lie deeper, where two components meet, or where none comes to, there is a gate.
    """
    rows, cols = cells.shape
    flat = cells.ravel()
    around = np.array([-cols - 1, -cols, -cols + 1, -1, 1, cols - 1, cols, cols + 1])
    owner = np.zeros(rows * cols, np.int32)
    depth = np.zeros(rows * cols, np.int32)
    queue = np.empty(rows * cols, np.int32)
    last, begin, end = 0, 0, 0
    for cell in range(rows * cols):
        if flat[cell] < FREE or owner[cell] != 0:
            continue
        last += 1
        owner[cell] = last
        queue[end] = cell
        end += 1
        while begin < end:
            here = queue[begin]
            begin += 1
            # The ring of the padded grid is blocked: neighbours never leave the array.
            for k in range(8):
                to = here + around[k]
                if flat[to] >= FREE and owner[to] == 0:
                    owner[to] = last
                    queue[end] = to
                    end += 1
    begin = 0
    while begin < end:
        here = queue[begin]
        begin += 1
        for k in range(8):
            to = here + around[k]
            if flat[to] != BLOCKED and owner[to] == 0:
                owner[to], depth[to] = owner[here], depth[here] + 1
                queue[end] = to
                end += 1
    gates = np.zeros((rows, cols), np.bool_)
    for row in range(1, rows - 1):
        for col in range(1, cols - 1):
            if cells[row, col] != UNDECIDED:
                continue
            cell = row * cols + col
            is_gate = owner[cell] == 0 or depth[cell] >= 3
            for k in range(8):
                to = cell + around[k]
                is_gate |= flat[to] != BLOCKED and owner[to] != owner[cell]
            if is_gate:
                for r in range(max(row - _AROUND, 1), min(row + _AROUND, rows - 2) + 1):
                    for c in range(max(col - _AROUND, 1), min(col + _AROUND, cols - 2) + 1):
                        gates[r, c] |= cells[r, c] != BLOCKED
    return gates


@njit(cache=True, nogil=True)
def label_components(disk: DiskTables, gates: Bools) -> Ints32:
    """Return the component of each cell and, at gates, of each part of a cell; 0 where no disk is free.

    Cells that are not surely blocked hang together over their sides, and so do the parts of a cell at a gate.  A disk
    whose centre goes over a corner touches all four there, so none of them is blocked: two components are apart for
    certain.  What is in one component need not hang together, where a gate is hardly wider or narrower than the disk.

    Returns
    -------
    labels : (rows * PARTS, cols * PARTS) would be much memory, so two arrays in one: (rows * cols + gates * PARTS**2,)
        First of the cells, row by row, those at gates with 0; then of the parts of each cell at a gate, row by row.
    """
    rows, cols = gates.shape
    number = np.full((rows, cols), -1, np.int64)
    count = 0
    for row in range(rows):
        for col in range(cols):
            if gates[row, col]:
                number[row, col] = count
                count += 1
    total = rows * cols + count * PARTS * PARTS
    parent = np.full(total, -1, np.int32)
    for row in range(rows):
        for col in range(cols):
            if number[row, col] >= 0:
                _open_parts(row, col, rows * cols + number[row, col] * PARTS * PARTS, parent, disk)
            elif disk.cells[row, col] != BLOCKED:
                parent[row * cols + col] = row * cols + col
    for row in range(1, rows - 1):
        for col in range(1, cols - 1):
            here = rows * cols + number[row, col] * PARTS * PARTS
            for down in range(2):
                to_row, to_col = row + down, col + 1 - down
                there = rows * cols + number[to_row, to_col] * PARTS * PARTS
                if number[row, col] < 0 and number[to_row, to_col] < 0:
                    _unite(row * cols + col, to_row * cols + to_col, parent)
                    continue
                for k in range(PARTS):
                    a, b = row * cols + col, to_row * cols + to_col
                    if number[row, col] >= 0:
                        a = here + ((PARTS - 1) * PARTS + k if down else k * PARTS + PARTS - 1)
                    if number[to_row, to_col] >= 0:
                        b = there + (k if down else k * PARTS)
                    _unite(a, b, parent)
            if number[row, col] >= 0:
                for k in range(PARTS * PARTS):
                    if k % PARTS < PARTS - 1:
                        _unite(here + k, here + k + 1, parent)
                    if k < PARTS * (PARTS - 1):
                        _unite(here + k, here + k + PARTS, parent)
    labels = np.zeros(total, np.int32)
    for i in range(total):
        if parent[i] >= 0:
            labels[i] = _root(i, parent) + 1
    return labels


@njit(cache=True, nogil=True)
def _open_parts(row: int, col: int, base: int, parent: Any, disk: DiskTables) -> None:
    """Open the parts of a cell that may have a free point: all but those whose middle is too near by their size."""
    coarse = PARTS // 4
    for i in range(16):
        top, left = (i // 4) * coarse, (i % 4) * coarse
        x, y = col + (left + 0.5 * coarse) / PARTS, row + (top + 0.5 * coarse) / PARTS
        distance = _distance(x, y, row, col, disk)
        reach = math.sqrt(0.5) * coarse / PARTS
        if distance + reach < disk.radius:
            continue
        for r in range(top, top + coarse):
            for c in range(left, left + coarse):
                if distance < disk.radius + reach:
                    x, y = col + (c + 0.5) / PARTS, row + (r + 0.5) / PARTS
                    if _distance(x, y, row, col, disk) + math.sqrt(0.5) / PARTS < disk.radius:
                        continue
                parent[base + r * PARTS + c] = base + r * PARTS + c


@njit(cache=True, nogil=True)
def _distance(x: float, y: float, row: int, col: int, disk: DiskTables) -> float:
    """Return the distance of a point of a cell to the nearest obstacle; beyond the radius any that is larger."""
    reach = math.ceil(disk.radius) + 1
    least = np.inf
    for other in range(max(col - reach, 0), min(col + reach, disk.cells.shape[1] - 1) + 1):
        gap_x = max(other - x, x - (other + 1), 0.0)
        gap_y = 0.0
        if disk.above[row, other] > 0:
            gap_y = min(y - (row + 1 - disk.above[row, other]), row + disk.below[row, other] - y)
        least = min(least, gap_x * gap_x + gap_y * gap_y)
    return math.sqrt(least)


@njit(cache=True, nogil=True)
def _root(i: int, parent: Any) -> int:
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@njit(cache=True, nogil=True)
def _unite(a: int, b: int, parent: Any) -> None:
    if parent[a] < 0 or parent[b] < 0:
        return
    a, b = _root(a, parent), _root(b, parent)
    if a < b:
        parent[b] = a
    elif b < a:
        parent[a] = b
