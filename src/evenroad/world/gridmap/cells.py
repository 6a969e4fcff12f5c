"""The state of each cell for a disk on a grid: free, blocked or undecided; it decides most checks.

The grid is *padded*: one ring of occupied cells around the map stands for the outside.  Lengths are in pixels.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats
from evenroad._njit import njit

BLOCKED = 0
"""State of a cell whose every point is nearer than `radius` to an obstacle."""
UNDECIDED = 1
"""State of a cell that needs the exact test."""
FREE = 2
"""State of a free cell: with FREE + s every point is at least `radius` + s from every obstacle."""


Runs: TypeAlias = npt.NDArray[np.uint16]


class DiskTables(NamedTuple):
    """What the kernels know of one disk on one map; arrays over the padded grid, (rows + 2, cols + 2)."""

    frame: Floats
    """`MapFrame.coefficients()`."""
    cells: npt.NDArray[np.uint8]
    """The class of each cell, see `classify`."""
    above: Runs
    below: Runs
    """Rows to the nearest occupied cell of the column, see `vertical_runs`."""
    radius: float
    """Of the disk, in pixels."""


_LARGEST_SLACK = 255 - FREE
_LARGEST_RUN = 65535


@njit(cache=True, nogil=True)
def vertical_runs(padded: Bools) -> tuple[Runs, Runs]:
    """Return how many rows up, and how many down, the nearest occupied cell of the same column is; 0 in one.

    Runs end at 65535: in no map that fits in memory is the nearest obstacle of a point that far.
    """
    rows, cols = padded.shape
    above = np.empty((rows, cols), np.uint16)
    below = np.empty((rows, cols), np.uint16)
    for row in range(rows):
        for col in range(cols):
            before = above[row - 1, col] if row > 0 else _LARGEST_RUN
            above[row, col] = 0 if padded[row, col] else min(before + 1, _LARGEST_RUN)
    for row in range(rows - 1, -1, -1):
        for col in range(cols):
            before = below[row + 1, col] if row < rows - 1 else _LARGEST_RUN
            below[row, col] = 0 if padded[row, col] else min(before + 1, _LARGEST_RUN)
    return above, below


@njit(cache=True, nogil=True)
def classify(above: Runs, below: Runs, radius: float) -> npt.NDArray[np.uint8]:
    """Return the class of every cell of the padded grid: BLOCKED, UNDECIDED or FREE + slack.

    The farthest that a point of a cell can be from a square (dc, dr) cells away is hypot(dc, dr): where that is less
    than the radius for the nearest occupied cell, the cell is blocked.  The nearest is hypot(max(dc - 1, 0),
    max(dr - 1, 0)), the distance from the obstacles grown by one cell all round: where that is at least the radius, the
    cell is free, and the rest is slack.
    """
    rows, cols = above.shape
    squared_radius = radius * radius
    cells = np.zeros((rows, cols), np.uint8)
    centre_heights = np.empty(cols, np.int64)
    gap_heights = np.empty(cols, np.int64)
    centre_squared = np.empty(cols, np.int64)
    gap_squared = np.empty(cols, np.int64)
    apexes = np.empty(cols, np.int64)
    starts = np.empty(cols, np.int64)
    for row in range(1, rows - 1):
        for col in range(cols):
            centre_heights[col] = min(above[row, col], below[row, col])
        for col in range(cols):
            lowest = centre_heights[col]
            if col > 0:
                lowest = min(lowest, centre_heights[col - 1])
            if col < cols - 1:
                lowest = min(lowest, centre_heights[col + 1])
            gap_heights[col] = max(lowest - 1, 0)
        _squared_distances(centre_heights, centre_squared, apexes, starts)
        _squared_distances(gap_heights, gap_squared, apexes, starts)
        for col in range(1, cols - 1):
            if centre_squared[col] == 0 or centre_squared[col] < squared_radius:
                cells[row, col] = BLOCKED
            elif gap_squared[col] >= squared_radius:
                slack = math.floor(math.sqrt(gap_squared[col]) - radius)
                cells[row, col] = FREE + min(slack, _LARGEST_SLACK)
            else:
                cells[row, col] = UNDECIDED
    return cells


@njit(cache=True, nogil=True)
def _squared_distances(heights: Any, squared: Any, apexes: Any, starts: Any) -> None:
    """Write ``min over j of (i - j)**2 + heights[j]**2`` into `squared`, in linear time.

    The parabolas' lower envelope, built from left to right and then read off (Meijster, Roerdink and
    Hesselink 2000, section 2.2); `apexes` and `starts` are work space of the same length.
    """
    count = len(heights)
    last = 0
    apexes[0] = 0
    starts[0] = 0
    for new in range(1, count):
        height = heights[new]
        while last >= 0:
            old = apexes[last]
            at = starts[last]
            if (at - old) ** 2 + heights[old] ** 2 <= (at - new) ** 2 + height**2:
                break
            last -= 1
        if last < 0:
            last = 0
            apexes[0] = new
            starts[0] = 0
            continue
        old = apexes[last]
        crossing = (new * new - old * old + height * height - heights[old] ** 2) // (2 * (new - old))
        if crossing + 1 < count:
            last += 1
            apexes[last] = new
            starts[last] = crossing + 1
    for i in range(count - 1, -1, -1):
        apex = apexes[last]
        squared[i] = (i - apex) ** 2 + heights[apex] ** 2
        if i == starts[last]:
            last -= 1
