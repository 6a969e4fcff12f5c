"""evenroad bench and evenroad export."""

import os
import re
import signal
import sqlite3
import subprocess
import sys
import time

import pytest

from evenroad.bench.store import read_rows

SMALL = ("bench", "paper", "--runs", 2, "--only", "hypercube-legacy6,corridor-2d-0.1", "--quick", "--jobs", 1)


def test_a_suite_is_run_shown_and_found_done_the_next_time(run, tmp_path):
    code, out, err = run(*SMALL)
    assert code == 0, err
    rows = read_rows(tmp_path / "results.db")
    assert rows.problem.present() == ("corridor-2d-0.1", "hypercube-legacy6")
    assert f"{len(rows)} tasks run now, 0 found done" in out
    assert "report: evenroad report results.db -o out/" in out
    code, out, _ = run(*SMALL)
    assert code == 0
    assert f"0 tasks run now, {len(rows)} found done" in out


def test_the_table_shows_success_by_problem_n_and_sampler_within_100_columns(run, tmp_path):
    _, out, _ = run(*SMALL)
    rows = read_rows(tmp_path / "results.db")
    here = rows.problem.is_in(["corridor-2d-0.1"]) & (rows.n == 256) & rows.sampler.is_in(["uniform"])
    line = next(line for line in out.splitlines() if re.match(r"corridor-2d-0.1 +256 ", line))
    assert line.split()[2] == f"{100 * rows.solved[here].mean():.0f}"
    # There is no grid of 128 points.
    line = next(line for line in out.splitlines() if re.match(r"corridor-2d-0.1 +128 ", line))
    assert "–" in line
    assert max(map(len, out.splitlines())) <= 100


def test_two_processes_write_the_rows_of_one(run, tmp_path):
    run(*SMALL, "--store", "one.db")
    code, _, _ = run(*SMALL[:-1], 2, "--store", "two.db")
    assert code == 0
    one, two = read_rows(tmp_path / "one.db"), read_rows(tmp_path / "two.db")
    assert one.status.values().tolist() == two.status.values().tolist()
    assert one.valid.tolist() == two.valid.tolist()
    assert one.edges_checked.tolist() == two.edges_checked.tolist()


def test_list_shows_what_there_is_and_runs_nothing(run, tmp_path):
    code, out, _ = run("bench", "--list")
    assert code == 0
    for word in (
        "suite paper",
        "suite fair",
        "maze-1",
        "hypercube-legacy6",
        "halton paper-blocks",
        "korobov",
    ):
        assert word in out
    assert not (tmp_path / "results.db").exists()


def test_a_run_without_an_answer_is_exit_code_1_and_is_tried_again_on_demand(run):
    hopeless = ("bench", "--only", "maze-1", "--runs", 1, "--quick", "--jobs", 1, "--limit", "1e-6")
    code, out, _ = run(*hopeless)
    assert code == 1
    assert "of them failures" in out
    code, out, _ = run(*hopeless)
    assert (code, "0 tasks run now" in out) == (0, True)
    code, out, _ = run(*hopeless[:-2], "--retry")
    assert (code, "0 found done" in out, "failures" in out) == (0, True, False)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("bench", "nonsense"), "unknown suite 'nonsense'; known: fair, paper"),
        (("bench", "--only", "nonsense"), "unknown problem of this suite 'nonsense'; known: chain-10d, "),
        (("bench", "--runs", 0), "runs must be an integer >= 1"),
        (("bench", "--seed", "-1"), "seed must be an integer >= 0"),
        (("bench", "--jobs", 0, "--quick"), "jobs must be an integer >= 1"),
        (("bench", "--limit", 0, *SMALL[2:]), "limit must be a finite number > 0"),
        (("bench", "--jobs", 2, "--scheduler", "tcp://127.0.0.1:9"), "--jobs does not go with --scheduler"),
        (("bench", "--store", "missing/results.db", *SMALL[2:]), "the folder missing does not exist"),
        (("export", "missing.db", "--arena", "-o", "arena.db"), "no such store: missing.db"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(run, arguments, says):
    code, _, err = run(*arguments)
    assert code == 2
    assert says in err
    assert err.startswith("evenroad: error: ")
    assert len(err.splitlines()) == 1


def test_a_file_that_is_no_store_is_refused_before_anything_runs(run, tmp_path):
    (tmp_path / "results.db").write_text("something else, long enough to be no SQLite header\n" * 20)
    code, _, err = run(*SMALL)
    assert code == 2
    assert "not a store of benchmark results" in err


def test_ctrl_c_keeps_what_is_finished_and_the_same_command_goes_on(tmp_path):
    arguments = [
        "bench",
        "--only",
        "hypercube-legacy6",
        "--runs",
        "200",
        "--jobs",
        "1",
        "--store",
        "results.db",
    ]
    command = [
        sys.executable,
        "-c",
        "import sys; from evenroad.cli import main; sys.exit(main())",
        *arguments,
    ]
    process = subprocess.Popen(
        command, cwd=tmp_path, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True
    )
    store = tmp_path / "results.db"
    for _ in range(600):
        if store.exists() and store.stat().st_size > 60_000:
            break
        time.sleep(0.1)
    os.kill(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "interrupted; what was finished is kept" in err
    rows = read_rows(store)
    assert len(rows) > 0
    assert set(rows.status.present()) <= {"solved", "not_connected"}


def test_export_writes_a_planner_arena_database(run, tmp_path):
    run(*SMALL)
    code, out, err = run("export", "results.db", "--arena", "-o", "arena.db")
    assert code == 0, err
    connection = sqlite3.connect(tmp_path / "arena.db")
    (runs,) = connection.execute("SELECT count(*) FROM runs").fetchone()
    connection.close()
    assert runs == len(read_rows(tmp_path / "results.db"))
    assert f"{runs} runs" in out


def test_export_asks_for_a_format(run):
    code, _, err = run("export", "results.db", "-o", "arena.db")
    assert code == 2
    assert "--arena" in err
