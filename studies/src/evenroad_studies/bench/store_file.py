"""The file of a store: its tables, how it is opened, who may write it, and how every row of it is checked."""

from __future__ import annotations

import math
import os
import sqlite3
import zlib
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from datetime import UTC, datetime
from operator import itemgetter
from pathlib import Path
from typing import Any

from evenroad._files import not_a
from evenroad.errors import BrokenFile
from evenroad_studies.bench.task import PROTOCOL, Outcome, Task, key_of

SCHEMA = 2
"""Version of the tables below."""
APPLICATION = 0x45564E52
"""What the header of the file says whose it is: "EVNR"."""
PATIENCE = 15.0
"""Seconds to wait for another process that holds the file."""
TABLES = (Path(__file__).parent / "store.sql").read_text(encoding="utf-8")


Values = tuple[Any, ...]
Row = tuple[str | int | float | None, ...]
"""The values of COLUMNS, texts as texts."""

COLUMNS = (
    "key", "protocol", "suite", "problem", "instance", "sampler", "n", "rule", "search", "run", "seed", "status",
    "valid", "valid_at_solution", "edges_checked", "length", "seconds", "set_id", "error", "worker", "finished",
)  # fmt: skip
"""Columns of a row, in the order of the table, without its checksum."""

NAMED = ("suite", "problem", "sampler", "rule", "search", "status", "set_id", "error", "worker")
"""Columns whose texts are kept as numbers of names."""
_names_in = itemgetter(*map(COLUMNS.index, NAMED))
_READ_ROLLBACK = ("SQLITE_READONLY_ROLLBACK", "SQLITE_READONLY_RECOVERY", "SQLITE_CANTOPEN")
"""Errors of SQLite where a commit that was cut off must be undone first, and the file or folder is read-only."""


def row_of(suite: str, task: Task, outcome: Outcome, worker: str) -> Row:
    """Return the row of a task that was finished now."""
    of_task = [field if isinstance(field, str) else int(field) for field in vars(task).values()]
    at = outcome.valid_at_solution
    counts = (int(outcome.valid), None if at is None else int(at), int(outcome.edges_checked))
    floats = (_or_null(outcome.length), _or_null(outcome.seconds))
    # SQLite takes no lone surrogates, as names of files can have them.
    error = outcome.error.encode(errors="backslashreplace").decode()
    of_outcome = (outcome.status, *counts, *floats, outcome.set_id, error)
    return (task.key, PROTOCOL, suite, *of_task, *of_outcome, worker, now())


def now() -> str:
    """Return the time as a store keeps it."""
    return datetime.now(UTC).isoformat(timespec="seconds")


def _or_null(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


@contextmanager
def sqlite_errors(path: Path) -> Iterator[None]:
    """Turn the errors of SQLite into BrokenFile, which names the file and says what can be done."""
    try:
        yield
    except UnicodeDecodeError as error:
        # The name of a column; texts in rows are errors of SQLite's.
        raise damaged(path, error) from error
    except sqlite3.Error as error:
        if "not a database" in str(error):
            raise not_a("a store of benchmark results", path, "it is no database") from error
        journal = path.with_name(f"{path.name}-journal")
        if getattr(error, "sqlite_errorname", "") in _READ_ROLLBACK and os.path.exists(journal):
            raise BrokenFile(
                f"{path}: {error}: its writer was stopped in the middle of a commit, which {journal.name} undoes, and"
                " here nothing can be written: copy both files into a folder that can be written, and open the copy"
            ) from error
        if isinstance(error, sqlite3.DatabaseError) and "malformed" in str(error):
            raise damaged(path, error) from error
        raise BrokenFile(f"{path}: {error} (rows that were written before are kept)") from error


def damaged(path: Path, what: object) -> BrokenFile:
    """Return the error of a store whose content is not what was written."""
    return BrokenFile(f"{path} is damaged: {what}; use a copy of it, or another file")


def connect(path: Path) -> sqlite3.Connection:
    """Open the file of a store for reading, and writing where that is permitted; BrokenFile if it is no sound one."""
    # Not Path.is_file, which raises where a name is too long.
    if not os.path.isfile(path):
        found = ", which is a folder" if os.path.isdir(path) else ""
        raise BrokenFile(f"no such store: {path}{found}")
    with sqlite_errors(path):
        # Not read-only: a run that was killed in the middle of a commit is rolled back by the next one to open.
        connection = sqlite3.connect(
            f"{path.absolute().as_uri()}?mode=rw", uri=True, timeout=PATIENCE, isolation_level=None
        )
    try:
        with sqlite_errors(path):
            if _pragma(connection, "application_id") != APPLICATION:
                raise not_a("a store of benchmark results", path, "it is no database")
            if (schema := _pragma(connection, "user_version")) != SCHEMA:
                raise BrokenFile(
                    f"{path} has schema version {schema}, this evenroad reads {SCHEMA}: use another file,"
                    " or the evenroad that wrote it"
                )
            if (verdict := _pragma(connection, "quick_check(1)")) != "ok":
                raise damaged(path, " ".join(str(verdict).split()))
    except BaseException:
        connection.close()
        raise
    return connection


def _pragma(connection: sqlite3.Connection, name: str) -> object:
    return connection.execute(f"PRAGMA {name}").fetchone()[0]


def create(path: Path) -> None:
    """Make an empty store at `path`, where there is no file yet or an empty one; all of it or nothing."""
    marks = f"PRAGMA application_id = {APPLICATION}; PRAGMA user_version = {SCHEMA};"
    with (
        sqlite_errors(path),
        closing(sqlite3.connect(path, timeout=PATIENCE, isolation_level=None)) as connection,
    ):
        connection.executescript(f"BEGIN EXCLUSIVE; {TABLES} {marks} COMMIT;")


def checksum_of(values: Sequence[object]) -> int:
    """Return the checksum of values: CRC-32 of how Python writes them as a tuple."""
    return zlib.crc32(repr(tuple(values)).encode("utf-8", "backslashreplace"))


def read_names(connection: sqlite3.Connection, path: Path) -> dict[int, str]:
    """Return the texts of a store by their numbers; BrokenFile if one is not as it was written."""
    names = connection.execute("SELECT id, text, checksum FROM names").fetchall()
    for number, text, checksum in names:
        if checksum != checksum_of((number, text)):
            raise damaged(path, f"the text {text!r} is not as it was written")
    return {number: text for number, text, _ in names}


def checked_rows(connection: sqlite3.Connection, path: Path, texts: dict[int, str]) -> Iterator[Values]:
    """Yield the columns of every row of a store, texts as numbers, and then its checksum.

    Raises BrokenFile if a row is not as it was written: its checksum or its task's key is not that of its fields.
    """
    for row in connection.execute(f"SELECT {', '.join(COLUMNS)}, checksum FROM rows"):
        blob, protocol, _, _, instance, _, n, _, _, run, seed, *_ = row
        if not isinstance(blob, bytes) or row[-1] != checksum_of(row[1:-2]):
            raise damaged(path, f"the row with the key {blob!r} is not as it was written")
        try:
            _, problem, sampler, rule, search, *_ = [texts[number] for number in _names_in(row)]
        except KeyError as error:
            raise damaged(path, f"a text with the number {error} is missing") from error
        if blob.hex() != key_of(protocol, problem, instance, sampler, n, rule, search, run, seed):
            raise damaged(path, f"the row with the key {blob.hex()[:12]}... has the fields of another task")
        yield row


@contextmanager
def only_writer(store: Path) -> Iterator[None]:
    """Hold the lock of a store, which goes with the process, and its file, STORE.lock, with the block.

    A lock of SQLite's own would keep readers out, too.
    """
    try:
        import fcntl
    except ImportError:
        # Windows: two writers wait for each other at each commit, and may do the same work twice.
        yield
        return
    lock = store.with_name(f"{store.name}.lock")
    try:
        # The longest name beside a store, which SQLite would say nothing helpful about.
        with suppress(FileNotFoundError):
            os.stat(f"{store}-journal")
        file = open(lock, "w", encoding="utf-8")  # noqa: SIM115
    except OSError as error:
        raise BrokenFile(
            f"cannot write {store}: {os.path.basename(error.filename)} beside it: {error.strerror}; remove what is"
            " there, or give another store"
        ) from error
    with file:
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
            # In a folder with the sticky bit only its owner may remove it.
            with suppress(OSError):
                lock.unlink()
