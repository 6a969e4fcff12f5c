"""The compiled searches for the obstacle point, and for the free point, that are nearest to a point."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad.world.gridmap.cells import BLOCKED, FREE, DiskTables
from evenroad.world.gridmap.kernel import point_is_free, to_padded


@njit(cache=True, nogil=True)
def nearest_obstacle_points(
    q: npt.NDArray[np.float64], disk: DiskTables
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return the nearest obstacle point to each map point, (n, 2), and its distance, (n,), both in pixels.

    The points are pixel coordinates of the map itself, not of the padded grid.  A point on or in an obstacle,
    the border and the outside included, is its own nearest one.  Columns are visited from the point's own
    outwards until they are farther than the best obstacle so far.
    """
    rows, cols = disk.cells.shape
    nearest = np.empty((len(q), 2))
    distance = np.zeros(len(q))
    for i in range(len(q)):
        x, y = to_padded(q[i, 0], q[i, 1], disk.frame)
        nearest[i, 0], nearest[i, 1] = x - 1.0, y - 1.0
        if not (1.0 < x < cols - 1.0 and 1.0 < y < rows - 1.0):
            continue
        col, row = int(x), int(y)
        best = np.inf
        # `away` columns off, everything is at least away - 1 away; the ring ends the search at the latest.
        for away in range(cols):
            if away > 1 and (away - 1.0) ** 2 >= best:
                break
            for other in (col - away, col + away):
                if other < 0 or other >= cols:
                    continue
                near_x = min(max(x, float(other)), other + 1.0)
                near_y = y
                if disk.above[row, other] > 0:
                    upper, lower = row + 1.0 - disk.above[row, other], float(row + disk.below[row, other])
                    near_y = upper if y - upper <= lower - y else lower
                squared = (near_x - x) ** 2 + (near_y - y) ** 2
                if squared < best:
                    best = squared
                    nearest[i, 0], nearest[i, 1] = near_x - 1.0, near_y - 1.0
        distance[i] = np.sqrt(best)
    return nearest, distance


@njit(cache=True, nogil=True)
def nearest_free_point(x: float, y: float, disk: DiskTables) -> tuple[float, float]:
    """Return the nearest point of surely free cells, or of a lattice of quarter pixels elsewhere; nan if none is free."""
    rows, cols = disk.cells.shape
    col, row = min(max(int(x), 1), cols - 2), min(max(int(y), 1), rows - 2)
    best, best_x, best_y = np.inf, np.nan, np.nan
    for ring in range(max(rows, cols)):
        if (ring - 1.0) > math.sqrt(best) and ring > 1:
            break
        for r in range(max(row - ring, 1), min(row + ring, rows - 2) + 1):
            step = 1 if abs(r - row) == ring else 2 * ring
            for c in range(col - ring, col + ring + 1, max(step, 1)):
                if c < 1 or c > cols - 2 or disk.cells[r, c] == BLOCKED:
                    continue
                if disk.cells[r, c] >= FREE:
                    # Not onto the sides of the cell, where rounding decides whose they are.
                    near_x, near_y = min(max(x, c + 1e-6), c + 1 - 1e-6), min(max(y, r + 1e-6), r + 1 - 1e-6)
                    squared = (near_x - x) ** 2 + (near_y - y) ** 2
                    if squared < best:
                        best, best_x, best_y = squared, near_x, near_y
                    continue
                for i in range(25):
                    near_x, near_y = c + 0.25 * (i % 5), r + 0.25 * (i // 5)
                    squared = (near_x - x) ** 2 + (near_y - y) ** 2
                    if squared < best and point_is_free(near_x, near_y, disk):
                        best, best_x, best_y = squared, near_x, near_y
    return best_x, best_y
