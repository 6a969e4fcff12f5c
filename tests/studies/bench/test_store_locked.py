"""Stores that cannot be written: what was finished waits beside them, and nothing is lost."""

import json
import sqlite3
import subprocess
import sys
from dataclasses import replace

import pytest

from evenroad.errors import BrokenFile
from evenroad_studies.bench.store import leave_rows, open_store, read_rows
from evenroad_studies.bench.store_file import COLUMNS
from tests.refused import refused
from tests.studies.bench.tables import FAILED, NOT_CONNECTED, SOLVED, TASK, query, write


def _columns(path):
    """Return all columns but the time of writing."""
    return [row[:-1] for row in query(path, "SELECT * FROM results ORDER BY run")]


def test_rows_that_a_locked_file_cannot_take_are_left_beside_it_and_taken_in_the_next_time(path, monkeypatch):
    monkeypatch.setattr("evenroad_studies.bench.store_file.PATIENCE", 0.1)
    outcomes = [(TASK, SOLVED), (replace(TASK, run=1), NOT_CONNECTED), (replace(TASK, run=2), FAILED)]
    write(path, outcomes[:1])
    other = sqlite3.connect(path, isolation_level=None)

    with pytest.raises(BrokenFile) as error, open_store(path) as store:  # noqa: PT012
        other.execute("BEGIN EXCLUSIVE")
        for task, outcome in outcomes[1:]:
            store.add("paper", task, outcome, "host:1")
    other.close()
    assert "locked (rows that were written before are kept)" in str(error.value)
    left = f"2 finished rows left in {path}.rescue: the next run with this store takes them in"
    assert left in str(error.value)
    assert read_rows(path).run.tolist() == [0]
    write(path, [])
    write(path.with_name("calm.db"), outcomes)
    assert _columns(path) == _columns(path.with_name("calm.db"))
    assert sorted(each.name for each in path.parent.iterdir()) == ["calm.db", "results.db"]


def test_a_store_that_stays_locked_keeps_what_was_left_beside_it(path, monkeypatch):
    monkeypatch.setattr("evenroad_studies.bench.store_file.PATIENCE", 0.01)
    write(path, [])
    beside, left = path.with_name("results.db.rescue"), _left_behind(path)
    beside.write_text(left)
    other = sqlite3.connect(path, isolation_level=None)
    other.execute("BEGIN IMMEDIATE")
    for _ in range(2):
        refused(BrokenFile, "locked", write, path, [])
        assert beside.read_text() == left
    other.close()
    write(path, [])
    assert len(read_rows(path)) == 1


def test_an_answer_is_not_given_up_for_a_failure_that_was_rescued_before_it(path):
    """The rescue lay in the temporary folder, say, while the task was run once more."""
    left = _left_behind(path).replace('"solved"', '"timeout"')
    assert "timeout" in left
    with open_store(path) as store:
        store.add("paper", TASK, SOLVED, "")
    path.with_name("results.db.rescue").write_text(left)
    write(path, [])
    assert read_rows(path).solved.tolist() == [True]
    assert not path.with_name("results.db.rescue").exists()


def _left_behind(path):
    """Return what a run that could not write its row left."""
    with pytest.raises(BrokenFile, match="left in"), open_store(path.with_name("full.db")) as store:  # noqa: PT012
        store._connection.execute("PRAGMA query_only = 1")
        store.add("paper", TASK, SOLVED, "host:1")
    return path.with_name("full.db.rescue").read_text()


def test_a_store_that_can_be_written_again_takes_what_waits(path):
    with open_store(path) as store:
        store.add("paper", TASK, SOLVED, "")
        store._connection.execute("PRAGMA query_only = 1")
        refused(BrokenFile, "", store.commit)
        store._connection.execute("PRAGMA query_only = 0")
        store.commit()
    assert len(read_rows(path)) == 1
    assert not path.with_name("results.db.rescue").exists()


FILL = """
import resource, sys
from dataclasses import replace
from evenroad_studies.bench.task import Outcome
from evenroad_studies.bench.store import open_store
from evenroad_studies.bench.task import Task
from evenroad.errors import BrokenFile

path, largest = sys.argv[1], int(sys.argv[2])
task = Task("maze-1", 0, "uniform", 128, "k=10 earlier", "stock", 0, 1)
try:
    with open_store(path) as store:
        resource.setrlimit(resource.RLIMIT_FSIZE, (largest, largest))
        for run in range(4000):
            store.add("paper", replace(task, run=run), Outcome("solved", run), "host:1")
            if run % 50 == 49:
                store.commit()
except BrokenFile as error:
    print(run + 1)
    sys.exit(str(error))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="has no limits on files")
def test_a_file_that_may_not_grow_as_on_a_full_disk_loses_no_row(path):
    done = subprocess.run([sys.executable, "-c", FILL, path, "150000"], capture_output=True, text=True)
    assert done.returncode == 1, done.stderr
    added = int(done.stdout)
    assert "rows that were written before are kept" in done.stderr
    assert f"50 finished rows left in {path}.rescue" in done.stderr
    assert read_rows(path).run.tolist() == list(range(added - 50))
    write(path, [])
    assert read_rows(path).run.tolist() == read_rows(path).valid.tolist() == list(range(added))


def test_without_room_beside_the_store_rows_go_to_a_temporary_folder_or_are_said_to_be_lost(
    path, tmp_path, monkeypatch
):
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temporary"))
    path.with_name("results.db.rescue").mkdir()
    said = leave_rows(path, [(run,) * len(COLUMNS) for run in (1, 2)])
    (left,) = (tmp_path / "temporary").iterdir()
    assert said == f"2 finished rows left in {left}: move it to {path}.rescue, and the next run takes them in"
    assert [json.loads(line)["run"] for line in left.read_text().splitlines()] == [1, 2]
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "missing"))
    said = leave_rows(path, [(1,) * len(COLUMNS)])
    assert said == f"1 finished row could not be left in {path}.rescue either: the next run computes them again"


@pytest.mark.parametrize("text", ["nonsense", "[1, 2]", '{"key": "00"}', "\N{DEGREE SIGN}"])
def test_a_file_in_the_place_of_left_rows_that_is_something_else_is_refused_and_left_alone(path, text):
    beside = path.with_name("results.db.rescue")
    beside.write_text(text, encoding="latin-1")
    refused(BrokenFile, "does not hold rows of a store.*move it away", write, path, [])
    assert beside.read_text(encoding="latin-1") == text
