"""Trees of balls over convex hulls as compiled code reads them, and where two bodies touch in many configurations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad._njit import njit
from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel.hull_contact import hulls_meet

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Leaves = Sequence[tuple[Floats, float]]
"""Hulls of one body: the corners of some, (hulls, corners, 3), in its frame, and by how much each is widened [m]."""


def tree_rows(leaves: Leaves, first_node: int, first_point: int) -> tuple[Ints, Floats, Floats, Ints]:
    """Return the nodes of a tree, root first: integers and floats in the order of ``layout.py``, points, leaves."""
    points = np.concatenate([corners.reshape(-1, 3) for corners, _ in leaves])
    counts = np.concatenate([np.full(corners.shape[0], corners.shape[1]) for corners, _ in leaves])
    widths = np.concatenate([np.full(len(corners), width) for corners, width in leaves])
    starts = np.cumsum(counts) - counts
    low = np.minimum.reduceat(points, starts) - widths[:, np.newaxis]
    high = np.maximum.reduceat(points, starts) + widths[:, np.newaxis]
    away = np.linalg.norm(points - np.repeat(0.5 * (low + high), counts, axis=0), axis=1)
    children, boxes, leaf = _tree_over(low, high, np.maximum.reduceat(away, starts) + widths)
    ints = np.where(children < 0, -1, children + first_node)
    spans = np.stack([starts, starts + counts], axis=1)[leaf] + first_point
    return np.hstack([ints, spans]), np.hstack([boxes, widths[leaf][:, np.newaxis]]), points, leaf


def _tree_over(low: Floats, high: Floats, reach: Floats) -> tuple[Ints, Floats, Ints]:
    """Return children (-1 of a leaf), boxes with their balls, and leaves of a tree over boxes, halved by place.

    The boxes of the leaves are from `low` to `high`, (n, 3); nothing in them is farther from their middle than `reach`.
    Not compiled: that would take seconds at a first plan, for milliseconds.
    """
    n = len(low)
    children, boxes = np.full((2 * n - 1, 2), -1), np.empty((2 * n - 1, 7))
    leaf, order = np.zeros(2 * n - 1, dtype=np.int64), np.arange(n)
    centres = low + high
    waiting = [(0, 0, n)]
    made = 1
    while waiting:
        node, first, end = waiting.pop()
        below = order[first:end]
        lowest, highest = low[below].min(axis=0), high[below].max(axis=0)
        middle, half = 0.5 * (lowest + highest), 0.5 * (highest - lowest) + 1e-12
        away = (0.5 * centres[below] - middle) ** 2
        radius = np.sqrt(away[:, 0] + away[:, 1] + away[:, 2]) + reach[below] + 1e-12
        boxes[node] = *middle, *half, radius.max()
        if end - first == 1:
            leaf[node] = order[first]
            continue
        # The first of the longest sides.
        order[first:end] = below[np.argsort(centres[below, half.argmax()], kind="stable")]
        halfway = (first + end) // 2
        for side, parts in enumerate(((first, halfway), (halfway, end))):
            children[node, side] = made
            waiting.append((made, *parts))
            made += 1
    return children, boxes, leaf


@dataclass(frozen=True, eq=False)
class HullTrees:
    """Trees of some bodies: the tables of `hulls_meet`, roots by the bodies' names, and which hull each node is."""

    ints: Ints
    floats: Floats
    roots: Mapping[str, int]
    leaf: Ints

    def ball(self, name: str) -> Floats:
        """Return centre and radius, (4,), of a ball around a body in its frame."""
        first = self.ints[at.NODE_FLOATS] + at.NODE_FLOAT_ROW * self.roots[name]
        return self.floats[first + np.array([0, 1, 2, 6])]


def hull_trees(bodies: Mapping[str, Leaves], first_point: int = 0) -> HullTrees:
    """Return the trees of bodies, each in a frame of its own; their points are counted from `first_point`."""
    roots, rows = {}, []
    node, point = 0, first_point
    for name, leaves in bodies.items():
        roots[name] = node
        rows.append(tree_rows(leaves, node, point))
        node, point = node + len(rows[-1][0]), point + len(rows[-1][2])
    ints = np.concatenate([np.zeros(at.HEADER, dtype=np.int64), *(row[0].ravel() for row in rows)])
    floats = np.concatenate([np.zeros(0), *(row[k].ravel() for k in (2, 1) for row in rows)])
    ints[at.NODE_INTS], ints[at.NODE_FLOATS] = at.HEADER, 3 * (point - first_point)
    return HullTrees(ints, floats, roots, np.concatenate([np.zeros(0, dtype=np.int64), *(row[3] for row in rows)]))


def contacts(trees: HullTrees, first: str, second: str, poses: Floats, others: Floats) -> Ints:
    """Return for every two poses, (n, 4, 4) each, the numbers of two hulls that touch, (n, 2); -1 where none do."""
    turned = poses[:, :3, :3].transpose(0, 2, 1)
    rotation = turned @ others[:, :3, :3]
    shift = turned @ (others[:, :3, 3:] - poses[:, :3, 3:])
    relative = np.concatenate([rotation.reshape(-1, 9), shift.reshape(-1, 3)], axis=1)
    meeting = _contacts(trees.roots[first], trees.roots[second], relative, trees.ints, trees.floats)
    nodes = np.stack([meeting >> 32, meeting & 0xFFFFFFFF], axis=1)
    return np.where(meeting[:, np.newaxis] < 0, -1, trees.leaf[nodes % len(trees.leaf)])


@njit(cache=True, nogil=True)
def _contacts(first: int, second: int, relative: Floats, ints: Ints, floats: Floats) -> Ints:
    meeting = np.empty(len(relative), dtype=np.int64)
    for n in range(len(relative)):
        meeting[n] = hulls_meet(first, second, relative[n], 0.0, ints, floats)
    return meeting
