"""DiskWorld: a disk robot on a grid map, with exact answers."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import numpy as np

from evenroad._arrays import Bools, Floats, Ints, Ints32
from evenroad._checks import require_positive
from evenroad.space import Rectangle
from evenroad.space.batch import as_batch, as_batch_pair
from evenroad.world.gridmap.cells import DiskTables, classify, vertical_runs
from evenroad.world.gridmap.components import PARTS, find_gates, label_components
from evenroad.world.gridmap.frame import MapFrame
from evenroad.world.gridmap.kernel import (
    motions_are_free,
    nearest_free_point,
    nearest_obstacle_points,
    points_are_free,
)
from evenroad.world.gridmap.search import find_path, straighten
from evenroad.world.protocol import Connection

_SPREADS = (32, 96)
"""Points that a path is offered to be straightened with, in the coarse rounds and in the fine ones."""

_SMALLEST_RADIUS = 1e-150
"""In pixels: its square is still above 0, so that a disk of any size touches what its centre lies on."""


class Grid(Protocol):
    """What a disk needs to know of a map; a GridMap does."""

    @property
    def occupied(self) -> Bools:
        """Which cells are obstacles, (rows, cols)."""
        ...

    @property
    def unknown(self) -> Bools:
        """Which cells the map says nothing of, (rows, cols): for pictures."""
        ...

    @property
    def frame(self) -> MapFrame:
        """Where the cells lie."""
        ...

    @property
    def space(self) -> Rectangle:
        """The map's rectangle, in map units."""
        ...


@dataclass(frozen=True, eq=False)
class DiskWorld:
    """A disk of one radius on one map: what `GridMap.world` returns.

    Obstacles are the closed squares of the occupied cells and everything outside the map; a disk is free if
    its centre is at least `radius` away from all of them, so touching is free.  Motions are swept disks along
    straight segments.  They are tested exactly, without any step length: up to float rounding, about 1e-12
    pixels, a motion reported free never comes closer and one reported blocked does.

    Parameters
    ----------
    grid : Grid
        The map: a GridMap.
    radius : float
        Of the disk with any clearance added, in map units, > 0.

    Raises
    ------
    InvalidValue
        If `radius` is not such a number.
    """

    grid: Grid
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

    def valid(self, q: Floats) -> Bools:
        """Return whether the disk is free at each map point, (n, 2) -> (n,); False outside the map."""
        return points_are_free(as_batch("q", q, 2), self._tables)

    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """Return whether the disk can move straight from each row of `a` to that of `b`: two (m, 2) -> (m,)."""
        return motions_are_free(*as_batch_pair(a, b, 2), self._tables)

    def clearance(self, q: Floats) -> Floats:
        """Return the distance from each map point, (n, 2), to the nearest obstacle, (n,), in map units.

        It is measured from the disk's centre, so the disk is free where it is at least `radius`; it is 0 in
        an obstacle and outside the map.  Errors as `valid`.
        """
        _, distance = nearest_obstacle_points(as_batch("q", q, 2), self._tables)
        return distance * self.grid.frame.resolution

    def nearest_obstacle(self, q: Floats) -> Floats:
        """Return the obstacle point nearest to each map point, (n, 2) -> (n, 2), in map units.

        A point in an obstacle or outside the map is its own; of several equally near ones, always the same
        is returned.  Errors as `valid`.
        """
        centres = as_batch("q", q, 2)
        pixels, distance = nearest_obstacle_points(centres, self._tables)
        # A centre that is its own nearest point is returned as it came, without the detour through pixels.
        nearest = centres.copy()
        away = distance > 0.0
        nearest[away] = self.grid.frame.to_map(pixels[away])
        return nearest

    def may_connect(self, a: Floats, b: Floats) -> bool:
        """Return False where it is proved that no path leads from map point `a`, (2,), to `b`, (2,).

        Places none of whose points is free separate the others into components, in one of which every path stays.
        Where both ends are in the same one, there is a path unless it leads through a passage that is narrower than
        the disk by less than about a tenth of a pixel.
        """
        first, second = self.component(a), self.component(b)
        return first == second and first != 0

    def component(self, q: Floats) -> int:
        """Return the number, from 1 on, of the component that a map point, (2,), lies in; 0 where no disk is free."""
        column, row = self.grid.frame.to_pixels(as_batch("q", np.reshape(q, (1, -1)), 2))[0]
        rows, cols = self.grid.occupied.shape
        if not (0.0 < column < cols and 0.0 < row < rows):
            return 0
        cell = int(row) + 1, int(column) + 1
        labels, parts = self._components
        if parts[cell] < 0:
            return int(labels[cell[0] * (cols + 2) + cell[1]])
        part = int(PARTS * (row % 1.0)) * PARTS + int(PARTS * (column % 1.0))
        return int(labels[(rows + 2) * (cols + 2) + parts[cell] * PARTS**2 + part])

    def cells_of(self, component: int) -> Bools:
        """Return the cells of the map, (rows, cols), that have a part in a component."""
        labels, parts = self._components
        inside = (labels[: parts.size] == component).reshape(parts.shape)
        at_gates = (labels[parts.size :].reshape(-1, PARTS**2) == component).any(axis=1)
        inside[parts >= 0] = at_gates
        return inside[1:-1, 1:-1]

    @cached_property
    def _gates(self) -> Bools:
        return find_gates(self._tables.cells)

    @cached_property
    def _components(self) -> tuple[Ints32, Ints]:
        """Labels as `label_components` returns them, and the number of each cell among those at gates, or -1."""
        parts = np.full(self._gates.shape, -1)
        parts[self._gates] = np.arange(np.count_nonzero(self._gates))
        return label_components(self._tables, self._gates), parts

    def nearest_free(self, q: Floats) -> Floats | None:
        """Return a free map point, (2,), near the map point `q`, (2,), or None if there is none.

        It is the nearest of the surely free cells, and of a lattice of quarter pixels in those that are partly free.
        """
        pixels = self.grid.frame.to_pixels(as_batch("q", np.reshape(q, (1, -1)), 2))[0]
        x, y = nearest_free_point(pixels[0] + 1.0, pixels[1] + 1.0, self._tables)
        return None if math.isnan(x) else self.grid.frame.to_map(np.array([[x - 1.0, y - 1.0]]))[0]

    @property
    def planner(self) -> str:
        """How `connect` plans, in results."""
        return "cells"

    def connect(
        self, start: Floats, goals: Floats, *, most_motions: int = 2**31 - 1, seconds: float = math.inf
    ) -> Connection:
        """Find a path from a free map point, (2,), to the one of several, (g, 2), that is nearest on the lattice.

        It leads over cell centres, and over half cells where it is narrow; it is found wherever `may_connect` holds
        but for passages hardly wider than the disk.  `most_motions` bounds the motions that are tested.  The time is
        bounded by the size of the map; `seconds` is not looked at.
        """
        first = as_batch("start", np.reshape(start, (1, -1)), 2)[0]
        last = as_batch("goals", goals, 2)
        path, goal, nodes, motions = find_path(first, last, self._tables, self._gates, most_motions)
        return Connection(path, int(goal), nodes, 0, motions)

    def shorten(self, path: Floats) -> tuple[Floats, int]:
        """Return a path of free motions, (q, 2), that is not longer than `path`, (p, 2), and how many were tested."""
        points = as_batch("path", path, 2)
        return straighten(points, self._tables, _SPREADS) if len(points) > 1 else (points.copy(), 0)

    def fingerprint(self) -> str:
        """Return the SHA-256 (hex) of map, frame and radius: equal for two worlds that give the same verdicts."""
        digest = hashlib.sha256(f"disk {self.radius!r} {self.grid.frame!r}".encode())
        digest.update(self.grid.occupied.tobytes())
        return digest.hexdigest()

    def explain(self, q: Floats) -> str:
        """Return in words how near an obstacle is to a disk at the map point `q`, (2,)."""
        centre = np.asarray(q, dtype=np.float64)[np.newaxis]
        distance = float(self.clearance(centre)[0])
        if distance == 0.0:
            reason = "its centre lies in an obstacle or outside the map"
        else:
            x, y = self.nearest_obstacle(centre)[0]
            reason = (
                f"the obstacle at ({x:.6g}, {y:.6g}) is {distance:.6g} away, the disk needs {self.radius:.6g}"
            )
        free = self.nearest_free(centre)
        if free is None:
            return f"{reason}; no place of the map is free"
        return f"{reason}; the nearest free place is ({free[0]:.6g}, {free[1]:.6g})"


def _tables_of(grid: Grid, radius: float) -> DiskTables:
    radius_in_pixels = max(radius / grid.frame.resolution, _SMALLEST_RADIUS)
    # The ring of occupied cells stands for everything outside the map.
    above, below = vertical_runs(np.pad(grid.occupied, 1, constant_values=True))
    cells = classify(above, below, radius_in_pixels)
    frame = grid.frame.coefficients()
    for table in (frame, cells, above, below):
        table.setflags(write=False)
    return DiskTables(frame, cells, above, below, radius_in_pixels)
