"""Connected pieces of surfaces, and what is inside of those that are closed."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from evenroad_verify.errors import Bools, Floats, Ints, demand

_WAYS = np.array(
    [[0.5377, 0.7211, 0.4369], [-0.3313, 0.6007, 0.7276], [0.7603, -0.3571, 0.5427], [0.2287, 0.3359, -0.9137]]
)
"""Directions of rays: the next one is tried where a ray comes too near to an edge."""
_NEAR = 1e-9
_MOST = 1_000_000
"""Pairs of a point and a triangle that are looked at together."""


class Pieces:
    """Pieces of a surface, whose triangles hang together by corners; `first` is where each begins, (k, 3)."""

    def __init__(self, points: Floats, corners: Ints) -> None:
        label = _labels(corners, len(points))
        self._points, self._corners, self._label = points, corners, label[corners[:, 0]]
        self._labels, first = np.unique(self._label, return_index=True)
        self.first = points[corners[first, 0]]
        order = np.argsort(label, kind="stable")
        begin = np.searchsorted(label[order], self._labels)
        self._low = np.minimum.reduceat(points[order], begin)
        self._high = np.maximum.reduceat(points[order], begin)

    def holding(self, points: Floats) -> Iterator[tuple[int, Floats]]:
        """Yield pieces whose boxes hold some of the points, (n, 3), and these."""
        if len(points):
            meets = (self._low <= points.max(0)) & (self._high >= points.min(0))
            for piece in np.flatnonzero(meets.all(axis=1)).tolist():
                some = points[((points >= self._low[piece]) & (points <= self._high[piece])).all(axis=1)]
                if len(some):
                    yield piece, some

    def closed(self, piece: int) -> Floats | None:
        """Return the triangles of a piece, (t, 3, 3); None if an edge belongs to an odd number of them.

        Triangles with the same corners count as one: two of them would hide what is inside.
        """
        corner = self._corners[self._label == self._labels[piece]]
        a, b, c = np.sort(corner, axis=1).T
        order, count = np.lexsort((c, b, a)), len(self._points)
        again = np.diff(a[order] * count + b[order]) + np.abs(np.diff(c[order])) == 0
        kept = np.sort(order[np.append(True, ~again)])
        edges = np.concatenate([a[kept] * count + b[kept], b[kept] * count + c[kept], a[kept] * count + c[kept]])
        _, times = np.unique(edges[edges // count != edges % count], return_counts=True)
        return None if (times % 2).any() else self._points[corner[kept]]


def _labels(corners: Ints, points: int) -> Ints:
    """Return a number for each point, the same of all that triangles join: the least of theirs."""
    label = np.arange(points)
    first, second = corners[:, :2].T.ravel(), corners[:, 1:].T.ravel()
    while len(first):
        pair = label[first], label[second]
        np.minimum.at(label, np.maximum(*pair), np.minimum(*pair))
        while (label != label[label]).any():
            label = label[label]
        apart = label[first] != label[second]
        first, second = first[apart], second[apart]
    return label


def any_inside(points: Floats, triangles: Floats) -> bool:
    """Return whether any of some points is inside of a closed surface, by the parity of the crossings of a ray."""
    step = max(1, _MOST // len(triangles))
    return any(_crosses_oddly(points[i : i + step], triangles).any() for i in range(0, len(points), step))


def _crosses_oddly(points: Floats, triangles: Floats) -> Bools:
    """Return which rays from points, (n, 3), cross the triangles an odd number of times."""
    odd, left = np.zeros(len(points), bool), np.arange(len(points))
    for way in _WAYS / np.linalg.norm(_WAYS, axis=1, keepdims=True):
        corners = triangles[None] - points[left, None, None]
        # Six times the volumes of the ray's unit and two corners: all of one sign where the ray meets the triangle.
        volume = np.stack([np.cross(corners[:, :, i], corners[:, :, (i + 1) % 3]) @ way for i in range(3)], axis=2)
        scale = np.linalg.norm(corners, axis=3).max(axis=2) ** 2
        unclear = (np.abs(volume) <= _NEAR * scale[..., None]).any(axis=2)
        meets = (volume > 0).all(axis=2) | (volume < 0).all(axis=2)
        normal = np.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0])
        before = (normal * corners[:, :, 0]).sum(axis=2) * (normal @ way) > 0
        # A ray that clearly passes a triangle by is clear, however near it comes to the lines of other edges.
        passes = (volume > _NEAR * scale[..., None]).any(axis=2) & (volume < -_NEAR * scale[..., None]).any(axis=2)
        clear = ~(unclear & ~passes).any(axis=1)
        odd[left[clear]] = (meets & before).sum(axis=1)[clear] % 2 == 1
        left = left[~clear]
        if not len(left):
            return odd
    demand(False, "no ray shows whether a body is inside of another one")
    raise AssertionError
