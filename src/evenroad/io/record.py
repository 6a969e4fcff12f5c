"""A plan on disk: a JSON record of what was asked, what came out and what made it; and its path as CSV."""

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
    """Return a plan as plain JSON values.

    Parameters
    ----------
    result : PlanResult
        The answer; configurations are written in the units of its space.
    query : dict
        What was asked (map, radius, seed, ...), stored under ``query`` together with start and goal.
    """
    return {
        "status": str(result.status),
        "message": result.message,
        "query": {
            "start": result.start.tolist(),
            "goal": result.goal.tolist(),
            "goals": result.goals.tolist(),
            **query,
        },
        "path": None if result.path is None else result.path.tolist(),
        "milestone_path": None if result.milestone_path is None else result.milestone_path.tolist(),
        "cost": result.cost,
        "milestone_cost": result.milestone_cost,
        "proof": result.proof,
        "goal_index": result.goal_index,
        "planner": result.planner,
        "rule": result.rule,
        "links": result.links,
        "counts": result.counts,
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
    rows = [
        ",".join(names),
        *(",".join(map(repr, row)) for row in np.asarray(waypoints, dtype=float).tolist()),
    ]
    with atomic_write(path) as file:
        file.write(("\n".join(rows) + "\n").encode())
