"""A training between two steps: one step further, onto disk and back.

A checkpoint is a safetensors file and a JSON file, which names it and holds its hash.  The JSON file is replaced last
and in one step, so a killed training leaves a whole checkpoint: the new one or the one before.
"""

from __future__ import annotations

import hashlib
import json
import math
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import safetensors.torch
import torch
from safetensors import SafetensorError

from evenroad._arrays import Floats
from evenroad._files import atomic_write
from evenroad.errors import BrokenFile, shown
from evenroad.research.network.config import NetworkConfig
from evenroad.research.network.model import PointNetwork, edges_of_sets, objective_of_sets
from evenroad.research.training.objective import Objective

CHECKPOINT_FILE = "checkpoint.json"
FORMAT = 1


class MicroBatch(NamedTuple):
    """Sets that go through the network together: number `first`, ``first + 1``, ...; their starts and their graph."""

    first: int
    starts: torch.Tensor
    sender: torch.Tensor
    receiver: torch.Tensor


@dataclass(eq=False)
class TrainingState:
    """All that changes during a training; a checkpoint holds it.

    `best_points`, (sets, n, d), and `best_values` are those of every set over all steps, ``inf`` before the first;
    `best_mean` is the smallest mean of the objective over the sets, of step `last_improved`.
    """

    network: PointNetwork
    optimiser: torch.optim.Adam
    best_points: Floats
    best_values: Floats
    best_mean: float = math.inf
    step: int = 0
    last_improved: int = 0


def first_state(config: NetworkConfig, device: torch.device) -> tuple[TrainingState, tuple[MicroBatch, ...]]:
    """Draw weights and starting points; return the state before the first step, and the points in micro-batches."""
    for_starts, for_weights = np.random.SeedSequence(config.seed).spawn(2)
    starts = np.random.default_rng(for_starts).random((config.sets, config.n, config.d))
    weights = np.random.default_rng(for_weights)
    network = PointNetwork(config.d, config.width, config.layers, weights).to(device)
    optimiser = torch.optim.Adam(network.parameters(), lr=config.rate, weight_decay=config.weight_decay)
    batches = []
    for first in range(0, config.sets, config.sets_at_once):
        own = starts[first : first + config.sets_at_once]
        arrays = own.astype(np.float32), *edges_of_sets(own, config.k, config.radius)
        batches.append(MicroBatch(first, *(torch.from_numpy(array).to(device) for array in arrays)))
    state = TrainingState(network, optimiser, starts.copy(), np.full(config.sets, math.inf))
    return state, tuple(batches)


def advance(
    state: TrainingState, batches: tuple[MicroBatch, ...], config: NetworkConfig, objective: Objective
) -> None:
    """Do one step of Adam on the mean objective of all sets, and keep the best points.

    The gradient is summed over the micro-batches: only one of them is in memory at a time.
    """
    for group in state.optimiser.param_groups:
        group["lr"] = learning_rate(state.step + 1, config)
    state.optimiser.zero_grad()
    total = 0.0
    for batch in batches:
        points = state.network(batch.starts, batch.sender, batch.receiver)
        values = objective_of_sets(points, objective)
        (values.sum() / config.sets).backward()
        now = values.detach().cpu().numpy()
        better = np.flatnonzero(now < state.best_values[batch.first : batch.first + len(now)])
        state.best_values[batch.first + better] = now[better]
        state.best_points[batch.first + better] = points.detach().cpu().numpy()[better]
        total += float(values.detach().sum())
    state.optimiser.step()
    state.step += 1
    if total / config.sets < state.best_mean:
        state.best_mean = total / config.sets
        state.last_improved = state.step


def is_finished(state: TrainingState, config: NetworkConfig) -> bool:
    """Return whether all steps are done, or the mean has not improved for `patience` steps."""
    waited = state.step - state.last_improved
    return state.step >= config.steps or (config.patience is not None and waited >= config.patience)


def learning_rate(step: int, config: NetworkConfig) -> float:
    """Return the rate of a step in 1 .. `steps`: it falls from the config's rate towards 0 along a half cosine."""
    return config.rate * 0.5 * (1.0 + math.cos(math.pi * (step - 1) / config.steps))


def save_checkpoint(folder: Path, config: NetworkConfig, state: TrainingState) -> None:
    """Write a training's state into `folder`, in place of the checkpoint that is there.

    Raises BrokenFile if it cannot be written; the checkpoint before is then still whole.
    """
    data = safetensors.torch.save(tensors_of(state))
    digest = hashlib.sha256(data).hexdigest()
    # The name depends on the content: the tensors that the old JSON file names are not overwritten.
    tensors_path = folder / f"checkpoint-{digest[:16]}.safetensors"
    with atomic_write(tensors_path) as file:
        file.write(data)
    record = {
        "format": FORMAT,
        "config": asdict(config),
        "step": state.step,
        "last_improved": state.last_improved,
        # JSON knows no infinity; before the first step there is no mean.
        "best_mean": state.best_mean if math.isfinite(state.best_mean) else None,
        "tensors": tensors_path.name,
        "sha256": digest,
    }
    with atomic_write(folder / CHECKPOINT_FILE) as file:
        file.write(json.dumps(record, indent=1).encode())
    for old in folder.glob("checkpoint-*.safetensors"):
        if old != tensors_path:
            with suppress(OSError):
                old.unlink()


def load_checkpoint(folder: Path, config: NetworkConfig, state: TrainingState) -> bool:
    """Put the checkpoint of `folder` into a fresh state; return False if there is none.

    Raises BrokenFile if it is damaged, incomplete, or of another config; then the state has not changed.
    """
    path = folder / CHECKPOINT_FILE
    if not path.exists():
        return False
    try:
        record = json.loads(path.read_bytes())
        step, last_improved = _steps_of(record, config)
        best_mean = math.inf if record["best_mean"] is None else float(record["best_mean"])
        data = (folder / Path(record["tensors"]).name).read_bytes()
        if hashlib.sha256(data).hexdigest() != record["sha256"]:
            raise ValueError(f"{record['tensors']} does not match its hash")
        tensors = safetensors.torch.load(data)
        _require_same_layout(tensors, tensors_of(state))
    except (OSError, ValueError, TypeError, KeyError, SafetensorError) as error:
        raise BrokenFile(
            f"{path} cannot be resumed: {type(error).__name__}: {error};"
            " start over with resume=False or in another folder"
        ) from error
    put_tensors(state, tensors, step)
    state.step, state.last_improved, state.best_mean = step, last_improved, best_mean
    return True


def tensors_of(state: TrainingState) -> dict[str, torch.Tensor]:
    """Return all tensors of a state by name, on the CPU: weights, Adam's two moments, the best points."""
    tensors = {
        "best_points": torch.from_numpy(state.best_points),
        "best_values": torch.from_numpy(state.best_values),
    }
    for name, weight in state.network.named_parameters():
        moments = state.optimiser.state.get(weight, {})
        tensors[f"network.{name}"] = weight.detach().cpu()
        for moment in ("exp_avg", "exp_avg_sq"):
            tensors[f"{moment}.{name}"] = moments.get(moment, torch.zeros_like(weight)).detach().cpu()
    return tensors


def put_tensors(state: TrainingState, tensors: dict[str, torch.Tensor], step: int) -> None:
    """Undo :func:`tensors_of`: overwrite the tensors of a state, whose optimiser has done `step` steps."""
    state.best_points[:] = tensors["best_points"].numpy()
    state.best_values[:] = tensors["best_values"].numpy()
    names = [name for name, _ in state.network.named_parameters()]
    state.network.load_state_dict({name: tensors[f"network.{name}"] for name in names})
    moments: dict[int, dict[str, Any]] = {
        index: {
            "step": torch.tensor(float(step)),
            "exp_avg": tensors[f"exp_avg.{name}"],
            "exp_avg_sq": tensors[f"exp_avg_sq.{name}"],
        }
        for index, name in enumerate(names)
    }
    groups = state.optimiser.state_dict()["param_groups"]
    state.optimiser.load_state_dict({"state": moments, "param_groups": groups})


def _steps_of(record: Any, config: NetworkConfig) -> tuple[int, int]:
    if not isinstance(record, dict) or record.get("format") != FORMAT:
        raise ValueError(f"it is no checkpoint of format {FORMAT}")
    if record["config"] != asdict(config):
        raise ValueError("it belongs to another config")
    step, last_improved = int(record["step"]), int(record["last_improved"])
    if not 0 <= last_improved <= step <= config.steps:
        raise ValueError(f"step {step}, last improved at {last_improved}, is not among 0 .. {config.steps}")
    return step, last_improved


def _require_same_layout(found: dict[str, torch.Tensor], wanted: dict[str, torch.Tensor]) -> None:
    if set(found) != set(wanted):
        raise ValueError(f"its tensors differ in {shown(sorted(set(found) ^ set(wanted))[:4])}")
    for name, tensor in wanted.items():
        there = found[name]
        if there.shape != tensor.shape or there.dtype != tensor.dtype:
            raise ValueError(
                f"tensor {name} is {there.dtype} {tuple(there.shape)},"
                f" expected {tensor.dtype} {tuple(tensor.shape)}"
            )
