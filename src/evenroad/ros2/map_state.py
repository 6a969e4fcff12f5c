"""The map of a node as it is now: a whole map, then updates of parts, and the robot's world on it."""

from __future__ import annotations

from dataclasses import dataclass
from threading import Lock

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_count, require_positive
from evenroad.driving.car_world import CarWorld
from evenroad.errors import InvalidValue, NotAvailable, shown
from evenroad.ros2.messages import Message, planar_pose, seconds_of
from evenroad.world import GridMap, MapFrame
from evenroad.world.gridmap.disk_world import DiskWorld

Cells = npt.NDArray[np.int8]

MOST_CELLS = 400_000_000
"""Largest number of cells of a map: 20 000 by 20 000."""


@dataclass(frozen=True)
class MapRobot:
    """What moves on the map: a disk, or a footprint if it is given, and how cells are read.

    `occupied_from` is the least percentage of an obstacle.  The others are arguments of :meth:`evenroad.GridMap.world`.
    """

    radius: float = 0.25
    footprint: tuple[tuple[float, float], ...] = ()
    turning_radius: float = 0.0
    reverse: bool = True
    holonomic: bool = False
    clearance: float = 0.0
    occupied_from: int = 65
    unknown_is_free: bool = False

    def on(self, grid: GridMap) -> DiskWorld | CarWorld:
        """Return its world on a map."""
        if not self.footprint:
            return grid.world(self.radius, self.clearance)
        return grid.world(
            footprint=self.footprint,
            turning_radius=self.turning_radius,
            reverse=self.reverse,
            holonomic=self.holonomic,
            clearance=self.clearance,
        )


@dataclass(frozen=True)
class MapWorld:
    """A world on a map, and the frame of the map."""

    world: DiskWorld | CarWorld
    frame: str


def grid_map(message: Message, robot: MapRobot | None = None) -> GridMap:
    """Return the map of a ``nav_msgs/OccupancyGrid``; InvalidValue for one that is malformed."""
    robot = MapRobot() if robot is None else robot
    return _as_grid(cells_of(message), frame_of(message), robot)


def cells_of(message: Message) -> Cells:
    """Return the cells of a ``nav_msgs/OccupancyGrid``, (height, width), the lowest row first: -1, or 0 to 100."""
    info = message.info
    height, width = require_count("height of the map", info.height), require_count("width of the map", info.width)
    if height * width > MOST_CELLS:
        raise InvalidValue(f"a map must have at most {MOST_CELLS} cells, got {height} x {width}")
    return _cells("the map", message.data, height, width)


def frame_of(message: Message) -> MapFrame:
    """Return the frame of the cells of a ``nav_msgs/OccupancyGrid``."""
    info = message.info
    x, y, yaw = planar_pose(info.origin, "the map's origin")
    # The message has single precision: 0.05 is meant, not 0.05000000074505806.
    resolution = require_positive("resolution of the map", float(str(np.float32(info.resolution))))
    return MapFrame(
        rows=int(info.height), cols=int(info.width), resolution=resolution, origin=(x, y), yaw=yaw, y_up=True
    )


def _cells(what: str, data: Message, height: int, width: int) -> Cells:
    try:
        cells = np.array(data, dtype=np.int8)
    except (TypeError, ValueError, OverflowError) as error:
        raise InvalidValue(f"cells of {what} must be numbers from -1 to 100: {error}") from None
    if cells.size != height * width:
        raise InvalidValue(f"{what} must have {height} x {width} = {height * width} cells, got {cells.size}")
    if cells.min() < -1 or cells.max() > 100:
        raise InvalidValue(f"cells of {what} must be from -1 to 100, got {cells.min()} to {cells.max()}")
    return cells.reshape(height, width)


def _as_grid(cells: Cells, frame: MapFrame, robot: MapRobot) -> GridMap:
    rows = cells[::-1]
    unknown = rows < 0
    blocked = rows >= robot.occupied_from
    return GridMap(blocked if robot.unknown_is_free else blocked | unknown, frame, unknown)


class MapState:
    """The latest map.  Threads may share it: messages change its cells, queries take a world that stays as it is.

    The world is made at the first query after a change, so updates that no query sees cost only their own cells.
    """

    def __init__(self, robot: MapRobot) -> None:
        self._robot, self._lock = robot, Lock()
        self._cells: Cells | None = None
        self._frame: MapFrame | None = None
        self._frame_id, self._stamp = "", 0.0
        self._made: MapWorld | None = None

    def take_map(self, message: Message) -> str:
        """Take a ``nav_msgs/OccupancyGrid``, and return in words what was taken; InvalidValue leaves all as it was."""
        cells, frame = cells_of(message), frame_of(message)
        if not message.header.frame_id:
            raise InvalidValue("a map must say in which frame it is: its header has no frame_id")
        stamp = seconds_of(message.header.stamp)
        with self._lock:
            if 0.0 < stamp < self._stamp:
                raise InvalidValue(f"a map of {stamp:.3f} s is older than the present one of {self._stamp:.3f} s")
            self._cells, self._frame, self._made = cells, frame, None
            self._frame_id, self._stamp = str(message.header.frame_id), stamp
        return f"map of {frame.rows} x {frame.cols} cells of {frame.resolution:g} m in frame {self._frame_id!r}"

    def take_update(self, message: Message) -> None:
        """Take a ``map_msgs/OccupancyGridUpdate``: the cells of a rectangle; InvalidValue leaves all as it was."""
        x, y = int(message.x), int(message.y)
        height, width = require_count("height of the update", message.height), require_count("width", message.width)
        stamp, frame_id = seconds_of(message.header.stamp), str(message.header.frame_id)
        with self._lock:
            if self._cells is None:
                raise NotAvailable("an update of a map came before any map")
            rows, cols = self._cells.shape
            if x < 0 or y < 0 or x + width > cols or y + height > rows:
                raise InvalidValue(
                    f"an update of {width} x {height} cells at ({x}, {y}) is not within the map of {cols} x {rows}"
                )
            if frame_id != self._frame_id:
                raise InvalidValue(f"an update is in frame {shown(frame_id)}, the map in {shown(self._frame_id)}")
            if 0.0 < stamp < self._stamp:
                raise InvalidValue(f"an update of {stamp:.3f} s is older than the map of {self._stamp:.3f} s")
            self._cells[y : y + height, x : x + width] = _cells("the update", message.data, height, width)
            self._made, self._stamp = None, max(stamp, self._stamp)

    @property
    def has_map(self) -> bool:
        """Whether there is a map."""
        return self._cells is not None

    def world(self) -> MapWorld:
        """Return the robot's world on the latest map; NotAvailable without one."""
        with self._lock:
            if self._cells is None or self._frame is None:
                raise NotAvailable("there is no map yet")
            if self._made is None:
                grid = _as_grid(self._cells, self._frame, self._robot)
                self._made = MapWorld(self._robot.on(grid), self._frame_id)
            return self._made
