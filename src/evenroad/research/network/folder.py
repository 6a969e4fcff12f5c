"""The folder of a training: the request it belongs to, and the finished sets."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from evenroad.errors import BrokenFile, InvalidValue
from evenroad.points.measures.l2 import Array
from evenroad.points.npz import load_points, save_points
from evenroad.points.pointset import Origin, PointSet
from evenroad.research.network.config import NetworkConfig
from evenroad.research.training.request import set_name


def request_of(config: NetworkConfig) -> dict[str, Any]:
    """Return what the folder of a training says it was asked for."""
    return {"method": "network", **config.as_record()}


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
