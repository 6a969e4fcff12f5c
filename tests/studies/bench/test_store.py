"""The store: rows in, columns out, and nothing lost."""

import shutil
import subprocess
import sys
from dataclasses import asdict, replace

import numpy as np
import pytest

from evenroad.errors import BrokenFile
from evenroad_studies.bench import rows as rows_module
from evenroad_studies.bench import store as store_module
from evenroad_studies.bench import store_file as file_module
from evenroad_studies.bench import task as task_module
from evenroad_studies.bench.store import joined, open_store, read_rows, read_sessions
from evenroad_studies.bench.store_file import SCHEMA
from evenroad_studies.bench.task import PROTOCOL, Outcome, Task
from tests.refused import refused
from tests.studies.bench.tables import FAILED, NOT_CONNECTED, SOLVED, TASK, query, write


def test_everything_comes_back_as_it_was_written(path):
    outcomes = [SOLVED, NOT_CONNECTED, FAILED, Outcome("timeout", error="took longer than 1 s")]
    tasks = [replace(TASK, run=run) for run in range(len(outcomes))]
    write(path, zip(tasks, outcomes, strict=True))
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


def test_what_is_finished_is_known_by_the_key_and_whether_it_is_an_answer_and_numbers_may_be_numpys(path):
    tasks = [replace(TASK, n=np.int64(128), run=np.int32(run)) for run in range(3)]
    solved = replace(SOLVED, valid=np.int64(20), length=np.float64(2.0))
    write(path, zip(tasks, (solved, FAILED, Outcome("lost")), strict=True))
    with open_store(path) as store:
        assert store.finished() == {
            replace(TASK, run=run).key: answered for run, answered in enumerate((True, False, False))
        }
    rows = read_rows(path)
    assert (rows.n[0], rows.run[0], rows.valid[0], rows.length[0]) == (128, 0, 20, 2.0)


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
    write(path, [(task, SOLVED) for task in tasks])
    rows = read_rows(path)
    read = list(zip(*(getattr(rows, name) for name in asdict(TASK)), strict=True))
    assert read == sorted(tuple(asdict(task).values()) for task in tasks)
    shuffled = [tasks[i] for i in np.random.default_rng(0).permutation(len(tasks))]
    write(tmp_path / "other.db", [(task, SOLVED) for task in shuffled])
    other = read_rows(tmp_path / "other.db")
    assert other.problem.names == rows.problem.names
    np.testing.assert_array_equal(other.sampler.codes, rows.sampler.codes)
    np.testing.assert_array_equal(other.run, rows.run)


def test_a_later_row_of_the_same_task_takes_the_place_of_the_first(path):
    write(path, [(TASK, replace(FAILED, error="no such file: \udcff.png"))])
    assert read_rows(path).error[0] == "no such file: \\udcff.png"
    write(path, [(TASK, SOLVED)])
    rows = read_rows(path)
    assert (len(rows), rows.status[0], rows.error[0]) == (1, "solved", "")


def test_rows_of_another_protocol_are_kept_but_not_read(path, monkeypatch):
    for module in (file_module, rows_module, task_module):
        monkeypatch.setattr(module, "PROTOCOL", PROTOCOL - 1)
    write(path, [(TASK, SOLVED)])
    assert len(read_rows(path)) == 1
    monkeypatch.undo()
    assert len(read_rows(path)) == 0


def test_rows_can_be_chosen_by_problem(path):
    with open_store(path) as store:
        store.add("paper", TASK, SOLVED, "")
        store.add("fair", replace(TASK, problem="maze-2"), SOLVED, "")
    assert read_rows(path, problems=["maze-1"]).suite.present() == ("paper",)
    assert len(read_rows(path, problems=["maze-1", "maze-2"])) == 2
    assert len(read_rows(path, problems=["nonsense"])) == 0
    assert len(read_rows(path, problems=[])) == 0


def test_a_selection_of_rows_keeps_their_columns_together_and_is_read_only(path):
    write(path, [(replace(TASK, run=run), replace(SOLVED, valid=10 * run)) for run in range(5)])
    rows = read_rows(path).where(np.array([4, 1]))
    assert (len(rows.problem), rows.run.tolist(), rows.valid.tolist()) == (2, [4, 1], [40, 10])
    assert not rows.valid.flags.writeable
    assert not rows.sampler.codes.flags.writeable


def test_stores_of_several_machines_are_read_as_one(path, tmp_path):
    tasks = [
        replace(TASK, problem=problem, n=n, run=run)
        for problem in ("maze-1", "maze-2")
        for n in (64, 128)
        for run in range(3)
    ]
    outcomes = [(task, replace(SOLVED, valid=place)) for place, task in enumerate(tasks)]
    write(path, outcomes)
    write(tmp_path / "here.db", outcomes[1::2])
    # Its names come in another order, and with others.
    write(tmp_path / "there.db", [(replace(TASK, problem="a maze"), NOT_CONNECTED), *reversed(outcomes[::2])])
    together = joined([read_rows(tmp_path / "there.db"), read_rows(tmp_path / "here.db")])
    assert together.problem[0] == "a maze"
    whole, rest = read_rows(path), together.where(np.arange(1, len(together)))
    for name in asdict(TASK) | asdict(SOLVED):
        values, expected = getattr(rest, name), getattr(whole, name)
        assert [values[i] for i in range(len(rest))] == [expected[i] for i in range(len(whole))], name


def test_of_a_task_with_rows_in_two_stores_that_of_the_first_counts_but_an_answer_before_a_failure(path, tmp_path):
    write(path, [(TASK, NOT_CONNECTED), (replace(TASK, run=1), SOLVED)])
    write(tmp_path / "b.db", [(TASK, SOLVED)])
    write(tmp_path / "failed.db", [(TASK, FAILED)])
    one, other, failed = (read_rows(each) for each in (path, tmp_path / "b.db", tmp_path / "failed.db"))
    assert joined([one, other]).solved.tolist() == [False, True]
    assert joined([other, one]).solved.tolist() == [True, True]
    assert len(joined([one.where(np.zeros(2, dtype=np.bool_))])) == 0
    assert joined([failed, other]).solved.tolist() == [True]
    assert joined([failed]).status[0] == "failed"


def test_a_store_is_one_file_that_can_be_copied_between_commits_and_after_the_end(path, tmp_path):
    with open_store(path) as store:
        store.add("paper", TASK, SOLVED, "")
        store.commit()
        shutil.copy(path, tmp_path / "copy.db")
        assert len(read_rows(tmp_path / "copy.db")) == 1
        assert len(read_rows(path)) == 1
    assert sorted(each.name for each in tmp_path.iterdir()) == ["copy.db", "results.db"]


def test_rows_are_committed_when_the_last_time_is_long_enough_ago(path, monkeypatch):
    with open_store(path) as store:
        store.add("paper", TASK, SOLVED, "")
        monkeypatch.setattr(store_module, "COMMIT_SECONDS", 1e6)
        store.commit_if_due()
        assert len(read_rows(path)) == 0
        monkeypatch.setattr(store_module, "COMMIT_SECONDS", 0.0)
        store.commit_if_due()
        assert len(read_rows(path)) == 1


class _Interrupted:
    """A connection in whose way Ctrl-C comes, once, right after a statement."""

    def __init__(self, connection, after):
        self._connection, self._after = connection, after

    def __getattr__(self, name):
        return getattr(self._connection, name)

    def execute(self, statement, *values):
        return self._interrupt(statement, self._connection.execute(statement, *values))

    def executemany(self, statement, values):
        return self._interrupt(statement, self._connection.executemany(statement, values))

    def _interrupt(self, statement, result):
        if self._after is not None and self._after in statement:
            self._after = None
            raise KeyboardInterrupt
        return result


@pytest.mark.parametrize("after", ["BEGIN", "INTO names", "INTO rows", "COMMIT"])
def test_an_interrupt_inside_a_commit_loses_no_row(path, after):
    with pytest.raises(KeyboardInterrupt), open_store(path) as store:  # noqa: PT012
        for run in range(5):
            store.add("paper", replace(TASK, run=run), replace(SOLVED, set_id=str(run)), "")
        store._connection = _Interrupted(store._connection, after)
        store.commit()
    write(path, [(replace(TASK, run=5), replace(SOLVED, set_id="5"))])
    rows = read_rows(path)
    assert rows.run.tolist() == list(range(6))
    assert [rows.set_id[row] for row in range(6)] == list("012345")


def test_an_interrupt_inside_the_last_commit_leaves_the_rows_beside_the_store(path, tmp_path):
    with pytest.raises(KeyboardInterrupt), open_store(path) as store:  # noqa: PT012
        store.add("paper", TASK, SOLVED, "")
        store._connection = _Interrupted(store._connection, "INTO rows")
    assert len(read_rows(path)) == 0
    assert (tmp_path / "results.db.rescue").exists()
    write(path, [])
    assert len(read_rows(path)) == 1


def test_a_killed_writer_leaves_what_it_committed(path):
    code = (
        "import os, sys\n"
        "from evenroad_studies.bench.store import open_store\n"
        "from evenroad_studies.bench.task import Task\n"
        "from evenroad_studies.bench.task import Outcome\n"
        f"with open_store({str(path)!r}) as store:\n"
        "    for run in range(10):\n"
        "        store.add('paper', Task('p', 0, 's', 1, 'r', 'x', run, 0), Outcome('solved'), '')\n"
        "        if run == 6: store.commit()\n"
        "    os.kill(os.getpid(), 9)\n"
    )
    assert subprocess.run([sys.executable, "-c", code]).returncode == -9
    assert read_rows(path).run.tolist() == list(range(7))
    write(path, [(TASK, SOLVED)])
    assert len(read_rows(path)) == 8


def test_a_session_tells_versions_and_only_those_that_wrote_count_and_any_sqlite_tool_reads_the_results(path):
    write(path, [(TASK, SOLVED)])
    (row,) = query(path, "SELECT key, problem, sampler, status, valid, set_id FROM results")
    assert row == (TASK.key, "maze-1", "uniform", "solved", 20, "12")
    write(path, [])
    (session,) = read_sessions(path)
    assert session.numpy == np.__version__
    assert session.started.startswith("20")


def test_a_second_writer_is_refused_and_readers_are_not(path):
    with open_store(path) as store:
        store.add("paper", TASK, SOLVED, "")
        store.commit()
        with pytest.raises(BrokenFile, match="another benchmark is writing it"), open_store(path):
            pass
        assert len(read_rows(path)) == 1
    write(path, [])


def _of_another_schema(path):
    write(path, [(TASK, SOLVED)])
    query(path, f"PRAGMA user_version = {SCHEMA + 1}")


@pytest.mark.parametrize(("make", "says"), [
    (lambda path: path.write_bytes(b"a,b\n1,2\n" * 100), "not a store of benchmark results"),
    (lambda path: query(path, "CREATE TABLE runs (id INTEGER)"), "not a store of benchmark results"),
    (_of_another_schema, f"schema version {SCHEMA + 1}, this evenroad reads {SCHEMA}"),
])  # fmt: skip
def test_a_file_of_another_kind_or_version_is_refused_and_left_alone(path, make, says):
    make(path)
    before = path.read_bytes()
    for use in (lambda: read_rows(path), lambda: write(path, [])):
        refused(BrokenFile, says, use)
    assert path.read_bytes() == before


def test_a_store_that_is_not_there_or_cannot_be_is_refused(tmp_path):
    refused(BrokenFile, "no such store", read_rows, tmp_path / "missing.db")
    refused(BrokenFile, "does not exist", write, tmp_path / "missing" / "results.db", [])
    refused(BrokenFile, "it is a folder", write, tmp_path, [])
