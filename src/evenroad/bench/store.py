"""The store: one SQLite file with a row for every finished task, written by one process at a time."""

from __future__ import annotations

import math
import os
import platform
import sqlite3
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, fields
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from evenroad import __version__
from evenroad._files import require_writable_folder
from evenroad.bench.outcome import Outcome
from evenroad.bench.rows import FAILURES, Rows, rows_from
from evenroad.bench.schema import connect, create, sqlite_errors
from evenroad.bench.task import PROTOCOL, Task
from evenroad.errors import BrokenFile

COMMIT_SECONDS = 0.5
"""Rows are committed together, this often: what a kill can lose at most."""

_COLUMNS = (
    "key, protocol, suite, problem, instance, sampler, n, rule, search, run, seed, status, valid, valid_at_solution,"
    " edges_checked, length, seconds, set_id, error, worker, finished"
)


class Store:
    """A store that is open for writing; made by :func:`open_store`."""

    def __init__(self, path: Path, connection: sqlite3.Connection) -> None:
        self.path, self._connection = path, connection
        self._names = {text: number for number, text in connection.execute("SELECT id, text FROM names")}
        self._new_names: list[tuple[int, str]] = []
        self._new_rows: list[tuple[object, ...]] = []
        self._last_commit = time.monotonic()
        self._has_written = False

    def finished(self, *, failures: bool = True) -> set[str]:
        """Return the keys of the tasks that have a row; without `failures` only of those that gave an answer."""
        with sqlite_errors(self.path):
            cursor = self._connection.execute("SELECT key, status FROM rows")
            failed = {self._names.get(status) for status in FAILURES}
            return {key.hex() for key, status in cursor if failures or status not in failed}

    def add(self, suite: str, task: Task, outcome: Outcome, worker: str) -> None:
        """Take the row of a finished task, in place of an earlier one; commit if it is time."""
        self._new_rows.append(
            (
                bytes.fromhex(task.key),
                PROTOCOL,
                self._number(suite),
                self._number(task.problem),
                task.instance,
                self._number(task.sampler),
                task.n,
                self._number(task.rule),
                self._number(task.search),
                task.run,
                task.seed,
                self._number(outcome.status),
                outcome.valid,
                outcome.valid_at_solution,
                outcome.edges_checked,
                _or_null(outcome.length),
                _or_null(outcome.seconds),
                self._number(outcome.set_id),
                self._number(outcome.error),
                self._number(worker),
                _now(),
            )
        )
        self.commit_if_due()

    def commit_if_due(self) -> None:
        """Commit, if the last time was long enough ago."""
        if time.monotonic() - self._last_commit >= COMMIT_SECONDS:
            self.commit()

    def commit(self) -> None:
        """Write what was added.

        Raises
        ------
        BrokenFile
            If the disk is full, or another process locks the file; earlier rows are kept.
        """
        if self._new_rows:
            places = ", ".join("?" * len(self._new_rows[0]))
            with sqlite_errors(self.path):
                try:
                    self._connection.execute("BEGIN IMMEDIATE")
                    if not self._has_written:
                        self._connection.execute(
                            "INSERT INTO sessions VALUES (?, ?, ?, ?, ?, ?, ?)", _session()
                        )
                    self._connection.executemany("INSERT INTO names VALUES (?, ?)", self._new_names)
                    self._connection.executemany(
                        f"INSERT OR REPLACE INTO rows ({_COLUMNS}) VALUES ({places})", self._new_rows
                    )
                    self._connection.execute("COMMIT")
                except sqlite3.Error:
                    with suppress(sqlite3.Error):
                        self._connection.execute("ROLLBACK")
                    raise
            self._has_written = True
            self._new_names.clear()
            self._new_rows.clear()
        self._last_commit = time.monotonic()

    def _number(self, text: str) -> int:
        if text not in self._names:
            self._names[text] = len(self._names) + 1
            self._new_names.append((self._names[text], text))
        return self._names[text]


@contextmanager
def open_store(path: str | os.PathLike[str]) -> Iterator[Store]:
    """Open a store for writing, or make one; what was added is committed when the block ends, however it does.

    Between the commits, and after the block, it is one file that can be copied.

    Raises
    ------
    BrokenFile
        If the folder cannot be written, another process writes to this store, the file is not a store, or it has
        another schema version.
    """
    target = Path(path)
    require_writable_folder(target)
    with _only_writer(target):
        if not target.exists() or target.stat().st_size == 0:
            create(target)
        connection = connect(target)
        try:
            with sqlite_errors(target):
                store = Store(target, connection)
            try:
                yield store
            finally:
                store.commit()
        finally:
            connection.close()


def read_rows(
    path: str | os.PathLike[str], *, suite: str | None = None, problems: Sequence[str] | None = None
) -> Rows:
    """Read finished rows of today's protocol, in the order of the tasks' fields; a million takes seconds.

    Parameters
    ----------
    path : path
        The store; it may be in use by a running benchmark.
    suite : str, optional
        Only rows of this suite.
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
            if suite is not None:
                condition += " AND suite = ?"
                values.append(numbers.get(suite, 0))
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


def _session() -> tuple[str, ...]:
    from importlib.metadata import version

    versions = tuple(version(name) for name in ("numpy", "scipy", "numba"))
    return (_now(), __version__, platform.python_version(), *versions, platform.platform())


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")


def _or_null(value: float) -> float | None:
    return value if math.isfinite(value) else None


@contextmanager
def _only_writer(store: Path) -> Iterator[None]:
    """Hold the lock of a store; the lock goes with the process, and its file with the block.

    A lock of SQLite's own would keep readers out, too.
    """
    try:
        import fcntl
    except ImportError:
        # Windows: two writers wait for each other at each commit, and may do the same work twice.
        yield
        return
    lock = store.with_name(f"{store.name}.lock")
    with open(lock, "w", encoding="utf-8") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # The writer before may have removed the file that was opened here: such a lock would be nobody's.
            ours = os.path.samestat(os.stat(lock), os.fstat(file.fileno()))
        except OSError:
            ours = False
        if not ours:
            raise BrokenFile(
                f"cannot write {store}: another benchmark is writing it; wait for it, or give another store"
            )
        try:
            yield
        finally:
            lock.unlink(missing_ok=True)
