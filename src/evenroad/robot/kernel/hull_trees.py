"""Trees of balls over convex hulls, and where two bodies touch in many configurations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad._native import robot as native

Leaves = Sequence[tuple[Floats, float]]
"""Hulls of one body: the corners of some, (hulls, corners, 3), in its frame, and by how much each is widened [m]."""


def _tree_rows(leaves: Leaves, first_node: int, first_point: int) -> tuple[Ints, Ints, Floats, Floats, Ints]:
    """Return the nodes of a tree, root first: children, spans of points, boxes; points, and which hull each leaf is."""
    points = np.concatenate([corners.reshape(-1, 3) for corners, _ in leaves])
    counts = np.concatenate([np.full(corners.shape[0], corners.shape[1]) for corners, _ in leaves])
    widths = np.concatenate([np.full(len(corners), width) for corners, width in leaves])
    starts = np.cumsum(counts) - counts
    low = np.minimum.reduceat(points, starts) - widths[:, np.newaxis]
    high = np.maximum.reduceat(points, starts) + widths[:, np.newaxis]
    away = np.linalg.norm(points - np.repeat(0.5 * (low + high), counts, axis=0), axis=1)
    children, boxes, leaf = _tree_over(low, high, np.maximum.reduceat(away, starts) + widths)
    children = np.where(children < 0, -1, children + first_node)
    spans = np.stack([starts, starts + counts], axis=1)[leaf] + first_point
    return children, spans, np.hstack([boxes, widths[leaf][:, np.newaxis]]), points, leaf


def _tree_over(low: Floats, high: Floats, reach: Floats) -> tuple[Ints, Floats, Ints]:
    """Return children (-1 of a leaf), boxes with their balls, and leaves of a tree over boxes, halved by place.

    The boxes of the leaves are from `low` to `high`, (n, 3); nothing in them is farther from their middle than `reach`.
    """
    n = len(low)
    children, boxes = np.full((2 * n - 1, 2), -1), np.empty((2 * n - 1, 7))
    leaf, order = np.zeros(2 * n - 1, dtype=np.int64), np.arange(n)
    centres = low + high
    # Of the nodes of a level: their numbers, where their boxes lie in the order, and the number of their first child.
    node, first, end, child = np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64), np.array([n]), np.ones(1, int)
    while len(node):
        count = end - first
        starts = np.cumsum(count) - count
        of = np.repeat(np.arange(len(node)), count)
        at = first[of] + np.arange(len(of)) - starts[of]
        below = order[at]
        lowest, highest = np.minimum.reduceat(low[below], starts), np.maximum.reduceat(high[below], starts)
        middle, half = 0.5 * (lowest + highest), 0.5 * (highest - lowest) + 1e-12
        away = (0.5 * centres[below] - middle[of]) ** 2
        radius = np.sqrt(away[:, 0] + away[:, 1] + away[:, 2]) + reach[below] + 1e-12
        boxes[node] = np.column_stack([middle, half, np.maximum.reduceat(radius, starts)])
        leaf[node] = np.where(count == 1, order[first], 0)
        # The first of the longest sides.
        order[at] = below[np.lexsort((centres[below, half.argmax(axis=1)[of]], of))]
        inner = count > 1
        node, first, end, child = node[inner], first[inner], end[inner], child[inner]
        halfway = (first + end) // 2
        children[node] = np.column_stack([child, child + 1])
        node = np.concatenate([child, child + 1])
        # The second half is numbered through before the first.
        child = np.concatenate([child + 2 * (end - halfway), child + 2])
        first, end = np.concatenate([first, halfway]), np.concatenate([halfway, end])
    return children, boxes, leaf


@dataclass(frozen=True, eq=False)
class HullTrees:
    """Trees of some bodies: roots by the bodies' names, and of every node which hull of its body it is.

    The arrays are those that native code reads: `children`, (n, 2), or -1 twice; `spans`, (n, 2), of points of a leaf;
    `boxes`, (n, 8): centre, half extents, radius of a ball about the centre, by how much a leaf is widened; `points`.
    """

    roots: Mapping[str, int]
    children: Ints
    spans: Ints
    boxes: Floats
    points: Floats
    leaf: Ints

    def ball(self, name: str) -> Floats:
        """Return centre and radius, (4,), of a ball around a body in its frame."""
        return self.boxes[self.roots[name], [0, 1, 2, 6]]

    @cached_property
    def native(self) -> native.HullTree:
        """The trees as native code has them."""
        return native.HullTree(self.children, self.spans, self.boxes, self.points)


def hull_trees(bodies: Mapping[str, Leaves]) -> HullTrees:
    """Return the trees of bodies, each in a frame of its own."""
    roots = {}
    rows = [(np.zeros((0, 2), int), np.zeros((0, 2), int), np.zeros((0, 8)), np.zeros((0, 3)), np.zeros(0, int))]
    node = point = 0
    for name, leaves in bodies.items():
        roots[name] = node
        rows.append(_tree_rows(leaves, node, point))
        node, point = node + len(rows[-1][0]), point + len(rows[-1][3])
    return HullTrees(roots, *(np.concatenate(column) for column in zip(*rows, strict=True)))


def contacts(trees: HullTrees, first: str, second: str, poses: Floats, others: Floats) -> Ints:
    """Return for every two poses, (n, 4, 4) each, the numbers of two hulls that touch, (n, 2); -1 where none do."""
    turned = poses[:, :3, :3].transpose(0, 2, 1)
    rotation = turned @ others[:, :3, :3]
    shift = turned @ (others[:, :3, 3:] - poses[:, :3, 3:])
    relative = np.concatenate([rotation.reshape(-1, 9), shift.reshape(-1, 3)], axis=1)
    nodes = trees.native.contacts(trees.roots[first], trees.roots[second], relative)
    return np.where(nodes < 0, -1, trees.leaf[nodes])
