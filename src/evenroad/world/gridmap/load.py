"""Reading a map of any kind: a bare image, or a YAML file of the ROS map_server beside an image.

With the checks that a file from anywhere needs.
"""

from __future__ import annotations

import json
import os
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np
import numpy.typing as npt
from PIL import Image

from evenroad._arrays import Bools
from evenroad._call import explains_calls
from evenroad._checks import as_file, require_known, require_positive
from evenroad._files import looks_like, not_a
from evenroad._yaml import numbers, read_mapping, require_keys
from evenroad.errors import BrokenFile, InvalidValue, UnknownName, near
from evenroad.world.gridmap.frame import MapFrame
from evenroad.world.gridmap.gridmap import DiskWorld, GridMap

MAPS = Path(__file__).parent / "maps"
SHIPPED = ("maze1.png", "maze2.png", "maze3.png", "office.yaml")
"""Maps that ship with evenroad, by name."""
_IMAGES = (".png", ".pgm")
_ROS_MAPS = (".yaml", ".yml")
_REQUIRED = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")
_MODES = ("trinary", "scale", "raw")


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


@explains_calls
def load_map(path: str | os.PathLike[str] | Bools, *, unknown_is_free: bool = False) -> GridMap:
    """Read a map: a bare image (.png, .pgm), a ROS map_server file (.yaml, .yml), or an array as `GridMap` takes it.

    `load_image` and `load_ros_map` say what the pixels mean, where the map then lies, and what they raise.

    Parameters
    ----------
    path : path, or bool ndarray, shape (height, width)
        The file; where there is none, the name of a shipped map: ``office.yaml``, 12 m by 8 m, or ``maze1``,
        ``maze2`` and ``maze3``, images of 640 by 480 pixels.
    unknown_is_free : bool
        Whether the unknown cells of a ROS map are free.

    Returns
    -------
    GridMap

    Raises
    ------
    UnknownName
        If the suffix is another one.
    BrokenFile, InvalidValue
        As `load_image` and `load_ros_map`.

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
    if suffix in _IMAGES:
        return load_image(file)
    if suffix in _ROS_MAPS:
        return load_ros_map(file, unknown_is_free=unknown_is_free)
    raise UnknownName.among(f"kind of map file {os.fspath(path)!r}: suffix", suffix, _IMAGES + _ROS_MAPS)


def find_map(source: str | os.PathLike[str]) -> Path:
    """Return the file of a map: `source` itself or, where there is no such file, the shipped one of that name."""
    path = as_file("a map", source, "a map of an array is GridMap(cells, resolution=...)")
    if not path.is_file() and path.parent == Path():
        for name in SHIPPED:
            if str(path) in (name, Path(name).stem):
                return MAPS / name
    return path


def map_files(path: str | os.PathLike[str]) -> tuple[Path, ...]:
    """Return the files that `load_map` reads for `path`: itself and, for a ROS map, its image."""
    file = find_map(path)
    return (file, read_ros_meta(file).image) if file.suffix.lower() in _ROS_MAPS else (file,)


def load_ros_map(path: str | os.PathLike[str], *, unknown_is_free: bool = False) -> GridMap:
    """Read a map_server YAML file and its image as a map.

    A cell is occupied, free or unknown by the rules of map_server (checked against nav2's ``map_io.cpp``):

    * the *shade* of a pixel is the mean of its colour channels, 0 = black, 1 = white; in mode trinary an
      alpha channel is one more channel of the mean;
    * its *occupancy* is ``1 - shade``, or ``shade`` with `negate`;
    * **trinary**: occupied if occupancy > occupied_thresh, free if occupancy < free_thresh, else unknown;
    * **scale**: the same, but a pixel that is not opaque is unknown.  Cells between the thresholds, which
      map_server grades from 1 to 99, are known neither to be free nor occupied: they count as unknown;
    * **raw**: the pixel, on the scale 0..255, *is* the occupancy in percent, with any `negate`, and values above
      100 are unknown.  map_server does not decide what is occupied; here the same two thresholds do.

    Unknown cells are obstacles, unless `unknown_is_free`.  Raises BrokenFile if the YAML file or the image is missing
    or broken, or a key is missing or there twice; UnknownName if a key is nearly one that map_server knows, or a mode
    is none of them (other keys are passed over with a warning); InvalidValue if a value has the wrong type or range.
    """
    meta = read_ros_meta(path)
    if meta.passed_over:
        warnings.warn(f"{path}: passed over: {', '.join(meta.passed_over)}", stacklevel=2)
    occupied, unknown = classify_pixels(open_image(meta.image), meta)
    obstacles = occupied if unknown_is_free else occupied | unknown
    for cells in (obstacles, unknown):
        cells.setflags(write=False)
    rows, cols = obstacles.shape
    x, y, yaw = meta.origin
    frame = MapFrame(rows=rows, cols=cols, resolution=meta.resolution, origin=(x, y), yaw=yaw, y_up=True)
    return GridMap(obstacles, frame, unknown)


def read_ros_meta(path: str | os.PathLike[str]) -> RosMapMeta:
    """Read and check a map_server YAML file; the image is not opened.  Errors as `load_ros_map`."""
    file = Path(path)
    document = read_mapping(file, "map")
    known = (*_REQUIRED, "mode")
    # Newer map servers write more; what looks like a slip of the pen is no newer key.
    strange = [key for key in document if key not in known and not near(str(key), known)]
    require_keys([key for key in document if key not in strange], _REQUIRED, ("mode",), str(file))
    image, mode, negate = document["image"], document.get("mode", "trinary"), document["negate"]
    if not isinstance(image, str) or not image:
        raise InvalidValue(f"image in {file} must be the name of a file, got {image!r}")
    require_known(f"mode in {file}:", mode, _MODES)
    if negate not in (0, 1) or isinstance(negate, float):
        raise InvalidValue(f"negate in {file} must be 0, 1, true or false, got {negate!r}")
    resolution, occupied, free = (
        numbers([document[key]], 1, f"{key} in {file}")[0] for key in ("resolution", "occupied_thresh", "free_thresh")
    )
    if not 0.0 <= free < occupied <= 1.0:
        raise InvalidValue(
            f"the thresholds in {file} must satisfy 0 <= free_thresh < occupied_thresh <= 1,"
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


def classify_pixels(image: Image.Image, meta: RosMapMeta) -> tuple[Bools, Bools]:
    """Return which pixels are occupied and which are unknown, two (rows, cols) arrays; the rest is free.

    `image` is one of `open_image`.  The rules are those of `load_ros_map`.
    """
    levels, white = _summed_channels(image, with_alpha=meta.mode == "trinary")
    # The class depends on the level alone, so it is computed once a level, in float64, and looked up.
    shade = np.arange(white + 1) / white
    if meta.mode == "raw":
        percent = np.round(shade * 255.0)
        occupancy = np.where(percent <= 100.0, percent / 100.0, np.nan)
    else:
        occupancy = shade if meta.negate else 1.0 - shade
    is_occupied = occupancy > meta.occupied_thresh
    is_unknown = ~is_occupied & ~(occupancy < meta.free_thresh)
    occupied, unknown = is_occupied[levels], is_unknown[levels]
    if meta.mode == "scale" and image.mode == "RGBA":
        see_through = np.asarray(image.getchannel("A")) < 255
        occupied &= ~see_through
        unknown |= see_through
    return occupied, unknown


def _summed_channels(image: Image.Image, *, with_alpha: bool) -> tuple[npt.NDArray[np.integer[Any]], int]:
    """Return the sum of each pixel's channels and the sum that white has."""
    pixels = np.asarray(image)
    if image.mode in ("L", "I;16"):
        return pixels, 255 if image.mode == "L" else 65535
    channels = 4 if image.mode == "RGBA" and with_alpha else 3
    return pixels[:, :, :channels].sum(axis=2, dtype=np.uint16), 255 * channels


LARGEST_IMAGE = 100_000_000
"""Largest number of pixels of a map: 10 000 x 10 000.  Where a disk plans all over it, its world takes 0.1 GB."""
DARK = 128.0
"""Luminance, of 255, below which a bare image's cell is an obstacle."""
_FORMATS = ("PNG", "PPM")
"""Formats that are read; PPM is Pillow's name for the family of PGM."""


def load_image(path: str | os.PathLike[str], *, dark: float = DARK) -> GridMap:
    """Read a bare PNG or PGM image as a map: pixels whose luminance, of 255, is below `dark` are obstacles.

    Colours count by ITU-R BT.601 (0.299 R + 0.587 G + 0.114 B, rounded), transparent pixels as if on white paper.  The
    frame is the image's own: x right, y down, origin in the top-left corner, unit = pixel.  Raises BrokenFile if the
    file is missing, is not a whole PNG or PGM image, or has more than 100 million pixels; InvalidValue if `dark` is not
    in (0, 255].
    """
    if require_positive("dark", dark) > 255.0:
        raise InvalidValue(f"dark must be in (0, 255], got {dark!r}")
    luminance, white = _luminance(open_image(path))
    occupied = luminance < dark * (white / 255.0)
    occupied.setflags(write=False)
    return GridMap(occupied)


def open_image(path: str | os.PathLike[str]) -> Image.Image:
    """Return the decoded image at `path`: mode L, I;16 (grey, 16 bit), RGB or RGBA.  Errors as `load_image`."""
    file = Path(path)
    try:
        with file.open("rb") as stream:
            return _decoded(stream, file)
    except BrokenFile:
        raise
    except (OSError, ValueError) as error:  # ValueError: a name that no file can have
        raise BrokenFile(f"cannot read the image {file}: {getattr(error, 'strerror', error)}") from error


def _decoded(stream: IO[bytes], file: Path) -> Image.Image:
    try:
        with warnings.catch_warnings():
            # Pillow warns from 89 million pixels on; the limit here is ours.
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            image = Image.open(stream, formats=_FORMATS)
    except Image.DecompressionBombError:
        raise BrokenFile(f"the image {file} is too large: at most {LARGEST_IMAGE} pixels are read") from None
    except Exception as error:  # a decoder fed with garbage may raise anything
        if looks_like(file) in ("a PNG image", "a PGM image"):
            raise BrokenFile(f"the image {file} is broken or cut short{_reason(error)}") from error
        raise not_a("a PNG or PGM image", file) from error
    columns, rows = image.size
    if columns * rows > LARGEST_IMAGE:
        size = f"{columns} x {rows} pixels, at most {LARGEST_IMAGE} are read"
        raise BrokenFile(f"the image {file} is too large: {size}")
    try:
        image.load()
        return _in_known_mode(image)
    except Exception as error:
        raise BrokenFile(f"the image {file} is broken or cut short{_reason(error)}") from error


def _in_known_mode(image: Image.Image) -> Image.Image:
    if image.mode in ("I", "I;16", "I;16B", "I;16L", "I;16N"):
        levels = np.asarray(image).astype(np.uint16)
        if "transparency" in image.info:
            levels[levels == image.info["transparency"]] = 65535  # as if on white paper
        return Image.fromarray(levels)
    if image.has_transparency_data:
        return image.convert("RGBA")
    if image.mode == "L":
        return image
    if image.mode == "1":
        return image.convert("L")
    if image.mode in ("RGB", "P"):
        return image.convert("RGB")
    raise ValueError(f"pixels of kind {image.mode} are not supported")


def _luminance(image: Image.Image) -> tuple[npt.NDArray[np.uint8 | np.uint16], int]:
    """Return the luminance of each pixel, (rows, cols), and the value that white has."""
    if image.mode == "I;16":
        return np.asarray(image), 65535
    if image.mode == "RGBA":
        paper = Image.new("RGBA", image.size, "white")
        paper.alpha_composite(image)
        image = paper
    return np.asarray(image if image.mode == "L" else image.convert("L")), 255


def _reason(error: Exception) -> str:
    """Return the decoder's own words in brackets, on one line, unless they only repeat the file's name."""
    text = " ".join(str(error).split())
    return f" ({text})" if text and "cannot identify" not in text else ""


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
    """Return the maze of level 1, 2 or 3, harder and harder for uniform points; else an UnknownName."""
    require_known("maze level", level, LEVELS)
    record = json.loads((MAPS / "mazes.json").read_text(encoding="utf-8"))[str(level)]
    start, goal = tuple(record["start"]), tuple(record["goal"])
    return Maze(level, MAPS / record["image"], start, goal, record["robot_radius"])
