"""A training on disk: tensors in one safetensors file, the rest in a JSON file that names it.

The JSON file is replaced last and in one step, and holds the hash of the tensors it belongs to: whenever a training
is killed, the folder has a whole checkpoint, the new one or the one before.
"""

from __future__ import annotations

import hashlib
import json
import math
from contextlib import suppress
from pathlib import Path
from typing import Any

import safetensors.torch
import torch
from safetensors import SafetensorError

from evenroad._files import atomic_write
from evenroad.errors import BrokenFile, shown
from evenroad.research.network.config import NetworkConfig
from evenroad.research.network.state import TrainingState

CHECKPOINT_FILE = "checkpoint.json"
FORMAT = 1


def save_checkpoint(folder: Path, config: NetworkConfig, state: TrainingState) -> None:
    """Write a training's state into `folder`, in place of the checkpoint that is there.

    Raises
    ------
    BrokenFile
        If it cannot be written; the checkpoint before is then still whole.
    """
    data = safetensors.torch.save(tensors_of(state))
    digest = hashlib.sha256(data).hexdigest()
    # A name of its own for every content, so that nothing which the old JSON file names is overwritten.
    tensors_path = folder / f"checkpoint-{digest[:16]}.safetensors"
    with atomic_write(tensors_path) as file:
        file.write(data)
    record = {
        "format": FORMAT,
        "config": config.as_record(),
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

    Raises
    ------
    BrokenFile
        If it is damaged, incomplete, or of another config; the state is then as it was.
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
    if record["config"] != config.as_record():
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
