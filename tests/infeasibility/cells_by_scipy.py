"""The search of cells as SciPy makes it: slow, and readable."""

from collections.abc import Iterator

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from evenroad._arrays import Bools, Floats, Ints
from evenroad.infeasibility.adaptive_cells import COARSE
from evenroad.infeasibility.prefix_cells import Bodies, Cells, CellTests, cells_around, first_links

CLEAR = 1e-7
"""Cost of a clear cell on a path; that of an unknown cell is 1."""
DEEPEST = 12
"""Largest number of times a cell is split."""


class Leaves:
    """Cells that are not blocked: how often each was split, its number along each joint, and whether it is clear."""

    def __init__(self, cells: Cells) -> None:
        self.cells = cells
        self.level, self.number = np.empty(0, dtype=np.int64), np.empty((0, len(cells.count)), dtype=np.int64)
        self.clear = np.empty(0, dtype=np.bool_)

    def __len__(self) -> int:
        return len(self.level)

    def add(self, level: Ints, number: Ints, clear: Bools) -> None:
        self.level, self.number = np.concatenate([self.level, level]), np.concatenate([self.number, number])
        self.clear = np.concatenate([self.clear, clear])

    def keep(self, these: Bools) -> None:
        self.level, self.number, self.clear = self.level[these], self.number[these], self.clear[these]

    def keys(self, level: int, number: Ints) -> Ints:
        """Return one number for each cell of a level."""
        keys: Ints = np.ravel_multi_index(tuple(number.T), tuple((self.cells.count << level).tolist()))
        return keys

    def find(self, q: Floats) -> int:
        """Return the cell that holds values, (joints,), or -1."""
        for level in np.unique(self.level).tolist():
            fine = Cells(self.cells.low, self.cells.high, self.cells.count << level, self.cells.period)
            cell = fine.cell(q)
            if cell is not None:
                here = np.flatnonzero((self.level == level) & (self.number == cell).all(axis=1))
                if len(here):
                    return int(here[0])
        return -1

    def neighbours(self) -> Iterator[tuple[Ints, Ints]]:
        """Yield pairs of cells that share a side, each pair at least once; the second is at least as large."""
        levels = np.unique(self.level).tolist()
        rows = {level: np.flatnonzero(self.level == level) for level in levels}
        sorted_keys = {}
        for level in levels:
            keys = self.keys(level, self.number[rows[level]])
            order = np.argsort(keys)
            sorted_keys[level] = keys[order], rows[level][order]
        for level in levels:
            count = self.cells.count << level
            for k in range(len(count)):
                for step in (-1, 1):
                    beside = self.number[rows[level]].copy()
                    beside[:, k] += step
                    if self.cells.whole[k]:
                        beside[:, k] %= count[k]
                    inside = (beside[:, k] >= 0) & (beside[:, k] < count[k])
                    mine, beside = rows[level][inside], beside[inside]
                    for other in [each for each in levels if each <= level]:
                        keys, cells = sorted_keys[other]
                        wanted = self.keys(other, beside >> (level - other))
                        index = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
                        same = keys[index] == wanted
                        yield mine[same], cells[index[same]]


def ended(bodies: Bodies, start: Floats, goals: Floats, joints: int, most: int) -> str:
    """Return what `search_cells` does, by graphs of SciPy."""
    first = first_links(bodies.robot, joints)
    cells = cells_around(first, start[:joints], np.full(joints, np.inf), COARSE * joints**2)
    leaves, tests = Leaves(cells), CellTests(bodies, first)
    corner = np.stack(np.meshgrid(*(np.arange(2),) * joints, indexing="ij"), axis=-1).reshape(-1, joints)
    new = np.stack(np.meshgrid(*map(np.arange, cells.count), indexing="ij"), axis=-1).reshape(-1, joints)
    level = np.zeros(len(new), dtype=np.int64)
    while True:
        for depth in np.unique(level).tolist():
            here = new[level == depth]
            size = cells.size / 2**depth
            middles = cells.low + (here + 0.5) * size
            kept = tests.unblocked(0.5 * size, middles)
            leaves.add(np.full(int(kept.sum()), depth), here[kept], tests.clear(0.5 * size, middles[kept]))
        terminals = [leaves.find(start[:joints])], [leaves.find(goal[:joints]) for goal in goals]
        if min(map(min, terminals)) < 0:
            # A free configuration outside of all cells contradicts the checks.
            return "undecided"
        one, two = map(np.concatenate, zip(*leaves.neighbours(), strict=True))
        counts = np.where(leaves.clear, CLEAR, 1.0)
        rows, columns = np.concatenate([one, two]), np.concatenate([two, one])
        graph = coo_matrix((counts[columns], (rows, columns)), shape=(len(leaves),) * 2).tocsr()
        # Pairs of cells of the same size occur twice.
        graph.data = counts[graph.indices]
        away, left = (dijkstra(graph, indices=cells_of, min_only=True) for cells_of in terminals)
        # Whole numbers of unknown cells.
        through = np.round(away + left - counts)
        least = max(float(through.min()), 0.0)
        if np.isinf(least):
            return "apart"
        split = ~leaves.clear & (through <= 2.0 * least + 1.0) & (leaves.level < DEEPEST)
        # The cells of the start and of the goal are clear, too.
        starts, ends = terminals
        if leaves.clear[starts[0]] and any(leaves.clear[end] and float(away[end]) < 0.5 for end in ends):
            return "joined"
        if not split.any() or len(leaves) + (len(corner) - 1) * int(split.sum()) > most:
            return "undecided"
        level = np.repeat(leaves.level[split] + 1, len(corner))
        new = (2 * leaves.number[split][:, np.newaxis] + corner).reshape(-1, joints)
        leaves.keep(~split)
