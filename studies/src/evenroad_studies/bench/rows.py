"""Rows: the finished tasks of a store, read as columns that are ready for statistics."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from operator import itemgetter
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats, Ints, Ints32
from evenroad_studies.bench.store_file import (
    COLUMNS,
    NAMED,
    checked_rows,
    checksum_of,
    connect,
    damaged,
    read_names,
    sqlite_errors,
)
from evenroad_studies.bench.task import PROTOCOL, Task

FAILURES = ("failed", "lost", "timeout")
"""Statuses that are failures of a run, not answers."""


@dataclass(frozen=True, eq=False)
class Labels:
    """A column of texts: `codes`, (rows,) int32 and read-only, are places in `names`.

    `names` are in alphabetical order; some may not occur after a selection.
    """

    codes: Ints32
    names: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.codes)

    def __getitem__(self, row: int) -> str:
        return self.names[self.codes[row]]

    def is_in(self, names: Iterable[str]) -> Bools:
        """Return which rows have one of these texts; those that no row has are passed over."""
        wanted = set(names)
        return np.array([name in wanted for name in self.names], dtype=np.bool_)[self.codes]

    def present(self) -> tuple[str, ...]:
        """Return the texts that occur, in alphabetical order."""
        return tuple(self.names[code] for code in np.unique(self.codes))


@dataclass(frozen=True, eq=False)
class Rows:
    """Columns of equal length, one row a task, in the order of the task's fields; never in that of arrival.

    The fields are those of `Task` and `Outcome`; `suite` is the one that asked first, `worker` the host and process
    that ran it.  `valid_at_solution` is -1, `length` and `seconds` are NaN where there is none.
    """

    suite: Labels
    problem: Labels
    instance: Ints
    sampler: Labels
    n: Ints
    rule: Labels
    search: Labels
    run: Ints
    seed: Ints
    status: Labels
    valid: Ints
    valid_at_solution: Ints
    edges_checked: Ints
    length: Floats
    seconds: Floats
    set_id: Labels
    error: Labels
    worker: Labels

    def __len__(self) -> int:
        return len(self.n)

    @property
    def solved(self) -> Bools:
        """Which rows have a path."""
        return self.status.is_in(["solved"])

    @property
    def answered(self) -> Bools:
        """Which rows are answers, a path or none, and not failures of the run."""
        return ~self.status.is_in(FAILURES)

    def where(self, chosen: Bools | npt.NDArray[np.integer]) -> Rows:
        """Return the rows that a mask or row numbers choose, in that order."""
        selected: dict[str, Any] = {}
        for name, column in vars(self).items():
            labelled = isinstance(column, Labels)
            values = (column.codes if labelled else column)[chosen]
            values.setflags(write=False)
            selected[name] = replace(column, codes=values) if labelled else values
        return Rows(**selected)


def read_rows(path: str | os.PathLike[str], *, problems: Sequence[str] | None = None) -> Rows:
    """Read finished rows of today's protocol, in the order of the tasks' fields; a million takes ten seconds.

    The store may be in use by a running benchmark.  With `problems`, only their rows.  BrokenFile if it is not a sound
    store, also where rows are not asked for.
    """
    target = Path(path)
    with closing(connect(target)) as connection, sqlite_errors(target):
        connection.execute("BEGIN")
        texts = read_names(connection, target)
        wanted = {number for number, text in texts.items() if problems is None or text in problems}
        chosen = (
            _record(row)
            for row in checked_rows(connection, target, texts)
            if row[_PROTOCOL] == PROTOCOL and row[_PROBLEM] in wanted
        )
        # Straight into one array: lists of a million tuples would take a gigabyte.
        return _rows_from(np.fromiter(chosen, dtype=_RECORD), texts)


_PROTOCOL, _PROBLEM = COLUMNS.index("protocol"), COLUMNS.index("problem")
_WITH_NULL = ("valid_at_solution", "length", "seconds")
_WITHOUT_NULL = [name for name in Rows.__annotations__ if name not in _WITH_NULL]
_pick, _pick_or_null = (itemgetter(*map(COLUMNS.index, names)) for names in (_WITHOUT_NULL, _WITH_NULL))
_RECORD = np.dtype(
    [(name, np.int64) for name in (*_WITHOUT_NULL, "valid_at_solution")]
    + [(name, np.float64) for name in ("length", "seconds")]
)


def _record(row: tuple[Any, ...]) -> tuple[Any, ...]:
    at, length, seconds = _pick_or_null(row)
    return (
        *_pick(row),
        -1 if at is None else at,
        np.nan if length is None else length,
        np.nan if seconds is None else seconds,
    )


def joined(parts: Sequence[Rows]) -> Rows:
    """Return the rows of several stores as those of one.

    Where several have a row of the same task, an answer counts before a failure of a run, and then the first store's.
    So a suite may be run on several machines, each with a store of its own.  `parts` must not be empty.
    """
    columns: dict[str, Any] = {
        name: _labels_below([getattr(part, name) for part in parts])
        if isinstance(first, Labels)
        else np.concatenate([getattr(part, name) for part in parts])
        for name, first in vars(parts[0]).items()
    }
    rows = Rows(**columns)
    rows = _in_order(vars(rows.where(np.argsort(~rows.answered, kind="stable"))))
    is_new = np.zeros(len(rows), dtype=np.bool_)
    is_new[:1] = True
    for name in Task.__annotations__:
        column = getattr(rows, name)
        values = column.codes if isinstance(column, Labels) else column
        is_new[1:] |= values[1:] != values[:-1]
    return rows.where(is_new)


class Session(NamedTuple):
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
    with closing(connect(target)) as connection, sqlite_errors(target):
        rows = connection.execute("SELECT * FROM sessions ORDER BY rowid").fetchall()
    if any(checksum != checksum_of(texts) for *texts, checksum in rows):
        raise damaged(target, "a session is not as it was written")
    return tuple(Session(*texts) for *texts, _ in rows)


def _rows_from(table: npt.NDArray[Any], texts: dict[int, str]) -> Rows:
    """Return rows, sorted by the fields of the task, from records whose texts are numbers."""
    columns: dict[str, Any] = {
        name: _labels(table[name], texts) if name in NAMED else table[name] for name in Rows.__annotations__
    }
    return _in_order(columns)


def _in_order(columns: dict[str, Any]) -> Rows:
    """Return rows sorted by the fields of the task; those of one task stay as they come."""
    keys = [getattr(columns[name], "codes", columns[name]) for name in Task.__annotations__]
    return Rows(**columns).where(np.lexsort(keys[::-1]))


def _labels_below(parts: Sequence[Labels]) -> Labels:
    """Return one column of texts: those of all parts, one after the other."""
    names = sorted({name for part in parts for name in part.names})
    places = {name: place for place, name in enumerate(names)}
    codes = [np.array([places[name] for name in part.names], dtype=np.int32)[part.codes] for part in parts]
    return Labels(np.concatenate(codes), tuple(names))


def _labels(numbers: npt.NDArray[np.generic], texts: dict[int, str]) -> Labels:
    present, place = np.unique(numbers, return_inverse=True)
    names, rank = np.unique(np.array([texts[number] for number in present.tolist()], dtype=object), return_inverse=True)
    return Labels(rank.astype(np.int32)[place], tuple(names.tolist()))
