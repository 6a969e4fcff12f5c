"""A footprint among polygons as compiled code takes it, and a disk on cells that is free wherever it is."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Bools
from evenroad._native.drive import Vehicle
from evenroad.driving.footprint import Footprint
from evenroad.driving.polygon_map import PolygonMap
from evenroad.world.gridmap.disk_world import DiskWorld
from evenroad.world.gridmap.gridmap import GridMap

_DIAGONAL = math.sqrt(2.0) + 1e-6
"""Largest distance of a point of a cell from a polygon that touches that cell, and more [cells]."""


class _LooserDisk(NamedTuple):
    """A disk on cells, rows along y, that is free wherever a larger one is free among polygons."""

    cells: Bools
    less: float
    """By how much its radius is smaller [cells]."""


def vehicle_among(polygon_map: PolygonMap, footprint: Footprint) -> Vehicle:
    """Return the checks of a footprint among polygons."""
    cells, less = _looser_disk(polygon_map, footprint.inscribed[1])
    frame = np.array([*polygon_map.grid.origin, polygon_map.resolution])
    return Vehicle.among(polygon_map.obstacles, cells, frame, footprint.native(polygon_map.resolution, less))


def looser_world(polygon_map: PolygonMap, radius: float) -> DiskWorld:
    """Return the world of a disk that gets wherever one of this radius gets among polygons, and farther."""
    cells, less = _looser_disk(polygon_map, radius)
    return GridMap(cells[::-1], polygon_map.grid.frame).world(radius - less * polygon_map.resolution)


def _looser_disk(polygon_map: PolygonMap, radius: float) -> _LooserDisk:
    if radius > 2.0 * _DIAGONAL * polygon_map.resolution:
        return _LooserDisk(polygon_map.obstacles.occupied, _DIAGONAL)
    return _LooserDisk(polygon_map.obstacles.solid, 0.0)
