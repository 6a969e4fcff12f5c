"""Point sets on disk: .npz with the coordinates and the origin as JSON, checked on load; or plain .npy arrays."""

from __future__ import annotations

import json
import os
from dataclasses import asdict, fields

import numpy as np

from evenroad._files import atomic_write
from evenroad.errors import BrokenFile, InvalidValue
from evenroad.points.pointset import Origin, PointSet

_NAMES = {"points", "origin", "hash"}


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
        raise BrokenFile(f"{path} is not a readable .npy array: {_one_line(error)}") from error
    return PointSet(array, Origin(family="given", method="given"))


def load_points(path: str | os.PathLike[str]) -> PointSet:
    """Read a point set written by :func:`save_points`, checking names, dtype, shape, range and hash.

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
            names = set(archive.files)
            if names != _NAMES:
                raise BrokenFile(f"{path} holds {sorted(names)}, a point set holds {sorted(_NAMES)}")
            coordinates, origin, digest = archive["points"], str(archive["origin"]), str(archive["hash"])
            if not isinstance(coordinates, np.ndarray):
                # NumPy hands out a member without the magic of an array as bytes.
                raise BrokenFile(f"{path}: points is no array")
    except FileNotFoundError:
        raise BrokenFile(f"no such file: {path}") from None
    except BrokenFile:
        raise
    except Exception as error:
        # No list is complete: damaged headers alone give errors of the tokenizer, of memory and of overflow, and
        # zipfile has its own for every compression, encryption and version that it does not know.
        raise BrokenFile(f"{path} is not a readable .npz point set: {_one_line(error)}") from error
    if coordinates.dtype != np.float64:
        raise BrokenFile(f"{path}: points have dtype {coordinates.dtype}, expected float64")
    try:
        loaded = PointSet(coordinates, _origin_from_json(origin))
    except (InvalidValue, TypeError, ValueError) as error:
        raise BrokenFile(f"{path}: {error}") from error
    if loaded.hash != digest:
        raise BrokenFile(f"{path}: the points do not match their hash; the file was changed or damaged")
    return loaded


def _one_line(error: BaseException) -> str:
    return " ".join(f"{type(error).__name__}: {error}".split())


def _origin_from_json(text: str) -> Origin:
    record = json.loads(text)
    known = {f.name for f in fields(Origin)}
    if not isinstance(record, dict) or not set(record) <= known:
        raise ValueError(f"the origin must be an object with keys among {sorted(known)}")
    return Origin(**record)
