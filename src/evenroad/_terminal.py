"""The terminal: tables within its width, and progress of long work."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from time import perf_counter
from typing import TextIO
from unicodedata import east_asian_width

_KNOWN = 0.05
"""Share of the work after which the remaining time can be estimated."""
WIDTH = 100
"""Largest width of a table [columns]."""
_STYLES = {"bold": 1, "italic": 3, "red": 31, "green": 32}
"""Name of a style -> its number in a terminal."""


def table_width() -> int:
    """Return the width of tables in this terminal [columns]."""
    # As the module `shutil` does, which loads much.
    columns = os.environ.get("COLUMNS", "")
    if columns.isdecimal() and int(columns):
        return min(WIDTH, int(columns))
    try:
        return min(WIDTH, os.get_terminal_size(sys.__stdout__.fileno()).columns or 80)  # type: ignore[union-attr]
    except (AttributeError, ValueError, OSError):
        # No terminal, or none at all.
        return min(WIDTH, 80)


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
    count = len(headings or rows[0])
    cells = [*([headings] if headings else []), *rows]
    widths = [max(_columns(line) for row in cells for line in row[i].split("\n")) for i in range(count)]
    while sum(widths) + gap * (count - 1) > table_width() and max(widths) > 1:
        widths[max(range(count), key=widths.__getitem__)] -= 1
    lines = [_styled(title, "italic")] if title else []
    for number, row in enumerate(cells):
        styles = ["bold"] * count if headings and number == 0 else [""] * count
        if not headings:
            styles[0] = "bold" if number else first
        wrapped = [_wrapped(text, width) for text, width in zip(row, widths, strict=True)]
        for i in range(max(map(len, wrapped))):
            line = ""
            for column, texts in enumerate(wrapped):
                text = texts[i] if i < len(texts) else ""
                space = " " * (widths[column] - _columns(text))
                said = _styled(text, styles[column])
                line += (space + said if column in right else said + space) + " " * gap
            lines.append(line.rstrip())
    try:
        print("\n".join(lines), flush=True)
    except BrokenPipeError:
        leave_output()


def _columns(text: str) -> int:
    """Return how many columns a text takes."""
    return len(text) if text.isascii() else sum(2 if east_asian_width(each) in "WF" else 1 for each in text)


def _wrapped(text: str, width: int) -> list[str]:
    """Return the lines of a text, wrapped between words, and within those that are too long."""
    lines: list[str] = []
    for part in text.split("\n"):
        line = ""
        for word in part.split(" "):
            longer = f"{line} {word}" if line else word
            if _columns(longer) <= width:
                line = longer
                continue
            lines += [line] if line else []
            line = ""
            for each in word:
                if _columns(line + each) > width and line:
                    lines.append(line)
                    line = ""
                line += each
        lines.append(line)
    return lines


def _styled(text: str, style: str) -> str:
    """Return a text in a style on a terminal that knows it, else as it is."""
    plain = not (text and style and _moves_cursor(sys.stdout))
    if plain or (style in ("red", "green") and os.environ.get("NO_COLOR")):
        return text
    return f"\033[{_STYLES[style]}m{text}\033[0m"


def _moves_cursor(stream: TextIO) -> bool:
    """Return whether a stream is a terminal that knows ANSI's codes for the cursor and for styles."""
    return stream.isatty() and os.environ.get("TERM", "dumb") not in ("dumb", "unknown")


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
def progress_shown(title: str) -> Iterator[LineProgress]:
    """Yield a ``callback(step, steps[, best])`` that renews one line on a terminal, or writes lines in a log."""
    if not _moves_cursor(sys.stderr):
        yield LineProgress(title, lambda line: print(line, file=sys.stderr, flush=True))
        return

    def show(line: str) -> None:
        # A line that wraps could not be cleared.
        print(f"\r\033[2K{line[: table_width() - 1]}", end="", file=sys.stderr, flush=True)

    show(f"{title} ...")
    try:
        yield LineProgress(title, show, every=0.1)
    finally:
        show("")
