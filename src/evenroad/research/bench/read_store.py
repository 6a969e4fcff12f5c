"""Reading a store: its rows as columns, and the sessions that wrote it."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from evenroad.research.bench.rows import Rows, rows_from
from evenroad.research.bench.schema import connect, sqlite_errors
from evenroad.research.bench.task import PROTOCOL


def read_rows(path: str | os.PathLike[str], *, problems: Sequence[str] | None = None) -> Rows:
    """Read finished rows of today's protocol, in the order of the tasks' fields; a million takes seconds.

    Parameters
    ----------
    path : path
        The store; it may be in use by a running benchmark.
    problems : sequence of str, optional
        Only rows of these problems.

    Raises
    ------
    BrokenFile
        If there is no such file, it is not a store, or one of another version.
    """
    target = Path(path)
    connection = connect(target)
    try:
        with sqlite_errors(target):
            connection.execute("BEGIN")
            texts = dict(connection.execute("SELECT id, text FROM names").fetchall())
            numbers = {text: number for number, text in texts.items()}
            condition, values = f"protocol = {PROTOCOL}", []
            if problems is not None:
                values += [numbers.get(problem, 0) for problem in problems]
                condition += f" AND problem IN ({', '.join('?' * len(problems))})"
            count = connection.execute(f"SELECT count(*) FROM rows WHERE {condition}", values).fetchone()[0]
            selected = connection.execute(f"SELECT {_SELECTED} FROM rows WHERE {condition}", values)
            # Straight into one array: lists of a million tuples would take a gigabyte.
            table = np.fromiter(selected, dtype=_RECORD, count=count)
    finally:
        connection.close()
    columns = {name: table[name] for name in _FIELDS}
    for name in ("length", "seconds"):
        columns[name] = np.where(columns[name] == np.inf, np.nan, columns[name])
    return rows_from(columns, texts)


_FIELDS = tuple(field.name for field in fields(Rows))
_RECORD = np.dtype([(name, np.float64 if name in ("length", "seconds") else np.int64) for name in _FIELDS])
_NULLS = {"valid_at_solution": "-1", "length": "9e999", "seconds": "9e999"}
"""What NULL is read as: SQL has no NaN, but infinity."""

_SELECTED = ", ".join(f"ifnull({name}, {_NULLS[name]})" if name in _NULLS else name for name in _FIELDS)


@dataclass(frozen=True)
class Session:
    """One time that a store was written to: when, and by what."""

    started: str
    evenroad: str
    python: str
    numpy: str
    scipy: str
    numba: str
    platform: str


def read_sessions(path: str | os.PathLike[str]) -> tuple[Session, ...]:
    """Return the sessions that wrote a store, the first one first; errors as :func:`read_rows`."""
    target = Path(path)
    connection = connect(target)
    try:
        with sqlite_errors(target):
            return tuple(Session(*row) for row in connection.execute("SELECT * FROM sessions ORDER BY rowid"))
    finally:
        connection.close()
