"""Training and refining: from a config to sets, in a folder where a stopped training goes on."""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from evenroad._checks import require_count, require_positive
from evenroad.errors import InvalidValue
from evenroad.points.bank.anneal import Callback, anneal
from evenroad.points.npz import save_points
from evenroad.points.pointset import Origin, PointSet
from evenroad.research.network.config import NetworkConfig, choose_device, same_bits
from evenroad.research.network.state import (
    MicroBatch,
    TrainingState,
    advance,
    first_state,
    is_finished,
    load_checkpoint,
    save_checkpoint,
)
from evenroad.research.training.folder import claim_folder, read_set, set_name
from evenroad.research.training.objective import Objective, parse_objective


def origin_of(config: NetworkConfig, replica: int) -> Origin:
    """Return the origin of one set of a training."""
    return Origin(
        family="mpmc", method="network", objective=config.objective, seed=config.seed, replica=replica
    )


def finished_sets(folder: Path, config: NetworkConfig) -> tuple[PointSet, ...] | None:
    """Return the sets of `folder`; None if one is missing or damaged, and all have to be written again."""
    sets = []
    for index in range(config.sets):
        points = read_set(folder / set_name(index), origin_of(config, index), (config.n, config.d))
        if points is None:
            return None
        sets.append(points)
    return tuple(sets)


def train(
    config: NetworkConfig,
    *,
    folder: str | os.PathLike[str] | None = None,
    resume: bool = True,
    callback: Callback | None = None,
    device: str = "auto",
    threads: int = 1,
    checkpoint_seconds: float = 60.0,
) -> tuple[PointSet, ...]:
    """Train a network that turns random points into even ones, and return the best points it made.

    The method of Message-Passing Monte Carlo (Rusch, Kirk, Bronstein, Lemieux, Rus 2024): all sets go through one
    network, whose weights Adam changes so that the mean of the objective over the sets falls.

    Parameters
    ----------
    config : NetworkConfig
        Everything that decides the result.
    folder : path, optional
        An existing folder.  It gets a checkpoint every `checkpoint_seconds` and ``set-0000.npz``, ... at the end; the
        same call goes on where a stopped one was, and reads the sets if they are all there.
    resume : bool
        False starts over, in place of what the folder holds of the same request.
    callback : callable, optional
        Called as ``callback(step, steps, best)`` after every step, with the best mean of the objective so far;
        what it raises stops the training, with a checkpoint written first.
    device : str
        Where the network runs: ``auto`` takes a GPU when there is one, else the CPU; ``cpu``, ``cuda``,
        ``cuda:1``.  The objective is always computed on the CPU.
    threads : int
        Threads of torch on a CPU.  Resuming continues bit for bit on a CPU with the same number.

    Returns
    -------
    tuple of PointSet
        The best points of every set over all steps, with their origin.

    Raises
    ------
    InvalidValue, BrokenFile, NotAvailable
        For an argument out of range, a folder of another request, or a training that diverges; for a folder that is
        missing or cannot be written, or a damaged checkpoint; for a GPU that is not there.
    """
    place = choose_device(device)
    require_count("threads", threads)
    require_positive("checkpoint_seconds", checkpoint_seconds, or_zero=True)
    home = None if folder is None else Path(folder)
    if home is not None:
        claim_folder(home, {"method": "network", **asdict(config)})
        if resume and (sets := finished_sets(home, config)) is not None:
            return sets
    with same_bits(place, threads):
        state, batches = first_state(config, place)
        if home is not None and resume:
            load_checkpoint(home, config, state)
        _run(config, state, batches, home, callback, checkpoint_seconds)
    sets = tuple(PointSet(each, origin_of(config, i)) for i, each in enumerate(state.best_points))
    if home is not None:
        for index, points in enumerate(sets):
            save_points(home / set_name(index), points)
    return sets


def _run(
    config: NetworkConfig,
    state: TrainingState,
    batches: tuple[MicroBatch, ...],
    home: Path | None,
    callback: Callback | None,
    checkpoint_seconds: float,
) -> None:
    objective = parse_objective(config.objective)
    saved_step, saved_at = state.step, time.monotonic()
    while not is_finished(state, config):
        advance(state, batches, config, objective)
        if home is not None and time.monotonic() - saved_at >= checkpoint_seconds:
            save_checkpoint(home, config, state)
            saved_step, saved_at = state.step, time.monotonic()
        try:
            if callback is not None:
                callback(state.step, config.steps, state.best_mean)
        except BaseException:
            # Between two steps the state is whole, so that nothing done so far needs to be lost.
            if home is not None:
                save_checkpoint(home, config, state)
            raise
    # The last one stays: should a set's file be damaged later, it is written again without training.
    if home is not None and saved_step != state.step:
        save_checkpoint(home, config, state)


def refine(
    sets: Sequence[PointSet],
    objective: str | Objective | None = None,
    *,
    steps: int = 5000,
    callback: Callback | None = None,
) -> tuple[PointSet, ...]:
    """Anneal every set from where it is; none gets worse, since the best points seen are kept.

    It starts as hot as any annealing: a gentler start stays in the basin that the network found, and ends 20 %
    higher (d = 2, n = 64).

    Parameters
    ----------
    sets : sequence of PointSet
        With their origin: its seed and replica seed the noise, so that the same sets give the same result.  The method
        gets ``+annealed``.
    objective : str or Objective, optional
        What to make small; by default what each set was made for (InvalidValue if its origin does not say).
    steps, callback
        As for :func:`~evenroad.points.bank.anneal.anneal`, the steps counted over all sets.
    """
    require_count("steps", steps)
    total = steps * len(sets)
    refined = []
    for index, points in enumerate(sets):
        origin = points.origin
        if objective is None and not origin.objective:
            raise InvalidValue(f"{points!r} was not made for an objective: say which one to refine for")
        target = parse_objective(origin.objective if objective is None else objective)
        report = None if callback is None else _counted(callback, index * steps, total)
        seeds = np.random.SeedSequence(origin.seed or 0, spawn_key=(origin.replica or 0, 0))
        annealed = anneal(
            points.n, points.d, target, steps=steps, rng=seeds, start=points.points, callback=report
        )
        made = Origin(family=origin.family, method=f"{origin.method}+annealed", objective=str(target))
        refined.append(PointSet(annealed.points, replace(made, seed=origin.seed, replica=origin.replica)))
    return tuple(refined)


def _counted(callback: Callback, before: int, total: int) -> Callback:
    return lambda step, steps, best: callback(before + step, total, best)
