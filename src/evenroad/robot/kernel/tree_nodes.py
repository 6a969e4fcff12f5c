"""Two trees of configurations, from the start and from the goals, as compiled planners keep them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.addresses import integers_at, matrices_at, number_tables_at, singles_at
from evenroad.robot.kernel.lane_memory import load, store
from evenroad.robot.kernel.lanes import ZERO, absolute, smaller, smallest_lane, spread
from evenroad.robot.kernel.layout import LANES, quick

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

_FAR = np.float32(1e15)
"""Where places that hold no node are."""


class Trees(NamedTuple):
    """Nodes of two trees; the first index says which tree.

    Attributes
    ----------
    nodes : float64 array, shape (2, capacity, dim)
        Configurations within bounds; the roots come first.
    columns : float32 array, shape (2 * dim * capacity,)
        The same by coordinate, for the search of the nearest; the capacity is a multiple of 16.
    links : int64 array, shape (4, 2, capacity)
        Each node's parent (-1 for a root), how often it was tried, 1 where the motion from the parent is proved (for
        a root, which of the ends it is), and room for `remove_branch`.
    sizes : int64 array, shape (2,)
        How many nodes each tree has.
    periods : float32 array, shape (dim,)
        After how much each coordinate repeats, 1e30 where it does not.
    """

    nodes: Floats
    columns: Singles
    links: Ints
    sizes: Ints
    periods: Singles


@quick
def trees_at(nodes: int, capacity: int, sizes: int, periods: int, bounds: Floats) -> Trees:
    """Return trees whose nodes, links and columns follow each other in memory; the periods are written."""
    dim = bounds.shape[1]
    links = nodes + 8 * 2 * capacity * dim
    trees = Trees(
        matrices_at(nodes, (2, capacity, dim)),
        singles_at(links + 8 * 8 * capacity, (2 * dim * capacity,)),
        number_tables_at(links, (4, 2, capacity)),
        integers_at(sizes, (2,)),
        singles_at(periods, (dim,)),
    )
    for k in range(dim):
        trees.periods[k] = min(bounds[2, k], 1e30)
    return trees


PARENT, TRIED, PROVED, MOVED = range(4)
"""Rows of ``Trees.links``."""


@quick
def add_node(trees: Trees, tree: int, q: Floats, parent: int) -> int:
    """Add a configuration and return its number."""
    dim = trees.nodes.shape[2]
    number = trees.sizes[tree]
    for k in range(dim):
        trees.nodes[tree, number, k] = q[k]
    trees.links[PARENT, tree, number] = parent
    trees.links[TRIED, tree, number] = 0
    trees.links[PROVED, tree, number] = 0
    capacity = trees.nodes.shape[1]
    for k in range(dim):
        index = (tree * dim + k) * capacity + number
        if number % LANES == 0:
            for lane in range(1, LANES):
                trees.columns[index + lane] = _FAR
        trees.columns[index] = q[k]
    trees.sizes[tree] = number + 1
    return number


@quick
def nearest(trees: Trees, tree: int, q: Floats, buffer: Singles) -> int:
    """Return the number of a tree's node nearest to `q`, the first of equals, in single precision.

    `buffer` is memory for sixteen numbers and one a coordinate.
    """
    _, capacity, dim = trees.nodes.shape
    for k in range(dim):
        buffer[LANES + k] = q[k]
    best, number = np.float32(3e38), 0
    for first in range(0, trees.sizes[tree], LANES):
        squared = spread(ZERO)
        for k in range(dim):
            apart = absolute(load(trees.columns, (tree * dim + k) * capacity + first) - buffer[LANES + k])
            apart = smaller(apart, spread(trees.periods[k]) - apart)
            squared = squared + apart * apart
        least = smallest_lane(squared)
        if least < best:
            store(buffer, 0, squared)
            lane = 0
            while buffer[lane] > least:
                lane += 1
            best, number = least, first + lane
    return number


@quick
def least_tried(trees: Trees, tree: int) -> int:
    """Return the number of the tree's node that was tried least often, the first of equals."""
    tried = trees.links[TRIED, tree, : trees.sizes[tree]]
    least = tried[0]
    # A loop of its own, of which the compiler makes vectors.
    for i in range(len(tried)):
        least = min(least, tried[i])
    number = 0
    while tried[number] != least:
        number += 1
    return number


@quick
def remove_branch(trees: Trees, tree: int, number: int) -> None:
    """Remove a node and all that descend from it; the others move up and keep their order."""
    size = trees.sizes[tree]
    moved = trees.links[MOVED, tree]
    trees.sizes[tree] = 0
    for i in range(size):
        parent, tried = trees.links[PARENT, tree, i], trees.links[TRIED, tree, i]
        proved = trees.links[PROVED, tree, i]
        # Parents come before their children.
        if i == number or (parent >= 0 and moved[parent] < 0):
            moved[i] = -1
            continue
        kept = add_node(trees, tree, trees.nodes[tree, i], moved[parent] if parent >= 0 else -1)
        trees.links[TRIED, tree, kept], trees.links[PROVED, tree, kept] = tried, proved
        moved[i] = kept
