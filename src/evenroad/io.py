"""A plan on disk: JSON of what was asked, what came out and what made it; and its path as CSV."""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Sequence
from dataclasses import asdict
from importlib import metadata
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad import __version__
from evenroad._files import atomic_write
from evenroad.roadmap import PlanResult


def plan_record(result: PlanResult, query: dict[str, Any]) -> dict[str, Any]:
    """Return a plan as plain JSON values, in the units of its space.

    `query` is what was asked (map, radius, seed, ...), stored under ``query`` together with start and goals.
    """
    places = {name: getattr(result, name).tolist() for name in ("start", "goal", "goals")}
    paths = {name: getattr(result, name) for name in ("path", "milestone_path")}
    same = (
        "cost",
        "milestone_cost",
        "proof",
        "goal_index",
        "planner",
        "rule",
        "links",
        "counts",
        "deviation",
    )
    return {
        "status": str(result.status),
        "message": result.message,
        "query": places | query,
        **{name: None if path is None else path.tolist() for name, path in paths.items()},
        **{name: getattr(result, name) for name in same},
        "seconds": {phase: round(value, 6) for phase, value in result.seconds.items()},
        "stages": [asdict(stage) for stage in result.stages],
        "origin": asdict(result.origin),
        "versions": versions(),
    }


def versions() -> dict[str, str]:
    """Return the versions that a number can depend on: evenroad, Python and the numerical libraries."""
    libraries = {name: metadata.version(name) for name in ("numpy", "numba", "scipy")}
    return {"evenroad": __version__, "python": platform.python_version(), **libraries}


def save_json(path: str | os.PathLike[str], record: dict[str, Any]) -> None:
    """Write a record as indented UTF-8 JSON, atomically; NaN and infinity are refused, they are not JSON."""
    text = json.dumps(record, indent=2, allow_nan=False) + "\n"
    with atomic_write(path) as file:
        file.write(text.encode())


def save_path_csv(path: str | os.PathLike[str], waypoints: npt.ArrayLike, names: Sequence[str]) -> None:
    """Write waypoints, shape (p, dim), under a header of column names, atomically; floats round-trip."""
    rows = [names, *(map(repr, row) for row in np.asarray(waypoints, dtype=float).tolist())]
    with atomic_write(path) as file:
        file.write("".join(",".join(row) + "\n" for row in rows).encode())
