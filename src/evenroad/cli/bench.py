"""``evenroad bench``: run a suite of benchmarks into a store; the same command goes on where it stopped."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

if TYPE_CHECKING:
    from evenroad.research.bench.runner import Report
    from evenroad.research.suites import Suite
    from evenroad.research.workers import Workers


@dataclass(frozen=True, kw_only=True)
class Bench:
    """Run benchmarks; what the store has is not run again, so the same command goes on after Ctrl-C.

    Exit code 1 if a run of the suite, now or before, gave no answer: see --retry.
    """

    suite: Annotated[str, tyro.conf.Positional] = "paper"
    """paper: the published experiments. fair: a new random world in every run."""
    list: bool = False
    """Show suites, problems and samplers, and run nothing."""
    runs: int = 400
    """Runs of every cell."""
    quick: bool = False
    """A taste in minutes; its rows are part of the whole suite's."""
    only: str = ""
    """Names of problems, with commas between them; empty: all of the suite."""
    store: Path = Path("results.db")
    """The SQLite file for the rows, made where there is none; rows that it cannot take are left in STORE.rescue."""
    jobs: int | None = None
    """Processes; None: one a processor."""
    scheduler: str | None = None
    """Address of a Dask scheduler whose workers run the tasks, tcp://host:port (needs the extra [dask])."""
    seed: int = 1
    """Root of the random numbers that draw the sets (paper-blocks have none: run i is always the same set)."""
    limit: float | None = None
    """Seconds for one task, after which its row says timeout; None: 600, and no limit with --scheduler."""
    retry: bool = False
    """Run those tasks again whose row is a failure (failed, timeout, lost)."""

    def run(self) -> int:
        """Run what is missing, print a table of success; exit code 1 if a run, now or before, gave no answer."""
        from evenroad.errors import InvalidValue, UnknownName
        from evenroad.research.suites import SUITES

        if self.list:
            from evenroad.cli.bench_table import print_catalogue

            print_catalogue()
            return 0
        if self.suite not in SUITES:
            raise UnknownName.among("suite", self.suite, SUITES)
        if self.jobs is not None and self.scheduler is not None:
            raise InvalidValue("--jobs does not go with --scheduler, whose workers are counted there")
        if self.limit is not None and self.scheduler is not None:
            raise InvalidValue("--limit does not go with --scheduler, whose workers run tasks in threads")
        only = [name.strip() for name in self.only.split(",") if name.strip()]
        suite = SUITES[self.suite](runs=self.runs, seed=self.seed, only=only, quick=self.quick)
        report = self._run(suite)
        self._print(suite, report)
        return 1 if report.failures or report.found_failures else 0

    def _run(self, suite: Suite) -> Report:
        from evenroad.cli.interrupt import interrupt_between_steps
        from evenroad.cli.progress import progress_bar
        from evenroad.research.bench.execute import DEFAULT_LIMIT, require_limit
        from evenroad.research.bench.runner import run_tasks
        from evenroad.research.bench.store import open_store

        # Tasks in threads, as Dask's are, cannot be stopped.
        limit = None if self.scheduler is not None else DEFAULT_LIMIT if self.limit is None else self.limit
        require_limit(limit)
        workers = self._workers()
        with (
            open_store(self.store) as store,
            interrupt_between_steps() as check,
            progress_bar(f"bench {suite.name}, {len(suite.tasks)} tasks") as show,
        ):

            def callback(finished: int, tasks: int) -> None:
                show(finished, tasks)
                check()

            return run_tasks(
                suite.name,
                suite.tasks,
                store,
                workers,
                callback=callback,
                limit=limit,
                retry=self.retry,
            )

    def _workers(self) -> Workers:
        from evenroad.research.workers import in_process, processes

        if self.scheduler is not None:
            from evenroad.research.bench.schedulers import dask_workers

            return dask_workers(self.scheduler)
        return in_process() if self.jobs == 1 else processes(self.jobs)

    def _print(self, suite: Suite, report: Report) -> None:
        from evenroad.cli.bench_table import print_failures, print_success
        from evenroad.research.bench.store import read_rows

        rows = read_rows(self.store, problems=sorted({task.problem for task in suite.tasks}))
        print_success(suite, rows)
        failures = f", {report.failures} of them failures" if report.failures else ""
        print(f"{self.store}: {report.finished} tasks run now{failures}, {report.found} found done")
        if report.failures or report.found_failures:
            print_failures(rows, report.failures + report.found_failures)
        print(f"report: evenroad report {self.store} -o out/")
