"""Maps of the MovingAI benchmarks: text files with one letter per cell."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from evenroad._files import not_a, open_file
from evenroad.errors import BrokenFile
from evenroad.world.gridmap.gridmap import GridMap
from evenroad.world.gridmap.images import LARGEST_IMAGE

SUFFIX = ".map"
"""Suffix of such files."""
_FREE = b".GS"
"""Ground, and swamp, which can be entered from ground."""
_OCCUPIED = b"@OTW"
"""Out of bounds, trees, and water, which cannot be entered from ground."""
_HEADER = ("type octile", "height H", "width W", "map")
_LONGEST_HEADER = 1000
"""Largest number of bytes in which the header ends."""


def load_movingai_map(path: str | os.PathLike[str]) -> GridMap:
    """Read a map of the MovingAI benchmarks (Sturtevant 2012), in the frame of a bare image: a cell is one unit.

    ``.``, ``G`` and ``S`` (swamp) are free; ``@``, ``O``, ``T`` (trees) and ``W`` (water) are obstacles.  The first
    row of letters is the top one.  Raises BrokenFile if the file is missing, its header is not ``type octile`` (or
    ``tile``), ``height``, ``width``, ``map``, a row has another length, a letter is another one, or there are more than
    100 million cells.
    """
    file = Path(path)
    try:
        with open_file(file) as stream:
            # The header comes first, because it has the size of the rest.
            lines = [_line(stream.readline(_LONGEST_HEADER)) for _ in _HEADER]
            rows, columns = _size(lines, file)
            body = stream.read(rows * (columns + 2) + _LONGEST_HEADER)
    except BrokenFile:
        raise
    except (OSError, ValueError) as error:
        raise BrokenFile(f"cannot read the map {file}: {getattr(error, 'strerror', error)}") from error
    letters = [row.rstrip(b"\r \t") for row in body.rstrip().split(b"\n")]
    if len(letters) != rows:
        raise BrokenFile(f"{file} has {len(letters)} rows of cells, but its header says height {rows}")
    for number, row in enumerate(letters):
        if len(row) != columns:
            where = f"row {number + 1} of {file}"
            raise BrokenFile(f"{where} has {len(row)} cells, but the header says width {columns}")
    cells = np.frombuffer(b"".join(letters), dtype=np.uint8).reshape(rows, columns)
    occupied = _among(_OCCUPIED)[cells]
    strange = ~(occupied | _among(_FREE)[cells])
    if strange.any():
        row, column = np.argwhere(strange)[0]
        letter = chr(cells[row, column])
        known = f"{_FREE.decode()} are free, {_OCCUPIED.decode()} obstacles"
        raise BrokenFile(f"{file} has {letter!r} in row {row + 1}, column {column + 1}; known: {known}")
    occupied.setflags(write=False)
    return GridMap(occupied)


def _line(text: bytes) -> list[str]:
    return text.decode(errors="replace").split()


def _size(lines: list[list[str]], file: Path) -> tuple[int, int]:
    """Return rows and columns of a header."""
    words = [line[0] if line else "" for line in lines]
    kind, values = lines[0][1:], [line[1:] for line in lines[1:3]]
    sizes = [int(value[0]) for value in values if len(value) == 1 and value[0].isdecimal() and len(value[0]) < 10]
    if (
        words != [each.split()[0] for each in _HEADER]
        or kind not in (["octile"], ["tile"])
        or len(sizes) != 2
        or 0 in sizes
    ):
        raise not_a("a map of MovingAI", file, f"it must begin with the lines {', '.join(_HEADER)}")
    rows, columns = sizes
    if rows * columns > LARGEST_IMAGE:
        raise BrokenFile(f"the map {file} is too large: {columns} x {rows} cells, at most {LARGEST_IMAGE} are read")
    return rows, columns


def _among(letters: bytes) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Return for each value of a byte whether it is one of these letters."""
    return np.isin(np.arange(256), list(letters))
