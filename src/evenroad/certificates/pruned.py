"""The smallest part of a tree of cells that still keeps start and goals apart, as answers of a certificate."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad.certificates.cells import Tree
from evenroad.certificates.targets import BEYOND

OTHER, INSIDE, WALL = 0, 1, 2


HALVED, LEFT_OPEN = -1, -1000
"""Answers: HALVED - k halves a cell along column k; all others are numbers of pairs."""


def pruned(tree: Tree, start: Floats, goals: Floats, targets: Ints) -> Ints:
    """Return the answers of a tree that keeps a start, (dim,), apart from goals, (g, dim), and from some targets."""
    terminals = tree.ranges.units(np.vstack([start, goals]))
    leaves = tree.leaves()
    label = _components(tree)
    at = tree.find(terminals, leaves)
    sides = [{int(label[at[0]])}, {int(label[each]) for each in at[1:] if each >= 0}]
    # A larger cell may have a posture that its halves have not.
    whole = (tree.status[:, targets] == BEYOND).all(axis=1)
    found = [
        _answers(tree, leaves, np.isin(label[leaves], sorted(side)), whole)
        for side in (sides[:1] if len(targets) else sides)
        if side
    ]
    return min(found, key=len)


def _components(tree: Tree) -> Ints:
    """Return a number for each cell, the same for open ones that are joined."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    one, two = tree.beside[:, (tree.pair[tree.beside] < 0).all(axis=0)]
    graph = coo_matrix((np.ones(len(one)), (one, two)), shape=(len(tree.depth),) * 2)
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def _answers(tree: Tree, leaves: Ints, inside: Bools, whole: Bools) -> Ints:
    """Return the answers that keep the cells of one side of a wall, of which those may be joined that are `whole`."""
    of = np.full(len(tree.depth), OTHER)
    of[leaves[inside]] = INSIDE
    for one, two in (tree.beside, tree.beside[::-1]):
        of[two[(of[one] == INSIDE) & (tree.pair[two] >= 0)]] = WALL
    pair = _few(tree, np.flatnonzero(of == WALL))
    halved = np.flatnonzero(tree.child >= 0)
    kept = np.zeros(len(of), dtype=np.bool_)
    # Children have larger numbers than their parents: deeper cells first.
    for depth in np.unique(tree.depth[halved])[::-1].tolist():
        here = halved[tree.depth[halved] == depth]
        first, second = of[tree.child[here]], of[tree.child[here] + 1]
        joined = (first == second) & ~kept[tree.child[here]] & ~kept[tree.child[here] + 1]
        joined &= (first == OTHER) | ((first == INSIDE) & whole[here])
        of[here] = np.where(joined, first, WALL)
        kept[here] = ~joined
    answers, cells = [], np.zeros(1, dtype=np.int64)
    while len(cells):
        shut_here = np.where(of[cells] == WALL, pair[cells], LEFT_OPEN)
        answers.append(np.where(kept[cells], HALVED - tree.along[cells], shut_here))
        inner = cells[kept[cells]]
        cells = np.stack([tree.child[inner], tree.child[inner] + 1], axis=1).ravel()
    return np.concatenate(answers)


def _few(tree: Tree, cells: Ints) -> Ints:
    """Return a pair for each of some blocked cells, few different ones: again and again the one that blocks most."""
    cell, pair = (np.concatenate(each) for each in zip(*tree.valid, strict=True))
    chosen = np.full(len(tree.depth), -1, dtype=np.int64)
    wanted = np.zeros(len(tree.depth), dtype=np.bool_)
    wanted[cells] = True
    while True:
        some = wanted[cell]
        cell, pair = cell[some], pair[some]
        if not len(cell):
            return chosen
        best = int(np.bincount(pair).argmax())
        rows = cell[pair == best]
        chosen[rows], wanted[rows] = best, False
