"""The tables of a store, and how such a file is opened."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from evenroad.errors import BrokenFile

SCHEMA = 1
"""Version of the tables below."""

APPLICATION = 0x45564E52
"""What the header of the file says whose it is: "EVNR"."""

PATIENCE = 15.0
"""Seconds to wait for another process that holds the file."""

TABLES = """
CREATE TABLE sessions (
    started TEXT NOT NULL,   -- UTC
    evenroad TEXT NOT NULL, python TEXT NOT NULL, numpy TEXT NOT NULL, scipy TEXT NOT NULL, numba TEXT NOT NULL,
    platform TEXT NOT NULL
);
CREATE TABLE names (id INTEGER PRIMARY KEY, text TEXT NOT NULL UNIQUE);
-- One row a finished task. Texts are numbers of names: a million rows then load in seconds.
CREATE TABLE rows (
    key BLOB PRIMARY KEY,    -- SHA-256 of the task
    protocol INTEGER NOT NULL,
    suite INTEGER NOT NULL,
    problem INTEGER NOT NULL, instance INTEGER NOT NULL, sampler INTEGER NOT NULL, n INTEGER NOT NULL,
    rule INTEGER NOT NULL, search INTEGER NOT NULL, run INTEGER NOT NULL, seed INTEGER NOT NULL,
    status INTEGER NOT NULL, valid INTEGER NOT NULL, valid_at_solution INTEGER, edges_checked INTEGER NOT NULL,
    length REAL, seconds REAL, set_id INTEGER NOT NULL, error INTEGER NOT NULL,
    worker INTEGER NOT NULL,
    finished TEXT NOT NULL   -- UTC
) WITHOUT ROWID;
-- For people: SELECT * FROM results.
CREATE VIEW results AS SELECT
    lower(hex(key)) AS key, protocol, of_suite.text AS suite, of_problem.text AS problem, instance,
    of_sampler.text AS sampler, n, of_rule.text AS rule, of_search.text AS search, run, seed,
    of_status.text AS status, valid, valid_at_solution, edges_checked, length, seconds,
    of_set.text AS set_id, of_error.text AS error, of_worker.text AS worker, finished
FROM rows
JOIN names of_suite ON of_suite.id = suite JOIN names of_problem ON of_problem.id = problem
JOIN names of_sampler ON of_sampler.id = sampler JOIN names of_rule ON of_rule.id = rule
JOIN names of_search ON of_search.id = search JOIN names of_status ON of_status.id = status
JOIN names of_set ON of_set.id = set_id JOIN names of_error ON of_error.id = error
JOIN names of_worker ON of_worker.id = worker;
"""


@contextmanager
def sqlite_errors(path: Path) -> Iterator[None]:
    """Turn the errors of SQLite into BrokenFile, which names the file and says that finished rows are kept."""
    try:
        yield
    except sqlite3.Error as error:
        if "not a database" in str(error):
            raise BrokenFile(f"{path} is not a store of benchmark results: {error}") from error
        raise BrokenFile(f"{path}: {error} (rows that were written before are kept)") from error


def connect(path: Path) -> sqlite3.Connection:
    """Open the file of a store for reading, and writing where that is permitted.

    Raises
    ------
    BrokenFile
        If there is no such file, it is not a store, or one of another version.
    """
    if not path.is_file():
        raise BrokenFile(f"no such store: {path}")
    with sqlite_errors(path):
        # Not read-only: a run that was killed in the middle of a commit is rolled back by the next one to open.
        connection = sqlite3.connect(
            f"{path.absolute().as_uri()}?mode=rw", uri=True, timeout=PATIENCE, isolation_level=None
        )
    try:
        with sqlite_errors(path):
            application = connection.execute("PRAGMA application_id").fetchone()[0]
            schema = connection.execute("PRAGMA user_version").fetchone()[0]
        if application != APPLICATION:
            raise BrokenFile(f"{path} is a SQLite file, but not a store of benchmark results")
        if schema != SCHEMA:
            raise BrokenFile(
                f"{path} has schema version {schema}, this evenroad reads {SCHEMA}: use another file,"
                " or the evenroad that wrote it"
            )
    except BaseException:
        connection.close()
        raise
    return connection


def create(path: Path) -> None:
    """Make an empty store at `path`, where there is no file yet or an empty one; all of it or nothing."""
    with sqlite_errors(path):
        connection = sqlite3.connect(path, timeout=PATIENCE, isolation_level=None)
        try:
            connection.executescript(
                f"BEGIN EXCLUSIVE; {TABLES} PRAGMA application_id = {APPLICATION};"
                f" PRAGMA user_version = {SCHEMA}; COMMIT;"
            )
        finally:
            connection.close()
