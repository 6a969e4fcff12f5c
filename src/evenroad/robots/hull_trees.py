"""Trees of balls over convex hulls, and where two bodies touch in many configurations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad._native import robot as native

Leaves = Sequence[tuple[Floats, float]]
"""Hulls of one body: the corners of some, (hulls, corners, 3), in its frame, and by how much each is widened [m]."""


class HullArrays(NamedTuple):
    """Hulls of bodies as the native kernel takes them: the first numbers of parts and points, points and widths."""

    first_part: Ints
    first_point: Ints
    points: Floats
    widths: Floats


def hull_arrays(bodies: Iterable[Leaves]) -> HullArrays:
    """Return the hulls of bodies as the native kernel takes them."""
    every = list(bodies)
    leaves = [leaf for of_body in every for leaf in of_body]
    counts = [0, *(count for corners, _ in leaves for count in [corners.shape[1]] * len(corners))]
    parts = [0, *(sum(len(corners) for corners, _ in of_body) for of_body in every)]
    none = [np.zeros((0, 3))]
    return HullArrays(
        np.cumsum(parts, dtype=np.int64),
        np.cumsum(counts, dtype=np.int64),
        np.concatenate([*none, *(corners.reshape(-1, 3) for corners, _ in leaves)]),
        np.repeat([float(width) for _, width in leaves], [len(corners) for corners, _ in leaves]),
    )


@dataclass(frozen=True, eq=False)
class HullTrees:
    """Trees of some bodies, whose numbers are those of their names."""

    bodies: Mapping[str, int]
    native: native.HullTrees

    def ball(self, name: str) -> Floats:
        """Return centre and radius, (4,), of a ball around a body in its frame."""
        return self.native.ball(self.bodies[name])


def hull_trees(bodies: Mapping[str, Leaves]) -> HullTrees:
    """Return the trees of bodies, each in a frame of its own."""
    return HullTrees({name: i for i, name in enumerate(bodies)}, native.HullTrees(*hull_arrays(bodies.values())))


def contacts(trees: HullTrees, first: str, second: str, poses: Floats, others: Floats) -> Ints:
    """Return for every two poses, (n, 4, 4) each, the numbers of two hulls that touch, (n, 2); -1 where none do."""
    turned = poses[:, :3, :3].transpose(0, 2, 1)
    rotation = turned @ others[:, :3, :3]
    shift = turned @ (others[:, :3, 3:] - poses[:, :3, 3:])
    relative = np.concatenate([rotation.reshape(-1, 9), shift.reshape(-1, 3)], axis=1)
    return trees.native.contacts(trees.bodies[first], trees.bodies[second], relative)
