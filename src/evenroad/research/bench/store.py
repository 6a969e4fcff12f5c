"""The store: one SQLite file with a row for every finished task, written by one process at a time."""

from __future__ import annotations

import math
import os
import platform
import sqlite3
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from pathlib import Path

from evenroad import __version__
from evenroad._files import require_writable_folder
from evenroad.errors import BrokenFile
from evenroad.research.bench.outcome import Outcome
from evenroad.research.bench.read_store import Session as Session
from evenroad.research.bench.read_store import read_rows as read_rows
from evenroad.research.bench.read_store import read_sessions as read_sessions
from evenroad.research.bench.rescue import Row, leave_rows, rescue_file, waiting_rows
from evenroad.research.bench.rows import FAILURES
from evenroad.research.bench.schema import connect, create, sqlite_errors
from evenroad.research.bench.task import PROTOCOL, Task
from evenroad.research.bench.writer_lock import only_writer

COMMIT_SECONDS = 0.5
"""Rows are committed together, this often: what a kill can lose at most."""

_COLUMNS = (
    "key",
    "protocol",
    "suite",
    "problem",
    "instance",
    "sampler",
    "n",
    "rule",
    "search",
    "run",
    "seed",
    "status",
    "valid",
    "valid_at_solution",
    "edges_checked",
    "length",
    "seconds",
    "set_id",
    "error",
    "worker",
    "finished",
)
_NAMED = {"suite", "problem", "sampler", "rule", "search", "status", "set_id", "error", "worker"}
"""Columns whose texts are kept as numbers of names."""

_INSERT_ROW = f"INSERT OR REPLACE INTO rows ({', '.join(_COLUMNS)}) VALUES ({', '.join('?' * len(_COLUMNS))})"

_INSERT_NAME = (
    "INSERT INTO names SELECT ?1, ?2 WHERE NOT EXISTS (SELECT 1 FROM names WHERE id = ?1 AND text = ?2)"
)
"""The same name again is no error: an interrupt may come right after a COMMIT, and the rows are then written again."""


class Store:
    """A store that is open for writing; made by :func:`open_store`."""

    def __init__(self, path: Path, connection: sqlite3.Connection) -> None:
        self.path, self._connection = path, connection
        self._names = {text: number for number, text in connection.execute("SELECT id, text FROM names")}
        self._stored_names = len(self._names)
        self._waiting: list[Row] = []
        self._failure: BrokenFile | None = None
        self._last_commit = time.monotonic()
        self._has_written = False

    def finished(self) -> dict[str, bool]:
        """Return the keys of the tasks that have a row, and whether it is an answer, not a failure of the run."""
        with sqlite_errors(self.path):
            cursor = self._connection.execute("SELECT key, status FROM rows")
            failed = {self._names.get(status) for status in FAILURES}
            return {key.hex(): status not in failed for key, status in cursor}

    def add(self, suite: str, task: Task, outcome: Outcome, worker: str) -> None:
        """Take the row of a finished task, in place of an earlier one, for the next commit; this cannot fail."""
        self._waiting.append(
            (
                task.key,
                PROTOCOL,
                suite,
                task.problem,
                task.instance,
                task.sampler,
                task.n,
                task.rule,
                task.search,
                task.run,
                task.seed,
                outcome.status,
                outcome.valid,
                outcome.valid_at_solution,
                outcome.edges_checked,
                _or_null(outcome.length),
                _or_null(outcome.seconds),
                outcome.set_id,
                # SQLite takes no lone surrogates, as names of files can have them.
                outcome.error.encode(errors="backslashreplace").decode(),
                worker,
                _now(),
            )
        )

    def commit_if_due(self) -> None:
        """Commit, if the last time was long enough ago; errors as :meth:`commit`."""
        if time.monotonic() - self._last_commit >= COMMIT_SECONDS:
            self.commit()

    def commit(self) -> None:
        """Write what was added.

        Raises
        ------
        BrokenFile
            If the disk is full, or another process locks the file.  Earlier rows are kept, and those that were to be
            written wait for another commit or for :meth:`close`.
        """
        if self._waiting:
            try:
                with sqlite_errors(self.path):
                    self._write()
            except BrokenFile as error:
                self._failure = error
                raise
            self._failure = None
            self._has_written = True
            self._stored_names = len(self._names)
            self._waiting.clear()
        self._last_commit = time.monotonic()

    def take_in_rescued(self) -> None:
        """Write the rows that an earlier writer had to leave beside the store; errors as :meth:`commit`."""
        rescued = waiting_rows(self.path, _COLUMNS)
        if rescued:
            # An answer that was found since is not given up for what was rescued before.
            is_answer = self.finished()
            self._waiting += [row for row in rescued if not is_answer.get(str(row[0]), False)]
            try:
                self.commit()
            except BaseException:
                # They stay where they are.
                self._waiting.clear()
                raise
            rescue_file(self.path).unlink()

    def close(self) -> None:
        """Commit; rows that the store cannot take are left in a file beside it.

        Raises
        ------
        BrokenFile
            If the store cannot be written; the text says where the rows are.
        """
        try:
            # What failed is not tried again: a locked file would be waited for once more.
            if self._failure is None:
                self.commit()
        finally:
            if self._waiting:
                where = leave_rows(self.path, _COLUMNS, self._waiting)
                if self._failure is not None:
                    raise BrokenFile(f"{self._failure}; {where}") from self._failure

    def _write(self) -> None:
        rows = [self._numbered(row) for row in self._waiting]
        names = [(number, text) for text, number in self._names.items() if number > self._stored_names]
        try:
            self._connection.execute("BEGIN IMMEDIATE")
            if not self._has_written:
                self._connection.execute("INSERT INTO sessions VALUES (?, ?, ?, ?, ?, ?, ?)", _session())
            self._connection.executemany(_INSERT_NAME, names)
            self._connection.executemany(_INSERT_ROW, rows)
            self._connection.execute("COMMIT")
        except BaseException:
            # After an interrupt, too: no later commit could begin within this one.
            with suppress(sqlite3.Error):
                self._connection.execute("ROLLBACK")
            raise

    def _numbered(self, row: Row) -> tuple[object, ...]:
        key, *others = row
        values = [
            self._names.setdefault(str(value), len(self._names) + 1) if column in _NAMED else value
            for column, value in zip(_COLUMNS[1:], others, strict=True)
        ]
        return (bytes.fromhex(str(key)), *values)


@contextmanager
def open_store(path: str | os.PathLike[str]) -> Iterator[Store]:
    """Open a store for writing, or make one; what was added is committed when the block ends, however it does.

    Between the commits, and after the block, it is one file that can be copied.  While it is open there is a lock
    beside it, STORE.lock.  Rows that cannot be committed are left in STORE.rescue, which the next opening takes in.

    Raises
    ------
    BrokenFile
        If the folder cannot be written, another process writes to this store, the file is not a store, it has
        another schema version, or it could not be written in the end; the text then says where the rows are.
    """
    target = Path(path)
    require_writable_folder(target)
    with only_writer(target):
        if not target.exists() or target.stat().st_size == 0:
            create(target)
        connection = connect(target)
        try:
            with sqlite_errors(target):
                store = Store(target, connection)
            try:
                store.take_in_rescued()
                yield store
            finally:
                store.close()
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
