"""A store of parts: many write it at once, what is damaged is refused, and its cells are those of the one file."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from evenroad.cli import main
from evenroad.errors import BrokenFile
from evenroad_studies.bench.rows import Labels
from evenroad_studies.bench.store import open_store, read_rows, read_sessions
from evenroad_studies.bench.store_parts import parts_of
from evenroad_studies.bench.task import Outcome
from evenroad_studies.report.cells import cells_of
from evenroad_studies.report.runs import runs_of
from evenroad_studies.report.streamed import streamed_cells, write_cells
from tests.studies.bench.tables import FAILED, NOT_CONNECTED, SOLVED, TASK, table_of, write

pytest.importorskip("pyarrow")


def some_rows(seed, count):
    """Rows of fixed and of random problems, of sets of a pool and of sets drawn afresh, some of them failures."""
    rng = np.random.default_rng(seed)
    for run in range(count):
        problem = ("maze-1", "maze-2", "paper-maze-2d")[run % 3]
        instance = run // 7 % 11 if problem == "paper-maze-2d" else 0
        sampler = ("uniform", "even", "grid")[rng.integers(3)]
        task = replace(TASK, problem=problem, instance=instance, sampler=sampler, n=64 << int(rng.integers(2)), run=run)
        set_id = str(rng.integers(9)) if sampler == "even" else sampler if sampler == "grid" else ""
        solved = Outcome("solved", 20, 7, 93, 1.25 + rng.random(), 0.003, set_id)
        yield task, (solved, solved, replace(NOT_CONNECTED, set_id=set_id), FAILED)[rng.integers(4)]


def values_of(store):
    rows = read_rows(store)
    return {name: list(each) if isinstance(each, Labels) else each.tolist() for name, each in vars(rows).items()}


def test_a_folder_of_parts_holds_what_the_one_file_holds(tmp_path):
    for name in ("one.db", "many.parts"):
        write(tmp_path / name, some_rows(1, 300))
    assert table_of(tmp_path / "many.parts") == table_of(tmp_path / "one.db")
    assert read_sessions(tmp_path / "many.parts")[0][1:] == read_sessions(tmp_path / "one.db")[0][1:]
    with open_store(tmp_path / "many.parts") as many, open_store(tmp_path / "one.db") as one:
        assert many.finished() == one.finished()


def test_many_write_at_once_and_no_row_is_lost_or_counted_twice(tmp_path):
    store = tmp_path / "many.parts"
    rows = list(some_rows(2, 400))

    def writer(k):
        with open_store(store) as opened:
            for task, outcome in rows[k::8]:
                opened.add("paper", task, outcome, f"host:{k}")
                opened.commit()

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(writer, range(8)))
    # Each has made one file of its fifty.
    assert len(list(store.iterdir())) == 8
    write(tmp_path / "one.db", rows)
    assert table_of(store) == table_of(tmp_path / "one.db")


def test_files_that_a_larger_one_replaces_do_not_count_though_a_kill_left_them_there(tmp_path, monkeypatch):
    store = tmp_path / "many.parts"
    monkeypatch.setattr("pathlib.Path.unlink", lambda *_, **__: None)
    with open_store(store) as opened:
        for task, outcome in some_rows(3, 20):
            opened.add("paper", task, outcome, "host:1")
            opened.commit()
    assert len(list(store.iterdir())) == 21
    assert len(list(parts_of(store))) == 1
    assert len(read_rows(store)) == 20


def test_an_answer_counts_before_a_failure_and_a_task_once(tmp_path):
    store = tmp_path / "many.parts"
    for outcome in (FAILED, SOLVED, FAILED, NOT_CONNECTED):
        write(store, [(TASK, outcome)])
    assert values_of(store)["status"] == ["solved"]
    (cells,) = streamed_cells(store)
    assert [(cell.runs, cell.solved, cell.failures) for cell in cells] == [(1, 1, 0)]


def test_cells_of_one_problem_at_a_time_are_those_of_all_rows_at_once(tmp_path):
    store = tmp_path / "many.parts"
    for part in range(4):
        write(store, list(some_rows(5, 2000))[part::4])
    expected = cells_of(runs_of(read_rows(store)))
    found = [cell for cells in streamed_cells(store) for cell in cells]
    assert len(found) == len(expected) > 10
    of = {(cell.setting, cell.sampler, cell.n): cell for cell in expected}
    for cell in found:
        other = of[cell.setting, cell.sampler, cell.n]
        assert (cell.runs, cell.solved, cell.failures, cell.interval) == (
            other.runs,
            other.solved,
            other.failures,
            other.interval,
        )
    assert {cell.interval.kind for cell in found} > {"wilson"}
    assert write_cells(store, tmp_path / "cells.csv") == 2000
    table = (tmp_path / "cells.csv").read_text()
    assert len(table.splitlines()) == 1 + len(found)
    write(tmp_path / "one.db", some_rows(5, 2000))
    assert main(["report", str(tmp_path / "one.db"), "-o", str(tmp_path / "out"), "--cells"]) == 0
    of_one = (tmp_path / "out" / "cells.csv").read_text()
    assert sorted(of_one.splitlines()) == sorted(table.splitlines())


def test_a_file_with_other_bytes_than_were_written_is_refused(tmp_path):
    store = tmp_path / "many.parts"
    write(store, some_rows(4, 50))
    (file,) = store.iterdir()
    content = bytearray(file.read_bytes())
    content[len(content) // 3] ^= 1
    file.write_bytes(content)
    with pytest.raises(BrokenFile, match=r"part-.* is damaged"):
        read_rows(store)
    file.write_bytes(b"PAR1")
    with pytest.raises(BrokenFile, match=r"part-.* is damaged"):
        read_rows(store)
    with pytest.raises(BrokenFile, match="no such store"):
        read_rows(tmp_path / "none.parts")
