"""The store: rows in, columns out, and nothing lost."""

import shutil
import sqlite3
import subprocess
import sys
from dataclasses import asdict, replace

import numpy as np
import pytest

from evenroad.bench import store as store_module
from evenroad.bench.outcome import Outcome
from evenroad.bench.schema import SCHEMA
from evenroad.bench.store import open_store, read_rows, read_sessions
from evenroad.bench.task import PROTOCOL, Task
from evenroad.errors import BrokenFile

TASK = Task("maze-1", 0, "uniform", 128, "k=10 earlier", "stock", 0, 1)
SOLVED = Outcome("solved", 20, 7, 93, 1.25, 0.003, "12", "")
NOT_CONNECTED = Outcome("not_connected", 18, None, 40, seconds=0.002)
FAILED = Outcome("failed", error="Traceback: it fell over\nbadly")


@pytest.fixture
def path(tmp_path):
    return tmp_path / "results.db"


def _write(path, outcomes):
    with open_store(path) as store:
        for task, outcome in outcomes:
            store.add("paper", task, outcome, "host:1")


def test_everything_comes_back_as_it_was_written(path):
    outcomes = [SOLVED, NOT_CONNECTED, FAILED, Outcome("timeout", error="took longer than 1 s")]
    tasks = [replace(TASK, run=run) for run in range(len(outcomes))]
    _write(path, zip(tasks, outcomes, strict=True))
    rows = read_rows(path)
    assert len(rows) == len(outcomes)
    for row, (task, outcome) in enumerate(zip(tasks, outcomes, strict=True)):
        for name, value in (asdict(task) | asdict(outcome)).items():
            read = getattr(rows, name)[row]
            expected = -1 if value is None else value
            assert read == expected or (np.isnan(read) and np.isnan(expected)), name
    assert rows.suite.present() == ("paper",)
    assert rows.worker.present() == ("host:1",)
    np.testing.assert_array_equal(rows.solved, [True, False, False, False])
    np.testing.assert_array_equal(rows.answered, [True, True, False, False])


def test_rows_are_in_the_order_of_the_tasks_whatever_the_order_of_arrival(path, tmp_path):
    tasks = [
        Task(problem, instance, sampler, n, rule, "connect", run, seed)
        for problem in ("b", "a")
        for instance in (2, 10)
        for sampler in ("uniform", "even")
        for n in (128, 32)
        for rule in ("k=4 mutual", "k=10 mutual")
        for run in (1, 0)
        for seed in (5,)
    ]
    _write(path, [(task, SOLVED) for task in tasks])
    rows = read_rows(path)
    read = list(
        zip(
            *(
                getattr(rows, name).values()
                if hasattr(getattr(rows, name), "values")
                else getattr(rows, name)
                for name in asdict(TASK)
            ),
            strict=True,
        )
    )
    assert read == sorted(tuple(asdict(task).values()) for task in tasks)
    shuffled = [tasks[i] for i in np.random.default_rng(0).permutation(len(tasks))]
    _write(tmp_path / "other.db", [(task, SOLVED) for task in shuffled])
    other = read_rows(tmp_path / "other.db")
    assert other.problem.names == rows.problem.names
    np.testing.assert_array_equal(other.sampler.codes, rows.sampler.codes)
    np.testing.assert_array_equal(other.run, rows.run)


def test_what_is_finished_is_known_by_the_key_and_failures_can_be_left_out(path):
    tasks = [replace(TASK, run=run) for run in range(3)]
    _write(path, zip(tasks, (SOLVED, FAILED, Outcome("lost")), strict=True))
    with open_store(path) as store:
        assert store.finished() == {task.key for task in tasks}
        assert store.finished(failures=False) == {tasks[0].key}


def test_a_later_row_of_the_same_task_takes_the_place_of_the_first(path):
    _write(path, [(TASK, FAILED)])
    _write(path, [(TASK, SOLVED)])
    rows = read_rows(path)
    assert (len(rows), rows.status[0], rows.error[0]) == (1, "solved", "")


def test_rows_of_another_protocol_are_kept_but_not_read(path, monkeypatch):
    monkeypatch.setattr(store_module, "PROTOCOL", PROTOCOL - 1)
    _write(path, [(TASK, SOLVED)])
    assert len(read_rows(path)) == 1
    monkeypatch.undo()
    assert len(read_rows(path)) == 0


def test_rows_can_be_chosen_by_suite_and_problem(path):
    with open_store(path) as store:
        store.add("paper", TASK, SOLVED, "")
        store.add("fair", replace(TASK, problem="maze-2"), SOLVED, "")
    assert read_rows(path, suite="fair").problem.present() == ("maze-2",)
    assert read_rows(path, problems=["maze-1"]).suite.present() == ("paper",)
    assert len(read_rows(path, problems=["maze-1", "maze-2"])) == 2
    assert len(read_rows(path, suite="nonsense")) == 0
    assert len(read_rows(path, problems=[])) == 0


def test_a_selection_of_rows_keeps_their_columns_together(path):
    _write(path, [(replace(TASK, run=run), replace(SOLVED, valid=10 * run)) for run in range(5)])
    rows = read_rows(path).where(np.array([4, 1]))
    assert rows.run.tolist() == [4, 1]
    assert rows.valid.tolist() == [40, 10]
    assert len(rows.problem) == 2
    assert not rows.valid.flags.writeable
    with pytest.raises(ValueError, match="read-only"):
        rows.sampler.codes[0] = 1


def test_a_new_store_is_empty(path):
    _write(path, [])
    rows = read_rows(path)
    assert len(rows) == 0
    assert rows.problem.present() == ()
    assert rows.solved.shape == (0,)


def test_what_was_added_before_an_exception_is_written(path):
    def stopped():
        with open_store(path) as store:
            store.add("paper", TASK, SOLVED, "")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        stopped()
    assert len(read_rows(path)) == 1


def test_a_store_is_one_file_that_can_be_copied_between_commits_and_after_the_end(path, tmp_path):
    with open_store(path) as store:
        store.add("paper", TASK, SOLVED, "")
        store.commit()
        shutil.copy(path, tmp_path / "copy.db")
        assert len(read_rows(tmp_path / "copy.db")) == 1
        assert len(read_rows(path)) == 1
    assert sorted(each.name for each in tmp_path.iterdir()) == ["copy.db", "results.db"]


def test_rows_are_committed_now_and_then_without_being_asked(path, monkeypatch):
    monkeypatch.setattr(store_module, "COMMIT_SECONDS", 0.0)
    with open_store(path) as store:
        store.add("paper", TASK, SOLVED, "")
        assert len(read_rows(path)) == 1


def test_a_killed_writer_leaves_what_it_committed(path):
    code = (
        "import os, sys\n"
        "from evenroad.bench.store import open_store\n"
        "from evenroad.bench.task import Task\n"
        "from evenroad.bench.outcome import Outcome\n"
        f"with open_store({str(path)!r}) as store:\n"
        "    for run in range(10):\n"
        "        store.add('paper', Task('p', 0, 's', 1, 'r', 'x', run, 0), Outcome('solved'), '')\n"
        "        if run == 6: store.commit()\n"
        "    os.kill(os.getpid(), 9)\n"
    )
    assert subprocess.run([sys.executable, "-c", code]).returncode == -9
    assert read_rows(path).run.tolist() == list(range(7))
    _write(path, [(TASK, SOLVED)])
    assert len(read_rows(path)) == 8


def test_a_session_tells_versions_and_only_those_that_wrote_count(path):
    _write(path, [(TASK, SOLVED)])
    _write(path, [])
    (session,) = read_sessions(path)
    assert session.numpy == np.__version__
    assert session.started.startswith("20")


def test_people_can_read_the_results_with_any_sqlite_tool(path):
    _write(path, [(TASK, SOLVED)])
    connection = sqlite3.connect(path)
    row = connection.execute("SELECT key, problem, sampler, status, valid, set_id FROM results").fetchone()
    connection.close()
    assert row == (TASK.key, "maze-1", "uniform", "solved", 20, "12")


def test_a_second_writer_is_refused_and_readers_are_not(path):
    with open_store(path) as store:
        store.add("paper", TASK, SOLVED, "")
        store.commit()
        with pytest.raises(BrokenFile, match="another benchmark is writing it"), open_store(path):
            pass
        assert len(read_rows(path)) == 1
    _write(path, [])


def test_a_file_of_another_kind_is_refused_and_left_alone(path):
    path.write_bytes(b"a,b\n1,2\n" * 100)
    before = path.read_bytes()
    for use in (lambda: read_rows(path), lambda: _write(path, [])):
        with pytest.raises(BrokenFile, match="not a store of benchmark results"):
            use()
    assert path.read_bytes() == before


def test_another_sqlite_file_is_refused_and_left_alone(path):
    connection = sqlite3.connect(path)
    connection.execute("CREATE TABLE runs (id INTEGER)")
    connection.close()
    before = path.read_bytes()
    for use in (lambda: read_rows(path), lambda: _write(path, [])):
        with pytest.raises(BrokenFile, match="not a store of benchmark results"):
            use()
    assert path.read_bytes() == before


def test_a_store_of_another_schema_version_is_refused_with_both_numbers(path):
    _write(path, [(TASK, SOLVED)])
    connection = sqlite3.connect(path)
    connection.execute(f"PRAGMA user_version = {SCHEMA + 1}")
    connection.close()
    before = path.read_bytes()
    for use in (lambda: read_rows(path), lambda: _write(path, [])):
        with pytest.raises(BrokenFile, match=f"schema version {SCHEMA + 1}, this evenroad reads {SCHEMA}"):
            use()
    assert path.read_bytes() == before


def test_a_store_that_is_not_there_or_cannot_be_is_refused(tmp_path):
    with pytest.raises(BrokenFile, match="no such store"):
        read_rows(tmp_path / "missing.db")
    with pytest.raises(BrokenFile, match="does not exist"):
        _write(tmp_path / "missing" / "results.db", [])
    with pytest.raises(BrokenFile, match="it is a folder"):
        _write(tmp_path, [])


def test_a_locked_file_is_an_error_that_loses_no_earlier_row(path, monkeypatch):
    monkeypatch.setattr("evenroad.bench.schema.PATIENCE", 0.1)
    _write(path, [(TASK, SOLVED)])
    other = sqlite3.connect(path, isolation_level=None)

    def write_while_locked():
        with open_store(path) as store:
            other.execute("BEGIN EXCLUSIVE")
            store.add("paper", replace(TASK, run=1), SOLVED, "")

    with pytest.raises(BrokenFile, match="locked.*rows that were written before are kept"):
        write_while_locked()
    other.close()
    assert read_rows(path).run.tolist() == [0]


def test_a_full_disk_is_an_error_that_loses_no_earlier_row(path):
    _write(path, [(TASK, SOLVED)])

    def write_too_much():
        with open_store(path) as store:
            pages = store._connection.execute("PRAGMA page_count").fetchone()[0]
            store._connection.execute(f"PRAGMA max_page_count = {pages}")
            for run in range(1, 2000):
                store.add(
                    "paper", replace(TASK, run=run), replace(FAILED, error="long " * 100 + str(run)), ""
                )

    with pytest.raises(BrokenFile, match="full.*rows that were written before are kept"):
        write_too_much()
    assert read_rows(path).run.tolist() == [0]
    _write(path, [(replace(TASK, run=1), SOLVED)])
    assert read_rows(path).run.tolist() == [0, 1]
