"""Grids over a surface: occupied cells, distances to them, and the inside."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad._njit import njit

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]

CELLS, LEAST_CELL = 400_000, 4e-3
"""Number of cells of a grid, about, and their least size [m]."""

FARTHEST_STEPS, STEPS = 64, 4
"""Largest distance in cells that is distinguished; a byte counts parts of a cell."""

_SURE = 1e-7
"""What is so near to a cell, in sides of one, is in it, too: more than rounding."""

MOST_WINDINGS = 100
"""Around a place a surface winds at most so often, as far as we count."""


@dataclass(frozen=True, eq=False)
class Grid:
    """A grid around a surface.

    Attributes
    ----------
    low, cell : float64 array, shape (3,), and float
        Lower corner, and side of a cell [m].
    taken : bool array, shape (x, y, z)
        Cells that the surface is in, or that it has inside.
    windings : int8 array, shape (x, y, z), or None
        How often a closed surface winds around the middle of each cell: not 0 inside.
    turned : bool
        Whether the orientation of triangles distinguishes inside and outside; else windings are counted by twos.
    """

    low: Floats
    cell: float
    taken: Bools
    windings: npt.NDArray[np.int8] | None = None
    turned: bool = False

    @property
    def distances(self) -> npt.NDArray[np.uint8]:
        """How far all of each cell is from those that are taken, in parts of a cell, rounded down; 255 or more."""
        return _distances(self.taken)

    @property
    def excess(self) -> float:
        """By how much a place of a cell is farther from the surface at most than its distance says [m]."""
        return self.cell * (1.0 / STEPS + 2.0 * math.sqrt(3.0)) * (1.0 + 1e-5)


def grid_of_points(points: Floats) -> Grid:
    """Return the grid of points, (n, 3)."""
    low, cell, counts = frame(points.min(axis=0), points.max(axis=0))
    taken = np.zeros(counts, dtype=np.bool_)
    indices = np.minimum(((points - low) * (1.0 / cell)).astype(np.int64), np.array(counts) - 1)
    taken[tuple(indices.T)] = True
    return Grid(low, cell, taken)


def grid_of_triangles(triangles: Floats, solid: Floats, turned: bool, reach: float) -> Grid:
    """Return the grid of triangles, (n, 3, 3), as far as they are within `reach` of the origin along each axis.

    `solid` are those of closed surfaces, (m, 3, 3), however far; `turned` says whether their sides tell inside from
    outside.  Where they do not, it is inside where a line from outside crosses an odd number of them.
    """
    low, high = (np.clip(each, -reach, reach) for each in _bounds(triangles))
    low, cell, counts = frame(low, high)
    taken = np.zeros(counts, dtype=np.bool_)
    _take(triangles, low, cell, taken)
    if len(solid) == 0:
        return Grid(low, cell, taken)
    windings = np.zeros(counts, dtype=np.int8)
    _wind(solid, turned, low, cell, windings)
    return Grid(low, cell, taken | (windings != 0), windings, turned)


def _bounds(triangles: Floats) -> tuple[Floats, Floats]:
    return triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))


def frame(low: Floats, high: Floats, cells: int = CELLS) -> tuple[Floats, float, tuple[int, int, int]]:
    """Return lower corner, side of a cell and numbers of cells of a grid that reaches half a cell beyond, or more."""
    cell = max(float(np.prod(np.maximum(high - low, LEAST_CELL)) / cells) ** (1 / 3), LEAST_CELL)
    x, y, z = np.ceil((high - low) / cell + 1.0).astype(np.int64).tolist()
    return low - 0.5 * (np.array([x, y, z]) * cell - (high - low)), cell, (x, y, z)


@njit(cache=True, nogil=True)
def _take(triangles: Floats, low: Floats, cell: float, taken: Bools) -> None:
    """Mark the cells that triangles are in: of each, cut into slabs and these into columns, from end to end."""
    shape = np.array(taken.shape)
    whole, slab, column, buffer = np.empty((3, 3)), np.empty((16, 3)), np.empty((16, 3)), np.empty((16, 3))
    first, last, number = (
        np.empty(3, dtype=np.int64),
        np.empty(3, dtype=np.int64),
        np.empty(3, dtype=np.int64),
    )
    for i in range(len(triangles)):
        outside, longest = False, 0
        for axis in range(3):
            least, most = np.inf, -np.inf
            for corner in range(3):
                whole[corner, axis] = (triangles[i, corner, axis] - low[axis]) / cell
                least, most = min(least, whole[corner, axis]), max(most, whole[corner, axis])
            outside |= most < -_SURE or least > shape[axis] + _SURE
            first[axis] = max(math.floor(max(least, 0.0) - _SURE), 0)
            last[axis] = min(math.floor(min(most, float(shape[axis])) + _SURE), shape[axis] - 1)
            if last[axis] - first[axis] > last[longest] - first[longest]:
                longest = axis
        if outside:
            continue
        # Columns run along the longest axis: so they are few.
        one, other = (longest + 1) % 3, (longest + 2) % 3
        for a in range(first[one], last[one] + 1):
            corners = _within(whole, 3, one, a, slab, buffer)
            for b in range(first[other], last[other] + 1):
                count = _within(slab, corners, other, b, column, buffer)
                least, most = np.inf, -np.inf
                for corner in range(count):
                    least, most = min(least, column[corner, longest]), max(most, column[corner, longest])
                number[one], number[other] = a, b
                begin = max(math.floor(max(least, 0.0) - _SURE), 0) if count > 0 else 0
                end = min(math.floor(min(most, float(shape[longest])) + _SURE), shape[longest] - 1)
                for c in range(begin, end + 1 if count > 0 else 0):
                    number[longest] = c
                    taken[number[0], number[1], number[2]] = True


@njit(cache=True, nogil=True)
def _within(corners: Floats, count: int, axis: int, number: int, into: Floats, buffer: Floats) -> int:
    """Write the corners of a convex polygon that is cut off below and above a row of cells, and return how many."""
    return _cut(buffer, _cut(corners, count, axis, number - _SURE, 1.0, buffer), axis, number + 1 + _SURE, -1.0, into)


@njit(cache=True, nogil=True)
def _cut(corners: Floats, count: int, axis: int, bound: float, side: float, into: Floats) -> int:
    """Write the corners of what is left of a convex polygon on one side of a bound, and return how many."""
    left = 0
    for i in range(count):
        k = i + 1 if i + 1 < count else 0
        here, there = side * (corners[i, axis] - bound), side * (corners[k, axis] - bound)
        if here >= 0.0:
            for entry in range(3):
                into[left, entry] = corners[i, entry]
            left += 1
        if (here >= 0.0) != (there >= 0.0):
            share = here / (here - there)
            for entry in range(3):
                into[left, entry] = corners[i, entry] + share * (corners[k, entry] - corners[i, entry])
            left += 1
    return left


@njit(cache=True, nogil=True)
def _wind(triangles: Floats, turned: bool, low: Floats, cell: float, windings: npt.NDArray[np.int8]) -> None:
    """Write how often closed triangles wind around the middles of cells: by where lines along x through them cross.

    A side that two triangles share is computed from the same end for both: what one of them leaves, the other takes.
    """
    nx, ny, nz = windings.shape
    crossings = np.zeros((ny, nz, nx + 1), dtype=np.int32)
    for i in range(len(triangles)):
        t = triangles[i]
        first = np.empty(2, dtype=np.int64)
        last = np.empty(2, dtype=np.int64)
        for k in range(2):
            least = min(t[0, k + 1], t[1, k + 1], t[2, k + 1])
            most = max(t[0, k + 1], t[1, k + 1], t[2, k + 1])
            first[k] = max(math.floor(min(max((least - low[k + 1]) / cell - 0.5, -1.0), 1e9)), 0)
            last[k] = min(
                math.ceil(min(max((most - low[k + 1]) / cell - 0.5, -1.0), 1e9)),
                windings.shape[k + 1] - 1,
            )
        for y in range(first[0], last[0] + 1):
            for z in range(first[1], last[1] + 1):
                p, q = low[1] + (y + 0.5) * cell, low[2] + (z + 0.5) * cell
                a, b, c = _side(t[1], t[2], p, q), _side(t[2], t[0], p, q), _side(t[0], t[1], p, q)
                if not ((a > 0.0) == (b > 0.0) and (b > 0.0) == (c > 0.0)):
                    continue
                position = (a * t[0, 0] + b * t[1, 0] + c * t[2, 0]) / (a + b + c)
                behind = math.ceil(min(max((position - low[0]) / cell - 0.5, 0.0), float(nx)))
                crossings[y, z, behind] += 1 if a > 0.0 or not turned else -1
    for y in range(ny):
        for z in range(nz):
            winding = 0
            for x in range(nx):
                winding += crossings[y, z, x]
                shown = winding if turned else winding % 2
                windings[x, y, z] = min(max(shown, -MOST_WINDINGS), MOST_WINDINGS)


@njit(cache=True, nogil=True)
def _side(a: Floats, b: Floats, p: float, q: float) -> float:
    """Return twice the area, with its sign, of a triangle in y and z between a side and a place; 0 counts as tiny."""
    exchanged = (a[1], a[2]) > (b[1], b[2])
    if exchanged:
        a, b = b, a
    area = (b[1] - a[1]) * (q - a[2]) - (b[2] - a[2]) * (p - a[1])
    area = 1e-300 if area == 0.0 else area
    return -area if exchanged else area


@njit(cache=True, nogil=True)
def _distances(taken: Bools) -> npt.NDArray[np.uint8]:
    """Do the work of `Grid.distances`.

    Between cells d apart along an axis there are d - 1: so distances, axis by axis, from cells that are taken or next
    to one (after P. Felzenszwalb and D. Huttenlocher, Distance Transforms of Sampled Functions, 2012, but each line is
    searched up to the farthest distinguished one, many lines at once).
    """
    nx, ny, nz = taken.shape
    far = FARTHEST_STEPS * FARTHEST_STEPS
    squared = np.full((nx, ny, nz), far, dtype=np.int32)
    for x in range(nx):
        for y in range(ny):
            for z in range(nz):
                if taken[x, y, z]:
                    squared[max(x - 1, 0) : x + 2, max(y - 1, 0) : y + 2, max(z - 1, 0) : z + 2] = 0
    for x in range(nx):
        for y in range(ny):
            away = FARTHEST_STEPS
            for z in range(nz):
                away = 0 if squared[x, y, z] == 0 else min(away + 1, FARTHEST_STEPS)
                squared[x, y, z] = away * away
            away = FARTHEST_STEPS
            for z in range(nz - 1, -1, -1):
                away = 0 if squared[x, y, z] == 0 else min(away + 1, FARTHEST_STEPS)
                squared[x, y, z] = min(squared[x, y, z], away * away)
    least = np.empty_like(squared)
    _spread(squared, least, nx, ny, nz)
    _spread(least.reshape(1, nx, ny * nz), squared.reshape(1, nx, ny * nz), 1, nx, ny * nz)
    steps = np.empty(far + 1, dtype=np.uint8)
    for i in range(far + 1):
        steps[i] = min(255, int(STEPS * math.sqrt(i)))
    distances = np.empty((nx, ny, nz), dtype=np.uint8)
    for x in range(nx):
        for y in range(ny):
            for z in range(nz):
                distances[x, y, z] = steps[squared[x, y, z]]
    return distances


@njit(cache=True, nogil=True)
def _spread(squared: npt.NDArray[np.int32], least: npt.NDArray[np.int32], a: int, b: int, c: int) -> None:
    """Write the squared distances that follow along the middle axis of three, of lengths a, b and c."""
    for i in range(a):
        for j in range(b):
            best = least[i, j]
            farthest = np.int32(0)
            for m in range(c):
                best[m] = squared[i, j, m]
                farthest = max(farthest, best[m])
            for away in range(1, FARTHEST_STEPS):
                added = np.int32(away * away)
                if added >= farthest:
                    break
                for side in range(2):
                    k = j - away if side == 0 else j + away
                    if k < 0 or k >= b:
                        continue
                    other = squared[i, k]
                    for m in range(c):
                        best[m] = min(best[m], other[m] + added)
