"""DiskWorld: a disk robot on a grid map, with exact answers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad.space import Rectangle
from evenroad.space.batch import as_batch, as_batch_pair
from evenroad.world.gridmap.cells import classify, vertical_runs
from evenroad.world.gridmap.frame import MapFrame
from evenroad.world.gridmap.kernel import motions_are_free, points_are_free


@dataclass(frozen=True, eq=False)
class DiskWorld:
    """A disk of one radius on one map (make it with `GridMap.world`, or `disk_world`).

    Obstacles are the closed squares of the occupied cells and everything outside the map; a disk is free if
    its centre is at least `radius` away from all of them, so touching is free.  Motions are swept disks along
    straight segments, tested exactly: there is no step length.  "Exact" means up to float rounding, about
    1e-12 pixels.

    Attributes
    ----------
    frame : MapFrame
        Where the map lies.
    radius : float
        Of the disk, with any clearance added, in map units.
    """

    frame: MapFrame
    radius: float
    _cells: npt.NDArray[np.uint8]
    _above: npt.NDArray[np.uint16]
    _below: npt.NDArray[np.uint16]

    @property
    def space(self) -> Rectangle:
        """The map's rectangle, in map units."""
        return self.frame.rectangle

    def valid(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return whether the disk is free at each map point, (n, 2) -> (n,); False outside the map.

        Raises
        ------
        InvalidValue
            If `q` has another shape or an entry that is not finite.
        """
        return points_are_free(as_batch("q", q, 2), *self._tables())

    def motion_valid(self, a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return whether the disk can move straight from each row of `a` to that of `b`: two (m, 2) -> (m,).

        Raises
        ------
        InvalidValue
            If the two differ in length, or as `valid`.
        """
        return motions_are_free(*as_batch_pair(a, b, 2), *self._tables())

    def _tables(self) -> tuple[npt.NDArray[np.generic] | float, ...]:
        return (
            self.frame.coefficients(),
            self._cells,
            self._above,
            self._below,
            self.radius / self.frame.resolution,
        )


def disk_world(occupied: npt.NDArray[np.bool_], frame: MapFrame, radius: float) -> DiskWorld:
    """Build the world of a disk of `radius` map units among the True cells of `occupied`, (rows, cols)."""
    above, below = vertical_runs(np.pad(occupied, 1, constant_values=True))
    cells = classify(above, below, radius / frame.resolution)
    for table in (cells, above, below):
        table.setflags(write=False)
    return DiskWorld(frame, radius, cells, above, below)
