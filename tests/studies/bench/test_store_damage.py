"""Stores that are damaged, or stand where they cannot be used: an error of ours, never other rows."""

import os
import shutil
import sqlite3
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from evenroad.errors import BrokenFile
from evenroad_studies.bench.store import open_store, read_rows, read_sessions
from tests.refused import refused
from tests.studies.bench.tables import FAILED, NOT_CONNECTED, SOLVED, TASK, query, table_of, write

MUTANTS = 400


def _write(path, rows=60):
    tasks = [replace(TASK, run=run, problem=f"maze-{run % 3 + 1}", n=128 << run % 4) for run in range(rows)]
    write(path, [(task, (SOLVED, NOT_CONNECTED, FAILED)[task.run % 3]) for task in tasks])


def _finished(path):
    with open_store(path) as store:
        return store.finished()


def _mutant(whole, rng):
    """Return the content with a byte changed, a bit flipped, a page zeroed, or its end cut off."""
    content = bytearray(whole)
    place = int(rng.integers(len(content)))
    kind = rng.integers(10)
    if kind == 0:
        # An empty file is no damaged store: it is where a new one may be made.
        return bytes(content[: max(place, 1)])
    if kind == 1:
        content[place : place + 512] = bytes(len(content[place : place + 512]))
    elif kind < 6:
        content[place] ^= 1 << int(rng.integers(8))
    else:
        content[place] = int(rng.integers(256))
    return bytes(content)


def test_a_damaged_store_gives_the_same_rows_and_sessions_or_an_error_of_ours(path):
    _write(path)
    whole, rows, sessions, finished = path.read_bytes(), table_of(path), read_sessions(path), _finished(path)
    assert sum(finished.values()) == 40
    rng = np.random.default_rng(0)
    refused = 0
    for number in range(MUTANTS):
        mutant = path.with_name(f"mutant-{number}.db")
        mutant.write_bytes(_mutant(whole, rng))
        try:
            assert table_of(mutant) == rows, f"mutant {number} has other rows"
            assert read_sessions(mutant) == sessions, f"mutant {number} has other sessions"
            read_rows(mutant, problems=["maze-2"])
            # A writer looks at it, too, which takes longer.
            assert number % 8 or _finished(mutant) == finished
        except BrokenFile:
            refused += 1
        mutant.unlink()
    # Many bytes of a small file are free space, times of writing, or the view for people.
    assert refused > MUTANTS / 3


@pytest.mark.parametrize("statement", [
    "UPDATE rows SET valid = valid + 1 WHERE run = 6", "UPDATE rows SET length = 1.3 WHERE run = 6",
    "UPDATE rows SET run = 60 WHERE run = 6", "UPDATE rows SET protocol = protocol - 1 WHERE run = 6",
    "UPDATE rows SET key = zeroblob(32) WHERE run = 6", "UPDATE rows SET key = 'a text' WHERE run = 6",
    "UPDATE rows SET status = 9999 WHERE run = 6", "UPDATE rows SET n = 'many' WHERE run = 6",
    "UPDATE names SET text = 'maze-4' WHERE text = 'maze-1'",
    "DELETE FROM names WHERE text = 'solved'",
])  # fmt: skip
def test_a_row_that_is_not_as_it_was_written_is_refused_by_readers_and_writers(path, statement):
    _write(path)
    query(path, statement)
    for use in (read_rows, lambda path: read_rows(path, problems=["maze-2"]), _finished):
        refused(BrokenFile, "results.db is damaged: ", use, path)


def test_a_key_that_is_not_its_tasks_is_refused_whatever_the_checksum_says(path, monkeypatch):
    # As a faulty version of this program could have written it.
    monkeypatch.setattr("evenroad_studies.bench.task.key_of", lambda *fields: "00" * 32)
    _write(path, rows=1)
    monkeypatch.undo()
    refused(BrokenFile, "has the fields of another task", read_rows, path)


@pytest.fixture
def other_user():
    """Yield a folder that all may write, where this process is another user than the one who makes files there."""
    if not hasattr(os, "geteuid") or os.geteuid() != 0:
        pytest.skip("needs the right to be another user")
    # Not below the test's own folder, which no other user may enter.
    with tempfile.TemporaryDirectory() as name:
        os.chmod(name, 0o777)
        yield Path(name)
        os.seteuid(0)


def test_a_lock_that_cannot_be_made_or_is_another_users_is_named(path, other_user):
    path.with_name("results.db.lock").mkdir()
    refused(BrokenFile, "results.db.lock beside it: Is a directory", _write, path)
    lock = other_user / "results.db.lock"
    lock.touch()
    lock.chmod(0o600)
    os.seteuid(65534)
    refused(BrokenFile, "results.db.lock beside it: Permission denied", _write, other_user / "results.db")


@pytest.mark.parametrize("length", [248, 251, 255, 256, 5000])
def test_a_name_that_is_too_long_is_an_error_of_ours(tmp_path, length):
    path = tmp_path / ("r" * length)
    for use in (read_rows, _write):
        refused(BrokenFile, "", use, path)
    assert list(tmp_path.iterdir()) == []


def _with_a_hot_journal(path):
    """Leave a store as a writer leaves it that is killed in the middle of a commit."""
    _write(path)
    connection = sqlite3.connect(path, isolation_level=None)
    # One page in memory: the others go to the file, and what they were before to the journal.
    connection.execute("PRAGMA cache_size = 1")
    connection.execute("BEGIN IMMEDIATE")
    connection.execute("UPDATE rows SET valid = valid + 1")
    copy = path.with_name("killed.db")
    for suffix in ("", "-journal"):
        shutil.copy(f"{path}{suffix}", f"{copy}{suffix}")
    connection.execute("ROLLBACK")
    connection.close()
    assert copy.read_bytes() != path.read_bytes()
    return copy


def test_a_commit_that_was_cut_off_is_undone_by_the_next_reader(path):
    killed = _with_a_hot_journal(path)
    assert table_of(killed) == table_of(path)


def test_a_commit_that_was_cut_off_in_a_read_only_folder_says_what_to_do(other_user):
    killed = _with_a_hot_journal(other_user / "results.db")
    other_user.chmod(0o555)
    os.seteuid(65534)
    with pytest.raises(BrokenFile, match="copy both files into a folder that can be written") as error:
        read_rows(killed)
    assert "killed.db-journal" in str(error.value)
