"""Point sets on disk: .npz with the coordinates and the origin as JSON, checked on load; or plain .npy arrays."""

from __future__ import annotations

import json
import os
from dataclasses import asdict
from typing import get_args, get_type_hints

import numpy as np

from evenroad._files import atomic_write
from evenroad.errors import BrokenFile, shown
from evenroad.points.pointset import Origin, PointSet

_NAMES = ("points", "origin", "hash")

_ORIGIN_TYPES = {name: get_args(kind) or (kind,) for name, kind in get_type_hints(Origin).items()}
"""Field of an origin -> the types that it may have."""


def save_points(path: str | os.PathLike[str], points: PointSet) -> None:
    """Write a point set as ``.npz`` (arrays `points`, `origin`, `hash`), atomically.

    Raises
    ------
    BrokenFile
        If the file cannot be written; whatever was at `path` is then untouched.
    """
    with atomic_write(path) as file:
        np.savez(file, points=points.points, origin=json.dumps(asdict(points.origin)), hash=points.hash)


def save_array(path: str | os.PathLike[str], points: PointSet) -> None:
    """Write the bare coordinates as ``.npy`` (float64, shape (n, d)), atomically; the origin is not kept."""
    with atomic_write(path) as file:
        np.save(file, points.points)


def read_points(path: str | os.PathLike[str]) -> PointSet:
    """Read a point set from ``.npz`` (see :func:`load_points`) or a plain ``.npy`` array, which has no origin.

    Raises
    ------
    BrokenFile
        If the file is missing or is neither.
    InvalidValue
        If a plain array is no point set: its shape, or a coordinate that is not in [0, 1).
    """
    if os.fspath(path).endswith(".npz"):
        return load_points(path)
    try:
        with open(path, "rb") as file:
            array = np.load(file, allow_pickle=False)
    except FileNotFoundError:
        raise BrokenFile(f"no such file: {path}") from None
    except Exception as error:  # see load_points
        raise BrokenFile(f"{path} is not a readable .npy array: {shown(error)}") from error
    return PointSet(array)


def load_points(path: str | os.PathLike[str]) -> PointSet:
    """Read a point set written by :func:`save_points`, checking names, types, shape, range and hash.

    Raises
    ------
    BrokenFile
        If the file is missing, is no such npz, or any of the checks fails; the text says which.
    """
    try:
        # Opened here, not by NumPy, which leaves the handle open when the archive is broken.
        with open(path, "rb") as file:
            archive = np.load(file, allow_pickle=False)
            if not isinstance(archive, np.lib.npyio.NpzFile):
                raise BrokenFile(f"{path} is a plain array, not a .npz point set")
            if sorted(archive.files) != sorted(_NAMES):
                raise BrokenFile(
                    f"{path} holds {shown(sorted(archive.files))}, a point set holds {sorted(_NAMES)}"
                )
            arrays = {name: archive[name] for name in _NAMES}
    except FileNotFoundError:
        raise BrokenFile(f"no such file: {path}") from None
    except BrokenFile:
        raise
    except Exception as error:
        # No list is complete: damaged headers alone give errors of the tokenizer, of memory and of overflow, and
        # zipfile has its own for every compression, encryption and version that it does not know.
        raise BrokenFile(f"{path} is not a readable .npz point set: {shown(error)}") from error
    for name, array in arrays.items():
        if not isinstance(array, np.ndarray):
            # NumPy hands out a member without the magic of an array as bytes.
            raise BrokenFile(f"{path}: {name} is no array")
    if arrays["points"].dtype != np.float64:
        raise BrokenFile(f"{path}: points have dtype {arrays['points'].dtype}, expected float64")
    try:
        loaded = PointSet(arrays["points"], _origin_from_json(str(arrays["origin"])))
    except (TypeError, ValueError, RecursionError) as error:
        raise BrokenFile(f"{path}: {error}") from error
    if loaded.hash != str(arrays["hash"]):
        raise BrokenFile(f"{path}: the points do not match their hash; the file was changed or damaged")
    return loaded


def _origin_from_json(text: str) -> Origin:
    record = json.loads(text)
    if not isinstance(record, dict) or not set(record) <= set(_ORIGIN_TYPES):
        raise ValueError(f"the origin must be an object with keys among {sorted(_ORIGIN_TYPES)}")
    for name, value in record.items():
        if type(value) not in _ORIGIN_TYPES[name]:
            raise ValueError(f"the origin's {name} cannot be {shown(value)}")
    return Origin(**record)
