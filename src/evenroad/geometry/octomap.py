"""Reader of OctoMaps (``.bt``): occupied cells are boxes, whose outside is a mesh."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from evenroad._arrays import Floats, Ints, unique_rows
from evenroad._files import read_bytes
from evenroad._understood import Kind, require_understood
from evenroad.errors import BrokenFile, UnknownName

_LEVELS = 16
"""Depth of the tree; the finest cells are 2^-16 of the root."""
_HEADER = Kind(("id", "size", "res"))
_OCCUPIED, _INNER = 2, 3
"""Values of a child's two bits in a node. The others are 0, unknown, and 1, free."""
_SIDES = ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6))
"""Corners of the sides of a cube, counterclockwise from outside; the bits of a corner say x, y and z."""


def read_octomap(file: Path) -> tuple[Floats, Ints]:
    """Return vertices, (v, 3) [m], and triangles, (t, 3), around the occupied cells of an OctoMap.

    The format is that of Hornung et al. (2013), "OctoMap: an efficient probabilistic 3D mapping framework".  After a
    header in text, each inner node, depth first, has two bits for each of eight children.  Sides shared by two cells of
    one size are omitted; unknown cells are free.  Raises BrokenFile if the file is not such a map, is cut off, or has
    no occupied cell.
    """
    try:
        header, data = read_bytes(file).split(b"\ndata\n", 1)
        lines = [line.split() for line in header.decode("ascii").splitlines() if line and not line.startswith("#")]
        said = {words[0]: words[1] for words in lines}
        require_understood(said, _HEADER, f"the header of the OctoMap {file}")
        resolution, count = float(said["res"]), int(said["size"])
    except UnknownName:
        raise
    except (OSError, ValueError, KeyError, IndexError) as error:
        raise BrokenFile(f"cannot read the OctoMap {file}: its header must have id, size, res and data") from error
    if said.get("id") != "OcTree" or not header.startswith(b"# Octomap OcTree binary file"):
        raise BrokenFile(f"{file} is no binary OctoMap of type OcTree: octomap's convert_octree writes one as .bt")
    if not 0.0 < resolution < 1e3:
        raise BrokenFile(f"the resolution of the OctoMap {file} must be > 0 and < 1000 m, got {resolution:g}")
    cells = _occupied(data, count, file)
    if len(cells) == 0:
        raise BrokenFile(f"the OctoMap {file} has no occupied cell: nothing would ever collide")
    return _surface(cells, resolution)


def _occupied(data: bytes, count: int, file: Path) -> Ints:
    """Return x, y, z and the width of the occupied cells in finest cells, (n, 4); the middle of the root is at 0."""
    root = 1 << (_LEVELS - 1)
    waiting = [(-root, -root, -root, 2 * root)]
    found, offset, nodes = [], 0, 1 if count else 0
    while waiting and count:
        x, y, z, width = waiting.pop()
        said = int.from_bytes(data[offset : offset + 2], "little")
        offset += 2
        if offset > len(data) or width == 1:
            raise BrokenFile(f"the OctoMap {file} is cut off or damaged at byte {offset} of its data")
        half, inner = width // 2, []
        for i in range(8):
            kind = said >> (2 * i) & 3
            nodes += kind > 0
            child = (x + half * (i & 1), y + half * (i >> 1 & 1), z + half * (i >> 2), half)
            if kind == _OCCUPIED:
                found.append(child)
            elif kind == _INNER:
                inner.append(child)
        waiting += reversed(inner)
    if nodes != count or offset != len(data):
        raise BrokenFile(
            f"the OctoMap {file} announces {count} nodes, and has {nodes} in {offset} of {len(data)} bytes"
        )
    return np.array(found, dtype=np.int64).reshape(-1, 4)


def _surface(cells: Ints, resolution: float) -> tuple[Floats, Ints]:
    """Return the sides of cells, (n, 4), that no neighbour of the same width shares."""
    corner = np.array([(i & 1, i >> 1 & 1, i >> 2) for i in range(8)])
    corners = cells[:, np.newaxis, :3] + cells[:, np.newaxis, 3:] * corner
    lattice, number = unique_rows(corners.reshape(-1, 3))
    sides = number.reshape(-1, 8)[:, _SIDES].reshape(-1, 4)
    _, side = unique_rows(np.sort(sides, axis=1))
    a, b, c, d = sides[np.bincount(side)[side] == 1].T
    triangles = np.stack([a, b, c, a, c, d], axis=1).reshape(-1, 3)
    vertices: Floats = resolution * lattice.astype(np.float64)
    return vertices, triangles
