"""Infeasibility proofs by cells that are split only where a path may lead through them.

A cell is blocked if every configuration in it is blocked, and clear if none is.  All other cells are unknown.  The
method splits unknown cells on the paths that have the fewest of them (D. Zhu and J.-C. Latombe, 1991).  It ends when
start and goal are separated, or joined by clear cells.  Compiled code keeps the cells and searches them.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from evenroad._arrays import Floats
from evenroad._native.infeasibility import SplitCells
from evenroad._time_limit import look_at_clock
from evenroad.infeasibility.prefix_cells import Bodies, CellTests, cells_around, first_links

COARSE = 500
"""Number of cells at the beginning, per square of the number of joints."""


def search_cells(
    bodies: Bodies, start: Floats, goals: Floats, joints: int, most: int
) -> Literal["apart", "joined", "undecided"]:
    """Return whether the first joints cannot pass from a start, (dim,), to any goal, (g, dim): ``apart``.

    It is ``joined`` if cells that seem clear lead to a goal, and ``undecided`` if neither is shown with `most` cells.
    """
    first = first_links(bodies.robot, joints)
    if not first.capsules:
        return "undecided"
    grid, tests = (
        cells_around(first, start[:joints], np.full(joints, np.inf), COARSE * joints**2),
        CellTests(bodies, first),
    )
    cells = SplitCells(grid.low, grid.size, grid.count, grid.period, grid.whole)
    terminals = np.ascontiguousarray(start[:joints]), np.ascontiguousarray(goals[:, :joints])
    while True:
        for depth in cells.depths:
            look_at_clock()
            half, middles = 0.5 * grid.size / 2**depth, cells.middles(depth)
            clear, kept = np.zeros(len(middles), dtype=np.bool_), tests.unblocked(half, middles)
            clear[kept] = tests.clear(half, middles[kept])
            cells.decide(depth, kept, clear)
        if (ended := cells.search(*terminals, most)) != "split":
            return ended
