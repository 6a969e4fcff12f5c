"""Nodes: sets of shapes of one frame, which a certificate may halve."""

from __future__ import annotations

import numpy as np

from evenroad_verify.errors import Floats, Ints, demand
from evenroad_verify.shapes import Shape

Part = tuple[Shape, Ints]
"""A shape and the rows of its elements."""
_MOST = 1 << 16
"""Products that are held at once: more do not fit a fast memory."""


class Nodes:
    """A growing table of nodes, each with its frame, its parts and a box around these."""

    def __init__(self) -> None:
        self.frame: list[int] = []
        self.reach: list[float] = []
        self.centre: list[Floats] = []
        self.box: list[Floats] = []
        self.parts: list[list[Part]] = []
        self._wholes: dict[tuple[int, ...], int] = {}
        self._halves: dict[int, tuple[int, int]] = {}
        self._corners: dict[int, list[tuple[Shape, Floats]]] = {}

    def whole(self, frame: int, shapes: list[Shape]) -> int:
        """Return the number of a node of whole shapes, the same each time."""
        key = (frame, *map(id, shapes))
        if key not in self._wholes:
            self._wholes[key] = self._add(frame, [(shape, np.arange(len(shape.corners))) for shape in shapes])
        return self._wholes[key]

    def _add(self, frame: int, parts: list[Part]) -> int:
        low, high, reach = np.full(3, np.inf), np.full(3, -np.inf), 0.0
        for shape, rows in parts:
            spans = _spans(shape, rows, slice(3, 10))
            wide = shape.radius + shape.disc * np.sqrt(np.maximum(0.0, 1.0 - shape.axis**2))
            low, high = np.minimum(low, spans[:3].min(1) - wide), np.maximum(high, spans[3:6].max(1) + wide)
            reach = max(reach, float(spans[6].max()) + shape.radius + shape.disc)
        centre, box = 0.5 * (low + high), 0.5 * (high - low)[:, None] * np.eye(3)
        if len(parts) == 1 and parts[0][0].is_box:
            corner, radius = parts[0][0].points, parts[0][0].radius
            edges = 0.5 * np.stack([corner[4] - corner[0], corner[2] - corner[0], corner[1] - corner[0]])
            length = np.linalg.norm(edges, axis=1, keepdims=True)
            # A flat box with a ball around it keeps the box along the frame's axes.
            if radius == 0.0 or length.min() > 1e-9:
                centre, box = 0.5 * (corner[0] + corner[7]), edges * (1.0 + radius / np.maximum(length, 1e-12))
        self.frame.append(frame)
        self.reach.append(reach)
        self.centre.append(centre)
        self.box.append(box)
        self.parts.append(parts)
        return len(self.frame) - 1

    def halves(self, node: int) -> tuple[int, int]:
        """Return the numbers of a node's two halves; Refused where it is a single element."""
        if node not in self._halves:
            middles = np.concatenate([_spans(shape, rows, slice(3)) for shape, rows in self.parts[node]], axis=1)
            count = middles.shape[1] // 2
            demand(count > 0, "a single element is halved")
            # Rounded to 2^-20 m: programs that differ in a last bit choose one axis, and order the elements alike.
            rounded = np.rint(2.0**20 * middles)
            along = rounded[np.ptp(rounded, axis=1).argmax()]
            between = np.partition(along, count - 1)[count - 1]
            is_first = along < between
            is_first[np.flatnonzero(along == between)[: count - int(is_first.sum())]] = True
            sides: tuple[list[Part], list[Part]] = ([], [])
            start = 0
            for shape, rows in self.parts[node]:
                chosen = is_first[start : start + len(rows)]
                start += len(rows)
                for side, some in zip(sides, (rows[chosen], rows[~chosen]), strict=True):
                    side.extend([(shape, some)] if len(some) else [])
            self._halves[node] = self._add(self.frame[node], sides[0]), self._add(self.frame[node], sides[1])
        return self._halves[node]

    def supports(self, node: int, along: Floats) -> Floats:
        """Return how far a node reaches along functionals, (m, 3), of its frame: (m,)."""
        if node not in self._corners:
            self._corners[node] = [(shape, _points(shape, rows)) for shape, rows in self.parts[node]]
        most = np.full(len(along), -np.inf)
        for shape, points in self._corners[node]:
            step = max(1, _MOST // points.shape[1])
            far = np.concatenate([(along[i : i + step] @ points).max(1) for i in range(0, len(along), step)])
            far += shape.radius * np.linalg.norm(along, axis=1)
            if shape.disc:
                across = along - np.outer(along @ shape.axis, shape.axis)
                far += shape.disc * np.linalg.norm(across, axis=1)
            most = np.maximum(most, far)
        return most


def _spans(shape: Shape, rows: Ints, some: slice) -> Floats:
    """Return some of the spans of elements: of all elements without a copy."""
    spans = shape.spans[some]
    return spans if len(rows) == len(shape.corners) else spans.take(rows, axis=1)


def _points(shape: Shape, rows: Ints) -> Floats:
    """Return the points that some elements have for corners, (3, m)."""
    corners = shape.corners[rows]
    used = np.zeros(len(shape.points), bool)
    used[corners] = True
    some = np.unique(corners) if 8 * corners.size < len(used) else np.flatnonzero(used)
    return np.ascontiguousarray(shape.points.take(some, axis=0).T)
