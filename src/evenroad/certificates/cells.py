"""Trees of cells that are halved where a path may lead through them, until start and goals are apart.

Each cell is halved along the joint that costs the deepest overlap in it most.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad._time_limit import look_at_clock, require_time_for
from evenroad.certificates.targets import BEYOND, WITHIN, Target, status_of
from evenroad.certificates.witnesses import SPARE, Witnesses, depths, frames_at, losses

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
    """Cells: depth, lower corner, sides in units, number of the first of two halves or -1, pair that blocks it or -1.

    `along` is the column along which a cell is best halved.  `rows` are pairs that may block a cell that is not halved;
    `valid` are pairs that block one.  `beside`, (2, p), are cells that are not halved and have a face in common.
    `status`, (cells, targets), says if targets are beyond a cell.
    """

    ranges: Ranges
    depth: Ints
    low: Ints
    side: Ints
    along: Ints
    child: Ints
    pair: Ints
    clear: Bools
    rows: tuple[Ints, Ints]
    beside: Ints
    targets: tuple[Target, ...]
    status: Ints
    valid: list[tuple[Ints, Ints]] = field(default_factory=list)

    def leaves(self) -> Ints:
        """Return the cells that are neither halved nor blocked."""
        return np.flatnonzero((self.child < 0) & (self.pair < 0))

    def find(self, positions: Ints, among: Ints) -> Ints:
        """Return which of some cells hold positions, (n, columns), or -1."""
        low, high = self.low[among], self.low[among] + self.side[among]
        inside = [((low <= position) & (position < high)).all(axis=1) for position in positions]
        return np.array([among[each.argmax()] if each.any() else -1 for each in inside], dtype=np.int64)

    def meet(self, both: Ints) -> Bools:
        """Return which pairs of cells, (2, p), have a face in common."""
        one, two = both
        spans = [np.stack([self.low[each], self.low[each] + self.side[each]]) for each in (one, two)]
        overlap = np.minimum(spans[0][1], spans[1][1]) > np.maximum(spans[0][0], spans[1][0])
        off = (spans[0][1] - spans[1][0]) * (spans[1][1] - spans[0][0]) == 0
        turn = np.abs(spans[0] - spans[1][::-1]) == 2**BITS
        off |= self.ranges.endless & turn.any(axis=0)
        others = overlap.sum(axis=1, keepdims=True) - overlap
        return np.asarray((off & (others == overlap.shape[1] - 1)).any(axis=1))


def tree_of(witnesses: Witnesses, ranges: Ranges, pairs: Ints, targets: tuple[Target, ...]) -> Tree:
    """Return a tree of one cell, which some pairs may block."""
    zero, none, axes = np.zeros(1, dtype=np.int64), np.full(1, -1, dtype=np.int64), len(ranges.columns)
    low, side, cell = np.zeros((1, axes), np.int64), np.full((1, axes), 2**BITS), np.zeros(len(pairs), np.int64)
    status, nowhere = np.zeros((1, len(targets)), np.int64), np.zeros((2, 0), np.int64)
    clear = np.zeros(1, dtype=np.bool_)
    return Tree(ranges, zero, low, side, zero, none, none.copy(), clear, (cell, pairs), nowhere, targets, status)


def decide(tree: Tree, witnesses: Witnesses, cells: Ints) -> None:
    """Look which of some new cells are blocked and which are clear, and keep the pairs that may block the others."""
    if not len(cells):
        return
    ranges, (row, pair) = tree.ranges, tree.rows
    position = np.full(len(tree.depth), -1, dtype=np.int64)
    position[cells] = np.arange(len(cells))
    new = position[row] >= 0
    unit = (ranges.high - ranges.low) / 2.0**BITS
    q, half = (np.zeros((len(cells), len(witnesses.robot.group))) for _ in range(2))
    q[:, ranges.columns] = ranges.low + (tree.low[cells] + 0.5 * tree.side[cells]) * unit
    half[:, ranges.columns] = 0.5 * tree.side[cells] * unit
    cell, tried = position[row[new]], pair[new]
    frames = frames_at(witnesses, q)
    for i, target in enumerate(tree.targets):
        tree.status[cells, i] = status_of(target, witnesses.tree, frames, half)
    deep, least, moved = depths(witnesses, frames, half, cell, tried)
    shut = least > SPARE
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
    first = rank == 0
    widest = (tree.side[cells] * unit).argmax(axis=1)
    tree.along[cells] = widest
    lost = losses(witnesses, frames, half, cell[first], tried[first])
    lost[tree.side[cells[cell[first]]] < 2] = -np.inf
    tree.along[cells[cell[first]]] = lost.argmax(axis=1)
    # What is not known of a target depends on all joints alike: every other time it decides.
    unsure = (tree.status[cells] != BEYOND).any(axis=1) & (tree.depth[cells] % 2 == 1)
    tree.along[cells[unsure]] = widest[unsure]
    most = np.maximum(LEAST_TRIED, len(witnesses.pairs.ball) >> (tree.depth[cells[cell]] // 2))
    kept = rank < most
    tree.rows = np.concatenate([row[~new], cells[cell[kept]]]), np.concatenate([pair[~new], tried[kept]])


def halve(tree: Tree, cells: Ints) -> Ints:
    """Halve some cells; return the halves, each of which takes over the pairs that may block its cell."""
    first, count = len(tree.depth), len(cells)
    low, side = np.repeat(tree.low[cells], 2, axis=0), np.repeat(tree.side[cells], 2, axis=0)
    rows, along = np.arange(2 * count), np.repeat(tree.along[cells], 2)
    side[rows, along] //= 2
    low[rows[1::2], along[1::2]] += side[rows[1::2], along[1::2]]
    tree.child[cells] = first + 2 * np.arange(count)
    row, pair = tree.rows
    at = tree.child[row]
    mine = at >= 0
    tree.rows = (
        np.concatenate([row[~mine], at[mine], at[mine] + 1]),
        np.concatenate([pair[~mine], pair[mine], pair[mine]]),
    )
    none = np.full(2 * count, -1, dtype=np.int64)
    tree.depth = np.concatenate([tree.depth, np.repeat(tree.depth[cells] + 1, 2)])
    tree.low, tree.side = np.concatenate([tree.low, low]), np.concatenate([tree.side, side])
    tree.along = np.concatenate([tree.along, none])
    tree.child, tree.pair = np.concatenate([tree.child, none]), np.concatenate([tree.pair, none])
    tree.clear = np.concatenate([tree.clear, np.zeros(2 * count, dtype=np.bool_)])
    tree.status = np.concatenate([tree.status, np.zeros((2 * count, len(tree.targets)), dtype=np.int64)])
    beside = tree.beside
    for end in (0, 1):
        # The halves of a cell take its place in each pair.
        at = tree.child[beside[end]]
        grown = np.repeat(beside[:, at >= 0], 2, axis=1)
        grown[end] = np.repeat(at[at >= 0], 2) + np.tile([0, 1], int((at >= 0).sum()))
        beside = np.concatenate([beside[:, at < 0], grown[:, tree.meet(grown)]], axis=1)
    halves = tree.child[cells] + np.array([[0], [1]])
    tree.beside = np.concatenate([beside, halves], axis=1)
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
        pairs = number[tree.beside]
        pairs = pairs[:, (pairs >= 0).all(axis=0)]
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
        split = mixed & (through <= MORE * through.min() + 1.0) & (tree.side[leaves].max(axis=1) > 1)
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
