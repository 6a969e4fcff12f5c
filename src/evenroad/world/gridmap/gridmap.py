"""GridMap: a map that robots drive on, as free and occupied cells."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, overload

import numpy as np

from evenroad._arrays import Bools, Floats, set_fields
from evenroad._call import explains_calls
from evenroad._checks import require_positive
from evenroad._hints import KnowsElsewhere
from evenroad.errors import InvalidValue, shown
from evenroad.space import Rectangle
from evenroad.space.batch import as_batch
from evenroad.world.gridmap.frame import MapFrame

if TYPE_CHECKING:
    from PIL import Image

    from evenroad.driving.car_world import CarWorld
    from evenroad.driving.footprint import Footprint, FootprintLike
    from evenroad.world.gridmap.disk_world import DiskWorld


@explains_calls
@dataclass(frozen=True, eq=False, init=False, repr=False)
class GridMap(metaclass=KnowsElsewhere):
    """The occupied cells of a map, and its frame.

    Parameters
    ----------
    occupied : array_like of bool, shape (rows, cols), at least one cell
        True where a cell is an obstacle; row 0 is the top of the image.  Copied to a read-only array.
    frame : MapFrame, optional
        Frame of the cells; by default that of a bare image of this size: x right, y down, unit = pixel.
    unknown : array_like of bool, shape (rows, cols), optional
        Unknown cells; `occupied` says whether they are obstacles.  Default: none.
    resolution : float, optional
        Side of a cell, > 0 [m], in place of `frame`: a map like those of ROS, y up, with the origin in the lower left.
    notes : iterable of str, optional
        Notes, one line each, about values that may have been meant differently; `load_map` fills it.

    Raises
    ------
    InvalidValue
        If the arrays are not of one size and of bools, or frame and resolution are both given.

    Examples
    --------
    >>> import numpy as np
    >>> import evenroad as er
    >>> er.GridMap(np.zeros((20, 30), dtype=bool), resolution=0.1)
    GridMap(20 x 30 cells of 0.1, 0% occupied)
    """

    occupied: Bools
    frame: MapFrame
    unknown: Bools
    notes: tuple[str, ...]

    def __init__(
        self,
        occupied: Bools,
        frame: MapFrame | None = None,
        unknown: Bools | None = None,
        *,
        resolution: float | None = None,
        notes: Iterable[str] = (),
    ) -> None:
        occupied = _as_cells("occupied", occupied)
        rows, cols = occupied.shape
        unknown = np.zeros((rows, cols), dtype=bool) if unknown is None else _as_cells("unknown", unknown)
        if unknown.shape != (rows, cols):
            raise InvalidValue(f"unknown has shape {unknown.shape}, but occupied {(rows, cols)}")
        if frame is not None and resolution is not None:
            raise InvalidValue("a map must have one of frame and resolution, got both")
        if frame is None and resolution is not None:
            frame = MapFrame(rows=rows, cols=cols, resolution=resolution, y_up=True)
        frame = MapFrame(rows=rows, cols=cols) if frame is None else frame
        if not isinstance(frame, MapFrame) or (frame.rows, frame.cols) != (rows, cols):
            raise InvalidValue(
                f"frame must be a MapFrame of {rows} rows and {cols} columns, as occupied has, got {shown(frame)}; the"
                " side of a cell is resolution=0.05"
            )
        set_fields(self, occupied=occupied, unknown=unknown, frame=frame, notes=tuple(notes))

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.frame.rows, self.frame.cols

    @property
    def resolution(self) -> float:
        """Side of a cell, in map units."""
        return self.frame.resolution

    @property
    def origin(self) -> tuple[float, float]:
        """Origin of the map, in map units: see :class:`MapFrame`."""
        return self.frame.origin

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Least and largest x and y of the map, (2,) each, in map units."""
        corners = self.space.from_cube(np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]]))
        return corners.min(axis=0), corners.max(axis=0)

    def plot(self, path: str | os.PathLike[str] | None = None) -> Image.Image:
        """Return a picture of the map, with at least one pixel per cell.

        Parameters
        ----------
        path : str or path-like, optional
            A ``.png`` to save it to.

        Returns
        -------
        PIL.Image.Image

        Raises
        ------
        BrokenFile
            If the file cannot be written.

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> grid = er.GridMap(np.zeros((20, 30), dtype=bool), resolution=0.1)
        >>> grid.plot().size
        (600, 400)
        """
        from evenroad.viz.result import plot_map

        return plot_map(self, path)

    def __repr__(self) -> str:
        rows, cols = self.shape
        size = f"{rows} x {cols} cells of {self.resolution:g}"
        return f"GridMap({size}, {self.occupied.mean():.0%} occupied)"

    @property
    def space(self) -> Rectangle:
        """The image's rectangle in map units, rotated like the map."""
        return self.frame.rectangle

    def contains(self, q: Floats) -> Bools:
        """Return which points lie in the map's closed rectangle.

        Parameters
        ----------
        q : array_like, shape (n, 2)
            In map units.

        Returns
        -------
        bool ndarray, shape (n,)

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> grid = er.GridMap(np.zeros((20, 30), dtype=bool), resolution=0.1)
        >>> grid.contains([(1, 1), (4, 1)]).tolist()
        [True, False]
        """
        column, row = self.frame.to_pixels(as_batch("q", q, 2)).T
        return np.asarray((column >= 0.0) & (column <= self.frame.cols) & (row >= 0.0) & (row <= self.frame.rows))

    @overload
    def world(self, radius: float, clearance: float = ...) -> DiskWorld: ...
    @overload
    def world(
        self,
        *,
        clearance: float = ...,
        footprint: Footprint | FootprintLike,
        turning_radius: float = ...,
        reverse: bool = ...,
        holonomic: bool = ...,
    ) -> CarWorld: ...
    def world(
        self,
        radius: float | None = None,
        clearance: float = 0.0,
        *,
        footprint: Footprint | FootprintLike | None = None,
        turning_radius: float = 0.0,
        reverse: bool = True,
        holonomic: bool = False,
    ) -> DiskWorld | CarWorld:
        """Return the world of a robot on the map: of a disk, or of a car with a footprint.

        Parameters
        ----------
        radius : float
            Radius of the disk, > 0, in map units: metres for a ROS map, pixels for a bare image.
        clearance : float
            Least distance from every obstacle, >= 0, in map units.  Around corners of a footprint it is up to 2 % more.
        footprint : Footprint or array_like, shape (n, 2), optional
            In place of `radius`: corners of a polygon around the robot's reference point, x forwards, y to the left,
            or a list of several polygons.
        turning_radius : float
            Of a footprint: least radius of a turn, >= 0, in map units.  Default: 0, which turns on the spot.
        reverse : bool
            Of a footprint: whether it may drive backwards.  Default: True.
        holonomic : bool
            Of a footprint: whether it moves in every direction, and turns while it does.  Default: False.

        Returns
        -------
        DiskWorld or CarWorld
            Configurations are points (x, y) of a disk, and poses (x, y, angle) of a footprint.

        Raises
        ------
        InvalidValue
            If a number is not such a one, a footprint crosses itself or is larger than the map, or both a radius and a
            footprint are given.

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> grid = er.GridMap(np.zeros((20, 30), dtype=bool), resolution=0.1)
        >>> grid.world(radius=0.25)
        DiskWorld(radius 0.25, 20 x 30 cells)
        >>> box = [(-0.3, -0.2), (0.3, -0.2), (0.3, 0.2), (-0.3, 0.2)]
        >>> car = grid.world(footprint=box, turning_radius=0.5)
        >>> car.valid([(0.3, 1, 0), (0.2, 1, 0)]).tolist()
        [True, False]
        """
        if footprint is not None:
            if radius is not None:
                raise InvalidValue("a robot is a disk, with radius=, or has a footprint=; give one of the two")
            from evenroad.driving.car_world import CarWorld
            from evenroad.driving.footprint import as_footprint

            return CarWorld(self, as_footprint(footprint), turning_radius, reverse, holonomic, clearance)
        if radius is None or turning_radius != 0.0 or not reverse or holonomic:
            raise InvalidValue("a map goes with radius=, that of a disk in map units, or footprint=, that of a car")
        own = require_positive("radius", radius)
        extra = require_positive("clearance", clearance, or_zero=True)
        from evenroad.world.gridmap.disk_world import DiskWorld

        return DiskWorld(self, require_positive("radius + clearance", own + extra), extra)

    def with_cells(self, occupied: Bools) -> GridMap:
        """Return the map with other occupied cells, none of them unknown, in the same frame.

        Parameters
        ----------
        occupied : array_like of bool, shape (rows, cols)

        Returns
        -------
        GridMap

        Raises
        ------
        InvalidValue
            If it has another shape, or is not of bools.

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> grid = er.GridMap(np.zeros((20, 30), dtype=bool), resolution=0.1)
        >>> grid.with_cells(np.ones((20, 30), dtype=bool))
        GridMap(20 x 30 cells of 0.1, 100% occupied)
        """
        if np.shape(occupied) != self.shape:
            raise InvalidValue(f"occupied must have the shape of the map, {self.shape}, got {np.shape(occupied)}")
        return GridMap(occupied, self.frame, notes=self.notes)

    def cropped(self) -> GridMap:
        """Return the map without rows and columns beyond its outermost free cells, in the same position.

        Nothing changes for a disk, because the outside of a map is also an obstacle.  Points drawn over the smaller
        rectangle lie near free cells, even if most of the map is unknown.
        """
        rows, cols = (np.flatnonzero((~self.occupied).any(axis=axis)) for axis in (1, 0))
        if not rows.size:
            return self
        top, bottom, left, right = int(rows[0]), int(rows[-1]) + 1, int(cols[0]), int(cols[-1]) + 1
        x, y = self.frame.to_map(np.array([[left, bottom if self.frame.y_up else top]], dtype=float))[0]
        frame = replace(self.frame, rows=bottom - top, cols=right - left, origin=(float(x), float(y)))
        inside = slice(top, bottom), slice(left, right)
        return GridMap(self.occupied[inside], frame, self.unknown[inside], notes=self.notes)


def _as_cells(name: str, value: Bools) -> Bools:
    cells = np.asarray(value)
    # A read-only array needs no copy. A copy of 100 million cells takes as long as reading them.
    if cells is not value or cells.flags.writeable or not cells.flags.owndata or not cells.flags.c_contiguous:
        cells = np.array(value, order="C")
    if cells.ndim != 2 or cells.size == 0 or cells.dtype != np.bool_:
        raise InvalidValue(
            f"{name} must be a boolean array of shape (rows, cols) with at least one cell,"
            f" got {cells.dtype} of shape {cells.shape}; a file is read by load_map, numbers are compared, as cells > 0"
        )
    return cells
