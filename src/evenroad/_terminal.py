"""The terminal: tables within its width, and progress of long work. Rich is loaded when it draws."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from time import perf_counter

_KNOWN = 0.05
"""Share of the work after which the remaining time can be estimated."""
WIDTH = 100
"""Largest width of a table [columns]."""


def table_width() -> int:
    """Return the width of tables in this terminal [columns]."""
    return min(WIDTH, shutil.get_terminal_size().columns)


def print_table(
    rows: Sequence[Sequence[str]],
    headings: Sequence[str] = (),
    title: str = "",
    *,
    right: Collection[int] = (),
    first: str = "bold",
    gap: int = 2,
) -> None:
    """Print rows of texts; columns of `right` are right-aligned, and the widest columns wrap.

    Headings are bold; without any the first column is, with the first row's name in the style `first`.
    """
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, pad_edge=False, padding=(0, gap, 0, 0), show_header=bool(headings))
    for i, heading in enumerate(headings or rows[0]):
        table.add_column(Text(heading, "bold"), justify="right" if i in right else "left", overflow="fold")
    for number, row in enumerate(rows):
        name = Text(row[0], "" if headings else "bold" if number else first)
        table.add_row(name, *map(Text, row[1:]))
    console = Console(width=table_width(), markup=False, highlight=False, emoji=False)
    with console.capture() as captured:
        if title:
            console.print(title, style="table.title")
        console.print(table)
    try:
        print("\n".join(line.rstrip() for line in captured.get().splitlines()), flush=True)
    except BrokenPipeError:
        leave_output()


def leave_output() -> None:
    """Discard the rest of the output, whose reader has gone, as `head` does."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


class LineProgress:
    """A ``callback(step, steps[, best])`` that reports progress in lines, `every` 10 seconds or so."""

    def __init__(self, title: str, report: Callable[[str], object], every: float = 10.0) -> None:
        self.title, self.report, self.every = title, report, every
        self.began = self.last = perf_counter()
        self.first_step: int | None = None

    def __call__(self, step: int, steps: int, best: float | None = None) -> None:
        """Report `step` of `steps`, over all sets."""
        now = perf_counter()
        if self.first_step is None:
            # Steps before a resumption do not count for the pace.
            self.first_step = step
        if now - self.last < self.every or step <= self.first_step:
            return
        self.last = now
        done = (step - self.first_step) / max(steps - self.first_step, 1)
        # The first steps, which load and set up, say nothing about the pace of the others.
        left = f", {(now - self.began) * (1.0 / done - 1.0):.0f} s left" if done >= _KNOWN else ""
        value = "" if best is None else f", best {best:.5g}"
        self.report(f"{self.title}: {100 * step / steps:.0f} %{left}{value}")


@contextmanager
def progress_shown(title: str) -> Iterator[Callable[..., None]]:
    """Yield a ``callback(step, steps[, best])`` that shows a bar on standard error, or lines in a log."""
    if not sys.stderr.isatty():
        yield LineProgress(title, lambda line: print(line, file=sys.stderr, flush=True))
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %{task.fields[best]}, left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(file=sys.stderr), transient=True) as bar:
        task = bar.add_task(title, total=None, best="")

        def advance(step: int, steps: int, best: float | None = None) -> None:
            value = "" if best is None else f", best {best:.5g}"
            bar.update(task, total=steps, completed=step, best=value)

        yield advance
