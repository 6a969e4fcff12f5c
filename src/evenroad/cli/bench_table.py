"""What the terminal shows of a benchmark: what there is, and success in per cent."""

from __future__ import annotations

from collections import Counter

import numpy as np
from rich.table import Table
from rich.text import Text

from evenroad.cli.console import print_table
from evenroad.research.bench.rows import Rows
from evenroad.research.bench.samplers import SAMPLERS
from evenroad.research.bench.task import Task
from evenroad.research.problems import PROBLEMS
from evenroad.research.report.analysis import failures_of
from evenroad.research.suites import SUITES, Suite

HEADINGS = {
    "halton paper-blocks": ("halton", "blocks"),
    "halton scrambled": ("halton", "scram."),
    "sobol paper-blocks": ("sobol", "blocks"),
    "sobol scrambled": ("sobol", "scram."),
    "hickernell": ("hicker-", "nell"),
}
"""Names of samplers in two lines: all of them, side by side, fit 80 columns."""


def print_catalogue() -> None:
    """Print the problems of each suite, and the samplers, a line each."""
    for name, make in SUITES.items():
        problems = dict.fromkeys(task.problem for task in make(runs=1).tasks)
        print_table(_glossary(f"suite {name}", {each: PROBLEMS[each].about for each in problems}))
    print_table(_glossary("samplers", {name: sampler.about for name, sampler in SAMPLERS.items()}))


def _glossary(title: str, lines: dict[str, str]) -> Table:
    table = Table(title=title, title_justify="left", show_header=False, box=None, pad_edge=False)
    table.add_column(style="bold", no_wrap=True)
    table.add_column()
    for name, about in lines.items():
        table.add_row(Text(name), Text(about))
    return table


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


def print_failures(rows: Rows, failures: int) -> None:
    """Say what becomes of runs without an answer, and what the most frequent one said last."""
    print(
        f"{failures} without an answer (failed, timeout, lost) count as not solved; --retry runs them again"
    )
    messages: Counter[str] = Counter()
    for failure in failures_of(rows):
        messages[failure.message or failure.status] += failure.runs
    for message, runs in messages.most_common(1):
        print(f"most often, in {runs} rows: {message}")
