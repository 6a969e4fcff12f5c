"""Compiled exact tests of a disk on a grid, of points and motions, and the nearest obstacle or free position.

All is in the pixel plane of the *padded* grid (see `cells`), whose coordinates are one larger than the map's.  Seen
from a point of cell (row, col), only one or two squares of each column can be the nearest: the one in the same row if
it is occupied, else the first above and the first below.  Only columns within `reach` = ceil(radius) matter.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad._njit import njit
from evenroad.world.gridmap.cells import BLOCKED, FREE, UNDECIDED, DiskTables


@njit(cache=True, nogil=True)
def points_are_free(q: Floats, disk: DiskTables) -> Bools:
    """Return for each finite map point, (n, 2), whether the disk there is free, (n,)."""
    free = np.empty(len(q), np.bool_)
    for i in range(len(q)):
        x, y = to_padded(q[i, 0], q[i, 1], disk.frame)
        free[i] = point_is_free(x, y, disk)
    return free


@njit(cache=True, nogil=True)
def motions_are_free(a: Floats, b: Floats, disk: DiskTables) -> Bools:
    """Return for each pair of finite map points, (m, 2), whether the disk can move straight, (m,)."""
    free = np.empty(len(a), np.bool_)
    for i in range(len(a)):
        free[i] = free_between(a[i, 0], a[i, 1], b[i, 0], b[i, 1], disk)
    return free


@njit(cache=True, nogil=True)
def free_between(ax: float, ay: float, bx: float, by: float, disk: DiskTables) -> bool:
    """Say whether the motion between two map points is free."""
    ax, ay = to_padded(ax, ay, disk.frame)
    bx, by = to_padded(bx, by, disk.frame)
    if not point_is_free(ax, ay, disk) or not point_is_free(bx, by, disk):
        return False
    # One direction for both orders: a motion and its reverse round alike.
    if bx < ax or (bx == ax and by < ay):
        return _motion_is_free(bx, by, ax, ay, disk)
    return _motion_is_free(ax, ay, bx, by, disk)


@njit(cache=True, nogil=True)
def to_padded(x: float, y: float, frame: Any) -> tuple[float, float]:
    """Return the padded pixel coordinates of a map point; `frame` is `MapFrame.coefficients()`."""
    x -= frame[0]
    y -= frame[1]
    column = (frame[2] * x + frame[3] * y) / frame[6]
    row = frame[7] + (frame[4] * x + frame[5] * y) / frame[6]
    return column + 1.0, row + 1.0


@njit(cache=True, nogil=True)
def point_is_free(x: float, y: float, disk: DiskTables) -> bool:
    """Say whether the disk is free at padded pixel coordinates."""
    rows, cols = disk.cells.shape
    # On the border the distance to the outside is 0, so it is no place for a disk either.
    if not (1.0 < x < cols - 1.0 and 1.0 < y < rows - 1.0):
        return False
    col, row = int(x), int(y)
    state = disk.cells[row, col]
    if state != UNDECIDED:
        return state >= FREE
    squared_radius = disk.radius * disk.radius
    return squared_gap(x, y, row, col, math.ceil(disk.radius), squared_radius, disk) >= squared_radius


@njit(cache=True, nogil=True, inline="always")
def squared_gap(x: float, y: float, row: int, col: int, reach: int, enough: float, disk: DiskTables) -> float:
    """Return the squared distance from a point of a cell to the obstacles of columns within `reach`.

    Once one is found nearer than `enough`, the nearest is not looked for.
    """
    least = np.inf
    for other in range(max(col - reach, 0), min(col + reach, disk.cells.shape[1] - 1) + 1):
        gap_x = max(other - x, x - (other + 1), 0.0)
        gap_y = 0.0
        if disk.above[row, other] > 0:
            gap_y = min(y - (row + 1 - disk.above[row, other]), row + disk.below[row, other] - y)
        least = min(least, gap_x * gap_x + gap_y * gap_y)
        if least < enough:
            break
    return least


@njit(cache=True, nogil=True)
def _motion_is_free(ax: float, ay: float, bx: float, by: float, disk: DiskTables) -> bool:
    """Follow the segment from a to b (ax <= bx), both free, cell by cell; parameter t runs from 0 to 1.

    Every piece of the segment from one t to the next lies in the closed cell that is looked at, and the pieces leave no
    gap.  Where the segment comes nearest to a square that it does not meet, either the segment ends, which was tested
    as a point, or the square has a corner.  So corners are all that an undecided cell asks about.
    """
    dx, dy = bx - ax, by - ay
    squared_length = dx * dx + dy * dy
    if squared_length < 1e-200:  # shorter than any rounding, and its ends are free
        return True
    crosses_columns, crosses_rows = dx > 1e-300, abs(dy) > 1e-300  # below, 1 / d would overflow
    per_column = 1.0 / dx if crosses_columns else 0.0
    per_row = 1.0 / dy if crosses_rows else 0.0
    per_pixel = 1.0 / math.sqrt(squared_length)
    row_step = 1 if dy > 0.0 else -1
    next_line = 1 if dy > 0.0 else 0
    col, row = int(ax), int(ay)
    t = 0.0
    while True:
        state = disk.cells[row, col]
        if state == BLOCKED:
            return False
        if state == UNDECIDED and _passes_a_corner(row, col, ax, ay, dx, dy, squared_length, disk):
            return False
        next_column = (col + 1 - ax) * per_column if crosses_columns else 2.0
        next_row = (row + next_line - ay) * per_row if crosses_rows else 2.0
        # Rounding may put a grid line a hair before the place that a leap ended at: never go back.
        t = max(t, min(next_column, next_row))
        if state > FREE:
            # The slack holds at the point of leaving, so as much of the motion beyond it is free as well.
            t += (state - FREE) * per_pixel
            col, row = int(ax + t * dx), int(ay + t * dy)
        elif next_column <= next_row:
            col += 1
        else:
            row += row_step
        if t >= 1.0:
            return True


@njit(cache=True, nogil=True)
def _passes_a_corner(
    row: int, col: int, ax: float, ay: float, dx: float, dy: float, squared_length: float, disk: DiskTables
) -> bool:
    """Say whether a corner that faces cell (row, col) is nearer than the radius to the whole segment.

    A square in the cell's own row or column faces it with a side: where that ends, a cell of the next row or column
    that the segment goes to sees the corner.
    """
    limit = disk.radius * disk.radius * squared_length
    reach = math.ceil(disk.radius)
    for other in range(max(col - reach, 0), min(col + reach, disk.cells.shape[1] - 1) + 1):
        up, down = disk.above[row, other], disk.below[row, other]
        if other == col or up == 0:
            continue
        x = (other + 1 if other < col else other) - ax
        if up <= reach and _is_too_close(x, row + 1 - up - ay, dx, dy, squared_length, limit):
            return True
        if down <= reach and _is_too_close(x, row + down - ay, dx, dy, squared_length, limit):
            return True
    return False


@njit(cache=True, nogil=True)
def _is_too_close(x: float, y: float, dx: float, dy: float, squared_length: float, limit: float) -> bool:
    """Say whether a corner at (x, y) from the segment's start is nearer than the radius to its inside.

    Only a foot strictly between the ends counts; its squared distance is cross**2 / length**2, compared without
    dividing: `limit` = radius**2 * length**2.
    """
    along = x * dx + y * dy
    if along <= 0.0 or along >= squared_length:
        return False
    cross = dx * y - dy * x
    return cross * cross < limit


@njit(cache=True, nogil=True)
def nearest_obstacle_points(q: Floats, disk: DiskTables) -> tuple[Floats, Floats]:
    """Return the nearest obstacle point to each map point, (n, 2), and its distance, (n,), both in the map's pixels.

    A point in an obstacle, on the border or outside is its own nearest one.  Columns are visited from the point's own
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
        # `away` columns off, everything is at least away - 1 away.
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
    """Return the nearest point of surely free cells, or of a lattice of quarter pixels elsewhere; nan if none is."""
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
