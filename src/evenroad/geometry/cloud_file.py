"""Readers of point clouds: .ply, .pcd, .xyz and .npy files."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._files import open_file, read_bytes
from evenroad._npz import read_array, reading
from evenroad._understood import Kind, require_understood
from evenroad.errors import BrokenFile, UnknownName, shown

_PLY_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
_PLY_ORDERS = {"ascii": "=", "binary_little_endian": "<", "binary_big_endian": ">"}
_PCD_TYPES = {"F": "f", "I": "i", "U": "u"}
_LONGEST_HEADER = 1 << 16
_MOST_COLUMNS, _FEW_COLUMNS = 32, 8
"""Largest number of columns (coordinates, colours, normals, times) with more points than columns, and otherwise."""
_SURFACES = ("face", "tristrips")
"""Elements of a .ply that make it a mesh."""
_PCD = Kind(("FIELDS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT", "POINTS", "DATA"), harmless={"VERSION", "VIEWPOINT"})


def load_cloud(path: str | os.PathLike[str]) -> Floats:
    """Read the points of a cloud from a file by its suffix, (n, 3); other columns are ignored.

    Formats are ``.ply`` (ascii or binary, its element ``vertex``), ``.pcd`` (ascii, binary or compressed), ``.xyz``
    (text: three numbers or more per line, ``#`` begins a comment), and ``.npy`` (an array of three columns or more, or
    of fields x, y, z).  Rows of NaN in .pcd files are ignored: they are pixels without a depth.

    Raises
    ------
    BrokenFile
        If the file is missing, damaged, cut off or compressed, its header announces another number of points, it is
        empty, or a point is not finite.
    UnknownName
        For another suffix.
    """
    file = Path(path)
    readers = {".ply": _read_ply, ".pcd": _read_pcd, ".xyz": _read_xyz, ".npy": _read_npy}
    if file.suffix.lower() not in readers:
        if file.suffix.lower() == ".bt":
            raise UnknownName(f"the cloud {file} is an OctoMap, which is included as boxes: include: FILE.bt")
        raise UnknownName.among(f"format of the cloud {file}:", file.suffix, readers)
    with reading(file, "cloud of points"):
        points = np.asarray(readers[file.suffix.lower()](file), dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise BrokenFile(f"the cloud {file} must have three numbers a point, got an array of {points.shape}")
    if len(points) == 0:
        raise BrokenFile(f"the cloud {file} is empty: without points nothing would ever collide")
    lost = np.count_nonzero(~np.isfinite(points).all(axis=1))
    if lost:
        raise BrokenFile(f"the cloud {file} must have finite points, {lost} of {len(points)} are not")
    return points


def _read_npy(file: Path) -> npt.NDArray[np.generic]:
    with open_file(file) as stream:
        array = read_array(stream, file.stat().st_size)
    if array.dtype.names:
        return _columns(array)
    if np.iscomplexobj(array):
        raise ValueError("its numbers are complex")
    if array.ndim == 2:
        _require_points(file, *array.shape)
    return array[:, :3] if array.ndim == 2 and array.shape[1] > 3 else array


def _require_points(file: Path, rows: int, columns: int) -> None:
    """Raise BrokenFile for a table that is not a list of points: a depth image, or points in columns."""
    if columns > _MOST_COLUMNS or (columns > _FEW_COLUMNS and columns >= rows):
        raise BrokenFile(
            f"{file}, {rows} x {columns} numbers, is no list of points: these have a row each, x y z first"
        )


def _read_xyz(file: Path) -> Floats:
    lines = (line.split("#")[0].replace(",", " ").split() for line in read_bytes(file).decode().splitlines())
    every = [words for words in lines if words]
    if len(every) > 1:
        _require_points(file, len(every), max(map(len, every)))
    rows = [[float(word) for word in words[:3]] for words in every]
    if len({len(row) for row in rows}) > 1:
        raise ValueError("not every line has three numbers")
    return np.array(rows) if rows else np.empty((0, 3))


def _read_ply(file: Path) -> Floats:
    header, data = _header(read_bytes(file), b"end_header")
    if not header or header[0] != ["ply"]:
        raise ValueError("it does not begin with 'ply'")
    kind = next(words[1] for words in header if words[0] == "format")
    order = _PLY_ORDERS[kind]
    elements = [(words[1], _count("element " + words[1], words[2])) for words in header if words[0] == "element"]
    first, count = next(((name, count) for name, count in elements if count or name == "vertex"), ("", 0))
    if first != "vertex":
        raise ValueError("its first element is not 'vertex'")
    fields, element = [], ""
    for words in header:
        if words[0] == "element":
            element = words[1]
        elif words[0] == "property" and element == "vertex":
            fields.append((words[2], order + _PLY_TYPES[words[1]], (1,)))
    if faces := sum(each for name, each in elements if name in _SURFACES):
        raise BrokenFile(f"{file} is a mesh of {faces} faces, and not a cloud of their corners: read it as shape: mesh")
    # An ascii file has one line per element after the points. Binary lists are not read.
    behind = sum(count for _, count in elements) - count
    if behind and kind == "ascii":
        lines = [line for line in data.splitlines() if line.strip()]
        if len(lines) != count + behind:
            raise ValueError(f"{count + behind} lines were announced, {len(lines)} are there")
        data = b"\n".join(lines[:count])
    return _rows(data, count, fields, kind == "ascii", may_go_on=behind > 0)


def _read_pcd(file: Path) -> Floats:
    header, data = _header(read_bytes(file), b"DATA")
    said = {words[0]: words[1:] for words in header}
    require_understood(said, _PCD, f"the header of {file}")
    kind = said["DATA"][0]
    if kind not in ("ascii", "binary", "binary_compressed"):
        raise ValueError(f"its data are {kind!r}, not ascii, binary or binary_compressed")
    names, count = said["FIELDS"], _count("POINTS", said["POINTS"][0])
    width, height = (_count(key, said.get(key, ["1"])[0]) for key in ("WIDTH", "HEIGHT"))
    if "WIDTH" in said and width * height != count:
        raise ValueError(f"it has {width} x {height} points by WIDTH and HEIGHT, and {count} by POINTS")
    counts = [_count("COUNT", word) for word in said.get("COUNT", ["1"] * len(names))]
    if kind == "binary_compressed":
        widths = [_count("SIZE", size) * many for size, many in zip(said["SIZE"], counts, strict=True)]
        data = _rows_of_columns(data, widths, count)
    if sum(counts) * count > len(data):
        raise ValueError(f"it is cut off: {count} points of {sum(counts)} numbers were announced")
    fields = [
        # Names may repeat: '_' is what PCL calls gaps.
        (name if many == 1 and name != "_" else f"{name} {i}", "<" + _PCD_TYPES[letter] + size, (many,))
        for i, (name, letter, size, many) in enumerate(zip(names, said["TYPE"], said["SIZE"], counts, strict=True))
    ]
    points = _rows(data, count, fields, kind == "ascii")
    return points[~np.isnan(points).all(axis=1)]


def _rows_of_columns(data: bytes, widths: list[int], count: int) -> bytes:
    """Return the rows of points that compressed columns hold; a field has `widths` bytes in each row."""
    packed, size = (int.from_bytes(data[i : i + 4], "little") for i in (0, 4))
    if size != sum(widths) * count or packed != len(data) - 8:
        raise ValueError(f"{packed} bytes of {size} were announced, {len(data) - 8} of {sum(widths) * count} are there")
    columns = np.split(np.frombuffer(_unpacked(data[8:], size), dtype=np.uint8), count * np.cumsum(widths)[:-1])
    rows = [column.reshape(count, width) for column, width in zip(columns, widths, strict=True)]
    return np.concatenate(rows, axis=1).tobytes()


def _unpacked(data: bytes, size: int) -> bytes:
    """Return the bytes that LZF packed (M. Lehmann's liblzf): literal bytes, and copies of earlier ones."""
    out, i = bytearray(), 0
    while i < len(data) and len(out) <= size:
        first = data[i]
        if first < 32:
            out += data[i + 1 : i + 2 + first]
            i += 2 + first
            continue
        length, i = first >> 5, i + 1
        if length == 7:
            length, i = length + data[i], i + 1
        start, i, length = len(out) - 1 - ((first & 31) << 8 | data[i]), i + 1, length + 2
        if start < 0:
            raise ValueError("its compressed data are damaged")
        piece = out[start : start + length]
        # A copy may overlap the bytes that it writes.
        out += (piece * (length // len(piece) + 1))[:length]
    if len(out) != size or i != len(data):
        raise ValueError("its compressed data are damaged")
    return bytes(out)


def _count(what: str, word: str) -> int:
    """Return the number in a header, or raise ValueError."""
    if not (word.isdecimal() and len(word) < 16):
        raise ValueError(f"its {what} must be a number >= 0, got {shown(word)}")
    return int(word)


def _header(content: bytes, last: bytes) -> tuple[list[list[str]], bytes]:
    """Return the words of a file's header by line, up to the line that begins with `last`, and the rest of the file."""
    lines, offset = [], 0
    while offset < min(len(content), _LONGEST_HEADER):
        end = content.find(b"\n", offset)
        line = content[offset : end if end >= 0 else None]
        offset = len(content) if end < 0 else end + 1
        words = line.decode("ascii").split()
        if words and words[0] not in ("comment", "obj_info") and not words[0].startswith("#"):
            lines.append(words)
        if line.startswith(last):
            return lines, content[offset:]
    raise ValueError(f"its header has no {last.decode()!r}")


def _rows(
    data: bytes, count: int, fields: list[tuple[str, str, tuple[int]]], ascii_rows: bool, *, may_go_on: bool = False
) -> Floats:
    """Return x, y and z of `count` rows, (n, 3); ValueError if more follow, unless it `may_go_on`."""
    kind = np.dtype(fields)
    if ascii_rows:
        words, columns = data.split(), {}
        width = 0
        for name, _, (many,) in fields:
            columns[name] = width
            width += many
        there, whole = divmod(len(words), width)
        if there != count or whole:
            raise ValueError(_of_announced(count, there))
        table = np.array(list(map(float, words))).reshape(count, width)
        return np.stack([table[:, columns[name]] for name in "xyz"], axis=1)
    there = len(data) // kind.itemsize
    if there < count or (there > count and not may_go_on):
        raise ValueError(_of_announced(count, there))
    return _columns(np.frombuffer(data, dtype=kind, count=count))


def _of_announced(count: int, there: int) -> str:
    cut = "it is cut off: " if there < count else ""
    return f"{cut}{count} points were announced, {there} are there"


def _columns(table: npt.NDArray[np.void]) -> Floats:
    return np.stack([table[name].astype(np.float64).reshape(-1) for name in "xyz"], axis=1)
