"""The runner: resumes, survives dead workers, and gives the same table however it ran."""

import os
import signal
import threading
import time
from concurrent.futures import BrokenExecutor, Future, ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from evenroad.datasets.workers import ProcessPool, SerialExecutor, Workers, in_process, processes
from evenroad.errors import BrokenFile, InvalidValue, WorkerLost
from evenroad_studies.bench import runner
from evenroad_studies.bench.execute import LONGEST_LIMIT
from evenroad_studies.bench.runner import Chunker, Done, run_chunk, run_tasks
from evenroad_studies.bench.store import open_store, read_rows
from evenroad_studies.bench.task import Outcome, Task
from tests.refused import refused
from tests.studies.bench.tables import table_of

TASKS = tuple(
    Task(problem, 0, sampler, 64, rule, "stock", run, 3)
    for problem in ("corridor-2d-0.1", "hypercube-legacy6")
    for sampler in ("uniform", "hickernell", "halton paper-blocks")
    for run in range(6)
    for rule in ("k=10 earlier", "k=4 symmetrised")
    if not (problem == "hypercube-legacy6" and sampler == "hickernell")
)
TO_RUN_HALF = len(TASKS) // 2


@pytest.fixture(scope="module")
def calm(tmp_path_factory):
    """The store of a run of all tasks in this process, to which nothing happened."""
    path = tmp_path_factory.mktemp("calm") / "calm.db"
    _run(path)
    return path


def _run(path, tasks=TASKS, workers=None, **options):
    with open_store(path) as store:
        return run_tasks("test", tasks, store, workers or in_process(), **options)


class _Executor(SerialExecutor):
    """Serial, but another function runs the chunks."""

    def __init__(self, run):
        self._run = run

    def submit(self, fn, /, *args, **kwargs):
        return super().submit(self._run, *args, **kwargs)


def _workers(run, count=1):
    return Workers(lambda: _Executor(run), lambda executor: count)


def test_every_task_gets_a_row_and_the_report_counts_them(path):
    calls = []
    report = _run(path, callback=lambda finished, tasks: calls.append((finished, tasks)))
    assert (report.found, report.finished, report.failures) == (0, len(TASKS), 0)
    assert len(read_rows(path)) == len(TASKS)
    assert calls[-1] == (len(TASKS), len(TASKS))
    assert calls == sorted(calls)


def test_a_stopped_run_keeps_its_rows_and_goes_on(path, calm):
    def stop(finished, tasks):
        if finished >= TO_RUN_HALF:
            raise KeyboardInterrupt

    refused(KeyboardInterrupt, "", _run, path, callback=stop)
    kept = len(read_rows(path))
    assert TO_RUN_HALF <= kept < len(TASKS)
    report = _run(path)
    assert (report.found, report.finished) == (kept, len(TASKS) - kept)
    assert table_of(path) == table_of(calm)


def test_one_process_threads_and_two_processes_that_leave_ctrl_c_to_their_parent_give_the_same_table(calm, tmp_path):
    pools = []

    def make():
        pools.append(processes(2).make())
        return pools[-1]

    def interrupt(finished, tasks):
        if 0 < finished < len(TASKS):
            for process in list(pools[0]._processes):
                os.kill(process, signal.SIGINT)

    _run(tmp_path / "two.db", workers=Workers(make, lambda executor: 2), callback=interrupt)
    _run(tmp_path / "threads.db", workers=Workers(lambda: ThreadPoolExecutor(3), lambda executor: 3))
    _run(tmp_path / "backwards.db", tasks=TASKS[::-1])
    for other in ("two.db", "threads.db", "backwards.db"):
        assert table_of(tmp_path / other) == table_of(calm)
    assert len(read_rows(tmp_path / "two.db").worker.present()) == 2
    assert len(pools) == 1


def test_a_task_that_fails_is_a_row_and_is_run_again_only_on_demand(path):
    broken = replace(TASKS[0], sampler="nonsense")
    report = _run(path, (*TASKS[:3], broken))
    assert (report.finished, report.failures) == (4, 1)
    rows = read_rows(path)
    assert "unknown sampler 'nonsense'" in rows.error[int(np.flatnonzero(~rows.answered)[0])]
    assert _run(path, (*TASKS[:3], broken)).finished == 0
    report = _run(path, (*TASKS[:3], broken))
    assert (report.found, report.found_failures, report.failures) == (4, 1, 0)
    report = _run(path, (*TASKS[:3], broken), retry=True)
    assert (report.found, report.found_failures) == (3, 0)
    assert (report.finished, report.failures) == (1, 1)


class _Mortal(ProcessPool):
    def submit(self, fn, /, *args, **kwargs):
        return super().submit(_run_unless_deadly, *args, **kwargs)


def _run_unless_deadly(tasks, limit):
    if any(task.seed == 666 for task in tasks):
        os.kill(os.getpid(), signal.SIGKILL)
    return run_chunk(tasks, limit)


def test_a_task_that_kills_its_worker_twice_is_lost_and_all_others_are_finished(path, calm):
    deadly = replace(TASKS[0], seed=666)
    tasks = (*TASKS[:8], deadly, *TASKS[8:])
    report = _run(path, tasks, Workers(lambda: _Mortal(1), lambda executor: 1))
    assert (report.finished, report.failures) == (len(tasks), 1)
    rows = read_rows(path)
    lost = rows.status.is_in(["lost"])
    assert rows.seed[lost].tolist() == [666]
    assert "its worker died" in rows.error[int(np.flatnonzero(lost)[0])]
    rest, undisturbed = rows.where(~lost), read_rows(calm)
    np.testing.assert_array_equal(rest.valid, undisturbed.valid)
    np.testing.assert_array_equal(rest.solved, undisturbed.solved)


def test_a_worker_that_is_killed_from_outside_costs_nothing(path, tmp_path):
    pools, killed = [], []

    def make():
        pools.append(ProcessPool(2))
        return pools[-1]

    def kill_one(finished, tasks):
        if finished >= TO_RUN_HALF and not killed:
            killed.append(next(iter(pools[0]._processes)))
            os.kill(killed[0], signal.SIGKILL)

    tasks = tuple(replace(task, run=run) for run in range(60, 80) for task in TASKS[::12])
    report = _run(path, tasks, Workers(make, lambda executor: 2), callback=kill_one)
    assert (report.finished, report.failures) == (len(tasks), 0)
    _run(tmp_path / "calm.db", tasks)
    assert table_of(path) == table_of(tmp_path / "calm.db")


def test_workers_that_die_again_and_again_end_the_run_with_advice(path):
    def die(tasks, limit):
        raise BrokenExecutor("gone")

    refused(WorkerLost, "fewer --jobs.*run it again to go on", _run, path, workers=_workers(die))
    # Those that were tried alone and died twice are known for it; a next run starts behind them.
    lost = len(read_rows(path))
    assert 0 < lost < len(TASKS)
    assert _run(path).finished == len(TASKS) - lost


def _pools(*executors):
    """Return workers whose executors are these, and then serial ones."""
    left = list(executors)
    return Workers(lambda: left.pop(0) if left else SerialExecutor(), lambda executor: 1)


class _Fails(SerialExecutor):
    def submit(self, fn, /, *args, **kwargs):
        future = Future()
        future.set_exception(BrokenExecutor("died"))
        return future


class _Refuses(SerialExecutor):
    def submit(self, fn, /, *args, **kwargs):
        raise BrokenExecutor("broken before anything was sent")


@pytest.mark.parametrize("executors", [(_Refuses(),) * 3, (_Fails(), _Refuses(), _Refuses())])
def test_a_task_that_never_reached_a_worker_is_not_blamed_for_its_death(path, executors):
    report = _run(path, TASKS[:1], _pools(*executors))
    assert (report.finished, report.failures) == (1, 0)
    assert read_rows(path).answered.all()


def test_tasks_that_never_reached_a_worker_are_run_in_their_order(path):
    ran = []

    def note(tasks, limit):
        ran.extend(tasks)
        return run_chunk(tasks, limit)

    executors = [_Refuses(), _Executor(note)]
    report = _run(path, TASKS, Workers(lambda: executors.pop(0), lambda executor: 1))
    assert (report.finished, tuple(ran)) == (len(TASKS), TASKS)


def test_workers_that_cannot_be_sent_anything_end_the_run_without_blaming_a_task(path):
    refused(WorkerLost, "run it again to go on", _run, path, workers=Workers(_Refuses, lambda executor: 1))
    assert len(read_rows(path)) == 0


class _Batch(SerialExecutor):
    """Serial; notes what was asked, and whether it was let go."""

    def __init__(self):
        self.ran, self.is_let_go = [], False

    def submit(self, fn, /, tasks, limit):
        self.ran.extend(tasks)
        return super().submit(fn, tasks, limit)

    def shutdown(self, wait=True, *, cancel_futures=False):
        self.is_let_go = True


def test_a_store_that_cannot_be_written_ends_the_run_and_no_finished_row_is_lost(path, monkeypatch):
    monkeypatch.setattr("evenroad_studies.bench.store.COMMIT_SECONDS", 0.0)
    executor = _Batch()

    def run():
        with open_store(path) as store:
            store._connection.execute("PRAGMA query_only = 1")
            run_tasks("test", TASKS, store, Workers(lambda: executor, lambda executor: 2))

    refused(BrokenFile, f"{len(TASKS[:8])} finished rows left in .*rescue: the next run", run)
    assert executor.is_let_go
    assert len(executor.ran) == 8
    report = _run(path)
    assert (report.found, report.finished) == (8, len(TASKS) - 8)
    assert len(read_rows(path)) == len(TASKS)


def test_a_suspect_runs_alone(path):
    sizes, running = [], threading.Semaphore(1)

    class Pool(ThreadPoolExecutor):
        def submit(self, fn, /, tasks, limit):
            return super().submit(self._one, tasks, limit)

        def _one(self, tasks, limit):
            if any(task.seed == 666 for task in tasks) and len(tasks) + len(sizes) > 0:
                alone = running.acquire(blocking=False)
                time.sleep(0.05)
                sizes.append((len(tasks), alone))
                if alone:
                    running.release()
                raise OSError("connection lost")
            return run_chunk(tasks, limit)

    deadly = replace(TASKS[1], seed=666)
    report = _run(path, (TASKS[0], deadly, *TASKS[2:]), Workers(lambda: Pool(2), lambda executor: 2))
    assert (report.finished, report.failures) == (len(TASKS), 1)
    assert [size for size, _ in sizes] == [2, 1]
    assert all(alone for _, alone in sizes)


def test_a_cancelled_chunk_is_run_again(path):
    cancelled = []

    class Pool(SerialExecutor):
        def submit(self, fn, /, *args, **kwargs):
            if not cancelled:
                future = Future()
                future.cancel()
                future.set_running_or_notify_cancel()
                cancelled.append(future)
                return future
            return super().submit(fn, *args, **kwargs)

    report = _run(path, workers=Workers(Pool, lambda executor: 1))
    assert (report.finished, report.failures) == (len(TASKS), 0)


@pytest.mark.parametrize("limit", [0.0, -1.0, np.nan, np.inf, 1e300, 1.1e6])
def test_a_limit_is_a_positive_number_that_clocks_can_take(path, limit):
    refused(InvalidValue, "limit must be", _run, path, limit=limit)


def test_the_limit_reaches_the_worker_and_the_longest_is_no_failure(path):
    limits = []

    def note(tasks, limit):
        limits.append(limit)
        return Done(tuple(Outcome("timeout") for _ in tasks), tuple(0.1 for _ in tasks), "")

    report = _run(path, workers=_workers(note), limit=12.5)
    assert set(limits) == {12.5}
    assert report.failures == len(TASKS)
    assert _run(path, TASKS[:1], limit=LONGEST_LIMIT, retry=True).failures == 0


def test_chunks_hold_all_tasks_in_order_each_of_one_problem_and_one_that_is_put_back_comes_next():
    chunker, cut = Chunker(TASKS), []
    first = chunker.next()
    chunker.put_back(first)
    while chunker:
        chunk = chunker.next()
        assert len({task.problem for task in chunk}) == 1
        chunker.learn(chunk, [0.001] * len(chunk))
        cut.append(chunk)
    assert cut[0] == first
    assert tuple(task for chunk in cut for task in chunk) == TASKS


def test_chunks_of_fast_tasks_grow_and_those_of_slow_ones_are_single():
    task = TASKS[0]
    many = [replace(task, run=run) for run in range(5000)]
    for seconds, expected in ((0.001, 490), (1e-7, runner.LARGEST_CHUNK), (10.0, 1)):
        chunker = Chunker(many)
        first = chunker.next()
        assert len(first) == runner.FIRST_CHUNK
        chunker.learn(first, [seconds] * len(first))
        assert len(chunker.next()) >= expected or expected == 1
        assert len(chunker.next()) <= max(1.5 * expected, 1)
