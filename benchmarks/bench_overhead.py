"""What the benchmark machinery costs: runner and store per task, and reading a store of a million rows.

    python -m benchmarks.bench_overhead

Tasks here do nothing, so all the time is the machinery's.  `start` is what comes before the first task: processes
that import the package, and keys.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from evenroad_studies.bench.runner import Done, run_tasks
from evenroad_studies.bench.store import open_store, read_rows
from evenroad_studies.bench.task import Outcome, Task
from evenroad_studies.workers import ProcessPool, SerialExecutor, Workers

SAMPLERS = ("uniform", "halton paper-blocks", "sobol scrambled", "lattice", "hickernell", "even", "korobov")


def answer_at_once(tasks: Sequence[Task], limit: float | None) -> Done:
    """Return an answer for each task, and claim that each took a millisecond."""
    outcome = Outcome("solved", 100, 50, 300, 1.5, 0.001, "7")
    return Done((outcome,) * len(tasks), (0.001,) * len(tasks), "host:1")


class _Serial(SerialExecutor):
    def submit(self, fn, /, *args, **kwargs):
        return super().submit(answer_at_once, *args, **kwargs)


class _Pool(ProcessPool):
    def submit(self, fn, /, *args, **kwargs):
        return super().submit(answer_at_once, *args, **kwargs)


def tasks_of(count: int) -> list[Task]:
    """Return so many tasks of a few problems and samplers."""
    runs = count // (10 * len(SAMPLERS)) + 1
    cells = ((f"problem-{p}", sampler) for p in range(10) for sampler in SAMPLERS)
    tasks = [Task(p, 0, s, 512, "k=10 earlier", "stock", run, 1) for p, s in cells for run in range(runs)]
    return tasks[:count]


def seconds_per_task(count: int, workers: Workers, folder: Path) -> float:
    """Return the wall time of a task in a run of so many, after the first chunk has come back."""
    path = folder / f"{time.monotonic_ns()}.db"
    first: list[tuple[float, int]] = []

    def note(finished: int, tasks: int) -> None:
        if finished and not first:
            first.append((time.perf_counter(), finished))

    with open_store(path) as store:
        run_tasks("overhead", tasks_of(count), store, workers, callback=note)
    ((began, finished),) = first
    return (time.perf_counter() - began) / (count - finished)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tasks", type=int, default=20_000)
    parser.add_argument("--rows", type=int, default=1_000_000)
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for title, workers in (
            ("in process", Workers(_Serial, lambda executor: 1)),
            ("two processes", Workers(lambda: _Pool(2), lambda executor: 2)),
        ):
            times = [seconds_per_task(options.tasks, workers, folder) for _ in range(options.repeats)]
            print(f"runner + store, {title}: {1e3 * statistics.median(times):.3f} ms a task", flush=True)
        path = folder / "large.db"
        began = time.perf_counter()
        with open_store(path) as store:
            for task in tasks_of(options.rows):
                store.add("overhead", task, Outcome("solved", 100, 50, 300, 1.5, 0.001, "7"), "host:1")
                store.commit_if_due()
        print(
            f"write {options.rows} rows: {time.perf_counter() - began:.1f} s, {path.stat().st_size / 1e6:.0f} MB"
        )
        times = []
        for _ in range(options.repeats):
            began = time.perf_counter()
            read_rows(path)
            times.append(time.perf_counter() - began)
        print(f"read {options.rows} rows: {statistics.median(times):.2f} s")
        began = time.perf_counter()
        with open_store(path) as store:
            run_tasks("overhead", tasks_of(options.rows), store, Workers(_Serial, lambda executor: 1))
        print(f"find {options.rows} tasks done: {time.perf_counter() - began:.1f} s")


if __name__ == "__main__":
    main()
