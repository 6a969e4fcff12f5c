"""What the terminal shows of a benchmark: what there is, and success in per cent."""

from __future__ import annotations

import numpy as np
from rich.table import Table
from rich.text import Text

from evenroad.bench.problems import PROBLEMS
from evenroad.bench.rows import Rows
from evenroad.bench.samplers import SAMPLERS
from evenroad.bench.suites import SUITES, Suite
from evenroad.bench.task import Task
from evenroad.cli.console import print_table

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
    """Print the success of each problem, N and sampler, under the suite's first rule and search of the problem."""
    first: dict[str, Task] = {}
    for task in suite.tasks:
        first.setdefault(task.problem, task)
    shown = sorted({(list(first).index(task.problem), task.problem, task.n) for task in suite.tasks})
    table = Table(title="Success [%]", title_justify="left", box=None, pad_edge=False, padding=(0, 0, 0, 1))
    table.add_column("problem", no_wrap=True, overflow="ellipsis")
    table.add_column("N", justify="right", no_wrap=True)
    for sampler in SAMPLERS:
        table.add_column(HEADINGS.get(sampler, sampler[:4]), justify="right", no_wrap=True)
    for _, problem, n in shown:
        task = first[problem]
        here = rows.problem.is_in([problem]) & rows.rule.is_in([task.rule]) & rows.search.is_in([task.search])
        here &= (rows.n == n) & (rows.seed == task.seed) & rows.answered
        cells = [_per_cent(rows.solved[here & rows.sampler.is_in([sampler])]) for sampler in SAMPLERS]
        table.add_row(Text(problem), str(n), *cells)
    print_table(table)


def _per_cent(solved: np.ndarray) -> str:
    """Return success in whole per cent; a dash where there is no run."""
    return f"{100 * solved.mean():.0f}" if len(solved) else "–"
