"""The compiled planner of a disk on a grid: components, a way over a lattice of points, and straightening it.

Ways are made of map points, so that what is tested is what is returned.  A *lattice* of step h has its points at
``first + h * (column, row)`` of the padded pixel plane (see `cells`): cell centres for h = 1, and those, corners and
middles of sides for h = 1/2.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad.world.gridmap.cells import BLOCKED, FREE, DiskTables
from evenroad.world.gridmap.kernel import point_is_free, to_padded, way_is_free

STRAIGHT, DIAGONAL, KNIGHT = 10, 14, 22
"""Costs of the steps of a lattice, near 10 times their lengths and never above them by more than rounding."""

_BUCKETS = 64
"""More than the largest step of the key of A*, twice the dearest step: a key names its bucket."""

STEPS = np.array(
    [
        (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1),
        (2, 1), (2, -1), (-2, 1), (-2, -1), (1, 2), (1, -2), (-1, 2), (-1, -2),
    ]
)  # fmt: skip
"""Column and row of each step; the first eight are those of a king."""

_LINKS = 24
"""Lattice points that an end is linked to."""


@njit(cache=True, nogil=True)
def label_components(cells: npt.NDArray[np.uint8]) -> npt.NDArray[np.int32]:
    """Return the component of each cell that is not surely blocked, from 1 on, and 0 for those that are.

    Cells hang together over their sides.  A disk whose centre goes over a corner from cell to cell touches all four
    cells there, so none of them is surely blocked: two components are apart for certain.
    """
    rows, cols = cells.shape
    label = np.zeros((rows, cols), np.int32)
    stack = np.empty(rows * cols, np.int64)
    last = 0
    for row in range(rows):
        for col in range(cols):
            if cells[row, col] == BLOCKED or label[row, col] != 0:
                continue
            last += 1
            label[row, col] = last
            stack[0] = row * cols + col
            size = 1
            while size > 0:
                size -= 1
                r, c = divmod(stack[size], cols)
                # The ring of the padded grid is blocked: neighbours never leave the array.
                for dr, dc in ((1, 0), (-1, 0), (0, 1), (0, -1)):
                    if cells[r + dr, c + dc] != BLOCKED and label[r + dr, c + dc] == 0:
                        label[r + dr, c + dc] = last
                        stack[size] = (r + dr) * cols + c + dc
                        size += 1
    return label


@njit(cache=True, nogil=True)
def nearest_free_point(x: float, y: float, disk: DiskTables) -> tuple[float, float]:
    """Return the point of surely free cells, or of the half lattice elsewhere, that is nearest to (x, y); else nan."""
    rows, cols = disk.cells.shape
    col, row = min(max(int(x), 1), cols - 2), min(max(int(y), 1), rows - 2)
    best, best_x, best_y = np.inf, np.nan, np.nan
    for ring in range(max(rows, cols)):
        if (ring - 1.0) > math.sqrt(best) and ring > 1:
            break
        for r in range(max(row - ring, 1), min(row + ring, rows - 2) + 1):
            step = 1 if abs(r - row) == ring else 2 * ring
            for c in range(col - ring, col + ring + 1, max(step, 1)):
                if c < 1 or c > cols - 2 or disk.cells[r, c] == BLOCKED:
                    continue
                if disk.cells[r, c] >= FREE:
                    # Not onto the sides of the cell, where rounding decides whose they are.
                    near_x, near_y = min(max(x, c + 1e-6), c + 1 - 1e-6), min(max(y, r + 1e-6), r + 1 - 1e-6)
                    squared = (near_x - x) ** 2 + (near_y - y) ** 2
                    if squared < best:
                        best, best_x, best_y = squared, near_x, near_y
                    continue
                for i in range(9):
                    near_x, near_y = c + 0.5 * (i % 3), r + 0.5 * (i // 3)
                    squared = (near_x - x) ** 2 + (near_y - y) ** 2
                    if squared < best and point_is_free(near_x, near_y, disk):
                        best, best_x, best_y = squared, near_x, near_y
    return best_x, best_y


@njit(cache=True, nogil=True)
def find_way(
    start: Any, goals: Any, disk: DiskTables, step: float, first: float, most: int
) -> tuple[npt.NDArray[np.float64], int, int, int]:
    """Find a way over a lattice from a free point, (2,), to the one of some free points, (g, 2), that is nearest on it.

    A* over whole-number costs with buckets for the queue; a step between surely free cells that share a side or a
    corner needs no check, every other one is tested exactly.

    Returns
    -------
    way : (p, 2)
        Map points, start and goal included; (0, 2) when there is none.
    goal : int
        Which goal, or -1.
    expanded, motions : int
        Lattice points looked at from, and motions tested; the search ends when `most` are.
    """
    rows, cols = disk.cells.shape
    high, wide = int((rows - first) / step) + 1, int((cols - first) / step) + 1
    steps = 8 if step == 1.0 else 16
    reached = np.full(high * wide, -1, np.int32)
    came = np.zeros(high * wide, np.int8)
    closed = np.zeros(high * wide, np.bool_)
    ends = np.full(high * wide, -1, np.int32)
    targets = np.empty((len(goals), 2))
    motions = 0
    for g in range(len(goals)):
        x, y = to_padded(goals[g, 0], goals[g, 1], disk.frame)
        targets[g, 0], targets[g, 1] = (x - first) / step, (y - first) / step
        linked, tried = _links(goals[g, 0], goals[g, 1], disk, step, first, high, wide)
        motions += tried
        for node in linked:
            if ends[node] < 0:
                ends[node] = g
    heads = np.full(_BUCKETS, -1, np.int64)
    entries = np.empty(4096, np.int64)
    links = np.empty(4096, np.int64)
    size, waiting, key = 0, 0, 2**60
    linked, tried = _links(start[0], start[1], disk, step, first, high, wide)
    motions += tried
    seeds = np.empty(len(linked), np.int64)
    x, y = to_padded(start[0], start[1], disk.frame)
    for i in range(len(linked)):
        node = linked[i]
        r, c = divmod(node, wide)
        away = math.hypot(first + step * c - x, first + step * r - y) / step
        reached[node] = int(10.0 * away)
        came[node] = -1
        seeds[i] = reached[node] + _left(c, r, targets)
        key = min(key, seeds[i])
    # The keys of the seeds may lie far apart, as no two steps of the search do: late ones count as less near.
    for i in range(len(linked)):
        bucket = min(seeds[i], key + _BUCKETS // 2 - 1) % _BUCKETS
        entries[size], links[size] = linked[i], heads[bucket]
        heads[bucket] = size
        size += 1
        waiting += 1
    expanded = 0
    while waiting > 0 and motions < most:
        bucket = key % _BUCKETS
        if heads[bucket] < 0:
            key += 1
            continue
        entry = heads[bucket]
        heads[bucket] = links[entry]
        waiting -= 1
        node = entries[entry]
        if closed[node]:
            continue
        closed[node] = True
        expanded += 1
        if ends[node] >= 0:
            way = _trace(node, came, wide, start, goals[ends[node]], step, first, disk)
            return way, ends[node], expanded, motions
        r, c = divmod(node, wide)
        x, y = first + step * c, first + step * r
        sure = disk.cells[int(y), int(x)] >= FREE
        for s in range(steps):
            to_c, to_r = c + STEPS[s, 0], r + STEPS[s, 1]
            if to_c < 0 or to_r < 0 or to_c >= wide or to_r >= high:
                continue
            to = to_r * wide + to_c
            cost = reached[node] + (STRAIGHT if s < 4 else DIAGONAL if s < 8 else KNIGHT)
            if closed[to] or (0 <= reached[to] <= cost):
                continue
            to_x, to_y = first + step * to_c, first + step * to_r
            if not (1.0 < to_x < cols - 1.0 and 1.0 < to_y < rows - 1.0):
                continue
            state = disk.cells[int(to_y), int(to_x)]
            if step == 1.0 and sure and state >= FREE:
                pass
            elif state == BLOCKED:
                continue
            else:
                motions += 1
                from_x, from_y = _to_map(x, y, disk.frame)
                to_x, to_y = _to_map(to_x, to_y, disk.frame)
                if not _free_between(from_x, from_y, to_x, to_y, disk):
                    continue
            reached[to] = cost
            came[to] = s
            bucket = max(cost + _left(to_c, to_r, targets), key) % _BUCKETS
            if size == len(entries):
                entries, links = _twice(entries), _twice(links)
            entries[size], links[size] = to, heads[bucket]
            heads[bucket] = size
            size += 1
            waiting += 1
    return np.empty((0, 2)), -1, expanded, motions


@njit(cache=True, nogil=True)
def straighten(way: Any, disk: DiskTables, spreads: Any) -> tuple[npt.NDArray[np.float64], int]:
    """Return a shorter way of free motions between the same ends, and how many motions were tested.

    First from each point on to the farthest that is found to be in sight; then rounds of points spread evenly along
    the way, of which the shortest selection that stays free is kept.
    """
    points, motions = _skip_ahead(way, disk)
    for most in spreads:
        for _ in range(8):
            before = _length(points)
            shorter, tried = _best_selection(_spread(points, most), disk)
            motions += tried
            after = _length(shorter)
            # Never more points for the same length: what could not be selected comes back as it was spread.
            if not after < before:
                break
            points = shorter
            if before - after < 1e-3 * before:
                break
    return points, motions


@njit(cache=True, nogil=True)
def _links(
    x: float, y: float, disk: DiskTables, step: float, first: float, high: int, wide: int
) -> tuple[list[int], int]:
    """Return the lattice points near (x, y) that can be reached straight, and how many were tried."""
    px, py = to_padded(x, y, disk.frame)
    near_c, near_r = round((px - first) / step), round((py - first) / step)
    linked = [np.int64(0)]
    linked.clear()
    tried = 0
    for ring in range(7):
        for r in range(max(near_r - ring, 0), min(near_r + ring, high - 1) + 1):
            for c in range(max(near_c - ring, 0), min(near_c + ring, wide - 1) + 1):
                if max(abs(r - near_r), abs(c - near_c)) != ring:
                    continue
                tried += 1
                to_x, to_y = _to_map(first + step * c, first + step * r, disk.frame)
                if _free_between(x, y, to_x, to_y, disk):
                    linked.append(np.int64(r * wide + c))
        if len(linked) >= _LINKS:
            break
    return linked, tried


@njit(cache=True, nogil=True)
def _left(c: int, r: int, targets: Any) -> int:
    """Return the least cost from a lattice point to the nearest target, all in steps."""
    least = 1e18
    for g in range(len(targets)):
        along, across = abs(targets[g, 0] - c), abs(targets[g, 1] - r)
        least = min(least, 10.0 * max(along, across) + 4.0 * min(along, across))
    return int(0.98 * least)


@njit(cache=True, nogil=True)
def _trace(
    node: int, came: Any, wide: int, start: Any, goal: Any, step: float, first: float, disk: DiskTables
) -> Any:
    count = 3
    at = node
    while came[at] >= 0:
        at -= STEPS[came[at], 1] * wide + STEPS[came[at], 0]
        count += 1
    way = np.empty((count, 2))
    way[0, 0], way[0, 1], way[-1, 0], way[-1, 1] = start[0], start[1], goal[0], goal[1]
    at = node
    for i in range(count - 2, 0, -1):
        way[i, 0], way[i, 1] = _to_map(first + step * (at % wide), first + step * (at // wide), disk.frame)
        if came[at] >= 0:
            at -= STEPS[came[at], 1] * wide + STEPS[came[at], 0]
    return way


@njit(cache=True, nogil=True)
def _twice(array: Any) -> Any:
    larger = np.empty(2 * len(array), array.dtype)
    larger[: len(array)] = array
    return larger


@njit(cache=True, nogil=True)
def _free_between(ax: float, ay: float, bx: float, by: float, disk: DiskTables) -> bool:
    """Say whether the motion between two map points is free, as `motions_are_free` does."""
    ax, ay = to_padded(ax, ay, disk.frame)
    bx, by = to_padded(bx, by, disk.frame)
    if not point_is_free(ax, ay, disk) or not point_is_free(bx, by, disk):
        return False
    if bx < ax or (bx == ax and by < ay):
        return way_is_free(bx, by, ax, ay, disk)
    return way_is_free(ax, ay, bx, by, disk)


@njit(cache=True, nogil=True)
def _to_map(column: float, row: float, frame: Any) -> tuple[float, float]:
    """Return the map point at padded coordinates, as `MapFrame.to_map` does for the map's own."""
    along, down = (column - 1.0) * frame[6], (row - 1.0 - frame[7]) * frame[6]
    return frame[0] + frame[2] * along + frame[4] * down, frame[1] + frame[3] * along + frame[5] * down


@njit(cache=True, nogil=True)
def _skip_ahead(way: Any, disk: DiskTables) -> tuple[npt.NDArray[np.float64], int]:
    kept = [0]
    motions = 0
    at, last = 0, len(way) - 1
    while at < last:
        # Steps of the way itself are free; farther ones are tried at 2, 4, 8, ... until one is not, then halved.
        near, far = at + 1, at + 1
        stride = 2
        while near < last:
            far = min(at + stride, last)
            motions += 1
            if not _free_between(way[at, 0], way[at, 1], way[far, 0], way[far, 1], disk):
                break
            near = far
            stride *= 2
        while far - near > 1:
            middle = (near + far) // 2
            motions += 1
            if _free_between(way[at, 0], way[at, 1], way[middle, 0], way[middle, 1], disk):
                near = middle
            else:
                far = middle
        at = near
        kept.append(at)
    points = np.empty((len(kept), 2))
    for i in range(len(kept)):
        points[i] = way[kept[i]]
    return points, motions


@njit(cache=True, nogil=True)
def _length(points: Any) -> float:
    total = 0.0
    for i in range(len(points) - 1):
        total += math.hypot(points[i + 1, 0] - points[i, 0], points[i + 1, 1] - points[i, 1])
    return total


@njit(cache=True, nogil=True)
def _spread(points: Any, most: int) -> Any:
    """Return the points with evenly spread ones between them, about `most` in all."""
    total, spare = _length(points), max(most - len(points), 0)
    extra = np.zeros(len(points), np.int64)
    for i in range(len(points) - 1):
        piece = math.hypot(points[i + 1, 0] - points[i, 0], points[i + 1, 1] - points[i, 1])
        extra[i] = int(spare * piece / total) if total > 0.0 else 0
    spread = np.empty((len(points) + extra.sum(), 2))
    at = 0
    for i in range(len(points)):
        for k in range(extra[i] + 1):
            t = k / (extra[i] + 1)
            following = points[min(i + 1, len(points) - 1)]
            spread[at, 0] = (1.0 - t) * points[i, 0] + t * following[0]
            spread[at, 1] = (1.0 - t) * points[i, 1] + t * following[1]
            at += 1
    return spread


@njit(cache=True, nogil=True)
def _best_selection(points: Any, disk: DiskTables) -> tuple[npt.NDArray[np.float64], int]:
    """Return the shortest selection of the points, in their order, whose motions are free."""
    count = len(points)
    length = np.full(count, np.inf)
    before = np.zeros(count, np.int64)
    length[0] = 0.0
    motions = 0
    for j in range(1, count):
        # From the first on: what skips most is found first, and what it beats needs no test.
        for i in range(j):
            through = length[i] + math.hypot(points[j, 0] - points[i, 0], points[j, 1] - points[i, 1])
            if through >= length[j]:
                continue
            # Pieces of a free motion, too: their ends are rounded.
            motions += 1
            if not _free_between(points[i, 0], points[i, 1], points[j, 0], points[j, 1], disk):
                continue
            length[j], before[j] = through, i
    if not np.isfinite(length[count - 1]):
        return points, motions
    kept = 1
    at = count - 1
    while at > 0:
        at = before[at]
        kept += 1
    chosen = np.empty((kept, 2))
    at = count - 1
    for i in range(kept - 1, -1, -1):
        chosen[i] = points[at]
        at = before[at]
    return chosen, motions
