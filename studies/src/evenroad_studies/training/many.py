"""Many sets, annealed or trained, one a process; finished ones are on disk at once, so that a stopped run goes on."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Iterator
from concurrent.futures import Future, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from evenroad._checks import require_count
from evenroad._rng import RngLike, generator, seed_of
from evenroad._threads import processors
from evenroad.datasets.folder import claim_folder
from evenroad.datasets.workers import ProcessPool
from evenroad.errors import InvalidValue, WorkerLost
from evenroad.points.anneal import Callback, require_points_for
from evenroad.points.pointset import Origin, PointSet
from evenroad_studies.training.folder import (
    REQUEST_FILE,
    SetTask,
    finished_set,
    make_set,
    request_of,
    set_name,
)
from evenroad_studies.training.objective import Objective, parse_objective

if TYPE_CHECKING:
    from evenroad_studies.network import NetworkConfig

_POLL_SECONDS = 0.2


def anneal_many(
    n: int,
    d: int,
    objective: str | Objective = "hickernell",
    sets: int = 1,
    *,
    steps: int = 5000,
    rng: RngLike = 0,
    workers: int | None = None,
    folder: str | os.PathLike[str] | None = None,
    family: str | None = None,
    callback: Callback | None = None,
) -> tuple[PointSet, ...]:
    """Anneal `sets` independent sets, each from its own seed, in parallel processes.

    Set i is drawn from the i-th child of the seed, so it is the same whatever the number of processes and
    whichever sets are already there.

    Parameters
    ----------
    n, d, objective, steps
        As for :func:`~evenroad.points.anneal.anneal`; the objective may be text.
    sets : int
        How many sets, >= 1.
    rng : int, SeedSequence or Generator
        Root of the seeds.  A Generator is spawned and so gives other sets in every call, which cannot be resumed.
    workers : int, optional
        Spawned processes, so that a script must guard its main part with ``if __name__ == "__main__"``; by default the
        processors that this process may use.  1 works in this process.
    folder : path, optional
        An existing folder that gets ``set-0000.npz``, ... each as soon as it is finished, and a file that says
        which request they belong to.  Sets that are already there are read instead of annealed.
    family : str, optional
        Name of the family in the origins; the objective's expression if not given.
    callback : callable, optional
        Called as ``callback(step, steps, best)`` with the steps of all sets together and the best value so far
        (``inf`` before the first), a few times a second; what it raises stops the work.

    Raises
    ------
    InvalidValue, BrokenFile
        For an argument out of range, or a folder of another request; if the folder is missing or cannot be written.
    WorkerLost
        If a process was killed.  Finished sets are in the folder; the same call goes on.
    """
    n, d, steps = require_count("n", n), require_count("d", d), require_count("steps", steps)
    target = parse_objective(objective)
    require_points_for(target, n)
    text = str(target)
    origin = Origin(family=text if family is None else family, method="annealed", objective=text, seed=seed_of(rng))
    first = SetTask(n, d, steps, _root_sequence(rng), origin, None)
    return _make_all(first, sets, workers, folder, callback)


def train_many(
    config: NetworkConfig,
    sets: int = 1,
    *,
    rng: RngLike = 0,
    workers: int | None = None,
    folder: str | os.PathLike[str] | None = None,
    callback: Callback | None = None,
) -> tuple[PointSet, ...]:
    """Train `sets` independent networks, each with its own seed and one set: all else as :func:`anneal_many`."""
    origin = Origin(family="mpmc", method="network", objective=config.objective, seed=seed_of(rng))
    first = SetTask(config.n, config.d, config.steps, _root_sequence(rng), origin, None, config)
    return _make_all(first, sets, workers, folder, callback)


def order_many(
    n: int,
    sets: int = 1,
    *,
    steps: int = 5000,
    rng: RngLike = 0,
    workers: int | None = None,
    folder: str | os.PathLike[str] | None = None,
    callback: Callback | None = None,
) -> tuple[PointSet, ...]:
    """Search orders of n points in the plane for `sets` sets of small star discrepancy: else as :func:`anneal_many`.

    `n` and `steps` are those of :func:`~evenroad_studies.training.order.search_orders`.
    """
    n, steps = require_count("n", n), require_count("steps", steps)
    origin = Origin(family="order", method="order", objective="star", seed=seed_of(rng))
    return _make_all(SetTask(n, 2, steps, _root_sequence(rng), origin, None), sets, workers, folder, callback)


def _make_all(
    first: SetTask,
    sets: int,
    workers: int | None,
    folder: str | os.PathLike[str] | None,
    callback: Callback | None,
) -> tuple[PointSet, ...]:
    """Make sets like the `first`, each of its own child of the seed, and with its own file in the folder."""
    sets, home = require_count("sets", sets), None if folder is None else Path(folder)
    processes = require_count("workers", processors() if workers is None else workers)
    root = first.seeds
    tasks = [
        replace(
            first,
            seeds=np.random.SeedSequence(root.entropy, spawn_key=(*root.spawn_key, i)),
            origin=replace(first.origin, replica=i),
            path=home and home / set_name(i),
        )
        for i in range(sets)
    ]
    if home is not None:
        claim_folder(home, request_of(tasks[0]), REQUEST_FILE)
    done = {task.replica: points for task in tasks if (points := finished_set(task)) is not None}
    missing = [task for task in tasks if task.replica not in done]
    make = _one_by_one if min(processes, len(missing)) <= 1 else _in_processes
    for points in make(missing, processes, first.steps * len(done), first.steps * sets, callback):
        done[points.origin.replica or 0] = points
    return tuple(done[i] for i in range(sets))


def _one_by_one(
    tasks: list[SetTask], processes: int, already: int, total: int, callback: Callback | None
) -> Iterator[PointSet]:
    best = np.inf
    for number, task in enumerate(tasks):

        def report(step: int, steps: int, value: float, before: int = already + number * task.steps) -> None:
            nonlocal best
            best = min(best, value)
            if callback is not None:
                callback(before + step, total, best)

        yield make_set(task, report)


def _in_processes(
    tasks: list[SetTask], processes: int, already: int, total: int, callback: Callback | None
) -> Iterator[PointSet]:
    context = multiprocessing.get_context("spawn")
    steps_done = context.Array("q", len(tasks), lock=False)
    best_values = context.Array("d", [np.inf] * len(tasks), lock=False)
    stop = context.Value("b", 0, lock=False)
    pool = ProcessPool(min(processes, len(tasks)), _share, (steps_done, best_values, stop))
    try:
        waiting: set[Future[PointSet]] = {pool.submit(_make_set_shared, slot, task) for slot, task in enumerate(tasks)}
        while waiting:
            finished, waiting = wait(waiting, timeout=_POLL_SECONDS, return_when="FIRST_COMPLETED")
            if callback is not None:
                callback(already + sum(steps_done), total, min(best_values))
            for future in finished:
                yield future.result()
    except BrokenProcessPool as error:
        raise WorkerLost(
            "a process of anneal_many ended early: killed, out of memory, or a script without"
            ' `if __name__ == "__main__"`. Finished sets are in the folder, if one was given; call again to go on'
        ) from error
    finally:
        stop.value = 1
        pool.shutdown(wait=True, cancel_futures=True)


_shared: tuple[Any, Any, Any] | None = None
"""In a worker process only: steps done and best value of every set, for the parent, and its wish to stop."""


class _Stopped(Exception):
    """The parent gave up; nobody reads this one."""


def _share(steps_done: Any, best_values: Any, stop: Any) -> None:
    global _shared
    _shared = (steps_done, best_values, stop)


def _make_set_shared(slot: int, task: SetTask) -> PointSet:
    assert _shared is not None  # set by the initializer
    steps_done, best_values, stop = _shared

    def report(step: int, steps: int, best: float) -> None:
        steps_done[slot] = step
        best_values[slot] = best
        if stop.value:
            raise _Stopped

    return make_set(task, report)


def _root_sequence(rng: RngLike) -> np.random.SeedSequence:
    if isinstance(rng, np.random.SeedSequence):
        return rng
    if isinstance(rng, np.random.Generator):
        return rng.bit_generator.seed_seq.spawn(1)[0]  # type: ignore[attr-defined]
    if isinstance(rng, np.random.RandomState):
        return generator(rng).bit_generator.seed_seq  # type: ignore[return-value]
    if isinstance(rng, bool) or not isinstance(rng, int | np.integer) or rng < 0:
        raise InvalidValue(f"rng must be an int >= 0, a numpy SeedSequence, Generator or RandomState, got {rng!r}")
    return np.random.SeedSequence(int(rng))
