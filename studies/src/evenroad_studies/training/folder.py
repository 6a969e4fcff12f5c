"""A folder of sets: the one request that it belongs to, and the tasks that fill it.

The request is written beside the sets, so sets of two requests never mix unnoticed.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from evenroad.errors import BrokenFile, InvalidValue
from evenroad.points.anneal import SCHEDULE, Callback, anneal
from evenroad.points.npz import load_points, save_points
from evenroad.points.pointset import Origin, PointSet
from evenroad_studies.training.objective import parse_objective
from evenroad_studies.training.order import search_orders

if TYPE_CHECKING:
    from evenroad_studies.network import NetworkConfig

REQUEST_FILE = "request.json"


def set_name(index: int) -> str:
    """Return the file name of a set inside its folder."""
    return f"set-{index:04d}.npz"


def read_set(path: Path, origin: Origin, shape: tuple[int, int]) -> PointSet | None:
    """Return a finished set; None if its file is missing or damaged.

    Raises InvalidValue if the file holds a set of another shape, method, objective, seed or replica.
    """
    try:
        points = load_points(path)
    except BrokenFile:
        return None
    names = ("method", "objective", "seed", "replica")
    same = all(getattr(points.origin, name) == getattr(origin, name) for name in names)
    if points.points.shape != shape or not same:
        raise InvalidValue(f"{path} holds another set ({points!r}); use another folder")
    return points


@dataclass(frozen=True)
class SetTask:
    """All that a process needs to make one set: what its origin will say, its own seeds, and its file if any.

    With a `network` it is trained as that says; by the origin's method ``order`` it is a search over orders, else it is
    annealed.
    """

    n: int
    d: int
    steps: int
    seeds: np.random.SeedSequence
    origin: Origin
    path: Path | None
    network: NetworkConfig | None = None

    @property
    def replica(self) -> int:
        """Number of the set in its folder."""
        return self.origin.replica or 0


def make_set(task: SetTask, callback: Callback) -> PointSet:
    """Make the set of a task, save it if it has a file, and return it."""
    if task.network is not None:
        # Here, because the network's configs are built on this folder.
        from evenroad_studies.network.train import train

        made = train(task.network, rng=task.seeds, callback=callback)
    elif task.origin.method == "order":
        made = search_orders(task.n, steps=task.steps, rng=task.seeds, callback=callback)
    else:
        objective = parse_objective(task.origin.objective)
        made = anneal(task.n, task.d, objective, steps=task.steps, rng=task.seeds, callback=callback)
    points = PointSet(made.points, task.origin)
    if task.path is not None:
        save_points(task.path, points)
    return points


def finished_set(task: SetTask) -> PointSet | None:
    """Return the set of a task from its file; None if it is missing or damaged and has to be made."""
    return None if task.path is None else read_set(task.path, task.origin, (task.n, task.d))


def request_of(task: SetTask) -> dict[str, Any]:
    """Return what all sets of a folder have in common; their number is not part of it."""
    method = {"schedule": SCHEDULE} if task.network is None else {"network": asdict(task.network)}
    return {
        "n": task.n,
        "d": task.d,
        "objective": task.origin.objective,
        "steps": task.steps,
        "family": task.origin.family,
        **method,
        "seed": task.origin.seed,
        "entropy": str(task.seeds.entropy),
        "spawn_key": list(task.seeds.spawn_key[:-1]),
    }


@contextmanager
def one_at_a_time(path: Path) -> Iterator[None]:
    """Hold the lock file `path` for the block: other processes that want it wait.

    The lock goes with the process, so a killed one leaves none.  Without ``flock`` (Windows) nothing is locked.
    """
    with open(path, "w", encoding="utf-8") as file:
        with suppress(ImportError):
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX)
        yield
