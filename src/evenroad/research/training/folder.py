"""A folder of sets: the one request that it belongs to, and the tasks that fill it."""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from evenroad._files import atomic_write, remove_abandoned_parts
from evenroad.errors import BrokenFile, InvalidValue, shown
from evenroad.points.npz import load_points, save_points
from evenroad.points.optimise.anneal import SCHEDULE, Callback, anneal
from evenroad.points.pointset import Origin, PointSet

REQUEST_FILE = "request.json"


def set_name(index: int) -> str:
    """Return the file name of a set inside its folder."""
    return f"set-{index:04d}.npz"


def claim_folder(folder: Path, request: dict[str, Any]) -> None:
    """Write the request into `folder`, or check that the one already there is the same.

    Temporary files of trainings that were killed are removed from it.

    Raises
    ------
    InvalidValue
        If the folder belongs to another request; the text names the first difference.
    BrokenFile
        If the folder is missing or cannot be written, or its request is not readable.
    """
    path = folder / REQUEST_FILE
    remove_abandoned_parts(folder)
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
                f"{folder} holds sets with {name}={shown(there)}, asked for {name}={shown(wanted)};"
                " use another folder"
            )


@dataclass(frozen=True)
class SetTask:
    """All that a process needs to anneal one set; plain values, so that it can be sent there.

    Attributes
    ----------
    n, d, objective, steps
        As for ``anneal``, the objective as text.
    entropy, spawn_key
        Of the set's own seed sequence.
    family, seed, replica
        For the origin of the set.
    path : str or None
        The file that the finished set goes to.
    """

    n: int
    d: int
    objective: str
    steps: int
    entropy: Any
    spawn_key: tuple[int, ...]
    family: str
    seed: int | None
    replica: int
    path: str | None


def make_set(task: SetTask, callback: Callback) -> PointSet:
    """Anneal the set of a task, save it if it has a file, and return it."""
    sequence = np.random.SeedSequence(task.entropy, spawn_key=task.spawn_key)
    annealed = anneal(task.n, task.d, task.objective, steps=task.steps, rng=sequence, callback=callback)
    points = PointSet(annealed.points, origin_of(task))
    if task.path is not None:
        save_points(task.path, points)
    return points


def origin_of(task: SetTask) -> Origin:
    """Return the origin that the set of a task gets."""
    return Origin(
        family=task.family, method="annealed", objective=task.objective, seed=task.seed, replica=task.replica
    )


def finished_set(task: SetTask) -> PointSet | None:
    """Return the set of a task from its file, or None where it is missing or damaged and must be made."""
    if task.path is None or not os.path.exists(task.path):
        return None
    try:
        points = load_points(task.path)
    except BrokenFile:
        return None
    expected = origin_of(task)
    same = all(
        getattr(points.origin, name) == getattr(expected, name)
        for name in ("method", "objective", "seed", "replica")
    )
    if points.points.shape != (task.n, task.d) or not same:
        raise InvalidValue(f"{task.path} holds another set ({points!r}); use another folder")
    return points


def request_of(task: SetTask) -> dict[str, Any]:
    """Return what the sets of a folder have in common, whatever their number."""
    request = {name: asdict(task)[name] for name in ("n", "d", "objective", "steps", "family")}
    return {
        **request,
        "schedule": SCHEDULE,
        "seed": task.seed,
        "entropy": str(task.entropy),
        "spawn_key": list(task.spawn_key[:-1]),
    }
