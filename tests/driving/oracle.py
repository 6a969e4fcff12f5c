"""Slow checks of a footprint among cells: separating axes at a pose, and halving along a motion."""

import math

import numpy as np

from evenroad.driving.car_space import CarSpace

AROUND = 8
"""Number of cells outside of the map on each side: farther no footprint of the tests reaches."""
BOX = [(-0.45, -0.31), (0.45, -0.31), (0.45, 0.31), (-0.45, 0.31)]
HOOK = [(-0.4, -0.3), (0.8, -0.3), (0.8, 0.1), (0.2, 0.1), (0.1, 0.6), (-0.4, 0.5)]


def placed(polygon, pose):
    """The corners of a polygon, (n, 2), at a pose."""
    turned = (np.asarray(polygon) @ [1.0, 1j]) * np.exp(1j * pose[2]) + complex(pose[0], pose[1])
    return np.column_stack([turned.real, turned.imag])


def separations(polygon, squares):
    """The largest gap of a convex polygon from each of squares, (k, 4, 2), along normals of sides, < 0: overlap."""
    largest = np.full(len(squares), -math.inf)
    for shape in (polygon, *squares[:1]):
        along = np.roll(shape, -1, axis=0) - shape
        normals = np.column_stack([along[:, 1], -along[:, 0]]) / np.linalg.norm(along, axis=1)[:, np.newaxis]
        for normal in (*normals, *-normals):
            largest = np.maximum(largest, (squares @ normal).min(axis=1) - (polygon @ normal).max())
    return largest


def squares_of(grid):
    """The corners of every occupied cell, and of those outside of the map, in map units, (n, 4, 2)."""
    padded = np.pad(grid.occupied, AROUND, constant_values=True)
    row, column = np.nonzero(padded)
    corners = np.stack(
        [np.column_stack([column + i, row + j]) - AROUND for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))], 1
    )
    return grid.frame.to_map(corners.reshape(-1, 2).astype(float)).reshape(-1, 4, 2)


class Oracle:
    """A footprint, as convex polygons, among the cells of a small map."""

    def __init__(self, grid, parts):
        self.squares, self.parts = squares_of(grid), [np.asarray(part, dtype=float) for part in parts]
        self.middles = self.squares.mean(axis=1)
        self.diagonal = float(np.linalg.norm(self.squares[0, 0] - self.squares[0, 2]))
        self.reach = max(float(np.linalg.norm(part, axis=1).max()) for part in self.parts)

    def gap(self, pose):
        """The least separation from all cells that are near; at most a cell's diagonal where there is none."""
        near = np.linalg.norm(self.middles - pose[:2], axis=1) < self.reach + 2.0 * self.diagonal
        gaps = [separations(placed(part, pose), self.squares[near]) for part in self.parts]
        return min(self.diagonal, *(own.min(initial=self.diagonal) for own in gaps))

    def touches(self, curve, speed, near=1e-4):
        """Whether something is touched along ``curve(t)``, t from 0 to 1; None where it comes `near`, or touches that
        little.

        No point of the footprint moves by more than `speed` a unit.
        """
        waiting, is_near = [(0.0, 1.0)], False
        while waiting:
            begin, end = waiting.pop()
            here, half = self.gap(curve(0.5 * (begin + end))), 0.5 * (end - begin)
            if here < -near:
                return True
            if here >= half * speed:
                continue
            if half * speed < near:
                is_near = True
                continue
            waiting += [(begin, begin + half), (begin + half, end)]
        return None if is_near else False


def driven(start, pieces):
    """The curve of pieces, (curvature, signed length) each, as a function of t, and its length."""
    length = sum(abs(each[1]) for each in pieces)

    def at(t):
        position, angle, left = complex(start[0], start[1]), start[2], t * length
        for curvature, signed in pieces:
            part = math.copysign(min(left, abs(signed)), signed)
            left -= abs(part)
            if math.isinf(curvature):
                angle += math.copysign(part, curvature)
            elif curvature == 0.0:
                position += part * np.exp(1j * angle)
            else:
                position += (np.exp(1j * (angle + curvature * part)) - np.exp(1j * angle)) / (1j * curvature)
                angle += curvature * part
        return np.array([position.real, position.imag, angle])

    return at, length


def poses(world, n, seed):
    return world.space.from_cube(np.random.default_rng(seed).random((n, 3)))


def curve_of(world, a, b):
    """The motion between two poses as a function, and the speed of the fastest point of the footprint."""
    reach = world.footprint.reach
    if isinstance(world.space, CarSpace):
        pieces = world.space.pieces(a, b)
        at, length = driven(a, pieces)
        per_length = 1.0 + reach * max([abs(k) for k in pieces[:, 0] if np.isfinite(k)] or [0.0])
        return at, length * max(per_length, reach)
    turn = (b[2] - a[2] + np.pi) % (2 * np.pi) - np.pi
    by = np.array([b[0] - a[0], b[1] - a[1], turn])
    return lambda t: a + t * by, math.hypot(by[0], by[1]) + reach * abs(turn)
