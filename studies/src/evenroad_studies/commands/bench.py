"""``evenroad bench``: run a suite of benchmarks into a store; the same command goes on where it stopped."""

from __future__ import annotations

import warnings
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from evenroad._terminal import print_table, progress_shown
from evenroad.cli.options import Positional
from evenroad.datasets.workers import Workers, in_process, interrupt_between_steps, processes
from evenroad.errors import InvalidValue, UnknownName
from evenroad.points.bank import has_large_sets
from evenroad_studies.bench.execute import DEFAULT_LIMIT, require_limit
from evenroad_studies.bench.rows import Rows
from evenroad_studies.bench.runner import Report, run_tasks
from evenroad_studies.bench.samplers import SAMPLERS
from evenroad_studies.bench.store import open_store, read_rows
from evenroad_studies.bench.task import Task
from evenroad_studies.problems import PROBLEMS
from evenroad_studies.report.analysis import failures_of
from evenroad_studies.suites import SUITES, Suite

HEADINGS = {
    "halton paper-blocks": ("halton", "blocks"),
    "halton scrambled": ("halton", "scram."),
    "sobol paper-blocks": ("sobol", "blocks"),
    "sobol scrambled": ("sobol", "scram."),
    "hickernell": ("hicker-", "nell"),
}
"""Names of samplers in two lines: all of them, side by side, fit 80 columns."""


@dataclass(frozen=True, kw_only=True)
class Bench:
    """Run benchmarks; what the store has is not run again, so the same command goes on after Ctrl-C.

    Exit code 1 if a run of the suite, now or before, gave no answer: see --retry.

    Example: evenroad bench paper --quick --only maze-1 --store results.db
    """

    suite: Positional[str] = "paper"
    """paper: the published experiments. fair: a new random world in every run. apart: the same, start and goal at
    opposite faces. arms: five robots among obstacles."""
    list: bool = False
    """Show suites, problems and samplers, and run nothing."""
    runs: int | None = None
    """Runs of every cell (default 400; suite arms: 40)."""
    quick: bool = False
    """A taste in minutes; its rows are part of the whole suite's."""
    only: str = ""
    """Names of problems, separated by commas.  Default: all of the suite."""
    store: Path = Path("results.db")
    """The SQLite file for the rows, made where there is none; rows that it cannot take are left in STORE.rescue.

    A name that ends with .parts is a folder of Parquet files, which several benchmarks may write at once.
    """
    jobs: int | None = None
    """Number of processes (default: one a processor)."""
    scheduler: str | None = None
    """Address of a Dask scheduler whose workers run the tasks, tcp://host:port (needs the extra [dask])."""
    seed: int = 1
    """Seed of the point sets (paper-blocks have none: run i always has the same set)."""
    limit: float | None = None
    """Seconds for one task, after which its row says timeout (default 600; with --scheduler no limit)."""
    retry: bool = False
    """Run those tasks again whose row is a failure (failed, timeout, lost)."""

    def run(self) -> int:
        """Run what is missing, print a table of success; exit code 1 if a run, now or before, gave no answer."""
        if self.list:
            _print_catalogue()
            return 0
        if self.suite not in SUITES:
            raise UnknownName.among("suite", self.suite, SUITES)
        if self.jobs is not None and self.scheduler is not None:
            raise InvalidValue("--jobs does not go with --scheduler, whose workers are counted there")
        if self.limit is not None and self.scheduler is not None:
            raise InvalidValue("--limit does not go with --scheduler, whose workers run tasks in threads")
        if not has_large_sets():
            warnings.warn(
                "without the large sets of evenroad-studies the suites leave out trained sets of more than 32 points",
                stacklevel=2,
            )
        suite = self._suite()
        report = self._run(suite)
        rows = read_rows(self.store, problems=sorted({task.problem for task in suite.tasks}))
        print_success(suite, rows)
        failures = f", {report.failures} of them failures" if report.failures else ""
        print(f"{self.store}: {report.finished} tasks run now{failures}, {report.found} found done")
        if failed := report.failures + report.found_failures:
            _print_failures(rows, failed)
        print(f"report: evenroad report {self.store} -o out/")
        return 1 if failed else 0

    def _suite(self) -> Suite:
        asked: dict[str, Any] = {"seed": self.seed, "only": words_of(self.only), "quick": self.quick}
        if self.runs is not None:
            asked["runs"] = self.runs
        return SUITES[self.suite](**asked)

    def _run(self, suite: Suite) -> Report:
        # Tasks in threads, as Dask's are, cannot be stopped.
        limit = None if self.scheduler is not None else DEFAULT_LIMIT if self.limit is None else self.limit
        require_limit(limit)
        workers = self._workers()
        with (
            open_store(self.store) as store,
            interrupt_between_steps() as check,
            progress_shown(f"bench {suite.name}, {len(suite.tasks)} tasks") as show,
        ):

            def callback(finished: int, tasks: int) -> None:
                show(finished, tasks)
                check()

            return run_tasks(suite.name, suite.tasks, store, workers, callback=callback, limit=limit, retry=self.retry)

    def _workers(self) -> Workers:
        if self.scheduler is not None:
            from evenroad.datasets.dask_cluster import dask_workers

            return dask_workers(self.scheduler)
        return in_process() if self.jobs == 1 else processes(self.jobs)


def words_of(text: str) -> list[str]:
    """Return the words between commas."""
    return [word.strip() for word in text.split(",") if word.strip()]


def _print_catalogue() -> None:
    """Print the problems of each suite, and the samplers, a line each."""
    for name, make in SUITES.items():
        problems = dict.fromkeys(task.problem for task in make(runs=1).tasks)
        print_table([(each, PROBLEMS[each].about) for each in problems], title=f"suite {name}")
    print_table([(name, sampler.about) for name, sampler in SAMPLERS.items()], title="samplers")


def print_success(suite: Suite, rows: Rows) -> None:
    """Print the success of each problem, N and sampler: a table for each rule and search that are shown."""
    shown = shown_tasks(suite)
    for rule, search in dict.fromkeys((task.rule, task.search) for task in shown.values()):
        print(f"Success [%] · rule: {rule} · search: {search}")
        _print_line("N", [HEADINGS.get(sampler, (sampler, ""))[0] for sampler in SAMPLERS])
        _print_line("", [HEADINGS.get(sampler, (sampler, ""))[1] for sampler in SAMPLERS])
        for task in shown.values():
            if (task.rule, task.search) == (rule, search):
                _print_problem(suite, rows, task)
        print()


def shown_tasks(suite: Suite) -> dict[str, Task]:
    """Return for each problem a task with the rule and search whose success is shown.

    With k = 10, as in the paper, where a suite has other rules, too.
    """
    shown: dict[str, Task] = {}
    for task in suite.tasks:
        if task.problem not in shown or (_is_main(task) and not _is_main(shown[task.problem])):
            shown[task.problem] = task
    return shown


def _is_main(task: Task) -> bool:
    return task.rule.startswith("k=10 ")


def _print_problem(suite: Suite, rows: Rows, shown: Task) -> None:
    """Print a problem's name, and a line for each N; a failure of a run counts as not solved."""
    print(shown.problem)
    here = rows.problem.is_in([shown.problem]) & (rows.seed == shown.seed)
    here &= rows.rule.is_in([shown.rule]) & rows.search.is_in([shown.search])
    for n in sorted({task.n for task in suite.tasks if task.problem == shown.problem}):
        of_n = here & (rows.n == n)
        cells = [_per_cent(rows.solved[of_n & rows.sampler.is_in([sampler])]) for sampler in SAMPLERS]
        _print_line(str(n), cells)


def _print_line(first: str, cells: list[str]) -> None:
    widths = [max(map(len, HEADINGS.get(sampler, (sampler,)))) for sampler in SAMPLERS]
    line = [f"{first:>5}", *(f"{cell:>{width}}" for cell, width in zip(cells, widths, strict=True))]
    print(" ".join(line).rstrip())


def _per_cent(solved: np.ndarray) -> str:
    """Return success in whole per cent; a dash where there is no run."""
    return f"{100 * solved.mean():.0f}" if len(solved) else "–"


def _print_failures(rows: Rows, failures: int) -> None:
    """Say what becomes of runs without an answer, and what the most frequent one said last."""
    kinds = "(failed, timeout, lost)"
    print(f"{failures} without an answer {kinds} count as not solved; --retry runs them again")
    messages: Counter[str] = Counter()
    for failure in failures_of(rows):
        messages[failure.message or failure.status] += failure.runs
    for message, runs in messages.most_common(1):
        print(f"most often, in {runs} rows: {message}")
