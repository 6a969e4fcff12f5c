"""The folder of a training: the request it belongs to, and the finished sets."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from evenroad._files import atomic_write
from evenroad.errors import BrokenFile, InvalidValue
from evenroad.points.measures.terms import Array
from evenroad.points.network.config import NetworkConfig
from evenroad.points.npz import load_points, save_points
from evenroad.points.optimise.set_task import REQUEST_FILE
from evenroad.points.pointset import Origin, PointSet


def claim_folder(folder: Path, config: NetworkConfig) -> None:
    """Write the request into `folder`, or check that the one already there is the same.

    Raises
    ------
    InvalidValue
        If the folder belongs to another request; the text names the first difference.
    BrokenFile
        If the folder is missing or cannot be written, or its request is not readable.
    """
    request = {"method": "network", **config.as_record()}
    path = folder / REQUEST_FILE
    if not path.exists():
        with atomic_write(path) as file:
            file.write(json.dumps(request, indent=1).encode())
        return
    try:
        found = json.loads(path.read_bytes())
    except (OSError, ValueError) as error:
        raise BrokenFile(f"{path} is not readable as JSON: {error}") from None
    for name, wanted in request.items():
        there = found.get(name) if isinstance(found, dict) else None
        if there != wanted:
            raise InvalidValue(
                f"{folder} holds sets with {name}={there!r}, asked for {name}={wanted!r}; use another folder"
            )


def point_sets(config: NetworkConfig, best_points: Array) -> tuple[PointSet, ...]:
    """Return the trained coordinates, shape (sets, n, d), as point sets with their origin."""
    return tuple(PointSet(each, origin_of(config, index)) for index, each in enumerate(best_points))


def origin_of(config: NetworkConfig, replica: int) -> Origin:
    """Return the origin of one set of a training."""
    return Origin(
        family="mpmc", method="network", objective=config.objective, seed=config.seed, replica=replica
    )


def save_sets(folder: Path, sets: Sequence[PointSet]) -> None:
    """Write ``set-0000.npz``, ... into `folder`."""
    for index, points in enumerate(sets):
        save_points(folder / set_name(index), points)


def finished_sets(folder: Path, config: NetworkConfig) -> tuple[PointSet, ...] | None:
    """Return the sets of `folder`, or None if one is missing or damaged and all have to be written again."""
    try:
        sets = tuple(load_points(folder / set_name(index)) for index in range(config.sets))
    except BrokenFile:
        return None
    for index, points in enumerate(sets):
        expected = origin_of(config, index)
        # The version may be an older one's: the sets are as good.
        if points.with_origin(version=expected.version).origin != expected:
            raise InvalidValue(
                f"{folder / set_name(index)} holds another set ({points!r}); use another folder"
            )
        if points.points.shape != (config.n, config.d):
            raise InvalidValue(
                f"{folder / set_name(index)} holds another set ({points!r}); use another folder"
            )
    return sets


def set_name(index: int) -> str:
    """Return the name of the file of a set, the same as for annealed ones."""
    return f"set-{index:04d}.npz"
