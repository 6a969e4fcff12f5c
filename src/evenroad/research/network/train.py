"""Training: steps until the end, checkpoints on the way, the best points of every set as the result."""

from __future__ import annotations

import os
import time
from pathlib import Path

from evenroad._checks import require_count, require_positive
from evenroad.points.optimise.anneal import Callback
from evenroad.points.optimise.objective import parse_objective
from evenroad.points.pointset import PointSet
from evenroad.research.network.checkpoint import load_checkpoint, save_checkpoint
from evenroad.research.network.config import NetworkConfig
from evenroad.research.network.device import choose_device, same_bits
from evenroad.research.network.folder import finished_sets, point_sets, request_of, save_sets
from evenroad.research.network.state import MicroBatch, TrainingState, advance, first_state, is_finished
from evenroad.research.training.request import claim_folder


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
        An existing folder.  It gets a checkpoint every minute and ``set-0000.npz``, ... at the end; the same
        call goes on where a stopped one was, and reads the sets if they are all there.
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
    checkpoint_seconds : float
        Time between two checkpoints, >= 0.

    Returns
    -------
    tuple of PointSet
        One a set, in order: its best points over all steps, with their origin.

    Raises
    ------
    InvalidValue
        For an argument out of range, a folder of another request, or a training that diverges.
    BrokenFile
        If the folder is missing or cannot be written, or its checkpoint is damaged.
    NotAvailable
        If a GPU is asked for that is not there.
    """
    place = choose_device(device)
    require_count("threads", threads)
    require_positive("checkpoint_seconds", checkpoint_seconds, or_zero=True)
    home = None if folder is None else Path(folder)
    if home is not None:
        claim_folder(home, request_of(config))
        if resume and (sets := finished_sets(home, config)) is not None:
            return sets
    with same_bits(place, threads):
        state, batches = first_state(config, place)
        if home is not None and resume:
            load_checkpoint(home, config, state)
        _run(config, state, batches, home, callback, checkpoint_seconds)
    sets = point_sets(config, state.best_points)
    if home is not None:
        save_sets(home, sets)
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
        if callback is not None:
            _report(callback, config, state, home)
    # The last one stays: should a set's file be damaged later, it is written again without training.
    if home is not None and saved_step != state.step:
        save_checkpoint(home, config, state)


def _report(callback: Callback, config: NetworkConfig, state: TrainingState, home: Path | None) -> None:
    try:
        callback(state.step, config.steps, state.best_mean)
    except BaseException:
        # Between two steps the state is whole, so that nothing done so far needs to be lost.
        if home is not None:
            save_checkpoint(home, config, state)
        raise
