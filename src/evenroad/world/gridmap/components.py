"""Proofs that positions of a disk on a grid are not connected: components of cells, and gates between them.

The grid is the padded one (see `cells`), whose ring is blocked.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Ints, Ints32
from evenroad._njit import njit
from evenroad.world.gridmap.cells import BLOCKED, FREE, UNDECIDED, DiskTables
from evenroad.world.gridmap.kernel import squared_gap

_AROUND = 3
"""Number of cells around a near contact of two components that belong to the gate."""
PARTS = 16
"""Number of parts, along each side, into which a cell at a gate is divided to decide whether the gate is shut."""


@njit(cache=True, nogil=True)
def find_gates(cells: npt.NDArray[np.uint8]) -> Bools:
    """Return the cells where a path may lead through cells that are not surely free.

    From every component of surely free cells the undecided ones are visited outwards.  Along a wall they are a strip of
    one or two.  Where they lie deeper, where two components meet, or where no component reaches, there is a gate.
    """
    rows, cols = cells.shape
    flat = cells.ravel()
    around = np.array([-cols - 1, -cols, -cols + 1, -1, 1, cols - 1, cols, cols + 1])
    owner = np.zeros(rows * cols, np.int32)
    depth = np.zeros(rows * cols, np.int32)
    queue = np.empty(rows * cols, np.int32)
    components, count = 0, 0
    for cell in range(rows * cols):
        if flat[cell] >= FREE and owner[cell] == 0:
            components += 1
            owner[cell], queue[count] = components, cell
            count = _flood(flat, FREE, 0, around, (owner, depth, queue), count, count + 1)
    _flood(flat, UNDECIDED, 1, around, (owner, depth, queue), 0, count)
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
def _flood(flat: Any, least: int, deeper: int, around: Any, reached: Any, begin: int, end: int) -> int:
    """Give the neighbours of queued cells, of state `least` or more, to the same owner, and so on; return the end."""
    owner, depth, queue = reached
    while begin < end:
        here = queue[begin]
        begin += 1
        # The ring of the padded grid is blocked: neighbours never leave the array.
        for k in range(8):
            to = here + around[k]
            if flat[to] >= least and owner[to] == 0:
                owner[to], depth[to] = owner[here], depth[here] + deeper
                queue[end] = to
                end += 1
    return end


class Components(NamedTuple):
    """Connected components; arrays over the padded grid, (rows + 2, cols + 2), and over its g cells at gates."""

    cells: Ints32
    """The component of each cell, 0 where no disk is free and at gates."""
    number: Ints32
    """The number of each cell among those at gates, or -1."""
    opened: npt.NDArray[np.uint16]
    """Which parts of a cell at a gate may have a free point, (g, PARTS): a bit a part, a number a row."""
    first: Ints
    """First pieces of each cell at a gate, (g + 1,): its parts that are connected inside it."""
    pieces: Ints32
    """The component of each piece."""


@njit(cache=True, nogil=True)
def label_components(disk: DiskTables, gates: Bools) -> tuple[Ints32, Ints32, Any, Ints, Ints32]:
    """Return the `Components` of a disk on a map, as a tuple.

    Cells that are not surely blocked are connected over their sides, and so are the parts of a cell at a gate.  A disk
    whose centre moves over a corner touches all four there, so none of them is blocked: two components are surely
    apart.  One component need not be connected where a gate is hardly wider or narrower than the disk.

    Of the parts of a cell only a bit each is kept: on a map of narrow passages every cell is at a gate.
    """
    rows, cols = gates.shape
    number = np.full((rows, cols), -1, np.int32)
    count = 0
    for row in range(rows):
        for col in range(cols):
            if gates[row, col]:
                number[row, col] = count
                count += 1
    opened = np.zeros((count, PARTS), np.uint16)
    first = np.zeros(count + 1, np.int64)
    here, there = np.empty((PARTS, PARTS), np.int16), np.empty((PARTS, PARTS), np.int16)
    for row in range(rows):
        for col in range(cols):
            k = number[row, col]
            if k >= 0:
                _open_parts(row, col, opened[k], disk)
                first[k + 1] = first[k] + pieces_of(opened[k], here)
    first += rows * cols
    parent = np.full(first[count], -1, np.int32)
    for row in range(rows):
        for col in range(cols):
            if number[row, col] < 0 and disk.cells[row, col] != BLOCKED:
                parent[row * cols + col] = row * cols + col
    for i in range(rows * cols, first[count]):
        parent[i] = i
    for row in range(1, rows - 1):
        for col in range(1, cols - 1):
            of_here = number[row, col]
            if of_here >= 0:
                pieces_of(opened[of_here], here)
            for down in range(2):
                to_row, to_col = row + down, col + 1 - down
                of_there = number[to_row, to_col]
                a, b = row * cols + col, to_row * cols + to_col
                if of_here < 0 and of_there < 0:
                    _unite(a, b, parent)
                    continue
                if of_there >= 0:
                    pieces_of(opened[of_there], there)
                for k in range(PARTS):
                    if of_here >= 0:
                        piece = here[PARTS - 1, k] if down else here[k, PARTS - 1]
                        a = first[of_here] + piece if piece >= 0 else -1
                    if of_there >= 0:
                        piece = there[0, k] if down else there[k, 0]
                        b = first[of_there] + piece if piece >= 0 else -1
                    if a >= 0 and b >= 0:
                        _unite(a, b, parent)
    # A parent never comes after its child: whose is done is final.
    for i in range(len(parent)):
        if parent[i] >= 0:
            parent[i] = parent[parent[i]]
    parent += 1
    of_cells = parent[: rows * cols].reshape(rows, cols)
    return of_cells, number, opened, first - rows * cols, parent[rows * cols :]


@njit(cache=True, nogil=True)
def pieces_of(opened: Any, pieces: Any) -> int:
    """Write which piece of a cell each of its parts belongs to, (PARTS, PARTS), -1 of none; return how many."""
    pieces[:] = -1
    waiting = np.empty(PARTS * PARTS, np.int16)
    count = 0
    for seed in range(PARTS * PARTS):
        r, c = divmod(seed, PARTS)
        if pieces[r, c] >= 0 or not opened[r] >> c & 1:
            continue
        pieces[r, c], waiting[0], size = count, seed, 1
        while size > 0:
            size -= 1
            r, c = divmod(waiting[size], PARTS)
            for k in range(4):
                to_r, to_c = r + (k == 0) - (k == 1), c + (k == 2) - (k == 3)
                inside = 0 <= to_r < PARTS and 0 <= to_c < PARTS
                if inside and opened[to_r] >> to_c & 1 and pieces[to_r, to_c] < 0:
                    pieces[to_r, to_c] = count
                    waiting[size] = to_r * PARTS + to_c
                    size += 1
        count += 1
    return count


@njit(cache=True, nogil=True)
def _open_parts(row: int, col: int, opened: Any, disk: DiskTables) -> None:
    """Open the parts of a cell that may have a free point: all but those whose middle is too near by their size."""
    coarse = PARTS // 4
    for i in range(16):
        top, left = (i // 4) * coarse, (i % 4) * coarse
        distance = _distance(row, col, top, left, coarse, disk)
        reach = math.sqrt(0.5) * coarse / PARTS
        if distance + reach < disk.radius:
            continue
        for r in range(top, top + coarse):
            for c in range(left, left + coarse):
                is_open = distance >= disk.radius + reach
                if is_open or _distance(row, col, r, c, 1, disk) + math.sqrt(0.5) / PARTS >= disk.radius:
                    opened[r] |= np.uint16(1 << c)


@njit(cache=True, nogil=True)
def _distance(row: int, col: int, top: int, left: int, size: int, disk: DiskTables) -> float:
    """Return the distance from the middle of a square of parts of a cell to the nearest obstacle.

    Beyond the radius it may be any larger distance.
    """
    x, y = col + (left + 0.5 * size) / PARTS, row + (top + 0.5 * size) / PARTS
    return math.sqrt(squared_gap(x, y, row, col, math.ceil(disk.radius) + 1, 0.0, disk))


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
