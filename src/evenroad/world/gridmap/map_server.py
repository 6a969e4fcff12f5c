"""Maps of ROS: the YAML file of map_server and its image, by the rules of nav2 and those of ROS 1."""

from __future__ import annotations

import os
import warnings
from collections import Counter
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from PIL import Image

from evenroad._arrays import Bools
from evenroad._checks import counted, require_known, require_positive
from evenroad._yaml import numbers, read_mapping, require_keys
from evenroad.errors import InvalidValue, near, shown
from evenroad.world.gridmap.frame import MapFrame
from evenroad.world.gridmap.gridmap import GridMap
from evenroad.world.gridmap.images import Pixels, in_eight_bits, open_image

SUFFIXES = (".yaml", ".yml")
"""Suffixes of the files of map_server."""
RULES = ("nav2", "ros1")
"""Rules by which a pixel is free, occupied or unknown; the first ones are the default."""

_REQUIRED = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")
_MODES = ("trinary", "scale", "raw")
_FREE, _UNKNOWN, _OCCUPIED = range(3)
_NAMES = ("free", "unknown", "occupied")

Kinds = npt.NDArray[np.uint8]
"""Kind of each cell, or of each possible level of a pixel: free, unknown or occupied."""


class RosMapMeta(NamedTuple):
    """The checked content of a map_server YAML file: lengths in metres, the yaw in radians."""

    image: Path
    resolution: float
    origin: tuple[float, ...]
    """x and y of the lower-left corner of the lower-left pixel, and yaw."""
    negate: bool
    occupied_thresh: float
    free_thresh: float
    mode: str
    passed_over: tuple[str, ...]
    """Unknown keys."""


def load_ros_map(path: str | os.PathLike[str], *, unknown_is_free: bool = False, rules: str | None = None) -> GridMap:
    """Read a map_server YAML file and its image as a map.

    A cell is occupied, free or unknown by the rules of map_server.  ``nav2``, the default, means those of nav2 since
    April 2025 (its pull request 5071):

    * the *shade* of a pixel is its luminance, of 255 levels, by ITU-R BT.601; 0 = black, 1 = white;
    * its *occupancy* is ``1 - shade``, or ``shade`` with `negate`;
    * **trinary**: free if occupancy <= free_thresh, else occupied if occupancy >= occupied_thresh, else unknown;
    * **scale**: the same.  map_server grades cells between the thresholds from 1 to 99; these count as unknown.  Those
      that it rounds to 0 and 100 are free and occupied;
    * in both modes a pixel that is not opaque is unknown;
    * **raw**: the level, 0 to 255, *is* the occupancy in percent, without any `negate` or alpha, and levels above 100
      are unknown.  map_server does not decide which cells are occupied; here the same two thresholds do.

    ``ros1`` means those of map_server in ROS 1 and earlier nav2.  The shade is the mean of the colour channels; in mode
    trinary the alpha channel is one of them.  A value equal to a threshold is unknown.  In mode scale a pixel that is
    not opaque is unknown.  If scale and raw of the two differ, nav2's rules apply.

    Unknown cells are obstacles, unless `unknown_is_free`.  Without `rules` a warning says where the two read the file
    differently; the map's `notes` always say so.

    Raises BrokenFile if the YAML file or the image is missing or broken, or a key is missing or repeated; UnknownName
    for a key similar to one of map_server, or an unknown mode or rules (other keys are ignored with a warning);
    InvalidValue if a value has the wrong type or range.
    """
    if rules is not None:
        require_known("rules of a map:", rules, RULES)
    meta = read_ros_meta(path)
    passed_over = [f"{path}: passed over: {', '.join(meta.passed_over)}"] if meta.passed_over else []
    kinds, differences = _read_pixels(open_image(meta.image), meta, rules or RULES[0])
    differently = [f"{path}: {differences}"] if differences else []
    for note in passed_over + ([] if rules else differently):
        warnings.warn(note, stacklevel=2)
    unknown = kinds == _UNKNOWN
    obstacles = kinds == _OCCUPIED if unknown_is_free else kinds != _FREE
    for cells in (obstacles, unknown):
        cells.setflags(write=False)
    rows, cols = obstacles.shape
    x, y, yaw = meta.origin
    frame = MapFrame(rows=rows, cols=cols, resolution=meta.resolution, origin=(x, y), yaw=yaw, y_up=True)
    return GridMap(obstacles, frame, unknown, notes=(*passed_over, *differently))


def read_ros_meta(path: str | os.PathLike[str]) -> RosMapMeta:
    """Read and check a map_server YAML file; the image is not opened.  Errors as `load_ros_map`."""
    file = Path(path)
    document = read_mapping(file, "map")
    known = (*_REQUIRED, "mode")
    # Newer map servers write more keys. One that looks misspelt is not a newer key.
    strange = [key for key in document if key not in known and not near(str(key), known)]
    require_keys([key for key in document if key not in strange], _REQUIRED, ("mode",), str(file))
    image, mode, negate = document["image"], document.get("mode", "trinary"), document["negate"]
    if not isinstance(image, str) or not image:
        raise InvalidValue(f"image in {file} must be the name of a file, got {image!r}")
    mode = mode.lower() if isinstance(mode, str) else mode
    require_known(f"mode in {file}:", mode, _MODES)
    if negate not in (0, 1) or isinstance(negate, float):
        raise InvalidValue(f"negate in {file} must be 0, 1, true or false, got {shown(negate)}")
    resolution, occupied, free = (
        numbers([document[key]], 1, f"{key} in {file}")[0] for key in ("resolution", "occupied_thresh", "free_thresh")
    )
    if not 0.0 <= free <= occupied <= 1.0:
        raise InvalidValue(
            f"the thresholds in {file} must satisfy 0 <= free_thresh <= occupied_thresh <= 1,"
            f" got free_thresh {free!r} and occupied_thresh {occupied!r}"
        )
    return RosMapMeta(
        image=file.parent / image,
        resolution=require_positive(f"resolution in {file}", resolution),
        origin=numbers(document["origin"], 3, f"origin [x, y, yaw] in {file}"),
        negate=bool(negate),
        occupied_thresh=occupied,
        free_thresh=free,
        mode=mode,
        passed_over=tuple(map(str, strange)),
    )


class Levels(NamedTuple):
    """Data for some rules: the level of each pixel, (rows, cols), the kind of each level, and hidden pixels."""

    of_pixels: Pixels
    table: Kinds
    hidden: Bools | None = None
    """Pixels that are unknown at any level."""

    def kinds(self) -> Kinds:
        """Return the kind of each pixel, (rows, cols)."""
        found = self.table[self.of_pixels]
        if self.hidden is not None:
            found[self.hidden] = _UNKNOWN
        return found


def _read_pixels(image: Image.Image, meta: RosMapMeta, rules: str) -> tuple[Kinds, str]:
    """Return the kind of each pixel of `open_image`, (rows, cols), and in words where the other rules differ."""
    pixels = np.asarray(image)
    own, other = (of(pixels, image, meta) for of in ((_nav2, _ros1) if rules == "nav2" else (_ros1, _nav2)))
    found = own.kinds()
    # In most images the level alone decides, and means the same by both rules, so nothing is compared.
    if own.of_pixels is other.of_pixels and np.array_equal(own.table, other.table):
        return found, ""
    others = other.kinds()
    differing = found != others
    if not differing.any():
        return found, ""
    pairs = Counter(zip(found[differing].tolist(), others[differing].tolist(), strict=True)).most_common()
    said = ", ".join(
        f"{counted(count, 'pixel')} {_NAMES[ours]} (else {_NAMES[theirs]})" for (ours, theirs), count in pairs
    )
    return found, f"the rules of map_server changed in April 2025: by rules={rules!r} {said}; known: {', '.join(RULES)}"


def _nav2(pixels: Pixels, image: Image.Image, meta: RosMapMeta) -> Levels:
    levels: Pixels = in_eight_bits(pixels) if image.mode == "I;16" else pixels
    if image.mode not in ("I;16", "L"):
        levels = np.asarray(image.convert("RGB").convert("L"))
    grey = np.arange(256, dtype=np.float32)
    if meta.mode == "raw":
        percent = np.where(grey <= 100.0, grey / 100.0, np.nan)
        return Levels(levels, _between(percent <= meta.free_thresh, percent >= meta.occupied_thresh))
    # In single precision, like map_server, because rounding decides about a level that equals a threshold.
    white, free, occupied = (np.float32(each) for each in (255.0, meta.free_thresh, meta.occupied_thresh))
    shade = grey / white
    occupancy = shade if meta.negate else np.float32(1.0) - shade
    is_free, is_occupied = occupancy <= free, occupancy >= occupied
    if meta.mode == "scale":
        grade = np.divide(occupancy - free, occupied - free, out=np.zeros_like(grey), where=~(is_free | is_occupied))
        is_occupied |= grade * np.float32(100.0) >= 99.5
        is_free |= ~is_occupied & (grade * np.float32(100.0) < 0.5)
    hidden = np.asarray(image.getchannel("A")) < 255 if image.mode == "RGBA" else None
    return Levels(levels, _between(is_free, is_occupied), hidden)


def _ros1(pixels: Pixels, image: Image.Image, meta: RosMapMeta) -> Levels:
    levels, white = pixels, 65535 if image.mode == "I;16" else 255
    if pixels.ndim == 3:
        channels = 4 if image.mode == "RGBA" and meta.mode == "trinary" else 3
        levels, white = pixels[:, :, :channels].sum(axis=2, dtype=np.uint16), 255 * channels
    shade = np.arange(white + 1) / white
    if meta.mode == "raw":
        percent = np.round(shade * 255.0)
        occupancy = np.where(percent <= 100.0, percent / 100.0, np.nan)
    else:
        occupancy = shade if meta.negate else 1.0 - shade
    is_hidden = meta.mode == "scale" and image.mode == "RGBA"
    hidden = np.asarray(image.getchannel("A")) < 255 if is_hidden else None
    is_free, is_occupied = occupancy < meta.free_thresh, occupancy > meta.occupied_thresh
    return Levels(levels, _between(is_free, is_occupied), hidden)


def _between(is_free: Bools, is_occupied: Bools) -> Kinds:
    """Return the kind of each level: one that is both is free, one that is neither is unknown."""
    return np.where(is_free, _FREE, np.where(is_occupied, _OCCUPIED, _UNKNOWN)).astype(np.uint8)
