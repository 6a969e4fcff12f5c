"""DiskWorld: a disk robot on a map, with exact checks."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np

from evenroad._arrays import Bools, Floats, set_fields
from evenroad._call import explains_calls
from evenroad._checks import require_positive
from evenroad._native.world import Components, Disk
from evenroad._time_limit import look_at_clock
from evenroad.errors import distinguished
from evenroad.space import Rectangle
from evenroad.space.batch import as_batch, as_batch_pair
from evenroad.world.clearance import least_distance
from evenroad.world.gridmap.gridmap import GridMap
from evenroad.world.one_or_many import OneOrMany, one_or_many
from evenroad.world.protocol import Apart

PROVED = "proved: there is no path; start and goal lie in two components of the free space"

_OF_CELL = 3e-8
"""Shortest time per cell to compute the components of a map [s]."""
_CLOSE = 1e-3
"""Largest amount by which a reported clearance is too small [pixels]."""
_INTERVALS = 300_000
"""Budget for the lower bound of path lengths, in intervals of cell sides: some hundredths of a second."""
_UNKNOWN_COUNT = "unknown cells count as obstacles unless unknown_is_free=True or --unknown-is-free says otherwise"
_ON_A_SIDE = 1e-6
"""Distance from a side of a cell within which a point is on it [pixels]."""
_ROUNDINGS = 16
"""Number of times that a coordinate of a state may have been rounded."""
_SMALLEST_RADIUS = 1e-150
"""Smallest radius. Its square is above 0, so that a disk of any size touches a cell under its centre [pixels]."""


@explains_calls
@dataclass(frozen=True, eq=False, repr=False)
class DiskWorld(OneOrMany):
    """The world of a disk of one radius on one map, made by `GridMap.world`.

    Obstacles are the closed squares of the occupied cells, and everything outside the map.  A disk is free if its
    centre is at least `radius` away from all of them, so touching is free.  Motions are swept disks along straight
    segments.  They are tested without a step length, and are exact up to float rounding, about 1e-12 pixels.  `radius`
    is that of the disk plus any clearance, in map units, > 0, else InvalidValue; `margin` is the clearance in it.
    """

    proof: ClassVar[str] = "exact"
    """The kind of proof of a motion's check."""

    grid: GridMap
    radius: float
    margin: float = 0.0
    disk: Disk = field(init=False, repr=False)

    def __post_init__(self) -> None:
        radius = require_positive("radius", self.radius)
        set_fields(self, radius=radius, disk=_disk_on(self.grid, radius))

    def __reduce__(self) -> tuple[type[DiskWorld], tuple[object, ...]]:
        """Return the arguments of a copy, which makes its own tables, here or in another process."""
        return type(self), (self.grid, self.radius, self.margin)

    @property
    def space(self) -> Rectangle:
        """The map's rectangle, in map units."""
        return self.grid.space

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes about values that the files of the map may mean differently."""
        return self.grid.notes

    def __repr__(self) -> str:
        rows, cols = self.grid.occupied.shape
        return f"DiskWorld(radius {self.radius:g}, {rows} x {cols} cells)"

    @one_or_many
    def valid(self, q: Floats) -> Bools:
        """Return whether the disk is free at each map point, (n, 2) -> (n,); False outside the map.

        For one point, (2,), it is a bool; likewise for `motion_valid`.
        """
        return self.disk.points_free(as_batch("q", q, 2))

    @one_or_many
    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """Return whether the disk can move straight from each row of `a` to that of `b`: two (m, 2) -> (m,)."""
        return self.disk.motions_free(*as_batch_pair(a, b, 2))

    def with_cells(self, occupied: Bools) -> DiskWorld:
        """Return the world of the same disk on a map whose cells have changed: see :meth:`GridMap.with_cells`."""
        return DiskWorld(self.grid.with_cells(occupied), self.radius, self.margin)

    def driven_free(self, states: Floats) -> Bools:
        """Return which motions between states of a trajectory, (n, 2), are free: (n - 1,).

        States are computed from a path and rounded.  If the path touches an obstacle, rounded states may overlap it.
        """
        points = as_batch("states", states, 2)
        free = self.disk.motions_free(points[:-1], points[1:])
        again = np.flatnonzero(~free)
        if again.size:
            free[again] = self._nearly.motions_free(points[again], points[again + 1])
        return free

    @cached_property
    def _nearly(self) -> Disk:
        """A disk that is smaller by the rounding of coordinates on this map."""
        farthest = max(float(np.abs(corner).max()) for corner in self.grid.bounds)
        rounding = _ROUNDINGS * np.finfo(float).eps * (farthest / self.grid.resolution + sum(self.grid.shape))
        return _disk_on(self.grid, max(self.radius - rounding * self.grid.resolution, 0.0))

    @one_or_many
    def distance(self, q: Floats) -> Floats:
        """Return the signed distance between the disk and the nearest obstacle, in map units (metres in a ROS map).

        Parameters
        ----------
        q : array_like, shape (n, 2) or (2,)
            Centres of the disk; for one, the distance is a float.

        Returns
        -------
        ndarray, shape (n,)
            Negative if the disk overlaps an obstacle.  It is minus the radius if the centre lies in an obstacle or
            outside the map.  The disk is free if the distance is at least the clearance of the world, by default 0.
        """
        return self._from_centre(as_batch("q", q, 2)) - (self.radius - self.margin)

    def _from_centre(self, q: Floats) -> Floats:
        """Return the distance from the disk's centre, (n, 2), to the nearest obstacle, (n,)."""
        return self.disk.nearest_obstacles(q)[1] * self.grid.frame.resolution

    def path_clearance(self, path: Floats) -> float:
        """Return the clearance of the disk along a path, (p, 2), within 1e-3 pixels and never too large."""
        points = as_batch("path", path, 2)
        nearest = least_distance(points, self._from_centre, _CLOSE * self.grid.frame.resolution)
        return max(0.0, nearest - (self.radius - self.margin))

    def nearest_obstacle(self, q: Floats) -> Floats:
        """Return the obstacle point nearest to each map point, (n, 2) -> (n, 2), in map units.

        A point in an obstacle or outside the map is its own nearest point.  Ties are always resolved in the same way.
        """
        centres = as_batch("q", q, 2)
        pixels, distance = self.disk.nearest_obstacles(centres)
        # A centre that is its own nearest point is returned unchanged, not rounded by pixels.
        nearest, away = centres.copy(), distance > 0.0
        nearest[away] = self.grid.frame.to_map(pixels[away])
        return nearest

    def nearest_free(self, q: Floats) -> Floats | None:
        """Return a free map point, (2,), near the map point `q`, (2,), or None if there is none.

        It is the nearest point of entirely free cells, or of a lattice of quarter pixels in partly free cells.
        """
        column, row = self._pixels(q)
        free = self.disk.nearest_free(column, row)
        return None if free is None else self.grid.frame.to_map(np.array([free]))[0]

    def may_connect(self, a: Floats, b: Floats) -> bool:
        """Return False if it is proved that no path leads from map point `a`, (2,), to `b`, (2,).

        Cells without a free point separate the others into components, and every path stays in one of them.  If both
        points are in the same component, there is a path, unless it leads through a passage that is narrower than the
        disk by less than about a tenth of a pixel.
        """
        return self.component(a) == self.component(b) != 0

    def apart(self, start: Floats, goals: Floats, *, quickly: bool = False) -> Apart | None:
        """Return the proof that no path leads from a start, (2,), to any goal, (g, 2); None means unknown.

        Tiles of the map decide first.  Then the components of the whole map are computed once, unless `quickly`.
        """
        first, last = as_batch("start", np.reshape(start, (1, -1)), 2)[0], as_batch("goals", goals, 2)
        if self.disk.may_reach(first, last) and (quickly or any(self.may_connect(start, goal) for goal in goals)):
            return None
        counted = f"; {_UNKNOWN_COUNT}" if (self.grid.unknown & self.grid.occupied).any() else ""
        return Apart(PROVED + counted, proved=True)

    def least_length(self, start: Floats, goals: Floats) -> float:
        """Return a lower bound of the length of paths from a map point, (2,), to any goal, (g, 2), in map units.

        It is the length of the shortest path of a point, in any direction, through all cells that are not entirely
        blocked: the disk's paths stay in them.  It is infinite if they join no goal to the start.  On a large map it
        takes at most some hundredths of a second; parts that are unknown by then make the bound smaller.
        """
        first = as_batch("start", np.reshape(start, (1, -1)), 2)[0]
        last = as_batch("goals", goals, 2)
        return min(self.disk.least_length(first, goal, _INTERVALS // len(last)) for goal in last)

    def component(self, q: Floats) -> int:
        """Return the number, from 1, of the component that contains a map point, (2,); 0 if no disk is free there."""
        column, row = self._pixels(q)
        rows, cols = self.grid.occupied.shape
        if not (0.0 < column < cols and 0.0 < row < rows):
            return 0
        return self._components.at(column, row)

    def cells_of(self, component: int) -> Bools:
        """Return the cells of the map, (rows, cols), that overlap a component."""
        return self._components.cells_of(component)[1:-1, 1:-1]

    @cached_property
    def _components(self) -> Components:
        look_at_clock(_OF_CELL * self.grid.occupied.size)
        return Components(self.disk)

    def fingerprint(self) -> str:
        """Return the SHA-256 (hex) of map, frame and radius: equal for worlds of equal results."""
        digest = hashlib.sha256(f"disk {self.radius!r} {self.grid.frame!r}".encode())
        digest.update(self.grid.occupied.tobytes())
        return digest.hexdigest()

    def explain(self, q: Floats) -> str:
        """Return in words how near an obstacle is to a disk at the map point `q`, (2,)."""
        centre = self._row(q)[np.newaxis]
        pixels, distances = self.disk.nearest_obstacles(centre)
        is_unknown = self._is_unknown(pixels[0])
        kind = "unknown cell" if is_unknown else "obstacle"
        if not self.grid.contains(centre)[0]:
            reason = "its centre lies outside the map"
        elif distances[0] == 0.0:
            reason = f"its centre lies in an {kind}"
        else:
            x, y = self.grid.frame.to_map(pixels)[0]
            # The distance is rounded down, so that a blocked disk never seems far enough away.
            distance = min(float(distances[0]) * self.grid.frame.resolution, math.nextafter(self.radius, 0.0))
            away, needs = distinguished(distance, self.radius)
            reason = f"the {kind} at ({x:.6g}, {y:.6g}) is {away} away, the disk needs {needs}"
        reason += f" ({_UNKNOWN_COUNT})" if is_unknown else ""
        free = self.nearest_free(centre)
        if free is None:
            return f"{reason}; no position on the map is free"
        return f"{reason}; the nearest free position is ({free[0]:.6g}, {free[1]:.6g})"

    def _is_unknown(self, pixel: Floats) -> bool:
        """Return whether all obstacles that a point of the pixel plane, (2,), lies in are unknown cells."""
        rows, cols = self.grid.shape
        found = []
        for row in {math.floor(pixel[1] - _ON_A_SIDE), math.floor(pixel[1] + _ON_A_SIDE)}:
            for column in {math.floor(pixel[0] - _ON_A_SIDE), math.floor(pixel[0] + _ON_A_SIDE)}:
                inside = 0 <= row < rows and 0 <= column < cols
                if not inside or self.grid.occupied[row, column]:
                    found.append(inside and bool(self.grid.unknown[row, column]))
        return bool(found) and all(found)

    def _pixels(self, q: Floats) -> Floats:
        """Return the pixel coordinates (column, row) of one map point."""
        return np.ravel(self.grid.frame.to_pixels(as_batch("q", np.reshape(q, (1, -1)), 2)))


def _disk_on(grid: GridMap, radius: float) -> Disk:
    radius_in_pixels = max(radius / grid.frame.resolution, _SMALLEST_RADIUS)
    return Disk(grid.occupied, grid.frame.coefficients(), radius_in_pixels)
