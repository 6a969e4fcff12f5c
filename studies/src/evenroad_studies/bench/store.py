"""The store: one SQLite file with a row for every finished task, written by one process at a time."""

from __future__ import annotations

import json
import os
import platform
import sqlite3
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from pathlib import Path

from evenroad import __version__
from evenroad._files import atomic_write, require_writable_folder
from evenroad.errors import BrokenFile
from evenroad_studies.bench import rows as of_file
from evenroad_studies.bench import store_parts
from evenroad_studies.bench.rows import FAILURES, Rows
from evenroad_studies.bench.rows import Session as Session
from evenroad_studies.bench.rows import joined as joined
from evenroad_studies.bench.store_file import (
    COLUMNS,
    NAMED,
    Row,
    checked_rows,
    checksum_of,
    connect,
    create,
    now,
    only_writer,
    read_names,
    row_of,
    sqlite_errors,
)
from evenroad_studies.bench.store_parts import PartsStore, is_parts
from evenroad_studies.bench.task import Outcome, Task, key_of

COMMIT_SECONDS = 0.5
"""Rows are committed together, this often: what a kill can lose at most."""
_STATUS = COLUMNS.index("status")
_INSERT_ROW = f"INSERT OR REPLACE INTO rows VALUES ({', '.join('?' * (len(COLUMNS) + 1))})"

_INSERT_NAME = "INSERT INTO names SELECT ?1, ?2, ?3 WHERE NOT EXISTS (SELECT 1 FROM names WHERE id = ?1 AND text = ?2)"
"""The same name again is no error: an interrupt may come right after a COMMIT, and the rows are then written again."""


class Store:
    """A store that is open for writing; made by :func:`open_store`."""

    def __init__(self, path: Path, connection: sqlite3.Connection) -> None:
        self.path, self._connection = path, connection
        self._names = {text: number for number, text in read_names(connection, path).items()}
        self._stored_names = len(self._names)
        self._waiting: list[Row] = []
        self._failure: BrokenFile | None = None
        self._last_commit = time.monotonic()
        self._has_written = False

    def finished(self) -> dict[str, bool]:
        """Return the keys of the tasks that have a row, and whether it is an answer, not a failure of the run."""
        texts = {number: text for text, number in self._names.items()}
        with sqlite_errors(self.path):
            rows = checked_rows(self._connection, self.path, texts)
            return {row[0].hex(): texts[row[_STATUS]] not in FAILURES for row in rows}

    def add(self, suite: str, task: Task, outcome: Outcome, worker: str) -> None:
        """Take the row of a finished task, in place of an earlier one, for the next commit; this cannot fail."""
        self._waiting.append(row_of(suite, task, outcome, worker))

    def commit_if_due(self) -> None:
        """Commit, if the last time was long enough ago."""
        if time.monotonic() - self._last_commit >= COMMIT_SECONDS:
            self.commit()

    def commit(self) -> None:
        """Write what was added; after a BrokenFile it waits for another commit or for :meth:`close`."""
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
        """Write the rows that an earlier writer had to leave beside the store."""
        rescued = waiting_rows(self.path)
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
        """Commit; rows that the store cannot take are left in a file beside it, as the text of the BrokenFile says."""
        try:
            # What failed is not tried again: a locked file would be waited for once more.
            if self._failure is None:
                self.commit()
        finally:
            if self._waiting:
                where = leave_rows(self.path, self._waiting)
                if self._failure is not None:
                    raise BrokenFile(f"{self._failure}; {where}") from self._failure

    def _write(self) -> None:
        rows = [self._numbered(row) for row in self._waiting]
        names = [
            (number, text, checksum_of((number, text)))
            for text, number in self._names.items()
            if number > self._stored_names
        ]
        try:
            self._connection.execute("BEGIN IMMEDIATE")
            if not self._has_written:
                self._connection.execute("INSERT INTO sessions VALUES (?, ?, ?, ?, ?, ?, ?, ?)", _session())
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
            self._names.setdefault(str(value), len(self._names) + 1) if column in NAMED else value
            for column, value in zip(COLUMNS[1:], others, strict=True)
        ]
        return (bytes.fromhex(str(key)), *values, checksum_of(values[:-1]))


@contextmanager
def open_store(path: str | os.PathLike[str]) -> Iterator[Store | PartsStore]:
    """Open a store for writing, or make one; what was added is committed when the block ends, however it does.

    Between the commits, and after the block, it is one file that can be copied.  While it is open there is a lock
    beside it, STORE.lock.  Rows that cannot be committed are left in STORE.rescue, which the next opening takes in;
    the text of the BrokenFile says so.

    A path that ends with ``.parts`` is a folder that many may write at once: see `store_parts`.
    """
    target = Path(path)
    if is_parts(target):
        with closing(PartsStore(target, Session(*map(str, _session()[:-1])))) as parts:
            yield parts
        return
    require_writable_folder(target)
    with only_writer(target):
        if not target.exists() or target.stat().st_size == 0:
            create(target)
        with closing(connect(target)) as connection:
            with sqlite_errors(target):
                store = Store(target, connection)
            with closing(store):
                store.take_in_rescued()
                yield store


def read_rows(path: str | os.PathLike[str], *, problems: Sequence[str] | None = None) -> Rows:
    """Read the rows of a store, one file or parts: see :func:`evenroad_studies.bench.rows.read_rows`."""
    read = store_parts.read_parts if is_parts(path) else of_file.read_rows
    return read(path, problems=problems)


def read_sessions(path: str | os.PathLike[str]) -> tuple[Session, ...]:
    """Return the sessions that wrote a store, the first one first; errors as :func:`read_rows`."""
    return store_parts.sessions_of_parts(path) if is_parts(path) else of_file.read_sessions(path)


def _session() -> tuple[object, ...]:
    from importlib.metadata import version

    # Earlier versions compiled with numba: its column stays, so that one store may hold their rows, too.
    versions = (version("numpy"), version("scipy"), "")
    session = (now(), __version__, platform.python_version(), *versions, platform.platform())
    return (*session, checksum_of(session))


def rescue_file(store: Path) -> Path:
    """Return where the rows of a store wait: STORE.rescue."""
    return store.with_name(f"{store.name}.rescue")


def leave_rows(store: Path, rows: Sequence[Row]) -> str:
    """Write rows into the rescue file, one JSON object a line; or, if its disk is full, into the temporary folder.

    Returns where they are, as the end of a sentence for the user.
    """
    text = "".join(json.dumps(dict(zip(COLUMNS, row, strict=True))) + "\n" for row in rows).encode()
    beside = rescue_file(store)
    elsewhere = Path(tempfile.gettempdir()) / f"{store.name}.{os.getpid()}.rescue"
    how_many = f"{len(rows)} finished row{'s' if len(rows) > 1 else ''}"
    if _is_written(beside, text):
        return f"{how_many} left in {beside}: the next run with this store takes them in"
    if _is_written(elsewhere, text):
        return f"{how_many} left in {elsewhere}: move it to {beside}, and the next run takes them in"
    return f"{how_many} could not be left in {beside} either: the next run computes them again"


def waiting_rows(store: Path) -> list[Row]:
    """Return the rows in the rescue file of a store; none where there is no such file."""
    path = rescue_file(store)
    try:
        records = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
        rows = [tuple(record[column] for column in COLUMNS) for record in records]
        if wrong := [row[0] for row in rows if row[0] != key_of(row[1], *row[3:_STATUS])]:
            raise ValueError(f"{wrong[0]!r} is not the key of its task")
        return rows
    except FileNotFoundError:
        return []
    except (OSError, ValueError, LookupError, TypeError) as error:
        raise BrokenFile(
            f"{path} does not hold rows of a store ({error!r}): move it away to go on without them"
        ) from error


def _is_written(path: Path, text: bytes) -> bool:
    try:
        with atomic_write(path) as file:
            file.write(text)
    except BrokenFile:
        return False
    return True
