"""The store: rows in, columns out, and nothing lost."""

import json
import shutil
import sqlite3
import subprocess
import sys
from dataclasses import asdict, replace

import numpy as np
import pytest

from evenroad.errors import BrokenFile
from evenroad_studies.bench import rows as rows_module
from evenroad_studies.bench import store as store_module
from evenroad_studies.bench import task as task_module
from evenroad_studies.bench.store import joined, leave_rows, open_store, read_rows, read_sessions
from evenroad_studies.bench.store_file import COLUMNS, SCHEMA
from evenroad_studies.bench.task import PROTOCOL, Outcome, Task

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


def _during(path, act):
    """Do something with a store, for tests that say what it raises."""
    with open_store(path) as store:
        act(store)


def _stop(store):
    store.add("paper", TASK, SOLVED, "")
    raise KeyboardInterrupt


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


def test_what_is_finished_is_known_by_the_key_and_whether_it_is_an_answer_and_numbers_may_be_numpys(path):
    tasks = [replace(TASK, n=np.int64(128), run=np.int32(run)) for run in range(3)]
    solved = replace(SOLVED, valid=np.int64(20), length=np.float64(2.0))
    _write(path, zip(tasks, (solved, FAILED, Outcome("lost")), strict=True))
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
    _write(path, [(task, SOLVED) for task in tasks])
    rows = read_rows(path)
    read = list(zip(*(getattr(rows, name) for name in asdict(TASK)), strict=True))
    assert read == sorted(tuple(asdict(task).values()) for task in tasks)
    shuffled = [tasks[i] for i in np.random.default_rng(0).permutation(len(tasks))]
    _write(tmp_path / "other.db", [(task, SOLVED) for task in shuffled])
    other = read_rows(tmp_path / "other.db")
    assert other.problem.names == rows.problem.names
    np.testing.assert_array_equal(other.sampler.codes, rows.sampler.codes)
    np.testing.assert_array_equal(other.run, rows.run)


def test_a_later_row_of_the_same_task_takes_the_place_of_the_first(path):
    _write(path, [(TASK, replace(FAILED, error="no such file: \udcff.png"))])
    assert read_rows(path).error[0] == "no such file: \\udcff.png"
    _write(path, [(TASK, SOLVED)])
    rows = read_rows(path)
    assert (len(rows), rows.status[0], rows.error[0]) == (1, "solved", "")


def test_rows_of_another_protocol_are_kept_but_not_read(path, monkeypatch):
    for module in (store_module, rows_module, task_module):
        monkeypatch.setattr(module, "PROTOCOL", PROTOCOL - 1)
    _write(path, [(TASK, SOLVED)])
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


def test_a_selection_of_rows_keeps_their_columns_together(path):
    _write(path, [(replace(TASK, run=run), replace(SOLVED, valid=10 * run)) for run in range(5)])
    rows = read_rows(path).where(np.array([4, 1]))
    assert rows.run.tolist() == [4, 1]
    assert rows.valid.tolist() == [40, 10]
    assert len(rows.problem) == 2
    assert not rows.valid.flags.writeable
    with pytest.raises(ValueError, match="read-only"):
        rows.sampler.codes[0] = 1


def test_stores_of_several_machines_are_read_as_one(path, tmp_path):
    tasks = [
        replace(TASK, problem=problem, n=n, run=run)
        for problem in ("maze-1", "maze-2")
        for n in (64, 128)
        for run in range(3)
    ]
    outcomes = [(task, replace(SOLVED, valid=place)) for place, task in enumerate(tasks)]
    _write(path, outcomes)
    _write(tmp_path / "here.db", outcomes[1::2])
    # Its names come in another order, and with others.
    _write(tmp_path / "there.db", [(replace(TASK, problem="a maze"), NOT_CONNECTED), *reversed(outcomes[::2])])
    together = joined([read_rows(tmp_path / "there.db"), read_rows(tmp_path / "here.db")])
    assert together.problem[0] == "a maze"
    whole, rest = read_rows(path), together.where(np.arange(1, len(together)))
    for name in asdict(TASK) | asdict(SOLVED):
        values, expected = getattr(rest, name), getattr(whole, name)
        assert [values[i] for i in range(len(rest))] == [expected[i] for i in range(len(whole))], name


def test_of_a_task_with_rows_in_two_stores_that_of_the_first_counts_but_an_answer_before_a_failure(path, tmp_path):
    _write(path, [(TASK, NOT_CONNECTED), (replace(TASK, run=1), SOLVED)])
    _write(tmp_path / "b.db", [(TASK, SOLVED)])
    _write(tmp_path / "failed.db", [(TASK, FAILED)])
    one, other, failed = (read_rows(each) for each in (path, tmp_path / "b.db", tmp_path / "failed.db"))
    assert joined([one, other]).solved.tolist() == [False, True]
    assert joined([other, one]).solved.tolist() == [True, True]
    assert len(joined([one.where(np.zeros(2, dtype=np.bool_))])) == 0
    assert joined([failed, other]).solved.tolist() == [True]
    assert joined([failed]).status[0] == "failed"


def test_what_was_added_before_an_exception_is_written(path):
    with pytest.raises(KeyboardInterrupt):
        _during(path, _stop)
    assert len(read_rows(path)) == 1


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


# Interrupts.


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
    def interrupted(store):
        for run in range(5):
            store.add("paper", replace(TASK, run=run), replace(SOLVED, set_id=str(run)), "")
        store._connection = _Interrupted(store._connection, after)
        store.commit()

    with pytest.raises(KeyboardInterrupt):
        _during(path, interrupted)
    _write(path, [(replace(TASK, run=5), replace(SOLVED, set_id="5"))])
    rows = read_rows(path)
    assert rows.run.tolist() == list(range(6))
    assert [rows.set_id[row] for row in range(6)] == list("012345")


def test_an_interrupt_inside_the_last_commit_leaves_the_rows_beside_the_store(path, tmp_path):
    def interrupted(store):
        store.add("paper", TASK, SOLVED, "")
        store._connection = _Interrupted(store._connection, "INTO rows")

    with pytest.raises(KeyboardInterrupt):
        _during(path, interrupted)
    assert len(read_rows(path)) == 0
    assert (tmp_path / "results.db.rescue").exists()
    _write(path, [])
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


def _other_database(path):
    connection = sqlite3.connect(path)
    connection.execute("CREATE TABLE runs (id INTEGER)")
    connection.close()


def _another_schema(path):
    _write(path, [(TASK, SOLVED)])
    connection = sqlite3.connect(path)
    connection.execute(f"PRAGMA user_version = {SCHEMA + 1}")
    connection.close()


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda path: path.write_bytes(b"a,b\n1,2\n" * 100), "not a store of benchmark results"),
        (_other_database, "not a store of benchmark results"),
        (_another_schema, f"schema version {SCHEMA + 1}, this evenroad reads {SCHEMA}"),
    ],
)
def test_a_file_of_another_kind_or_version_is_refused_and_left_alone(path, make, says):
    make(path)
    before = path.read_bytes()
    for use in (lambda: read_rows(path), lambda: _write(path, [])):
        with pytest.raises(BrokenFile, match=says):
            use()
    assert path.read_bytes() == before


def test_a_store_that_is_not_there_or_cannot_be_is_refused(tmp_path):
    with pytest.raises(BrokenFile, match="no such store"):
        read_rows(tmp_path / "missing.db")
    with pytest.raises(BrokenFile, match="does not exist"):
        _write(tmp_path / "missing" / "results.db", [])
    with pytest.raises(BrokenFile, match="it is a folder"):
        _write(tmp_path, [])


# Stores that cannot be written.


def _columns(path):
    """Return all columns but the time of writing."""
    connection = sqlite3.connect(path)
    rows = connection.execute("SELECT * FROM results ORDER BY run").fetchall()
    connection.close()
    return [row[:-1] for row in rows]


def test_rows_that_a_locked_file_cannot_take_are_left_beside_it_and_taken_in_the_next_time(path, monkeypatch):
    monkeypatch.setattr("evenroad_studies.bench.store_file.PATIENCE", 0.1)
    outcomes = [(TASK, SOLVED), (replace(TASK, run=1), NOT_CONNECTED), (replace(TASK, run=2), FAILED)]
    _write(path, outcomes[:1])
    other = sqlite3.connect(path, isolation_level=None)

    def write_while_locked(store):
        other.execute("BEGIN EXCLUSIVE")
        for task, outcome in outcomes[1:]:
            store.add("paper", task, outcome, "host:1")

    with pytest.raises(BrokenFile) as error:
        _during(path, write_while_locked)
    other.close()
    assert "locked (rows that were written before are kept)" in str(error.value)
    left = f"2 finished rows left in {path}.rescue: the next run with this store takes them in"
    assert left in str(error.value)
    assert read_rows(path).run.tolist() == [0]
    _write(path, [])
    _write(path.with_name("calm.db"), outcomes)
    assert _columns(path) == _columns(path.with_name("calm.db"))
    assert sorted(each.name for each in path.parent.iterdir()) == ["calm.db", "results.db"]


def test_a_store_that_stays_locked_keeps_what_was_left_beside_it(path, monkeypatch):
    monkeypatch.setattr("evenroad_studies.bench.store_file.PATIENCE", 0.01)
    _write(path, [])
    beside, left = path.with_name("results.db.rescue"), _left_behind(path)
    beside.write_text(left)
    other = sqlite3.connect(path, isolation_level=None)
    other.execute("BEGIN IMMEDIATE")
    for _ in range(2):
        with pytest.raises(BrokenFile, match="locked"):
            _write(path, [])
        assert beside.read_text() == left
    other.close()
    _write(path, [])
    assert len(read_rows(path)) == 1


def test_an_answer_is_not_given_up_for_a_failure_that_was_rescued_before_it(path):
    """The rescue lay in the temporary folder, say, while the task was run once more."""
    left = _left_behind(path).replace('"solved"', '"timeout"')
    assert "timeout" in left
    with open_store(path) as store:
        store.add("paper", TASK, SOLVED, "")
    path.with_name("results.db.rescue").write_text(left)
    _write(path, [])
    assert read_rows(path).solved.tolist() == [True]
    assert not path.with_name("results.db.rescue").exists()


def _left_behind(path):
    """Return what a run that could not write its row left."""

    def full(store):
        store._connection.execute("PRAGMA query_only = 1")
        store.add("paper", TASK, SOLVED, "host:1")

    with pytest.raises(BrokenFile, match="left in"):
        _during(path.with_name("full.db"), full)
    return path.with_name("full.db.rescue").read_text()


def test_a_store_that_can_be_written_again_takes_what_waits(path):
    with open_store(path) as store:
        store.add("paper", TASK, SOLVED, "")
        store._connection.execute("PRAGMA query_only = 1")
        with pytest.raises(BrokenFile):
            store.commit()
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
    _write(path, [])
    assert read_rows(path).run.tolist() == read_rows(path).valid.tolist() == list(range(added))


def test_without_room_beside_the_store_rows_go_to_the_temporary_folder(path, tmp_path, monkeypatch):
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temporary"))
    path.with_name("results.db.rescue").mkdir()
    said = leave_rows(path, [(run,) * len(COLUMNS) for run in (1, 2)])
    (left,) = (tmp_path / "temporary").iterdir()
    assert said == f"2 finished rows left in {left}: move it to {path}.rescue, and the next run takes them in"
    assert [json.loads(line)["run"] for line in left.read_text().splitlines()] == [1, 2]


def test_rows_that_can_be_left_nowhere_are_said_to_be_lost(path, tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "missing"))
    path.with_name("results.db.rescue").mkdir()
    said = leave_rows(path, [(1,) * len(COLUMNS)])
    assert said == f"1 finished row could not be left in {path}.rescue either: the next run computes them again"


@pytest.mark.parametrize("text", ["nonsense", "[1, 2]", '{"key": "00"}', "\N{DEGREE SIGN}"])
def test_a_file_in_the_place_of_left_rows_that_is_something_else_is_refused_and_left_alone(path, text):
    beside = path.with_name("results.db.rescue")
    beside.write_text(text, encoding="latin-1")
    with pytest.raises(BrokenFile, match="does not hold rows of a store.*move it away"):
        _write(path, [])
    assert beside.read_text(encoding="latin-1") == text
