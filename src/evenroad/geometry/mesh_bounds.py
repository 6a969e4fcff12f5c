"""Bounds on the memory of a mesh file before it is read: a few bytes can declare gigabytes."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from xml.etree import ElementTree

from evenroad._npz import require_unpackable
from evenroad.errors import BrokenFile

_PACKED = (".gz", ".tgz", ".bz2", ".xz", ".zst")
_MOST_TIMES = 10
"""Largest number of entries and triangles per byte of a file; files that people make have less than one."""
_FEW_TRIANGLES = 1_000_000
_FEW_INSTANCES = 20
"""Number of instances up to which the parts of a COLLADA file cannot multiply."""


def require_bounded(file: Path) -> None:
    """Raise BrokenFile or ValueError if what a file announces is far more than there is in it."""
    suffix, size = file.suffix.lower(), file.stat().st_size
    if suffix in _PACKED:
        raise BrokenFile(f"the mesh {file} is packed: unpack it first")
    if zipfile.is_zipfile(file):
        with zipfile.ZipFile(file) as archive:
            require_unpackable(file, archive)
    elif suffix == ".glb":
        announced = _announced_by_gltf(file.read_bytes())
        if announced > _MOST_TIMES * size:
            raise ValueError(f"it announces {announced} entries in {size} bytes")
    elif suffix == ".dae":
        content = file.read_bytes()
        if content.count(b"instance_node") > _FEW_INSTANCES:
            require_few_triangles(_nodes_of_collada(content), size)


def require_few_triangles(count: int, size: int) -> None:
    """Raise ValueError for so many triangles, with every repetition, from a file of so many bytes."""
    if count > max(_FEW_TRIANGLES, _MOST_TIMES * size):
        raise ValueError(f"with its repetitions it has {count} parts, in {size} bytes")


def _announced_by_gltf(content: bytes) -> int:
    """Return how many entries the accessors of a .glb have in all: of one without data they are zeros."""
    length = int.from_bytes(content[12:16], "little")
    record = json.loads(content[20 : 20 + length])
    return sum(int(each["count"]) for each in record.get("accessors", []))


def _nodes_of_collada(content: bytes) -> int:
    """Return how many nodes there are where each that is named stands for all that is in it, again."""
    root = ElementTree.fromstring(content)
    nodes = [each for each in root.iter() if each.tag.endswith("}node")]
    named = {each.get("id", ""): each for each in nodes}
    known: dict[int, int] = {}

    def count(node: ElementTree.Element) -> int:
        if id(node) not in known:
            # Of a node inside of itself the reader says so.
            known[id(node)] = 1
            inside = [each for each in node if each.tag.endswith("}node")]
            meant = [named.get(each.get("url", "")[1:]) for each in node if each.tag.endswith("}instance_node")]
            known[id(node)] += sum(count(each) for each in (*inside, *meant) if each is not None)
        return known[id(node)]

    return max(map(count, nodes), default=0)
