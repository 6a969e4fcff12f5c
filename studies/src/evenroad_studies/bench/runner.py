"""The runner: tasks to workers, rows to the store; what was finished once is never run again."""

from __future__ import annotations

import os
import platform
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, wait
from typing import NamedTuple

from evenroad.datasets.workers import Workers
from evenroad.errors import WorkerLost
from evenroad_studies.bench.execute import DEFAULT_LIMIT, require_limit, run_task
from evenroad_studies.bench.rows import FAILURES
from evenroad_studies.bench.store import Store
from evenroad_studies.bench.store_parts import PartsStore
from evenroad_studies.bench.task import Outcome, Task

POLL_SECONDS = 0.2
IN_FLIGHT = 2
"""Chunks for each worker: one to work on and one to go on with."""
DEATHS_OF_A_TASK = 2
"""A task whose worker died so often, the last time with this task alone, is given up as lost."""
DEATHS_IN_A_ROW = 8
"""So many dead workers without a single finished chunk between them are not the tasks' doing."""
Callback = Callable[[int, int], object]


class Report(NamedTuple):
    """How a run of a suite went, in tasks.

    `found` had a row in the store before, `found_failures` of them a failure; `finished` were run now, and `failures`
    of these failed, took too long or lost their worker.
    """

    found: int
    finished: int
    failures: int
    found_failures: int


def run_tasks(
    suite: str,
    tasks: Iterable[Task],
    store: Store | PartsStore,
    workers: Workers,
    *,
    callback: Callback | None = None,
    limit: float | None = DEFAULT_LIMIT,
    retry: bool = False,
) -> Report:
    """Run all tasks that the store has no row of; a stopped run goes on with the next call.

    Outcomes do not depend on the workers, nor on how often the run was stopped; seconds do.  Tasks should come in an
    order that suits caches (see :func:`~evenroad_studies.bench.execute.run_task`); `suite` labels their rows, `limit`
    is in seconds a task.  `callback` is called as ``callback(finished, tasks)`` a few times a second, with those found
    in the store counted; what it raises stops the run.  With `retry` tasks whose row is a failure are run again.
    Raises WorkerLost if workers die again and again without finishing anything.
    """
    require_limit(limit)
    tasks = tuple(tasks)
    is_answer = store.finished()
    # None where there is no row.
    answered = [is_answer.get(task.key) for task in tasks]
    is_missing = [not answer if retry else answer is None for answer in answered]
    missing = [task for task, runs in zip(tasks, is_missing, strict=True) if runs]
    found, found_failures = len(tasks) - len(missing), 0 if retry else answered.count(False)
    run = _Run(suite, missing, store, workers, limit)
    try:
        while run.goes_on():
            if callback is not None:
                callback(found + run.finished, len(tasks))
    finally:
        run.stop()
    store.commit()
    if callback is not None:
        callback(len(tasks), len(tasks))
    return Report(found, run.finished, run.failures, found_failures)


class _Run:
    """The state of one run: what waits, what is in flight, and who is under suspicion of killing workers."""

    def __init__(
        self, suite: str, tasks: list[Task], store: Store | PartsStore, workers: Workers, limit: float | None
    ) -> None:
        self.suite, self.store, self.workers, self.limit = suite, store, workers, limit
        self.finished = self.failures = 0
        self._chunker = Chunker(tasks)
        self._suspects: deque[Task] = deque()
        self._deaths: Counter[Task] = Counter()
        self._deaths_in_a_row = 0
        self._on_trial = False
        self._executor: Executor | None = None
        self._in_flight: dict[Future[Done], tuple[Task, ...]] = {}

    def goes_on(self) -> bool:
        """Send what there is room for, wait a moment and take what came back; False when nothing is left."""
        self._send()
        if not self._in_flight:
            # An executor that broke at once took nothing; the next one may.
            return bool(self._suspects or self._chunker)
        done, _ = wait(self._in_flight, timeout=POLL_SECONDS, return_when="FIRST_COMPLETED")
        for future in done:
            # Not there any more, if one before it took the executor down.
            if future in self._in_flight:
                self._take(future)
        self.store.commit_if_due()
        return True

    def stop(self) -> None:
        """Take what is finished, and let go of the executor; what is being run is not waited for."""
        try:
            for future in [each for each in self._in_flight if _has_result(each)]:
                self._take(future)
        finally:
            self._let_go()

    def _send(self) -> None:
        room = 0
        while self._suspects or self._chunker:
            if self._executor is None:
                self._executor = self.workers.make()
            # A suspect runs alone: if a worker dies, it is known whose doing that was.
            alone = bool(self._suspects) or self._on_trial
            room = 1 if alone else room or IN_FLIGHT * self.workers.count(self._executor)
            if len(self._in_flight) >= room:
                return
            is_suspect = bool(self._suspects)
            chunk = (self._suspects.popleft(),) if is_suspect else self._chunker.next()
            try:
                self._in_flight[self._executor.submit(run_chunk, chunk, self.limit)] = chunk
            except BrokenExecutor as error:
                # It never ran, so this death is not its doing.
                if is_suspect:
                    self._suspects.extendleft(chunk)
                else:
                    self._chunker.put_back(chunk)
                self._dies(self._broken(), error)
                return
            self._on_trial = is_suspect

    def _take(self, future: Future[Done]) -> None:
        chunk = self._in_flight.pop(future)
        self._on_trial = False
        if not _has_result(future):
            # Exceptions of tasks are outcomes, so this one is the worker's.
            error = BrokenExecutor("cancelled") if future.cancelled() else future.exception()
            others = self._broken() if isinstance(error, BrokenExecutor) else []
            self._dies([chunk, *others], error)
            return
        done = future.result()
        self._deaths_in_a_row = 0
        self._chunker.learn(chunk, done.seconds)
        for task, outcome in zip(chunk, done.outcomes, strict=True):
            self._write(task, outcome, done.worker)

    def _broken(self) -> list[tuple[Task, ...]]:
        """Let go of an executor that is broken, and return the chunks that went with it."""
        self._let_go()
        gone = [future for future in self._in_flight if not _has_result(future)]
        return [self._in_flight.pop(future) for future in gone]

    def _let_go(self) -> None:
        if self._executor is not None:
            self._executor.shutdown(wait=False, cancel_futures=True)
            self._executor = None

    def _dies(self, chunks: list[tuple[Task, ...]], error: BaseException | None) -> None:
        """Take note that a worker is gone, and these chunks with it; they are to be run again, task by task."""
        self._deaths_in_a_row += 1
        tasks = [task for chunk in chunks for task in chunk]
        self._deaths.update(tasks)
        if len(tasks) == 1 and self._deaths[tasks[0]] >= DEATHS_OF_A_TASK:
            message = f"its worker died {self._deaths[tasks[0]]} times: {error!r}"
            self._write(tasks[0], Outcome(status="lost", error=message), "")
        else:
            self._suspects.extend(tasks)
        if self._deaths_in_a_row >= DEATHS_IN_A_ROW:
            raise WorkerLost(
                f"{self._deaths_in_a_row} workers died without finishing a task, the last one with {error!r}: out of"
                ' memory (fewer --jobs), a script without `if __name__ == "__main__"`, or another version on a worker.'
                " Finished rows are in the store; run it again to go on"
            ) from error

    def _write(self, task: Task, outcome: Outcome, worker: str) -> None:
        self.finished += 1
        self.failures += outcome.status in FAILURES
        self.store.add(self.suite, task, outcome, worker)


def _has_result(future: Future[Done]) -> bool:
    return future.done() and not future.cancelled() and future.exception() is None


CHUNK_SECONDS = 0.7
"""Work in a chunk: much against the milliseconds of sending it, little to lose, or to wait for."""
FIRST_CHUNK = 2
"""Tasks in the first chunks of a kind, whose pace is not known yet."""
LARGEST_CHUNK = 500


class Done(NamedTuple):
    """A chunk that was run: outcomes, the wall time of each with problems and sets made, and by which worker."""

    outcomes: tuple[Outcome, ...]
    seconds: tuple[float, ...]
    worker: str


def run_chunk(tasks: Sequence[Task], limit: float | None) -> Done:
    """Run tasks one after the other, each within `limit` seconds."""
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
