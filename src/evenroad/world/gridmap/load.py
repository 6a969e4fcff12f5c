"""Reading a map of any kind, told by the file's suffix."""

from __future__ import annotations

import os
from pathlib import Path

from evenroad.errors import UnknownName
from evenroad.world.gridmap.gridmap import GridMap
from evenroad.world.gridmap.image import load_image
from evenroad.world.gridmap.ros import load_ros_map, read_ros_meta

_IMAGES = (".png", ".pgm")
_ROS_MAPS = (".yaml", ".yml")


def load_map(path: str | os.PathLike[str], *, unknown_is_free: bool = False) -> GridMap:
    """Read a map: a bare image (.png, .pgm) or a ROS map_server file (.yaml, .yml).

    Parameters
    ----------
    path : str or path-like
        See `load_image` and `load_ros_map` for what the pixels mean and where the map then lies.
    unknown_is_free : bool
        Take the unknown cells of a ROS map as free; a bare image has none.

    Raises
    ------
    UnknownName
        If the suffix is another one, or as `load_ros_map`.
    BrokenFile, InvalidValue
        As `load_image` and `load_ros_map`.
    """
    suffix = Path(path).suffix.lower()
    if suffix in _IMAGES:
        return load_image(path)
    if suffix in _ROS_MAPS:
        return load_ros_map(path, unknown_is_free=unknown_is_free)
    raise UnknownName.among(f"kind of map file {os.fspath(path)!r}: suffix", suffix, _IMAGES + _ROS_MAPS)


def map_files(path: str | os.PathLike[str]) -> tuple[Path, ...]:
    """Return the files that `load_map` reads for `path`: itself and, for a ROS map, its image."""
    file = Path(path)
    return (file, read_ros_meta(file).image) if file.suffix.lower() in _ROS_MAPS else (file,)
