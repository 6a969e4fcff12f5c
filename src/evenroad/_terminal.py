"""The terminal: tables within its width, progress of long work, and Ctrl-C between two steps."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

WIDTH = 100
"""Columns that a table may take."""

REDRAW_SECONDS = 0.2


def print_table(table: Table) -> None:
    """Print a table on standard output now, within the terminal and 100 columns; a title may be wider.

    Texts are printed as they are: neither ``[ms]`` nor ``:key:`` in a name is a command to the terminal.
    """
    console = _console()
    title, table.title = table.title, None
    try:
        if title:
            console.print(title, style="table.title", width=table_width())
        console.print(table, width=table_width())
        sys.stdout.flush()
    except BrokenPipeError:
        leave_output()


def leave_output() -> None:
    """Send the rest of the output nowhere: its reader has gone, as `head` does, and the work goes on."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def table_width() -> int:
    """Return how many columns a table may take here."""
    return min(WIDTH, _console().width)


def _console() -> Console:
    from rich.console import Console

    class Output(Console):
        def on_broken_pipe(self) -> None:
            """Leave it to the caller, where Rich would end the process with an error."""
            raise BrokenPipeError

    return Output(highlight=False, markup=False, emoji=False)


class Advance(Protocol):
    """Takes note of how far the work is, and of the best value so far where there is such a thing."""

    def __call__(self, step: int, steps: int, best: float | None = None) -> None:
        """Show `step` of `steps`."""
        ...


class LineProgress:
    """A ``callback(step, steps[, best])`` that hands a line to `report` now and then, at the pace since it was made."""

    def __init__(self, title: str, report: Callable[[str], object], every: float = 10.0) -> None:
        self.title, self.report, self.every = title, report, every
        self.began = self.last = time.monotonic()
        self.first_step: int | None = None

    def __call__(self, step: int, steps: int, best: float | None = None) -> None:
        """Take note of `step` of `steps`, counted over all sets."""
        now = time.monotonic()
        if self.first_step is None:
            # Work that was resumed has steps behind it which say nothing about today's pace.
            self.first_step = step
        if now - self.last < self.every or step <= self.first_step:
            return
        self.last = now
        left = (now - self.began) / (step - self.first_step) * (steps - step)
        value = "" if best is None else f", best {best:.5g}"
        self.report(f"{self.title}: {100 * step / steps:.0f} %, {left:.0f} s left{value}")


@contextmanager
def progress_bar(title: str) -> Iterator[Advance]:
    """Yield a ``callback(step, steps, best)`` that draws a bar on standard error; in a log, lines."""
    if not sys.stderr.isatty():
        yield LineProgress(title, lambda line: print(line, file=sys.stderr, flush=True))
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %{task.fields[value]}"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(file=sys.stderr), transient=True) as bar:
        task = bar.add_task(title, total=None, value="")
        last = 0.0

        def callback(step: int, steps: int, best: float | None = None) -> None:
            nonlocal last
            now = time.monotonic()
            if now - last >= REDRAW_SECONDS or step == steps:
                last = now
                value = "" if best is None else f"  best {best:.5g}"
                bar.update(task, total=steps, completed=step, value=value)

        yield callback


@contextmanager
def interrupt_between_steps() -> Iterator[Callable[[], None]]:
    """Yield ``check()``, which raises KeyboardInterrupt if Ctrl-C was pressed; a second Ctrl-C acts at once.

    A signal handler runs in the middle of whatever is computed, where state is half-written; the library keeps
    what is done when its callback raises.  Outside the main thread handlers cannot be set and nothing changes.
    """
    pressed = False

    def check() -> None:
        if pressed:
            raise KeyboardInterrupt

    def press(number: int, frame: object) -> None:
        nonlocal pressed
        if pressed:
            raise KeyboardInterrupt
        pressed = True
        print("evenroad: stopping after this step (Ctrl-C again: at once)", file=sys.stderr)

    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or before != signal.default_int_handler:
        # Not ours to set, or somebody else's: with SIGINT ignored (nohup, a background job) it stays so.
        yield check
        return
    signal.signal(signal.SIGINT, press)
    try:
        yield check
    finally:
        signal.signal(signal.SIGINT, before)
