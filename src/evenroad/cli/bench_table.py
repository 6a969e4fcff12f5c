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
    "uniform": "uni",
    "halton paper-blocks": "halt\npap",
    "halton scrambled": "halt\nscr",
    "sobol paper-blocks": "sob\npap",
    "sobol scrambled": "sob\nscr",
    "lattice": "latt",
    "sukharev": "sukh",
    "mpmc": "mpmc",
    "hickernell": "hick",
    "even": "even",
    "korobov": "koro",
}
"""Short enough for eleven columns side by side."""


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
        problems = [name for name, task in shown.items() if (task.rule, task.search) == (rule, search)]
        print_table(_success(suite, rows, [shown[name] for name in problems]))


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


def _success(suite: Suite, rows: Rows, shown: list[Task]) -> Table:
    """Return the table of problems that have one rule and search; a failure of a run counts as not solved."""
    rule, search = shown[0].rule, shown[0].search
    title = f"Success [%] · rule: {rule} · search: {search}"
    table = Table(title=title, title_justify="left", box=None, pad_edge=False, padding=(0, 0, 0, 1))
    table.add_column("problem", no_wrap=True, overflow="ellipsis")
    table.add_column("N", justify="right", no_wrap=True)
    for sampler in SAMPLERS:
        table.add_column(HEADINGS.get(sampler, sampler[:4]), justify="right", no_wrap=True)
    counts: dict[str, set[int]] = {}
    for task in suite.tasks:
        counts.setdefault(task.problem, set()).add(task.n)
    of_question = rows.rule.is_in([rule]) & rows.search.is_in([search])
    for task in shown:
        of_problem = of_question & rows.problem.is_in([task.problem]) & (rows.seed == task.seed)
        for n in sorted(counts[task.problem]):
            here = of_problem & (rows.n == n)
            cells = [_per_cent(rows.solved[here & rows.sampler.is_in([sampler])]) for sampler in SAMPLERS]
            table.add_row(Text(task.problem), str(n), *cells)
    return table


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
