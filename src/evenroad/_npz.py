"""Files of arrays (.npz): written atomically; every damage raises BrokenFile on reading."""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from errno import EINVAL
from typing import IO, TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Array
from evenroad._files import Json, atomic_write, not_a, open_file
from evenroad._shared import OwnLock
from evenroad.errors import BrokenFile, UnknownName, shown

if TYPE_CHECKING:
    import zipfile

Path = str | os.PathLike[str]
Arrays = dict[str, Array]
_ALWAYS_ALLOWED, _MOST_TIMES = 1 << 22, 50
"""Largest unpacked size of an archive: a number of bytes, or a multiple of its own size; ours have 1 to 10 times."""


def write_npz(path: Path, arrays: Mapping[str, npt.ArrayLike], *, compressed: bool = False) -> None:
    """Write arrays by their names, atomically (see `atomic_write`); texts become arrays of no axes."""
    save = np.savez_compressed if compressed else np.savez
    with atomic_write(path) as file:
        save(file, allow_pickle=False, **{name: np.asarray(array) for name, array in arrays.items()})


@contextmanager
def reading(path: Path, kind: str, begins: bytes = b"") -> Iterator[None]:
    """Turn every error in the block into a BrokenFile that names the file and its `kind`.

    The bytes with which every such file `begins` distinguish a damaged one from one of another kind.
    """
    try:
        yield
    except (BrokenFile, UnknownName):
        raise
    except FileNotFoundError:
        raise BrokenFile(f"no such file: {path}") from None
    except IsADirectoryError:
        raise BrokenFile(f"{path} is a folder, not a {kind}") from None
    except Exception as error:
        # No list is complete: damaged headers alone give errors of the tokenizer, of memory and of overflow.
        # A file that cannot be opened has a message of its own; EINVAL comes from a damaged archive.
        if not begins or (isinstance(error, OSError) and error.errno not in (None, EINVAL)):
            raise BrokenFile(f"{path} is not a readable {kind}: {shown(error)}") from error
        with open(path, "rb") as file:
            is_other = file.read(len(begins)) != begins
        if is_other:
            raise not_a(f"a {kind}", path) from error
        why = "it was damaged, cut off, or holds Python objects"
        raise BrokenFile(f"{path} is not a readable {kind}: {why}") from error


def read_npz(path: Path, what: str, *layouts: Collection[str]) -> Arrays:
    """Return the arrays of a file of `write_npz` whose names are those of one of the `layouts`, else BrokenFile."""
    # Imported late: a plan of an arm reads no archive.
    import zipfile

    arrays = {}
    # Opened here, not by NumPy, which leaves the handle open when the archive is broken.
    with reading(path, f".npz {what}", b"PK"), open_file(path) as file:
        if file.read(6) == np.lib.format.MAGIC_PREFIX:
            raise BrokenFile(f"{path} is a plain array, not a .npz {what}")
        with zipfile.ZipFile(file) as archive:
            require_unpackable(path, archive)
            members = {info.filename.removesuffix(".npy"): info for info in archive.infolist()}
            if set(members) not in map(set, layouts):
                raise BrokenFile(f"{path} holds {shown(sorted(members))}, a {what} {sorted(layouts[0])}")
            for name, info in members.items():
                with archive.open(info) as member:
                    if member.read(6) != np.lib.format.MAGIC_PREFIX:
                        raise BrokenFile(f"{path}: {name} is no array")
                    member.seek(0)
                    arrays[name] = read_array(member, info.file_size)
    return arrays


def read_array(file: IO[bytes], size: int) -> Array:
    """Return the array of an open .npy file of `size` bytes, or raise ValueError if its header announces others."""
    version = np.lib.format.read_magic(file)
    if version not in _HEADERS:
        raise ValueError(f"a .npy file of version {version}")
    with _LOCK:
        shape, _, dtype = _HEADERS[version](file)
        announced, there = math.prod(shape) * dtype.itemsize, size - file.tell()
        if not dtype.hasobject and announced != there:
            raise ValueError(f"it is damaged or cut off: {announced} bytes were announced, {there} are there")
        file.seek(0)
        return np.lib.format.read_array(file, allow_pickle=False)


_LOCK = OwnLock()
"""Headers are parsed one after the other: CPython 3.11 counts how deep a syntax tree is for all threads at once."""


_HEADERS = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
    (3, 0): np.lib.format.read_array_header_2_0,
}
"""Readers of headers by version; 3.0 has names of fields in UTF-8, which changes no size."""


def require_unpackable(path: Path, archive: zipfile.ZipFile) -> None:
    """Raise BrokenFile if an archive would unpack to far more than its own size; nothing is unpacked to find out."""
    packed, unpacked = os.path.getsize(path), sum(info.file_size for info in archive.infolist())
    if unpacked > max(_ALWAYS_ALLOWED, _MOST_TIMES * packed):
        raise BrokenFile(f"{path} has {packed} bytes and would unpack to {unpacked}: it is not read")


def read_json(path: Path, name: str, array: Array, keys: Collection[str]) -> dict[str, Json]:
    """Return the JSON object that an array of no axes holds as text, with keys among `keys`, or raise BrokenFile."""
    try:
        record = json.loads(str(array))
    except (ValueError, RecursionError) as error:
        raise BrokenFile(f"{path}: {name} is no JSON: {shown(error)}") from error
    if not isinstance(record, dict) or not set(record) <= set(keys):
        raise BrokenFile(f"{path}: {name} must be an object with keys among {sorted(keys)}")
    return record


def require_array(path: Path, name: str, array: Array, dtype: npt.DTypeLike, shape: tuple[int | None, ...]) -> None:
    """Raise BrokenFile unless an array has this dtype and shape; None stands for any length."""
    fits = len(shape) == array.ndim and all(
        wanted is None or wanted == length for wanted, length in zip(shape, array.shape, strict=True)
    )
    if array.dtype != np.dtype(dtype) or not fits:
        lengths = ", ".join("any" if length is None else str(length) for length in shape)
        raise BrokenFile(
            f"{path}: {name} must be {np.dtype(dtype)} of shape ({lengths}), got {array.dtype} of shape {array.shape}"
        )


def digest(arrays: Mapping[str, Array]) -> str:
    """Return the SHA-256 (hex) of arrays: their names, dtypes, shapes and bytes."""
    sha = hashlib.sha256()
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        sha.update(f"{name} {array.dtype.str} {array.shape}:".encode())
        sha.update(array.tobytes())
    return sha.hexdigest()
