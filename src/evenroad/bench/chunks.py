"""Chunks: neighbouring tasks that go to a worker together, enough of them for half a second of work."""

from __future__ import annotations

import os
import platform
import time
from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from evenroad.bench.execute import run_task
from evenroad.bench.outcome import Outcome
from evenroad.bench.task import Task

CHUNK_SECONDS = 0.7
"""Work in a chunk: much against the milliseconds of sending it, little to lose, or to wait for."""

FIRST_CHUNK = 2
"""Tasks in the first chunks of a kind, whose pace is not known yet."""

LARGEST_CHUNK = 500


@dataclass(frozen=True)
class Done:
    """A chunk that was run.

    Attributes
    ----------
    outcomes : tuple of Outcome
        One a task, in order.
    seconds : float
        Wall time of all, with the making of problems and sets.
    worker : str
        Host and process that ran it.
    """

    outcomes: tuple[Outcome, ...]
    seconds: float
    worker: str


def run_chunk(tasks: Sequence[Task], limit: float | None) -> Done:
    """Run tasks one after the other; `limit` as for :func:`~evenroad.bench.execute.run_task`."""
    began = time.perf_counter()
    outcomes = tuple(run_task(task, limit) for task in tasks)
    return Done(outcomes, time.perf_counter() - began, f"{platform.node()}:{os.getpid()}")


class Chunker:
    """Cuts a sequence of tasks into chunks, longer ones as it learns how fast tasks of a kind are.

    Outcomes do not depend on how tasks are cut.
    """

    def __init__(self, tasks: Iterable[Task]) -> None:
        self._waiting = deque(tasks)
        self._pace: dict[tuple[str, str, int], float] = {}

    def __bool__(self) -> bool:
        return bool(self._waiting)

    def next(self) -> tuple[Task, ...]:
        """Return the next chunk: tasks of one kind."""
        kind = _kind(self._waiting[0])
        pace = self._pace.get(kind)
        size = FIRST_CHUNK if pace is None else int(min(max(CHUNK_SECONDS / pace, 1), LARGEST_CHUNK))
        chunk = []
        while self._waiting and len(chunk) < size and _kind(self._waiting[0]) == kind:
            chunk.append(self._waiting.popleft())
        return tuple(chunk)

    def learn(self, tasks: Sequence[Task], seconds: float) -> None:
        """Take note of how long a chunk took."""
        self._pace[_kind(tasks[0])] = max(seconds / len(tasks), 1e-6)


def _kind(task: Task) -> tuple[str, str, int]:
    return task.problem, task.sampler, task.n
