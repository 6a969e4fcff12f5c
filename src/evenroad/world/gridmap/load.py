"""Reader of maps of any kind, by their suffix, and the maps that ship with evenroad."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evenroad._arrays import Bools
from evenroad._call import explains_calls
from evenroad._checks import as_file, require_known
from evenroad.errors import BrokenFile, InvalidValue, UnknownName, near
from evenroad.world.gridmap import images, map_server, movingai
from evenroad.world.gridmap.disk_world import DiskWorld
from evenroad.world.gridmap.gridmap import GridMap
from evenroad.world.gridmap.images import load_image
from evenroad.world.gridmap.map_server import load_ros_map, read_ros_meta
from evenroad.world.gridmap.movingai import load_movingai_map

MAPS = Path(__file__).parent / "maps"
SHIPPED = ("maze1.png", "maze2.png", "maze3.png", "office.yaml")
"""Maps that ship with evenroad, by name."""
OF_POLYGONS = (".geojson", ".csv")
"""Suffixes of maps of polygons, which are read elsewhere."""


@explains_calls
def load_map(
    path: str | os.PathLike[str] | Bools, *, unknown_is_free: bool = False, rules: str | None = None
) -> GridMap:
    """Read a map from a file, or make one of an array for `GridMap`.

    Files are bare images (.png, .pgm, .bmp), ROS map_server files (.yaml, .yml), and maps of the MovingAI benchmarks
    (.map).  `load_image`, `load_ros_map` and `load_movingai_map` document the meaning of pixels or letters, the frames,
    and the errors.

    Parameters
    ----------
    path : path, or bool ndarray, shape (height, width)
        The file.  If there is no such file, the name of a shipped map: ``office.yaml``, 12 m by 8 m, or ``maze1``,
        ``maze2`` and ``maze3``, images of 640 by 480 pixels.
    unknown_is_free : bool
        Whether the unknown cells of a ROS map are free.
    rules : {"nav2", "ros1"}, optional
        Rules of map_server for reading a ROS map: those of nav2 since April 2025, the default, or those of ROS 1 and
        earlier nav2.  If you do not choose, a warning says whether they read a file differently.

    Returns
    -------
    GridMap

    Raises
    ------
    UnknownName
        If the suffix is another one.
    BrokenFile, InvalidValue
        As for the three; InvalidValue also for rules with a map that is not of ROS.

    Examples
    --------
    >>> import evenroad as er
    >>> er.load_map("office.yaml")
    GridMap(160 x 240 cells of 0.05, 26% occupied)
    """
    if isinstance(path, np.ndarray):
        return GridMap(path)
    file = find_map(path)
    meant = near(file.stem, [Path(name).stem for name in SHIPPED]) if len(file.parts) == 1 else ""
    if meant and not file.exists():
        kind = BrokenFile if file.suffix else UnknownName
        raise kind(f"there is no map {path}; {meant}")
    suffix = file.suffix.lower()
    if suffix in map_server.SUFFIXES:
        return load_ros_map(file, unknown_is_free=unknown_is_free, rules=rules)
    if rules is not None:
        raise InvalidValue(f"rules are those of ROS maps ({', '.join(map_server.SUFFIXES)}), not of {file}")
    if suffix in images.SUFFIXES:
        return load_image(file)
    if suffix == movingai.SUFFIX:
        return load_movingai_map(file)
    if suffix in OF_POLYGONS:
        raise UnknownName(f"{file} is no map of cells; polygons are read by er.PolygonMap, and go with footprint=")
    known = (*images.SUFFIXES, *map_server.SUFFIXES, movingai.SUFFIX)
    raise UnknownName.among(f"kind of map file {os.fspath(path)!r}: suffix", suffix, known)


def find_map(source: str | os.PathLike[str]) -> Path:
    """Return the file of a map: `source` itself or, if there is no such file, the shipped one of that name."""
    path = as_file("a map", source, "a map of an array is GridMap(cells, resolution=...)")
    if not path.is_file() and path.parent == Path():
        for name in SHIPPED:
            if str(path) in (name, Path(name).stem):
                return MAPS / name
    return path


def map_files(path: str | os.PathLike[str]) -> tuple[Path, ...]:
    """Return the files that `load_map` reads for `path`: itself and, for a ROS map, its image."""
    file = find_map(path)
    return (file, read_ros_meta(file).image) if file.suffix.lower() in map_server.SUFFIXES else (file,)


LEVELS = (1, 2, 3)


@dataclass(frozen=True)
class Maze:
    """A maze and its query, in pixels: x right, y down, origin in the top-left corner."""

    level: int
    path: Path
    start: tuple[float, float]
    goal: tuple[float, float]
    robot_radius: float

    def map(self) -> GridMap:
        """Read the maze's picture."""
        return load_map(self.path)

    def world(self) -> DiskWorld:
        """Return the world of the maze's own robot."""
        return self.map().world(self.robot_radius)


def load_maze(level: int) -> Maze:
    """Return the maze of level 1, 2 or 3, each harder for uniform points; UnknownName for another level."""
    require_known("maze level", level, LEVELS)
    record = json.loads((MAPS / "mazes.json").read_text(encoding="utf-8"))[str(level)]
    start, goal = tuple(record["start"]), tuple(record["goal"])
    return Maze(level, MAPS / record["image"], start, goal, record["robot_radius"])
