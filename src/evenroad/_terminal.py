"""The terminal: tables within its width, and the progress of long work."""

from __future__ import annotations

import os
import shutil
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import zip_longest
from textwrap import fill, wrap

WIDTH = 100
"""Columns that a table may take."""

REDRAW_SECONDS = 0.2
BOLD, GREEN, RED = "1", "32", "31"


def table_width() -> int:
    """Return how many columns a table may take here."""
    return min(WIDTH, shutil.get_terminal_size().columns)


def print_table(
    rows: Sequence[Sequence[str]],
    headings: Sequence[str] = (),
    title: str = "",
    *,
    right: Sequence[int] = (),
    first: str = BOLD,
    gap: int = 2,
) -> None:
    """Print rows of texts, those of the columns `right` at the right; the widest column is wrapped to fit.

    Headings are bold; without any the first column is, and the first row's name is shown in the style `first`.
    """
    table = [tuple(headings), *rows] if headings else rows
    widths = [
        max(len(line) for cell in column for line in cell.split("\n")) for column in zip(*table, strict=True)
    ]
    widest = widths.index(max(widths))
    rest = sum(widths) - widths[widest] + gap * (len(widths) - 1)
    widths[widest] = min(widths[widest], max(table_width() - rest, 10))
    lines = [fill(title, table_width(), break_on_hyphens=False)] if title else []
    for number, row in enumerate(table):
        cells = [_lines(cell, width) for cell, width in zip(row, widths, strict=True)]
        for parts in zip_longest(*cells, fillvalue=""):
            shown = [
                part.rjust(width) if i in right else part.ljust(width)
                for i, (part, width) in enumerate(zip(parts, widths, strict=True))
            ]
            if headings and number == 0:
                shown = [_styled(text, BOLD) for text in shown]
            elif not headings:
                shown[0] = _styled(shown[0], BOLD if number else first)
            lines.append((" " * gap).join(shown).rstrip())
    try:
        print("\n".join(lines), flush=True)
    except BrokenPipeError:
        leave_output()


def _lines(cell: str, width: int) -> list[str]:
    return [line for part in cell.split("\n") for line in wrap(part, width, break_on_hyphens=False) or [""]]


def _styled(text: str, style: str) -> str:
    """Return a text in bold or a colour, where standard output is a terminal that shows it."""
    return f"\033[{style}m{text}\033[0m" if sys.stdout.isatty() and not os.environ.get("NO_COLOR") else text


def leave_output() -> None:
    """Send the rest of the output nowhere: its reader has gone, as `head` does, and the work goes on."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


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
def progress_shown(title: str) -> Iterator[LineProgress]:
    """Yield a ``callback(step, steps, best)`` that keeps a line on standard error up to date; in a log, lines."""
    if not sys.stderr.isatty():
        yield LineProgress(title, lambda line: print(line, file=sys.stderr, flush=True))
        return

    def redraw(line: str) -> None:
        print(f"\r\033[K{line[: table_width() - 1]}", end="", file=sys.stderr, flush=True)

    try:
        yield LineProgress(title, redraw, every=REDRAW_SECONDS)
    finally:
        redraw("")
