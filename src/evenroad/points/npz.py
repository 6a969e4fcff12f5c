"""Point sets on disk: .npz with the coordinates and the origin as JSON, checked on load; or plain .npy arrays."""

from __future__ import annotations

import json
import os
from dataclasses import asdict
from typing import get_args, get_type_hints

import numpy as np

from evenroad._call import explains_calls
from evenroad._checks import as_file, require_known
from evenroad._files import atomic_write, open_file, require_file
from evenroad._npz import Arrays, Path, read_array, read_json, read_npz, reading, write_npz
from evenroad.errors import BrokenFile, shown
from evenroad.points.pointset import Origin, PointSet

_ORIGIN_TYPES = {name: get_args(kind) or (kind,) for name, kind in get_type_hints(Origin).items()}
"""Field of an origin -> the types that it may have."""


def save_points(path: Path, points: PointSet) -> None:
    """Write a point set as ``.npz`` (arrays `points`, `origin`, `hash`), atomically; BrokenFile if that fails."""
    write_npz(path, dict(points=points.points, origin=json.dumps(asdict(points.origin)), hash=points.hash))


def write_points(points: PointSet, path: str | os.PathLike[str]) -> None:
    """See :meth:`PointSet.save`."""
    file = as_file("what points are saved to", path)
    suffix = file.suffix.lower()
    require_known(f"kind of file for points, {os.fspath(path)!r}: suffix", suffix, (".npz", ".npy", ".csv"))
    if suffix == ".npz":
        save_points(file, points)
    elif suffix == ".npy":
        with atomic_write(file) as out:
            np.save(out, points.points)
    else:
        text = "".join(",".join(map(repr, row)) + "\n" for row in points.points.tolist())
        with atomic_write(file) as out:
            out.write(text.encode())


@explains_calls
def load_points(path: str | os.PathLike[str]) -> PointSet:
    """Read points from a file.

    Parameters
    ----------
    path : str or path-like
        ``.npz`` with an origin, all of which is checked; or ``.npy`` or ``.csv``.

    Returns
    -------
    PointSet

    Raises
    ------
    BrokenFile
        If the file is missing or damaged.
    InvalidValue
        If a plain array is no point set.

    Examples
    --------
    >>> import tempfile
    >>> import evenroad as er
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     er.draw("sobol", 64, 2).save(f"{folder}/set.csv")
    ...     er.load_points(f"{folder}/set.csv").shape
    (64, 2)
    """
    suffix = as_file("what points are read from", path, "points of an array are PointSet(array)").suffix
    if suffix == ".csv":
        try:
            require_file(path)
            rows = np.loadtxt(path, delimiter=",", ndmin=2)
        except (OSError, UnicodeDecodeError) as error:
            raise BrokenFile(f"cannot read the points {path}: {error}") from error
        except ValueError as error:
            raise BrokenFile(
                f"{path} is no table of points, which has numbers alone ({error}); a plan or a trajectory is read from"
                " its .json"
            ) from error
        return PointSet(rows)
    if suffix != ".npz":
        with reading(path, ".npy array of shape (n, d)", b"\x93NUMPY"), open_file(path) as file:
            array = read_array(file, os.path.getsize(path))
        return PointSet(array)
    arrays = read_npz(path, "point set", ("points", "origin", "hash"))
    if arrays["points"].dtype != np.float64:
        raise BrokenFile(f"{path}: points have dtype {arrays['points'].dtype}, expected float64")
    loaded = points_of(path, arrays)
    if loaded.hash != str(arrays["hash"]):
        raise BrokenFile(f"{path}: the points do not match their hash; the file was changed or damaged")
    return loaded


def points_of(path: Path, arrays: Arrays) -> PointSet:
    """Return the point set of the arrays `points` and `origin` of a file, or raise BrokenFile."""
    record = read_json(path, "origin", arrays["origin"], _ORIGIN_TYPES)
    for name, value in record.items():
        if type(value) not in _ORIGIN_TYPES[name]:
            raise BrokenFile(f"{path}: the origin's {name} cannot be {shown(value)}")
    try:
        return PointSet(arrays["points"], Origin(**record))
    except (TypeError, ValueError) as error:
        raise BrokenFile(f"{path}: {error}") from error
