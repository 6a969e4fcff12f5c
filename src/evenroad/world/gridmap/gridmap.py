"""GridMap: a grid of free and occupied cells, placed in the plane."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

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

    Raises
    ------
    InvalidValue
        If `occupied` is not a boolean array with at least one cell, or the frame is of another size.
    """

    occupied: npt.NDArray[np.bool_]
    frame: MapFrame = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        occupied = np.array(self.occupied, order="C")
        if occupied.ndim != 2 or occupied.size == 0 or occupied.dtype != np.bool_:
            raise InvalidValue(
                "occupied must be a boolean array of shape (rows, cols) with at least one cell,"
                f" got {occupied.dtype} of shape {occupied.shape}"
            )
        occupied.setflags(write=False)
        object.__setattr__(self, "occupied", occupied)
        rows, cols = occupied.shape
        if self.frame is None:
            object.__setattr__(self, "frame", MapFrame(rows=rows, cols=cols))
        elif (self.frame.rows, self.frame.cols) != (rows, cols):
            raise InvalidValue(
                f"the frame is for {self.frame.rows} rows and {self.frame.cols} columns,"
                f" but occupied has {rows} and {cols}"
            )

    @property
    def space(self) -> Rectangle:
        """The image's rectangle in map units, turned as the map is."""
        return self.frame.rectangle

    def contains(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return whether each map point, (n, 2), lies in the map's closed rectangle, (n,)."""
        pixels = self.frame.to_pixels(as_batch("q", q, 2))
        size = self.frame.cols, self.frame.rows
        inside = (pixels >= 0.0) & (pixels <= size)
        return inside[:, 0] & inside[:, 1]

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
        # Here, so that reading a map needs no compiled code.
        from evenroad.world.gridmap.disk import DiskWorld

        radius = require_positive("robot_radius", robot_radius)
        radius = require_positive(
            "robot_radius + clearance", radius + require_positive("clearance", clearance, or_zero=True)
        )
        return DiskWorld(self, radius)
