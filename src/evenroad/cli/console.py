"""The terminal that tables are printed on."""

from __future__ import annotations

import os
import sys

from rich.console import Console
from rich.table import Table

WIDTH = 100
"""Columns that a table may take."""


class _Output(Console):
    def on_broken_pipe(self) -> None:
        """Leave it to the caller, where Rich would end the process with an error."""
        raise BrokenPipeError


def print_table(table: Table) -> None:
    """Print a table on standard output now, within the terminal and 100 columns.

    Texts are printed as they are: neither ``[ms]`` nor ``:key:`` in a name is a command to the terminal.
    A title may be wider than its table.
    """
    console = _console()
    title, table.title = table.title, None
    try:
        if title:
            console.print(title, style="table.title", width=table_width())
        console.print(table, width=table_width())
        sys.stdout.flush()
    except BrokenPipeError:
        # The reader has gone, as `head` does: the rest of the output goes nowhere, and the work goes on.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def table_width() -> int:
    """Return how many columns a table may take here."""
    return min(WIDTH, _console().width)


def _console() -> Console:
    return _Output(highlight=False, markup=False, emoji=False)
