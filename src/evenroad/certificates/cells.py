"""Trees of cells that are halved where a path may lead through them, until start and goals are apart.

All cells of one depth are halved along the same joint, so the cells of a depth are alike.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad._time_limit import look_at_clock, require_time_for
from evenroad.certificates.targets import BEYOND, WITHIN, Target, status_of
from evenroad.certificates.witnesses import SPARE, Witnesses, depths, frames_at

BITS = 24
"""A range is 2^BITS units long; no cell has a shorter side than one."""
COARSE = 7
"""Depth of the cells at the beginning, and as much more for each joint but the first."""
MORE = 4.0
"""Paths with up to this many times the unknown cells of the best path are halved, too."""
CLEAR = 1e-6
"""Cost of a clear cell on a path; that of an unknown cell is 1."""
LEAST_TRIED = 256
"""Number of pairs that are tried in small cells; in large ones there are more."""


@dataclass(frozen=True)
class Ranges:
    """Ranges of some columns [rad or m]; endless ones are one turn, which begins where it stops."""

    columns: Ints
    low: Floats
    high: Floats
    endless: Bools

    def units(self, q: Floats) -> Ints:
        """Return where configurations, (n, dim), are, (n, columns)."""
        at = (q[:, self.columns] - self.low) / (self.high - self.low)
        at = np.where(self.endless, np.mod(at, 1.0), at)
        return np.clip(np.floor(at * 2.0**BITS).astype(np.int64), 0, 2**BITS - 1)


@dataclass
class Tree:
    """Cells: depth, lower corner in units, number of the first of two halves or -1, and the pair that blocks it or -1.

    `shifts`, (depths + 1, columns), says how often the cells of a depth are halved along each column.  `rows` are pairs
    that may block a cell that is not halved; `valid` are pairs that block one.  `status`, (cells, targets), says if
    targets are beyond a cell.
    """

    ranges: Ranges
    shifts: Ints
    depth: Ints
    low: Ints
    child: Ints
    pair: Ints
    clear: Bools
    rows: tuple[Ints, Ints]
    targets: tuple[Target, ...]
    status: Ints
    valid: list[tuple[Ints, Ints]] = field(default_factory=list)

    def side(self, depth: Ints) -> Ints:
        """Return the sides of cells of some depths, in units."""
        return np.asarray(2**BITS >> self.shifts[depth], dtype=np.int64)

    def leaves(self) -> Ints:
        """Return the cells that are neither halved nor blocked."""
        return np.flatnonzero((self.child < 0) & (self.pair < 0))

    def keys(self, depth: int, positions: Ints) -> Ints:
        """Return one number for each place, (n, columns), by the cell of a depth that it is in."""
        key = np.zeros(len(positions), dtype=np.int64)
        for k, shift in enumerate(self.shifts[depth].tolist()):
            key = (key << shift) | (positions[:, k] >> (BITS - shift))
        return key

    def find(self, positions: Ints, among: Ints) -> Ints:
        """Return which of some cells hold positions, (n, columns), or -1."""
        found = np.full(len(positions), -1, dtype=np.int64)
        for depth in np.unique(self.depth[among]).tolist():
            here = among[self.depth[among] == depth]
            keys = self.keys(depth, self.low[here])
            order = np.argsort(keys)
            wanted = self.keys(depth, positions)
            index = np.minimum(np.searchsorted(keys[order], wanted), len(here) - 1)
            same = keys[order][index] == wanted
            found[same] = here[order[index[same]]]
        return found

    def neighbours(self, cells: Ints, among: Ints) -> Iterator[tuple[Ints, Ints]]:
        """Yield pairs of some cells and others that share a face with them and are no smaller."""
        by_depth = {depth: among[self.depth[among] == depth] for depth in np.unique(self.depth[among]).tolist()}
        tables = {}
        for depth, here in by_depth.items():
            keys = self.keys(depth, self.low[here])
            order = np.argsort(keys)
            tables[depth] = keys[order], here[order]
        for depth in np.unique(self.depth[cells]).tolist():
            mine = cells[self.depth[cells] == depth]
            side = self.side(np.array(depth))
            for k in range(len(side)):
                for step in (int(side[k]), -1):
                    beside = self.low[mine].copy()
                    beside[:, k] += step
                    if self.ranges.endless[k]:
                        beside[:, k] %= 2**BITS
                    inside = (beside[:, k] >= 0) & (beside[:, k] < 2**BITS)
                    for other in [each for each in tables if each <= depth]:
                        keys, here = tables[other]
                        wanted = self.keys(other, beside)
                        index = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
                        same = inside & (keys[index] == wanted)
                        yield mine[same], here[index[same]]


def tree_of(witnesses: Witnesses, ranges: Ranges, pairs: Ints, targets: tuple[Target, ...]) -> Tree:
    """Return a tree of one cell, which some pairs may block."""
    dim = len(witnesses.robot.group)
    middle = np.zeros((1, dim))
    middle[0, ranges.columns] = 0.5 * (ranges.low + ranges.high)
    cell, lengths = np.zeros(len(pairs), dtype=np.int64), []
    for column, low, high in zip(ranges.columns, ranges.low, ranges.high, strict=True):
        half = np.zeros((1, dim))
        half[0, column] = 0.5 * (high - low)
        lengths.append(float(depths(witnesses, frames_at(witnesses, middle), half, cell, pairs)[1].max()) + 1e-3)
    shifts = [np.zeros(len(lengths), dtype=np.int64)]
    left = np.array(lengths)
    while shifts[-1].max() < BITS - 1 and shifts[-1].sum() < 60:
        # Halved is the side along which half a cell moves bodies farthest.
        k = int(left.argmax())
        left[k] *= 0.5
        shifts.append(shifts[-1] + (np.arange(len(left)) == k))
    none = np.full(1, -1, dtype=np.int64)
    return Tree(
        ranges,
        np.array(shifts),
        np.zeros(1, dtype=np.int64),
        np.zeros((1, len(left)), dtype=np.int64),
        none,
        none.copy(),
        np.zeros(1, dtype=np.bool_),
        (cell, pairs),
        targets,
        np.zeros((1, len(targets)), dtype=np.int64),
    )


def decide(tree: Tree, witnesses: Witnesses, cells: Ints) -> None:
    """Look which of some new cells are blocked and which are clear, and keep the pairs that may block the others."""
    ranges, (row, pair) = tree.ranges, tree.rows
    position = np.full(len(tree.depth), -1, dtype=np.int64)
    position[cells] = np.arange(len(cells))
    new = position[row] >= 0
    side = tree.side(tree.depth[cells]) * ((ranges.high - ranges.low) / 2.0**BITS)
    q, half = (np.zeros((len(cells), len(witnesses.robot.group))) for _ in range(2))
    q[:, ranges.columns] = ranges.low + tree.low[cells] * ((ranges.high - ranges.low) / 2.0**BITS) + 0.5 * side
    half[:, ranges.columns] = 0.5 * side
    cell, tried = position[row[new]], pair[new]
    frames = frames_at(witnesses, q)
    for i, target in enumerate(tree.targets):
        tree.status[cells, i] = status_of(target, witnesses.tree, frames, half)
    deep, moved = depths(witnesses, frames, half, cell, tried)
    shut = deep - moved > SPARE
    tree.valid.append((cells[cell[shut]], tried[shut]))
    tree.pair[cells[cell[shut]]] = tried[shut]
    maybe = (deep + moved > SPARE) & (tree.pair[cells[cell]] < 0)
    clear = np.ones(len(cells), dtype=np.bool_)
    clear[cell[maybe]] = False
    tree.clear[cells] = clear & (tree.pair[cells] < 0)
    # The deepest pairs of each cell, more of them in large cells.
    cell, tried, deep = cell[maybe], tried[maybe], deep[maybe]
    order = np.lexsort((-deep, cell))
    cell, tried = cell[order], tried[order]
    rank = np.arange(len(cell)) - np.searchsorted(cell, cell)
    most = np.maximum(LEAST_TRIED, len(witnesses.pairs.ball) >> (tree.depth[cells[cell]] // 2))
    kept = rank < most
    tree.rows = np.concatenate([row[~new], cells[cell[kept]]]), np.concatenate([pair[~new], tried[kept]])


def halve(tree: Tree, cells: Ints) -> Ints:
    """Halve some cells; return the halves, each of which takes over the pairs that may block its cell."""
    first, count = len(tree.depth), len(cells)
    depth = np.repeat(tree.depth[cells] + 1, 2)
    low = np.repeat(tree.low[cells], 2, axis=0)
    grown = tree.shifts[depth] - tree.shifts[depth - 1]
    low[1::2] += (grown * tree.side(depth))[1::2]
    tree.child[cells] = first + 2 * np.arange(count)
    row, pair = tree.rows
    at = tree.child[row]
    mine = at >= 0
    tree.rows = (
        np.concatenate([row[~mine], at[mine], at[mine] + 1]),
        np.concatenate([pair[~mine], pair[mine], pair[mine]]),
    )
    none = np.full(2 * count, -1, dtype=np.int64)
    tree.depth, tree.low = np.concatenate([tree.depth, depth]), np.concatenate([tree.low, low])
    tree.child, tree.pair = np.concatenate([tree.child, none]), np.concatenate([tree.pair, none])
    tree.clear = np.concatenate([tree.clear, np.zeros(2 * count, dtype=np.bool_)])
    tree.status = np.concatenate([tree.status, np.zeros((2 * count, len(tree.targets)), dtype=np.int64)])
    return np.arange(first, first + 2 * count)


def separate(tree: Tree, witnesses: Witnesses, start: Floats, goals: Floats, most: int) -> Bools:
    """Halve cells until a start, (dim,), is apart from goals, (g, dim), and from the targets; return from which it is.

    A goal that clear cells join with the start is given up; all are, where more than `most` cells would be needed.
    """
    terminals, open_goals = tree.ranges.units(np.vstack([start, goals])), np.arange(len(goals) + len(tree.targets))
    decide(tree, witnesses, np.zeros(1, dtype=np.int64))
    for _ in range(COARSE + 2 * (len(tree.ranges.columns) - 1)):
        cells = tree.leaves()
        decide(tree, witnesses, halve(tree, cells[~tree.clear[cells]]))
    while True:
        look_at_clock()
        leaves = tree.leaves()
        number = np.full(len(tree.depth), -1, dtype=np.int64)
        number[leaves] = np.arange(len(leaves))
        at = tree.find(terminals, leaves)
        if at[0] < 0:
            return np.zeros(len(goals) + len(tree.targets), dtype=np.bool_)
        pairs = number[np.concatenate([np.stack(each) for each in tree.neighbours(leaves, leaves)], axis=1)]
        counts = np.where(tree.clear[leaves], CLEAR, 1.0)
        away = _costs(pairs, counts, np.where(leaves == at[0], counts, np.inf))
        entries = _entries(tree, leaves, at[1:])
        reach = (away + entries).min(axis=1, initial=np.inf)
        apart: Bools = np.isinf(reach)
        open_goals = open_goals[~apart[open_goals] & ~(reach[open_goals] < 0.5)]
        if not len(open_goals):
            return apart
        left = _costs(pairs, counts, counts + entries[open_goals].min(axis=0))
        status = tree.status[leaves][:, open_goals[open_goals >= len(goals)] - len(goals)]
        mixed = ~tree.clear[leaves] | (status != BEYOND).any(axis=1)
        through = away + left - counts
        split = mixed & (through <= MORE * through.min() + 1.0) & (tree.depth[leaves] + 1 < len(tree.shifts))
        if not split.any() or len(tree.depth) + 2 * int(split.sum()) > most:
            return apart
        decide(tree, witnesses, halve(tree, leaves[split]))


def _costs(pairs: Ints, counts: Floats, begin: Floats) -> Floats:
    """Return the least cost of paths to each cell, (n,), that begin in cells at some costs, inf where none does.

    A path goes on between `pairs` of cells, (2, p), and each cell that it enters costs something.
    """
    require_time_for("scipy.sparse.csgraph")
    # Imported here, as most plans need no proof.
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import dijkstra

    first, most = np.flatnonzero(np.isfinite(begin)), len(counts)
    rows = np.concatenate([pairs[0], pairs[1], np.full(len(first), most)])
    columns = np.concatenate([pairs[1], pairs[0], first])
    graph = coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(most + 1,) * 2).tocsr()
    # Pairs of cells of one size come twice.
    graph.data = counts[graph.indices]
    graph.data[graph.indptr[most] :] = begin[graph.indices[graph.indptr[most] :]]
    return np.asarray(dijkstra(graph, indices=most)[:most])


def _entries(tree: Tree, leaves: Ints, goals: Ints) -> Floats:
    """Return what it costs to end at goals, which are in some cells or in none, and at targets, in each cell."""
    at_goals = np.where(leaves == goals[:, np.newaxis], CLEAR, np.inf)
    status = tree.status[leaves].T
    at_targets = np.where(status == BEYOND, np.inf, np.where(status == WITHIN, CLEAR, 1.0))
    return np.concatenate([at_goals, at_targets])
