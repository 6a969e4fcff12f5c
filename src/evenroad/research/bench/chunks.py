"""Chunks: neighbouring tasks that go to a worker together, enough of them for half a second of work."""

from __future__ import annotations

import os
import platform
import time
from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from evenroad.research.bench.execute import run_task
from evenroad.research.bench.task import Outcome, Task

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
    seconds : tuple of float
        Wall time of each, with the making of problems and sets.
    worker : str
        Host and process that ran it.
    """

    outcomes: tuple[Outcome, ...]
    seconds: tuple[float, ...]
    worker: str


def run_chunk(tasks: Sequence[Task], limit: float | None) -> Done:
    """Run tasks one after the other; `limit` as for :func:`~evenroad.research.bench.execute.run_task`."""
    outcomes, seconds = [], []
    for task in tasks:
        began = time.perf_counter()
        outcomes.append(run_task(task, limit))
        seconds.append(time.perf_counter() - began)
    return Done(tuple(outcomes), tuple(seconds), f"{platform.node()}:{os.getpid()}")


class Chunker:
    """Cuts a sequence of tasks into chunks of one problem, longer ones as it learns how long tasks of a kind take.

    Outcomes do not depend on how tasks are cut.
    """

    def __init__(self, tasks: Iterable[Task]) -> None:
        self._waiting = deque(tasks)
        self._pace: dict[tuple[str, str, int], float] = {}

    def __bool__(self) -> bool:
        return bool(self._waiting)

    def next(self) -> tuple[Task, ...]:
        """Return the next chunk, at least one task."""
        problem = self._waiting[0].problem
        chunk: list[Task] = []
        expected = 0.0
        while self._waiting and self._waiting[0].problem == problem and len(chunk) < LARGEST_CHUNK:
            expected += self._pace.get(_kind(self._waiting[0]), CHUNK_SECONDS / FIRST_CHUNK)
            if chunk and expected > CHUNK_SECONDS:
                break
            chunk.append(self._waiting.popleft())
        return tuple(chunk)

    def put_back(self, chunk: Sequence[Task]) -> None:
        """Take back a chunk that was not run; it comes next."""
        self._waiting.extendleft(reversed(chunk))

    def learn(self, tasks: Sequence[Task], seconds: Sequence[float]) -> None:
        """Take note of how long each task of a chunk took."""
        for task, took in zip(tasks, seconds, strict=True):
            kind = _kind(task)
            # The newest counts for a quarter: one slow task, as the first in a process is, says little.
            self._pace[kind] = took if kind not in self._pace else 0.75 * self._pace[kind] + 0.25 * took


def _kind(task: Task) -> tuple[str, str, int]:
    return task.problem, task.sampler, task.n
