"""GridMap: a grid of free and occupied cells, placed in the plane."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad._checks import require_positive
from evenroad.errors import InvalidValue
from evenroad.space import Rectangle
from evenroad.space.batch import as_batch
from evenroad.world.gridmap.frame import MapFrame

if TYPE_CHECKING:
    from evenroad.world.gridmap.disk import DiskWorld


@dataclass(frozen=True, eq=False)
class GridMap:
    """Which cells of a map are occupied, and where the map lies.

    Parameters
    ----------
    occupied : array_like of bool, shape (rows, cols)
        True where a cell is an obstacle; row 0 is the top of the image.  Copied to a read-only array.
    frame : MapFrame, optional
        Where the cells lie; by default that of a bare image of this size: x right, y down, unit = pixel.
    unknown : array_like of bool, shape (rows, cols), optional
        Cells of which a map says nothing; whether they are obstacles, `occupied` says.  Default: none.

    Raises
    ------
    InvalidValue
        If `occupied` or `unknown` is not a boolean array with at least one cell, or a size differs from that of
        `occupied`.
    """

    occupied: Bools
    frame: MapFrame = None  # type: ignore[assignment]
    unknown: Bools = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        object.__setattr__(self, "occupied", _as_cells("occupied", self.occupied))
        rows, cols = self.occupied.shape
        unknown = np.zeros((rows, cols), dtype=np.bool_) if self.unknown is None else self.unknown
        object.__setattr__(self, "unknown", _as_cells("unknown", unknown))
        if self.unknown.shape != (rows, cols):
            raise InvalidValue(f"unknown has shape {self.unknown.shape}, but occupied {(rows, cols)}")
        if self.frame is None:
            object.__setattr__(self, "frame", MapFrame(rows=rows, cols=cols))
        elif (self.frame.rows, self.frame.cols) != (rows, cols):
            raise InvalidValue(
                f"the frame is for {self.frame.rows} rows and {self.frame.cols} columns,"
                f" but occupied has {rows} and {cols}"
            )

    @property
    def space(self) -> Rectangle:
        """The image's rectangle in map units, rotated as the map is."""
        return self.frame.rectangle

    def contains(self, q: Floats) -> Bools:
        """Return whether each map point, (n, 2), lies in the map's closed rectangle, (n,)."""
        pixels = self.frame.to_pixels(as_batch("q", q, 2))
        size = self.frame.cols, self.frame.rows
        inside = (pixels >= 0.0) & (pixels <= size)
        return inside[:, 0] & inside[:, 1]

    def cropped(self) -> GridMap:
        """Return the map without what lies beyond its outermost free cells, in the same place.

        Nothing changes for a disk: what is left out is obstacle, and so is the outside of a map.  Points of its
        rectangle are then drawn where the map is free, which matters where most of it is unknown.
        """
        rows, cols = (np.flatnonzero((~self.occupied).any(axis=axis)) for axis in (1, 0))
        if not rows.size:
            return self
        top, bottom, left, right = int(rows[0]), int(rows[-1]) + 1, int(cols[0]), int(cols[-1]) + 1
        x, y = self.frame.to_map(np.array([[left, bottom if self.frame.y_up else top]], dtype=float))[0]
        frame = replace(self.frame, rows=bottom - top, cols=right - left, origin=(float(x), float(y)))
        inside = slice(top, bottom), slice(left, right)
        return GridMap(self.occupied[inside], frame, self.unknown[inside])

    def world(self, robot_radius: float, clearance: float = 0.0) -> DiskWorld:
        """Return the world of a disk robot on this map.

        Parameters
        ----------
        robot_radius : float
            In map units (pixels for a bare image, metres for a ROS map), > 0.
        clearance : float
            Added to the radius: how far from obstacles the robot must stay, >= 0.

        Raises
        ------
        InvalidValue
            If one of them is not such a number.
        """
        # Here, so that reading a map needs no compiled code; the disk's module knows nothing of this one.
        from evenroad.world.gridmap.disk import DiskWorld

        radius = require_positive("robot_radius", robot_radius)
        radius = require_positive(
            "robot_radius + clearance", radius + require_positive("clearance", clearance, or_zero=True)
        )
        return DiskWorld(self, radius)


def _as_cells(name: str, value: Bools) -> Bools:
    """Return a read-only copy of an array of cells."""
    cells = np.array(value, order="C")
    if cells.ndim != 2 or cells.size == 0 or cells.dtype != np.bool_:
        raise InvalidValue(
            f"{name} must be a boolean array of shape (rows, cols) with at least one cell,"
            f" got {cells.dtype} of shape {cells.shape}"
        )
    cells.setflags(write=False)
    return cells
