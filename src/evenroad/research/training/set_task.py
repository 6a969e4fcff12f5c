"""The task of annealing one set of several: its seed, its origin, and its file in a folder."""

from __future__ import annotations

import os
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from evenroad.errors import BrokenFile, InvalidValue
from evenroad.points.npz import load_points, save_points
from evenroad.points.optimise.anneal import SCHEDULE, Callback, anneal
from evenroad.points.pointset import Origin, PointSet


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
