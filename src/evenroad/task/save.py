"""The answer to a task as a file: the plans of its motions with their worlds, its waypoints, or a picture."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from evenroad._checks import as_file, require_known
from evenroad._files import Json, read_json_file
from evenroad._seal import has_digest, with_digest
from evenroad.errors import BrokenFile, EvenroadError, InvalidValue
from evenroad.io import plan_of, plan_record, save_json, save_path_csv, versions
from evenroad.planning.result import Status
from evenroad.task.motion import Motion
from evenroad.task.record import plain_value, value_of_plain
from evenroad.task.result import TaskResult
from evenroad.task.steps import Move

FORMAT = "evenroad.task 2"
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
            "steps": [plain_value(step) for step in done.steps],
            "step": done.step,
            "cost": done.cost,
            "motions": [_motion_record(motion) for motion in done.motions],
            "timings": dict(done.timings),
            "tried": done.tried,
            "versions": versions(),
        }
        save_json(path, with_digest(record))
    elif done.path is None:
        raise InvalidValue(f"there is no path that could be saved: {done.message}")
    else:
        arm = next(motion.parts[0] for motion in done.motions if motion.parts and not motion.fingers)
        robot = getattr(arm.world, "robot", None)
        names = tuple(f"q{i}" for i in range(np.shape(done.path)[1])) if robot is None else robot.joint_names
        save_path_csv(path, done.path, names)


def is_task(path: Path) -> bool:
    """Return whether a file is the answer to a task."""
    if path.suffix.lower() != ".json" or not path.is_file():
        return False
    with path.open("rb") as file:
        return FORMAT.rpartition(" ")[0].encode() in file.read(100)


def load_task_result(path: str | os.PathLike[str]) -> TaskResult:
    """Return the saved answer to a task, each plan with its world; BrokenFile if the file is damaged."""
    return task_result_of(read_json_file(path, "task"), path)


def task_result_of(record: Json, path: str | os.PathLike[str]) -> TaskResult:
    """Return the answer to a task from the record of its file, as :func:`load_task_result` does."""
    if not isinstance(record, dict) or record.get("format") != FORMAT:
        raise BrokenFile(f"{path} is not a task: its 'format' must be {FORMAT!r}, as TaskResult.save writes it")
    has_digest(record, path)
    try:
        steps = tuple(value_of_plain(each) for each in record["steps"])
        motions = tuple(_motion_of(each, path) for each in record["motions"])
        timings = {str(name): float(seconds) for name, seconds in record["timings"].items()}
        if sum(isinstance(step, Move) for step in steps) != len(motions) and motions:
            raise ValueError("there must be one motion for each step that moves")
        status, message = Status(record["status"]), str(record["message"])
        return TaskResult(steps, status, message, motions, record["step"], timings, int(record["tried"]))
    except (EvenroadError, KeyError, TypeError, ValueError, AttributeError) as error:
        if isinstance(error, BrokenFile):
            raise
        why = f"it lacks {error}" if isinstance(error, KeyError) else str(error)
        raise BrokenFile(f"{path} is a damaged task: {why}") from error


def _motion_record(motion: Motion) -> dict[str, object]:
    return {
        "parts": [plan_record(part, {}) for part in motion.parts],
        "goal": motion.goal,
        "constraints": plain_value(motion.constraints),
        "speed": motion.speed,
        "tip": motion.tip,
        "fingers": dict(motion.fingers),
    }


def _motion_of(record: Any, path: str | os.PathLike[str]) -> Motion:
    parts = tuple(plan_of(part, path)[0] for part in record["parts"])
    speed = None if record["speed"] is None else float(record["speed"])
    fingers = {str(name): float(value) for name, value in record["fingers"].items()}
    return Motion(parts, record["goal"], value_of_plain(record["constraints"]), speed, str(record["tip"]), fingers)
