"""The compiled search for the obstacle point nearest to a map point, at any distance."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad.world.gridmap.cells import DiskTables
from evenroad.world.gridmap.kernel import to_padded


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
