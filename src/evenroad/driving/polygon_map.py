"""PolygonMap: polygons as obstacles, tested as they are, for cars and other footprints."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, set_fields
from evenroad._call import explains_calls
from evenroad._checks import as_file, counted, require_positive
from evenroad._native.drive import Obstacles
from evenroad.driving.polygon_files import SUFFIXES, read_parking, read_polygons
from evenroad.errors import InvalidValue, shown
from evenroad.world.gridmap.frame import MapFrame
from evenroad.world.gridmap.gridmap import GridMap
from evenroad.world.gridmap.load import load_map

if TYPE_CHECKING:
    from evenroad.driving.car_world import CarWorld
    from evenroad.driving.footprint import Footprint, FootprintLike

MOST = 1_000_000
"""Largest number of corners of all polygons."""
_CELLS = 800
"""Number of cells along the longer side of a map, by default."""
_MOST_CELLS = 20_000_000
"""Largest number of cells of a map."""
_MOST_TOUCHED = 50_000_000
"""Largest number of cells that sides go through, each side counted."""
_FARTHEST = 1e6
"""Largest distance of a corner from the map [cells]."""
_MARGIN = 0.25
"""Distance of the map's border from all polygons by default, as a share of its longer side."""

Bounds = tuple[npt.ArrayLike, npt.ArrayLike]
"""Least and largest x and y, (2,) each."""


@explains_calls
@dataclass(frozen=True, eq=False, init=False, repr=False)
class PolygonMap:
    """A map whose obstacles are polygons, and all that lies outside of a rectangle.

    Polygons are closed, and tested as they are.  Cells only say which of them are near.

    Parameters
    ----------
    polygons : path, or sequence of array_like, shape (n, 2)
        A GeoJSON file (.geojson, .json) of polygons and lines in one plane, or a parking case of TPCAP (.csv).  Or the
        corners of each polygon, n >= 2; two are a wall of no thickness.  A polygon with holes is a sequence of borders.
        At most a million corners.
    bounds : pair of array_like, shape (2,), optional
        Least and largest x and y of the map.  Default: the `bbox` of a GeoJSON file; else a quarter of the longer side
        more than polygons and, of a parking case, start and goal need.
    resolution : float, optional
        Side of the cells, > 0.  It decides how fast checks are, and no result.  Default: 800 along the longer side.
    names : sequence of str, optional
        What messages call the polygons.  Default: names of GeoJSON features, else ``polygon 0`` and so on.

    Attributes
    ----------
    polygons : tuple of tuple of ndarrays, shape (n, 2)
        The borders of each polygon.  What an odd number of them surrounds is in it, so a second one may be a hole.
    grid : GridMap
        The cells that a polygon touches.
    bounds : pair of ndarrays, shape (2,)

    Raises
    ------
    InvalidValue, BrokenFile, UnknownName
        If polygons are not such ones, a file cannot be read, or there would be more than 20 million cells.

    Examples
    --------
    >>> import evenroad as er
    >>> yard = er.PolygonMap([[(4, 0), (5, 0), (4.5, 2)]], bounds=((0, 0), (9, 5)))
    >>> yard
    PolygonMap(1 polygon, 3 corners, 9 by 5)
    >>> car = yard.world(footprint=[(-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3)], turning_radius=1.0)
    >>> er.plan(car, (2, 1, 0), (7, 1, 0)).proof
    'exact'
    """

    polygons: tuple[tuple[Floats, ...], ...]
    names: tuple[str, ...]
    bounds: tuple[Floats, Floats]
    grid: GridMap
    obstacles: Obstacles = field(repr=False)

    def __init__(
        self,
        polygons: str | os.PathLike[str] | Iterable[npt.ArrayLike | Sequence[npt.ArrayLike]],
        *,
        bounds: Bounds | None = None,
        resolution: float | None = None,
        names: Sequence[str] = (),
    ) -> None:
        points, notes = np.empty((0, 2)), tuple[str, ...]()
        if isinstance(polygons, str | os.PathLike):
            file = read_polygons(polygons)
            borders, points, notes = file.borders, file.points, file.notes
            names = names or file.names
            if bounds is None and file.bounds is not None:
                bounds = file.bounds[0], file.bounds[1]
        else:
            borders = _as_borders(polygons)
        borders = tuple(tuple(_outline(border, number) for border in each) for number, each in enumerate(borders))
        if (corners := sum(len(border) for each in borders for border in each)) > MOST:
            raise InvalidValue(f"polygons must have at most {MOST} corners, got {corners}")
        names = tuple(map(str, names)) or tuple(f"polygon {number}" for number in range(len(borders)))
        if len(names) != len(borders):
            raise InvalidValue(f"names must be one for each of {counted(len(borders), 'polygon')}, got {len(names)}")
        low, high = _bounds(borders, points) if bounds is None else _as_bounds(bounds)
        longest = float((high - low).max())
        side = longest / _CELLS if resolution is None else require_positive("resolution", resolution)
        if np.ceil((high - low) / side).prod() > _MOST_CELLS:
            raise InvalidValue(
                f"resolution must be larger: {side:g} makes more than {_MOST_CELLS} cells of a map of"
                f" {high[0] - low[0]:g} by {high[1] - low[1]:g}"
            )
        cols, rows = np.maximum(np.ceil((high - low) / side - 1e-9), 1.0).astype(int).tolist()
        obstacles = _obstacles((*borders, *_beyond(low, high, cols, rows, side)), low, side, rows, cols)
        frame = MapFrame(rows=rows, cols=cols, resolution=side, origin=(float(low[0]), float(low[1])), y_up=True)
        grid = GridMap(np.ascontiguousarray(obstacles.occupied[::-1]), frame, notes=notes)
        for each in (low, high, *(border for polygon in borders for border in polygon)):
            each.setflags(write=False)
        set_fields(self, polygons=borders, names=names, bounds=(low, high), grid=grid, obstacles=obstacles)

    def __reduce__(self) -> tuple[object, ...]:
        """Return what a copy is made of, here or in another process: it makes its own tables."""
        made = partial(PolygonMap, bounds=self.bounds, resolution=self.resolution, names=self.names)
        return made, (self.polygons,)

    def __repr__(self) -> str:
        corners = sum(len(border) for each in self.polygons for border in each)
        width, height = self.bounds[1] - self.bounds[0]
        return f"PolygonMap({counted(len(self.polygons), 'polygon')}, {corners} corners, {width:g} by {height:g})"

    @property
    def resolution(self) -> float:
        """Side of a cell, in map units."""
        return self.grid.resolution

    @property
    def notes(self) -> tuple[str, ...]:
        """What of a file was left out."""
        return self.grid.notes

    def world(
        self,
        radius: float | None = None,
        *,
        footprint: Footprint | FootprintLike | None = None,
        turning_radius: float = 0.0,
        reverse: bool = True,
        holonomic: bool = False,
        clearance: float = 0.0,
    ) -> CarWorld:
        """Return the world of a footprint among the polygons.

        Parameters
        ----------
        radius : float
            Refused: disks move on cells, and ``polygon_map.grid.world(radius=0.3)`` is their world.
        footprint : Footprint or array_like, shape (n, 2)
            Corners of a polygon around the robot's reference point, x forwards, y to the left, or several polygons.
        turning_radius, reverse, holonomic, clearance : optional
            As of :meth:`evenroad.GridMap.world`.

        Returns
        -------
        CarWorld

        Raises
        ------
        InvalidValue
            If a number or the footprint is not such a one.

        Examples
        --------
        >>> import evenroad as er
        >>> yard = er.PolygonMap([[(4, 0), (5, 0), (4.5, 2)]], bounds=((0, 0), (9, 5)))
        >>> box = [(-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3)]
        >>> yard.world(footprint=box).valid([(3.5, 0.3, 0), (4.5, 2.3, 0)]).tolist()
        [True, True]
        """
        if footprint is None or radius is not None:
            raise InvalidValue(
                "polygons go with footprint=, that of a car; a disk moves on the cells that polygons touch:"
                " polygon_map.grid.world(radius=...)"
            )
        from evenroad.driving.car_world import CarWorld
        from evenroad.driving.footprint import as_footprint

        return CarWorld(self.grid, as_footprint(footprint), turning_radius, reverse, holonomic, clearance, self)

    def fingerprint(self) -> str:
        """Return the SHA-256 (hex) of bounds and polygons: equal for maps of equal results."""
        digest = hashlib.sha256(f"polygons {[[len(border) for border in each] for each in self.polygons]}".encode())
        for each in (*self.bounds, *(border for polygon in self.polygons for border in polygon)):
            digest.update(each.tobytes())
        return digest.hexdigest()


def load_any_map(
    path: str | os.PathLike[str], *, unknown_is_free: bool = False, rules: str | None = None
) -> GridMap | PolygonMap:
    """Read a map of polygons, or one of cells as `load_map` does, by its suffix."""
    if Path(path).suffix.lower() not in SUFFIXES:
        return load_map(path, unknown_is_free=unknown_is_free, rules=rules)
    if unknown_is_free or rules is not None:
        raise InvalidValue(f"unknown cells and rules are of ROS maps, not of polygons such as {os.fspath(path)}")
    return PolygonMap(path)


class ParkingCase(NamedTuple):
    """A parking case of TPCAP: its map, and poses of the middle of the rear axle."""

    map: PolygonMap
    start: Floats
    goal: Floats


def load_parking_case(path: str | os.PathLike[str]) -> ParkingCase:
    """Read a parking case of TPCAP, the competition of trajectory planning for parking (2022).

    Parameters
    ----------
    path : str or path-like
        A ``.csv`` of one line: start and goal, x, y and angle each, the number of polygons, their numbers of corners,
        and all corners.

    Returns
    -------
    ParkingCase

    Raises
    ------
    BrokenFile
        If it is no such file.

    Examples
    --------
    >>> from evenroad.driving import load_parking_case
    >>> case = load_parking_case("tpcap_case1.csv")  # doctest: +SKIP
    >>> case.map.world(footprint=car, turning_radius=3.0)  # doctest: +SKIP
    """
    case = read_parking(as_file("a parking case", path))
    return ParkingCase(PolygonMap(path), case.start, case.goal)


def _as_borders(polygons: Iterable[npt.ArrayLike | Sequence[npt.ArrayLike]]) -> tuple[tuple[Floats, ...], ...]:
    """Return the borders of each polygon, which is corners, or a sequence of borders."""
    try:
        given = [list(each) for each in polygons]  # type: ignore[arg-type]
        return tuple(
            tuple(map(_corners, each)) if np.ndim(each[0]) == 2 else (_corners(each),)  # type: ignore[arg-type]
            for each in given
        )
    except (TypeError, ValueError, IndexError):
        raise InvalidValue(f"polygons must be corners (n, 2) each, or a file, got {shown(polygons)}") from None


def _corners(border: npt.ArrayLike) -> Floats:
    corners = np.array(border, dtype=np.float64)
    if corners.ndim != 2 or corners.shape[1] != 2:
        raise ValueError(corners.shape)
    return corners


def _outline(border: Floats, number: int) -> Floats:
    """Return a border without corners that the next one repeats."""
    if not np.isfinite(border).all():
        raise InvalidValue(f"corners of polygon {number} must be finite, got {shown(border.tolist())}")
    outline = border[(border != np.roll(border, -1, axis=0)).any(axis=1)]
    if len(outline) < 2:
        raise InvalidValue(f"polygon {number} must have two different corners or more, got {shown(border.tolist())}")
    return np.ascontiguousarray(outline)


def _as_bounds(bounds: Bounds) -> tuple[Floats, Floats]:
    try:
        low, high = (np.array(each, dtype=np.float64) for each in bounds)
    except (TypeError, ValueError):
        low = high = np.zeros(0)
    if low.shape != (2,) or high.shape != (2,) or not np.isfinite([*low, *high]).all() or not (low < high).all():
        raise InvalidValue(f"bounds must be ((x, y), (x, y)), the least and the largest, got {shown(bounds)}")
    return low, high


def _bounds(borders: tuple[tuple[Floats, ...], ...], points: Floats) -> tuple[Floats, Floats]:
    """Return the default of the map's rectangle."""
    corners = np.concatenate([points, *(border for each in borders for border in each)])
    if not len(corners):
        raise InvalidValue("a map without polygons must have bounds")
    low, high = corners.min(axis=0), corners.max(axis=0)
    margin = _MARGIN * float((high - low).max())
    return low - margin, high + margin


def _beyond(low: Floats, high: Floats, cols: int, rows: int, side: float) -> tuple[tuple[Floats, ...], ...]:
    """Return polygons for what whole cells have beyond the map's rectangle."""
    right, top = low[0] + (cols + 1) * side, low[1] + (rows + 1) * side
    strips = []
    if low[0] + cols * side > high[0]:
        strips.append([(high[0], low[1] - side), (right, low[1] - side), (right, top), (high[0], top)])
    if low[1] + rows * side > high[1]:
        strips.append([(low[0] - side, high[1]), (right, high[1]), (right, top), (low[0] - side, top)])
    return tuple((np.array(each),) for each in strips)


def _obstacles(polygons: tuple[tuple[Floats, ...], ...], low: Floats, side: float, rows: int, cols: int) -> Obstacles:
    """Return polygons as compiled code takes them, in cells."""
    borders = [border for each in polygons for border in each]
    corners = (np.concatenate([np.empty((0, 2)), *borders]) - low) / side
    if np.abs(corners).max(initial=0.0) > _FARTHEST:
        raise InvalidValue(f"polygons must reach at most {_FARTHEST * side:g} beyond the map, with cells of {side:g}")
    cells = [np.clip((border - low) / side, -1.0, (cols + 1, rows + 1)) for border in borders]
    if sum(float(np.abs(each - np.roll(each, 1, axis=0)).sum()) + 2 * len(each) for each in cells) > _MOST_TOUCHED:
        raise InvalidValue(f"resolution must be larger: sides go through more than {_MOST_TOUCHED} cells of {side:g}")
    sizes = np.array([len(border) for border in borders], dtype=np.int64)
    numbers = np.array([i for i, each in enumerate(polygons) for _ in each], dtype=np.int64)
    return Obstacles(np.ascontiguousarray(corners), sizes, numbers, rows, cols)
