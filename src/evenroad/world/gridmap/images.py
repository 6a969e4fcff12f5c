"""Images as maps: pictures from any source are decoded and checked, and dark pixels are obstacles."""

from __future__ import annotations

import os
import warnings
from pathlib import Path
from typing import IO

import numpy as np
import numpy.typing as npt
from PIL import Image

from evenroad._checks import require_positive
from evenroad._files import looks_like, not_a, open_file
from evenroad.errors import BrokenFile, InvalidValue
from evenroad.world.gridmap.gridmap import GridMap

SUFFIXES = (".png", ".pgm", ".bmp")
"""Suffixes of images that are maps on their own."""

LARGEST_IMAGE = 100_000_000
"""Largest number of pixels of a map: 10 000 x 10 000.  A world whose queries cover all of it takes 0.1 GB."""
DARK = 128.0
"""Luminance, of 255, below which a bare image's cell is an obstacle."""
Pixels = npt.NDArray[np.uint8 | np.uint16]
_FORMATS = ("PNG", "PPM", "BMP")
"""Formats that are read; PPM is Pillow's name for the family of PGM."""
_KINDS = ("a PNG image", "a PGM image", "a BMP image")


def load_image(path: str | os.PathLike[str], *, dark: float = DARK) -> GridMap:
    """Read a bare PNG, PGM or BMP image as a map: pixels whose luminance, of 255, is below `dark` are obstacles.

    Luminance is that of ITU-R BT.601 (0.299 R + 0.587 G + 0.114 B, rounded), with transparent pixels on white.  The
    frame is the image's own: x right, y down, origin in the top-left corner, unit = pixel.  Raises BrokenFile if the
    file is missing, is no complete image of these kinds, or has more than 100 million pixels; InvalidValue if `dark` is
    not in (0, 255].
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
        with open_file(file) as stream:
            return _decoded(stream, file)
    except BrokenFile:
        raise
    except (OSError, ValueError) as error:  # ValueError: a name that no file can have
        raise BrokenFile(f"cannot read the image {file}: {getattr(error, 'strerror', error)}") from error


def _decoded(stream: IO[bytes], file: Path) -> Image.Image:
    try:
        with warnings.catch_warnings():
            # Pillow warns above 89 million pixels, but our limit is higher.
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            image = Image.open(stream, formats=_FORMATS)
    except Image.DecompressionBombError:
        raise BrokenFile(f"the image {file} is too large: at most {LARGEST_IMAGE} pixels are read") from None
    except Exception as error:  # a decoder fed with garbage may raise anything
        if looks_like(file) in _KINDS:
            raise BrokenFile(f"the image {file} is broken or cut short{_reason(error)}") from error
        raise not_a("a PNG, PGM or BMP image", file) from error
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
        if "transparency" not in image.info:
            return Image.fromarray(levels)
        grey, alpha = in_eight_bits(levels), np.where(levels == image.info["transparency"], 0, 255).astype(np.uint8)
        return Image.fromarray(np.dstack([grey, grey, grey, alpha]))
    if image.has_transparency_data:
        return image.convert("RGBA")
    if image.mode == "L":
        return image
    if image.mode == "1":
        return image.convert("L")
    if image.mode in ("RGB", "P"):
        return image.convert("RGB")
    raise ValueError(f"pixels of kind {image.mode} are not supported")


def in_eight_bits(levels: Pixels) -> npt.NDArray[np.uint8]:
    """Return levels of 16 bits as the nearest of 8 bits."""
    return ((levels.astype(np.uint32) + 128) // 257).astype(np.uint8)


def _luminance(image: Image.Image) -> tuple[Pixels, int]:
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
