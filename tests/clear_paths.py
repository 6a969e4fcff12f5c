"""Worlds of discs in planes of a cube, in which the shortest path of any clearance is known by brute force."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.ndimage import label
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from evenroad._arrays import Bools, Floats
from evenroad.space import BoxSpace


@dataclass(frozen=True, eq=False)
class Plane:
    """Discs, (m, 2) centres and (m,) radii, in the plane of two axes of the cube; along the others they go on."""

    axes: tuple[int, int]
    centres: Floats
    radii: Floats

    def clearance(self, a: Floats, b: Floats) -> Floats:
        """Return how far the motions between rows of two (n, d) arrays stay from every disc, (n,); < 0 inside."""
        a, b = a[:, self.axes], b[:, self.axes]
        way = b - a
        squares = np.maximum((way**2).sum(1), 1e-300)
        away = np.full(len(a), np.inf)
        for centre, radius in zip(self.centres, self.radii, strict=True):
            share = np.clip(((centre - a) * way).sum(1) / squares, 0.0, 1.0)
            away = np.minimum(away, np.linalg.norm(a + share[:, None] * way - centre, axis=1) - radius)
        return away


@dataclass(frozen=True, eq=False)
class DiscWorld:
    """The unit cube without discs in one plane, or in two planes that share no axis."""

    d: int
    planes: tuple[Plane, ...]

    proof = "exact"

    @property
    def space(self) -> BoxSpace:
        """The cube."""
        return BoxSpace([0.0] * self.d, [1.0] * self.d)

    def valid(self, q: Floats) -> Bools:
        """Return which places, (n, d), lie in no disc."""
        return self.motion_valid(q, q)

    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """Return which motions, between rows of two (m, d) arrays, meet no disc."""
        return np.min([plane.clearance(a, b) for plane in self.planes], axis=0) >= 0.0

    def optimum(self, start: Floats, goal: Floats, clearance: float) -> float:
        """Return the length of the shortest path of this clearance that is known; inf where none is.

        The free space is a product of planes with holes and of segments, so the squares of the lengths in them add.
        Where every disc, larger by the clearance, lies inside the square, no shorter path exists.
        """
        rest = [k for k in range(self.d) if not any(k in plane.axes for plane in self.planes)]
        squares = float(((goal - start)[rest] ** 2).sum())
        for plane in self.planes:
            axes = list(plane.axes)
            squares += shortest_around(plane.centres, plane.radii + clearance, start[axes], goal[axes]) ** 2
        return float(np.sqrt(squares))

    def leads(self, start: Floats, goal: Floats, clearance: float, cells: int = 800) -> bool | None:
        """Return whether a path of this clearance exists, by filling a fine grid; None where that cannot tell."""
        verdicts = [
            _filled(plane, start[list(plane.axes)], goal[list(plane.axes)], clearance, cells) for plane in self.planes
        ]
        return False if False in verdicts else None if None in verdicts else True


def shortest_around(centres: Floats, radii: Floats, start: Floats, goal: Floats) -> float:
    """Return the length of a shortest path in the unit square outside discs: over all their tangents and arcs.

    It keeps to the square; where a disc crosses a side there may be a shorter one, along the side.
    """
    places, circle = [start, goal], [-1, -1]
    pairs: list[tuple[int, int]] = [(0, 1)]

    def add(place: Floats, i: int) -> int:
        places.append(place)
        circle.append(i)
        return len(places) - 1

    m = len(radii)
    for end in (0, 1):
        for i in range(m):
            gap = centres[i] - places[end]
            far = np.hypot(*gap)
            if far < radii[i]:
                return np.inf
            turn = np.arccos(min(radii[i] / far, 1.0))
            towards = np.arctan2(-gap[1], -gap[0])
            pairs += [(end, add(_on(centres[i], radii[i], towards + s * turn), i)) for s in (-1, 1)]
    for i, j in combinations(range(m), 2):
        gap = centres[j] - centres[i]
        far, towards = np.hypot(*gap), np.arctan2(gap[1], gap[0])
        for sign in (-1.0, 1.0):
            # Outer tangents have the two discs on one side, inner ones between them.
            cosine = (radii[i] - sign * radii[j]) / far
            if abs(cosine) >= 1.0:
                continue
            for s in (-1, 1):
                angle = towards + s * np.arccos(cosine)
                second = angle if sign > 0 else angle + np.pi
                a = add(_on(centres[i], radii[i], angle), i)
                pairs.append((a, add(_on(centres[j], radii[j], second), j)))
    q, on = np.array(places), np.array(circle)
    first, second = np.array(pairs).T
    inside = ((q >= 0.0) & (q <= 1.0)).all(1)
    free = inside[first] & inside[second]
    for i in range(m):
        others = (on[first] != i) & (on[second] != i)
        away = Plane((0, 1), centres[[i]], radii[[i]]).clearance(q[first], q[second])
        free &= ~others | (away >= 0.0)
    ways = [(first[free], second[free], np.linalg.norm(q[second] - q[first], axis=1)[free])]
    for i in range(m):
        nodes = np.flatnonzero(on == i)
        angles = np.arctan2(*(q[nodes] - centres[i]).T[::-1]) % (2 * np.pi)
        nodes, angles = nodes[np.argsort(angles)], np.sort(angles)
        turns = np.diff(angles, append=angles[:1] + 2 * np.pi)
        open_arcs = _open_arcs(i, centres, radii, angles, turns)
        ways.append((nodes[open_arcs], np.roll(nodes, -1)[open_arcs], radii[i] * turns[open_arcs]))
    row, column, length = (np.concatenate(each) for each in zip(*ways, strict=True))
    graph = coo_array((np.maximum(length, 1e-15), (row, column)), (len(q), len(q))).tocsr()
    return float(dijkstra(graph, directed=False, indices=0)[1])


def _on(centre: Floats, radius: float, angle: float) -> Floats:
    return centre + radius * np.array([np.cos(angle), np.sin(angle)])


def _open_arcs(i: int, centres: Floats, radii: Floats, angles: Floats, turns: Floats) -> Bools:
    """Return which arcs of circle i, from each angle on, no other disc and no side of the square cuts."""
    open_arcs = np.ones(len(angles), dtype=np.bool_)

    def cut(towards: float, half: float) -> None:
        # From the arc's begin on, the cut begins at `ahead`; a cut that began before reaches `ahead + 2 half - 2 pi`.
        ahead = (towards - half - angles) % (2 * np.pi)
        np.logical_and(open_arcs, (ahead >= turns) & (ahead + 2 * half <= 2 * np.pi + 1e-12), out=open_arcs)

    for j in range(len(radii)):
        gap = centres[j] - centres[i]
        far = np.hypot(*gap)
        if j == i or far >= radii[i] + radii[j] or far + radii[j] <= radii[i]:
            continue
        if far + radii[i] <= radii[j]:
            return np.zeros(len(angles), dtype=np.bool_)
        cosine = (radii[i] ** 2 + far**2 - radii[j] ** 2) / (2 * radii[i] * far)
        cut(np.arctan2(gap[1], gap[0]), np.arccos(np.clip(cosine, -1.0, 1.0)))
    for axis, quarter in ((0, 0.0), (1, 0.5 * np.pi)):
        for side, turn in ((centres[i, axis], np.pi), (1.0 - centres[i, axis], 0.0)):
            if side < radii[i]:
                cut(quarter + turn, np.arccos(np.clip(side / radii[i], -1.0, 1.0)))
    return open_arcs


def _filled(plane: Plane, start: Floats, goal: Floats, clearance: float, cells: int) -> bool | None:
    ticks = (np.arange(cells) + 0.5) / cells
    x, y = np.meshgrid(ticks, ticks, indexing="ij")
    away = np.full(x.shape, np.inf)
    for centre, radius in zip(plane.centres, plane.radii, strict=True):
        away = np.minimum(away, np.hypot(x - centre[0], y - centre[1]) - radius)
    slack = np.sqrt(0.5) / cells
    ends = [tuple(np.minimum((cells * end).astype(int), cells - 1)) for end in (start, goal)]

    def joined(least: float) -> bool:
        parts, _ = label(away >= least, np.ones((3, 3)))
        return bool(parts[ends[0]] == parts[ends[1]] != 0)

    # A cell whose centre is clear by a little less holds every place of such a path; one clear by more is clear.
    if not joined(clearance - slack):
        return False
    return True if joined(clearance + slack) else None
