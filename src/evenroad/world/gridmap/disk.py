"""DiskWorld: a disk robot on a grid map, with exact answers."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_positive
from evenroad.space import Rectangle
from evenroad.space.batch import as_batch, as_batch_pair
from evenroad.world.gridmap.cells import DiskTables, classify, vertical_runs
from evenroad.world.gridmap.gridmap import GridMap
from evenroad.world.gridmap.kernel import motions_are_free, points_are_free
from evenroad.world.gridmap.nearest import nearest_obstacle_points

_SMALLEST_RADIUS = 1e-150
"""In pixels: its square is still above 0, so that a disk of any size touches what its centre lies on."""


@dataclass(frozen=True, eq=False)
class DiskWorld:
    """A disk of one radius on one map: what `GridMap.world` returns.

    Obstacles are the closed squares of the occupied cells and everything outside the map; a disk is free if
    its centre is at least `radius` away from all of them, so touching is free.  Motions are swept disks along
    straight segments.  They are tested exactly, without any step length: up to float rounding, about 1e-12
    pixels, a motion reported free never comes closer and one reported blocked does.

    Parameters
    ----------
    grid : GridMap
        The map.
    radius : float
        Of the disk with any clearance added, in map units, > 0.

    Raises
    ------
    InvalidValue
        If `radius` is not such a number.
    """

    grid: GridMap
    radius: float
    _tables: DiskTables = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", require_positive("radius", self.radius))
        object.__setattr__(self, "_tables", _tables_of(self.grid, self.radius))

    @property
    def space(self) -> Rectangle:
        """The map's rectangle, in map units."""
        return self.grid.space

    @property
    def proof(self) -> str:
        """What is shown of a motion called free: ``exact``."""
        return "exact"

    def valid(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return whether the disk is free at each map point, (n, 2) -> (n,); False outside the map.

        Raises
        ------
        InvalidValue
            If `q` has another shape or an entry that is not finite.
        """
        return points_are_free(as_batch("q", q, 2), self._tables)

    def motion_valid(self, a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return whether the disk can move straight from each row of `a` to that of `b`: two (m, 2) -> (m,).

        Raises
        ------
        InvalidValue
            If the two differ in length, or as `valid`.
        """
        return motions_are_free(*as_batch_pair(a, b, 2), self._tables)

    def clearance(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return the distance from each map point, (n, 2), to the nearest obstacle, (n,), in map units.

        It is measured from the disk's centre, so the disk is free where it is at least `radius`; it is 0 in
        an obstacle and outside the map.  Errors as `valid`.
        """
        _, distance = nearest_obstacle_points(as_batch("q", q, 2), self._tables)
        return distance * self.grid.frame.resolution

    def nearest_obstacle(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return the obstacle point nearest to each map point, (n, 2) -> (n, 2), in map units.

        A point in an obstacle or outside the map is its own; of several equally near ones, always the same
        is returned.  Errors as `valid`.
        """
        centres = as_batch("q", q, 2)
        pixels, distance = nearest_obstacle_points(centres, self._tables)
        # A centre that is its own nearest point is returned as it came, without the way through pixels.
        nearest = centres.copy()
        away = distance > 0.0
        nearest[away] = self.grid.frame.to_map(pixels[away])
        return nearest

    def fingerprint(self) -> str:
        """Return the SHA-256 (hex) of map, frame and radius: equal for two worlds that give the same verdicts."""
        digest = hashlib.sha256(f"disk {self.radius!r} {self.grid.frame!r}".encode())
        digest.update(self.grid.occupied.tobytes())
        return digest.hexdigest()

    def explain(self, q: npt.NDArray[np.float64]) -> str:
        """Return in words how near an obstacle is to a disk at the map point `q`, (2,)."""
        centre = np.asarray(q, dtype=np.float64)[np.newaxis]
        distance = float(self.clearance(centre)[0])
        if distance == 0.0:
            return "its centre lies in an obstacle or outside the map"
        x, y = self.nearest_obstacle(centre)[0]
        return f"the obstacle at ({x:.6g}, {y:.6g}) is {distance:.6g} away, the disk needs {self.radius:.6g}"


def _tables_of(grid: GridMap, radius: float) -> DiskTables:
    radius_in_pixels = max(radius / grid.frame.resolution, _SMALLEST_RADIUS)
    # The ring of occupied cells stands for everything outside the map.
    above, below = vertical_runs(np.pad(grid.occupied, 1, constant_values=True))
    cells = classify(above, below, radius_in_pixels)
    frame = grid.frame.coefficients()
    for table in (frame, cells, above, below):
        table.setflags(write=False)
    return DiskTables(frame, cells, above, below, radius_in_pixels)
