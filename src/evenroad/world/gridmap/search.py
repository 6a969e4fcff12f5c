"""The compiled planner of a disk on a grid: a path over a lattice of points, and its smoothing.

Paths are made of map points, so that what is tested is what is returned.  They lead over the *half lattice*, the points
``(column / 2, row / 2)`` of the padded pixel plane (see `cells`): over the centres of surely free cells, and over all
of its points at *gates*, where components of such cells come close to each other (see `components`).  The narrowest
place of a gate is the middle between two corners or sides of squares, which is a point of the half lattice.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad._njit import njit
from evenroad.world.gridmap.cells import BLOCKED, FREE, DiskTables
from evenroad.world.gridmap.kernel import free_between, to_padded

_BUCKETS = 64
"""Number of buckets of A*'s queue: more than the largest step of a key, twice the costliest step."""

STEPS = np.array(
    [
        (2, 0), (-2, 0), (0, 2), (0, -2), (2, 2), (2, -2), (-2, 2), (-2, -2),
        (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1),
        (2, 1), (2, -1), (-2, 1), (-2, -1), (1, 2), (1, -2), (-1, 2), (-1, -2),
    ]
)  # fmt: skip
"""Columns and rows of each step on the half lattice; the first eight lead from cell to cell."""

COSTS = np.array([10] * 4 + [14] * 4 + [5] * 4 + [7] * 4 + [11] * 8)
"""Costs of the steps: about ten times their lengths in pixels."""
_LINKS = 24
"""Number of lattice points that a start or goal is linked to."""


class _Search(NamedTuple):
    """A* over whole-number costs: of each lattice point its cost, -1 before it is reached, the step it came by, whether
    it is done with; first entries of the buckets of the queue.
    """

    reached: Any
    came: Any
    closed: Any
    heads: Any


@njit(cache=True, nogil=True)
def find_path(
    start: Any, goals: Any, disk: DiskTables, gates: Bools, most: int
) -> tuple[Floats, int, int, int]:
    """Find a path over the half lattice from a free point, (2,), to the nearest on it of others, (g, 2).

    A* over whole-number costs with buckets for the queue; a step between surely free cells that share a side or a
    corner needs no check, every other one is tested exactly.  Given back are the path in map points, start and goal
    included, (p, 2); which goal, or -1 and an empty path; how many lattice points were looked at from; and how many
    motions tested: the search ends when `most` are.
    """
    rows, cols = disk.cells.shape
    wide = 2 * cols + 1
    nodes = (2 * rows + 1) * wide
    search = _Search(
        np.full(nodes, -1, np.int32),
        np.zeros(nodes, np.int8),
        np.zeros(nodes, np.bool_),
        np.full(_BUCKETS, -1, np.int64),
    )
    goal_of, targets, motions = _goal_nodes(goals, nodes, disk, gates)
    entries, links, waiting, key, tried = _seeded(start, targets, search, disk, gates)
    size, motions, expanded = waiting, motions + tried, 0
    while waiting > 0 and motions < most:
        bucket = key % _BUCKETS
        if search.heads[bucket] < 0:
            key += 1
            continue
        entry = search.heads[bucket]
        search.heads[bucket] = links[entry]
        waiting -= 1
        node = entries[entry]
        if search.closed[node]:
            continue
        search.closed[node] = True
        expanded += 1
        if goal_of[node] >= 0:
            path = _trace(node, search.came, wide, start, goals[goal_of[node]], disk)
            return path, goal_of[node], expanded, motions
        r, c = divmod(node, wide)
        at_gate = _is_at_gate(r, c, gates)
        for s in range(0 if _is_centre(r, c, disk) else 8, len(STEPS) if at_gate else 8):
            to_c, to_r = c + STEPS[s, 0], r + STEPS[s, 1]
            # Never out of the array: nothing is free on its ring.
            to = to_r * wide + to_c
            cost = search.reached[node] + COSTS[s]
            if search.closed[to] or (0 <= search.reached[to] <= cost):
                continue
            if s < 8:
                if not _is_centre(to_r, to_c, disk):
                    continue
            else:
                if not _is_at_gate(to_r, to_c, gates) or disk.cells[to_r // 2, to_c // 2] == BLOCKED:
                    continue
                motions += 1
                if not _is_step_free(c, r, to_c, to_r, disk):
                    continue
            search.reached[to] = cost
            search.came[to] = s
            bucket = max(cost + _left(to_c, to_r, targets), key) % _BUCKETS
            if size == len(entries):
                entries, links = np.append(entries, entries), np.append(links, links)  # twice the room
            entries[size], links[size] = to, search.heads[bucket]
            search.heads[bucket] = size
            size += 1
            waiting += 1
    return np.empty((0, 2)), -1, expanded, motions


@njit(cache=True, nogil=True)
def _goal_nodes(goals: Any, nodes: int, disk: DiskTables, gates: Bools) -> tuple[Any, Any, int]:
    """Return to which goal each lattice point leads, -1 to none, the goals on the lattice, and the motions tested."""
    goal_of = np.full(nodes, -1, np.int32)
    targets = np.empty((len(goals), 2))
    motions = 0
    for g in range(len(goals)):
        x, y = to_padded(goals[g, 0], goals[g, 1], disk.frame)
        targets[g, 0], targets[g, 1] = 2.0 * x, 2.0 * y
        linked, tried = _links(goals[g, 0], goals[g, 1], disk, gates)
        motions += tried
        for node in linked:
            if goal_of[node] < 0:
                goal_of[node] = g
    return goal_of, targets, motions


@njit(cache=True, nogil=True)
def _seeded(
    start: Any, targets: Any, search: _Search, disk: DiskTables, gates: Bools
) -> tuple[Any, Any, int, int, int]:
    """Put the lattice points near the start into the queue: its entries and their links, how many, the least key."""
    wide = 2 * disk.cells.shape[1] + 1
    entries = np.empty(4096, np.int64)
    links = np.empty(4096, np.int64)
    linked, tried = _links(start[0], start[1], disk, gates)
    seeds, key = np.empty(len(linked), np.int64), 2**60
    x, y = to_padded(start[0], start[1], disk.frame)
    for i in range(len(linked)):
        node = linked[i]
        r, c = divmod(node, wide)
        search.reached[node] = int(10.0 * math.hypot(0.5 * c - x, 0.5 * r - y))
        search.came[node] = -1
        seeds[i] = search.reached[node] + _left(c, r, targets)
        key = min(key, seeds[i])
    # The keys of the seeds may lie far apart, as no two steps of the search do: late ones count as less near.
    for i in range(len(linked)):
        bucket = min(seeds[i], key + _BUCKETS // 2 - 1) % _BUCKETS
        entries[i], links[i] = linked[i], search.heads[bucket]
        search.heads[bucket] = i
    return entries, links, len(linked), key, tried


@njit(cache=True, nogil=True)
def _is_step_free(c: int, r: int, to_c: int, to_r: int, disk: DiskTables) -> bool:
    """Say whether the motion between two lattice points is free."""
    x, y = _to_map(0.5 * c, 0.5 * r, disk.frame)
    to_x, to_y = _to_map(0.5 * to_c, 0.5 * to_r, disk.frame)
    return free_between(x, y, to_x, to_y, disk)


@njit(cache=True, nogil=True)
def straighten(path: Any, disk: DiskTables, spreads: Any) -> tuple[Floats, int]:
    """Return a shorter path of free motions between the same endpoints, and the number of motions tested.

    First each point is joined to the farthest visible one; then rounds of points spread evenly along the path follow,
    of which the shortest free selection is kept.
    """
    points, motions = _skip_ahead(path, disk)
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
    # Points on the path, or nearly so, are not needed.
    points, tried = _skip_ahead(points, disk)
    return points, motions + tried


@njit(cache=True, nogil=True)
def _links(x: float, y: float, disk: DiskTables, gates: Bools) -> tuple[Any, int]:
    """Return the lattice points near (x, y) that straight motions reach, and the number tried."""
    px, py = to_padded(x, y, disk.frame)
    rows, cols = disk.cells.shape
    near_c, near_r = round(2.0 * px), round(2.0 * py)
    linked = [np.int64(0)]
    linked.clear()
    tried = 0
    for ring in range(13):
        for r in range(max(near_r - ring, 0), min(near_r + ring, 2 * rows - 1) + 1):
            for c in range(max(near_c - ring, 0), min(near_c + ring, 2 * cols - 1) + 1):
                if max(abs(r - near_r), abs(c - near_c)) != ring:
                    continue
                if not _is_centre(r, c, disk) and not _is_at_gate(r, c, gates):
                    continue
                tried += 1
                to_x, to_y = _to_map(0.5 * c, 0.5 * r, disk.frame)
                if free_between(x, y, to_x, to_y, disk):
                    linked.append(np.int64(r * (2 * cols + 1) + c))
        if len(linked) >= _LINKS:
            break
    return linked, tried


@njit(cache=True, nogil=True)
def _left(c: int, r: int, targets: Any) -> int:
    """Return the least cost from a lattice point to the nearest target, in half pixels as `c` and `r` are."""
    least = 1e18
    for g in range(len(targets)):
        along, across = abs(targets[g, 0] - c), abs(targets[g, 1] - r)
        least = min(least, 5.0 * max(along, across) + 2.0 * min(along, across))
    return int(0.97 * least)


@njit(cache=True, nogil=True)
def _is_centre(r: int, c: int, disk: DiskTables) -> bool:
    """Say whether a point of the half lattice is the centre of a surely free cell."""
    return r % 2 == 1 and c % 2 == 1 and disk.cells[r // 2, c // 2] >= FREE


@njit(cache=True, nogil=True)
def _is_at_gate(r: int, c: int, gates: Bools) -> bool:
    """Say whether a point of the half lattice lies in a cell of a gate, or between two."""
    return gates[r // 2, c // 2] or gates[(r - 1) // 2, (c - 1) // 2]


@njit(cache=True, nogil=True)
def _trace(node: int, came: Any, wide: int, start: Any, goal: Any, disk: DiskTables) -> Any:
    nodes = [node]
    while came[nodes[-1]] >= 0:
        step = STEPS[came[nodes[-1]]]
        nodes.append(nodes[-1] - step[1] * wide - step[0])
    path = np.empty((len(nodes) + 2, 2))
    path[0], path[-1] = start, goal
    for i in range(len(nodes)):
        r, c = divmod(nodes[-1 - i], wide)
        path[i + 1, 0], path[i + 1, 1] = _to_map(0.5 * c, 0.5 * r, disk.frame)
    return path


@njit(cache=True, nogil=True)
def _to_map(column: float, row: float, frame: Any) -> tuple[float, float]:
    """Return the map point at padded coordinates, as `MapFrame.to_map` does for the map's own."""
    along, down = (column - 1.0) * frame[6], (row - 1.0 - frame[7]) * frame[6]
    return frame[0] + frame[2] * along + frame[4] * down, frame[1] + frame[3] * along + frame[5] * down


@njit(cache=True, nogil=True)
def _skip_ahead(path: Any, disk: DiskTables) -> tuple[Floats, int]:
    kept = [0]
    motions = 0
    at, last = 0, len(path) - 1
    while at < last:
        # Steps of the path itself are free; farther ones are tried at 2, 4, 8, ... until one is not, then halved.
        near, far = at + 1, at + 1
        stride = 2
        while near < last:
            far = min(at + stride, last)
            motions += 1
            if not free_between(path[at, 0], path[at, 1], path[far, 0], path[far, 1], disk):
                break
            near = far
            stride *= 2
        while far - near > 1:
            middle = (near + far) // 2
            motions += 1
            if free_between(path[at, 0], path[at, 1], path[middle, 0], path[middle, 1], disk):
                near = middle
            else:
                far = middle
        at = near
        kept.append(at)
    return path[np.array(kept)], motions


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
def _best_selection(points: Any, disk: DiskTables) -> tuple[Floats, int]:
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
            if not free_between(points[i, 0], points[i, 1], points[j, 0], points[j, 1], disk):
                continue
            length[j], before[j] = through, i
    if not np.isfinite(length[count - 1]):
        return points, motions
    chosen = [count - 1]
    while chosen[-1] > 0:
        chosen.append(before[chosen[-1]])
    return points[np.array(chosen[::-1])], motions
