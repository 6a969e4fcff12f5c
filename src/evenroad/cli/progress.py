"""A progress bar with the time that remains, on standard error, as a callback for the library."""

from __future__ import annotations

import importlib
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from evenroad._compiled import is_kept
from evenroad._progress import LineProgress
from evenroad.errors import NotAvailable

REDRAW_SECONDS = 0.2


def say_if_compiling(module: str, function: str, seconds: int) -> bool:
    """Say on standard error that a first run takes so long, where code of this function is yet to be compiled.

    Returns whether it was said.
    """
    try:
        compiled = getattr(importlib.import_module(module), function)
    except (ImportError, NotAvailable):
        # Where sixteen lanes cannot be had, others plan.
        return False
    if is_kept(compiled):
        return False
    print(f"evenroad: compiling for this machine, once: about {seconds} s", file=sys.stderr, flush=True)
    return True


class Advance(Protocol):
    """Takes note of how far the work is, and of the best value so far where there is such a thing."""

    def __call__(self, step: int, steps: int, best: float | None = None) -> None:
        """Show `step` of `steps`."""
        ...


@contextmanager
def progress_bar(title: str) -> Iterator[Advance]:
    """Yield a ``callback(step, steps, best)`` that draws a bar until the block ends; in a log, lines."""
    console = Console(file=sys.stderr)
    if not console.is_terminal:
        yield LineProgress(title, lambda line: print(line, file=sys.stderr, flush=True))
        return
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %{task.fields[value]}"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
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
