"""The answer to a task as a file: the plans of its motions with their worlds, its waypoints, or a picture."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from evenroad._checks import as_file, require_known
from evenroad._files import read_json_file
from evenroad._seal import has_digest, with_digest
from evenroad.errors import BrokenFile, InvalidValue
from evenroad.io import plan_of, plan_record, save_json, save_path_csv, versions
from evenroad.planning.result import PlanResult
from evenroad.task.result import TaskResult

FORMAT = "evenroad.task 1"
"""What the record of a task begins with."""


def save_task(done: TaskResult, path: str | os.PathLike[str]) -> None:
    """Do what :meth:`TaskResult.save` does."""
    suffix = as_file("what a task is saved to", path).suffix.lower()
    require_known(f"kind of file for a task, {os.fspath(path)!r}: suffix", suffix, (".json", ".csv", ".png"))
    if suffix == ".png":
        done.plot(path)
    elif suffix == ".json":
        record = {
            "format": FORMAT,
            "status": str(done.status),
            "message": done.message,
            "steps": [str(step) for step in done.steps],
            "step": done.step,
            "cost": done.cost,
            "parts": [plan_record(part, {}) for part in done.parts],
            "versions": versions(),
        }
        save_json(path, with_digest(record))
    elif done.path is None:
        raise InvalidValue(f"there is no path that could be saved: {done.message}")
    else:
        robot = getattr(done.parts[0].world, "robot", None)
        names = tuple(f"q{i}" for i in range(np.shape(done.path)[1])) if robot is None else robot.joint_names
        save_path_csv(path, done.path, names)


def is_task(path: Path) -> bool:
    """Return whether a file is the answer to a task."""
    if path.suffix.lower() != ".json" or not path.is_file():
        return False
    with path.open("rb") as file:
        return FORMAT.encode() in file.read(100)


def load_parts(path: Path) -> tuple[PlanResult, ...]:
    """Return the plans of a saved task, each with its world; BrokenFile if the file is damaged."""
    record = read_json_file(path, "task")
    if not isinstance(record, dict) or record.get("format") != FORMAT or not isinstance(record.get("parts"), list):
        raise BrokenFile(f"{path} is not a task: its 'format' must be {FORMAT!r}, as TaskResult.save writes it")
    has_digest(record, path)
    return tuple(plan_of(part, path)[0] for part in record["parts"])
