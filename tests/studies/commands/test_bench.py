"""evenroad bench and evenroad export."""

import os
import re
import signal
import subprocess
import sys
import time

import pytest

from evenroad.cli import main
from evenroad.errors import BrokenFile
from evenroad_studies.bench.samplers import SAMPLERS
from evenroad_studies.bench.store import Store, open_store, read_rows
from tests.studies.bench.tables import query
from tests.studies.report.stores import made_up, write_store

SMALL = ("bench", "paper", "--runs", 2, "--only", "hypercube-legacy6,corridor-2d-0.1", "--quick", "--jobs", 1)


def _cells(out, problem, n):
    """Return what the table shows of a problem and N, by sampler."""
    lines = out.splitlines()
    below = lines[lines.index(problem) + 1 :]
    _, *cells = next(line.split() for line in below if line.split()[0] == str(n))
    return dict(zip(SAMPLERS, cells, strict=True))


def test_a_suite_is_run_shown_within_80_columns_exported_and_found_done_the_next_time(run, tmp_path):
    code, out, err = run(*SMALL)
    assert code == 0, err
    rows, lines = read_rows(tmp_path / "results.db"), out.splitlines()
    assert rows.problem.present() == ("corridor-2d-0.1", "hypercube-legacy6")
    assert f"{len(rows)} tasks run now, 0 found done" in out
    assert "report: evenroad report results.db -o out/" in out
    here = rows.problem.is_in(["corridor-2d-0.1"]) & (rows.n == 256) & rows.sampler.is_in(["uniform"])
    assert _cells(out, "corridor-2d-0.1", 256)["uniform"] == f"{100 * rows.solved[here].mean():.0f}"
    # There is no grid of 128 points.
    assert _cells(out, "corridor-2d-0.1", 128)["sukharev"] == "–"
    assert [word[:6] for word in lines[1].split()[1:]] == [name.split()[0][:6] for name in SAMPLERS]
    assert lines[2].split() == ["blocks", "scram.", "blocks", "scram.", "nell"]
    assert max(map(len, lines)) <= 80
    code, out, _ = run(*SMALL)
    assert (code, f"0 tasks run now, {len(rows)} found done" in out) == (0, True)
    # With the option that scripts of earlier versions say, and without.
    for option in ((), ("--arena",)):
        code, out, err = run("export", "results.db", *option, "-o", "arena.db")
        assert (code, f"{len(rows)} runs" in out) == (0, True), err
        assert query(tmp_path / "arena.db", "SELECT count(*) FROM runs") == [(len(rows),)]


def test_the_table_names_its_rule_and_search_and_the_fair_one_shows_k_10(run, tmp_path):
    fair = ("bench", "fair", "--runs", 3, "--only", "fair-balls-2d-50", "--quick", "--jobs", 1)
    code, out, err = run(*fair)
    assert code == 0, err
    assert "rule: k=10 symmetrised · search: connect" in out
    rows = read_rows(tmp_path / "results.db")
    uniform = rows.where(rows.sampler.is_in(["uniform"]) & rows.search.is_in(["connect"]))
    rates = {rule: f"{100 * uniform.solved[uniform.rule.is_in([rule])].mean():.0f}" for rule in rows.rule.present()}
    (n,) = set(rows.n.tolist())
    assert _cells(out, "fair-balls-2d-50", n)["uniform"] == rates["k=10 symmetrised"]


def test_problems_with_different_rules_are_different_tables(run):
    _, out, _ = run("bench", "--only", "maze-1,corridor-2d-0.1", "--runs", 1, "--quick", "--jobs", 1)
    titles = [line.strip() for line in out.splitlines() if line.startswith("Success")]
    assert titles == [
        "Success [%] · rule: k=10 symmetrised · search: connect",
        "Success [%] · rule: k=10 earlier · search: stock",
    ]


def test_list_shows_what_there_is_and_runs_nothing(run, tmp_path):
    code, out, _ = run("bench", "--list")
    assert code == 0
    for word in ("suite paper", "suite fair", "maze-1", "hypercube-legacy6", "halton paper-blocks", "rank-1"):
        assert word in out
    assert not (tmp_path / "results.db").exists()


def test_runs_without_an_answer_are_exit_code_1_until_they_are_tried_again_on_demand(run):
    hopeless = ("bench", "--only", "maze-1", "--runs", 1, "--quick", "--jobs", 1, "--limit", "1e-6")
    code, out, _ = run(*hopeless)
    assert code == 1
    tasks = int(re.search(r"(\d+) tasks run now, \1 of them failures", out)[1])
    # Not solved, and not a dash, which says that there is no such run.
    assert set(_cells(out, "maze-1", 64).values()) == {"0"}
    advice = f"{tasks} without an answer (failed, timeout, lost) count as not solved; --retry runs them again"
    assert advice in out
    for again in (hopeless, hopeless[:-2]):
        code, out, _ = run(*again)
        assert code == 1
        assert f"0 tasks run now, {tasks} found done" in out
        assert advice in out
        assert f"most often, in {tasks} rows: took longer than 1e-06 s" in out
    code, out, _ = run(*hopeless[:-2], "--retry")
    assert (code, "0 found done" in out, "without an answer" in out) == (0, True, False)


def test_rows_that_a_store_could_not_take_are_named_and_taken_in_by_the_same_command(run, monkeypatch, tmp_path):
    def refuse(store):
        raise BrokenFile("results.db: database or disk is full")

    with monkeypatch.context() as change:
        change.setattr("evenroad_studies.bench.store.Store._write", refuse)
        code, _, err = run(*SMALL)
    assert code == 2
    left = int(re.search(r"disk is full; (\d+) finished rows left in results.db.rescue: the next run", err)[1])
    assert len(err.splitlines()) == 1
    code, out, _ = run(*SMALL)
    assert (code, f"{left} found done" in out) == (0, True)
    assert not (tmp_path / "results.db.rescue").exists()


@pytest.mark.parametrize(("arguments", "says"), [
    (("bench", "nonsense"), "unknown suite 'nonsense'; known: apart, arms, fair, paper"),
    (("bench", "--only", "nonsense"), "unknown problem of this suite 'nonsense'; known: chain-10d, "),
    (("bench", "--runs", 0), "runs must be an integer >= 1"),
    (("bench", "--seed", "-1"), "seed must be an integer >= 0"),
    (("bench", "--jobs", 0, "--quick"), "jobs must be an integer >= 1"),
    (("bench", "--limit", 0, *SMALL[2:]), "limit must be a finite number > 0"),
    (("bench", "--limit", "1e300", *SMALL[2:]), "limit must be at most 1e+06 s, got 1e+300"),
    (("bench", "--limit", "60", "--scheduler", "tcp://127.0.0.1:9"), "--limit does not go with --scheduler"),
    (("bench", "--jobs", 2, "--scheduler", "tcp://127.0.0.1:9"), "--jobs does not go with --scheduler"),
    (("bench", "--store", "missing/results.db", *SMALL[2:]), "the folder missing does not exist"),
    (("export", "missing.db", "-o", "arena.db"), "no such store: missing.db"),
])  # fmt: skip
def test_bad_input_is_one_line_and_exit_code_2(run, arguments, says):
    code, _, err = run(*arguments)
    assert code == 2
    assert says in err
    assert err.startswith("evenroad: error: ")
    assert len(err.splitlines()) == 1


def test_a_damaged_store_is_one_line_and_exit_code_2_for_every_verb_that_reads_it(run, tmp_path):
    query(write_store(tmp_path / "results.db", made_up(runs=2)), "UPDATE rows SET valid = valid + 1 WHERE run = 1")
    for verb in (SMALL, ("report", "results.db", "-o", "out"), ("export", "results.db", "-o", "arena.db")):
        code, _, err = run(*verb)
        assert code == 2
        assert err.startswith("evenroad: error: results.db is damaged: the row with the key ")
        assert len(err.splitlines()) == 1


INTERRUPTED = [
    "evenroad: stopping after this step (Ctrl-C again: at once)",
    "evenroad: interrupted; what was finished is kept",
]


def _said(err):
    """Return what was said beside the lines of the progress."""
    return [line for line in err.splitlines() if not line.startswith("bench paper")]


def test_ctrl_c_ends_the_run_after_its_step(run, tmp_path, monkeypatch):
    added, add = [], Store.add

    def add_and_interrupt(store, *row):
        add(store, *row)
        added.append(row)
        if len(added) == 20:
            os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr(Store, "add", add_and_interrupt)
    code, _, err = run(*SMALL)
    assert (code, _said(err)) == (130, INTERRUPTED)
    assert len(read_rows(tmp_path / "results.db")) == len(added)
    assert [each.name for each in tmp_path.iterdir() if each.is_file()] == ["results.db"]


def test_ctrl_c_twice_ends_a_run_of_two_processes_at_once_and_keeps_what_is_finished(tmp_path):
    store = tmp_path / "results.db"
    line = ["bench", "--only", "hypercube-legacy6", "--runs", "200", "--jobs", "2", "--store", "results.db"]
    command = [sys.executable, "-c", "import sys; from evenroad.cli import main; sys.exit(main())", *line]
    quiet = dict(stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
    with subprocess.Popen(command, cwd=tmp_path, **quiet) as process:
        try:
            for _ in range(600):
                if store.exists() and store.stat().st_size > 60_000:
                    break
                time.sleep(0.1)
            for _ in range(2):
                process.send_signal(signal.SIGINT)
                time.sleep(0.05)
            _, err = process.communicate(timeout=60)
        finally:
            process.kill()
    assert (process.returncode, _said(err)) == (130, INTERRUPTED)
    rows = read_rows(store)
    assert len(rows) > 0
    assert set(rows.status.present()) <= {"solved", "not_connected"}
    # The second one may come while rows are being written: these then wait for the next run.
    left = {each.name for each in tmp_path.iterdir() if each.is_file()}
    assert left in ({"results.db"}, {"results.db", "results.db.rescue"})
    with open_store(store):
        pass
    assert len(read_rows(store)) >= len(rows)
    assert [each.name for each in tmp_path.iterdir() if each.is_file()] == ["results.db"]


def test_a_suite_says_that_it_leaves_cells_out_without_the_large_sets(monkeypatch, tmp_path):
    monkeypatch.setattr("evenroad_studies.commands.bench.has_large_sets", lambda: False)
    words = ["bench", "paper", "--only", "nonsense", "--store", str(tmp_path / "a.db")]
    with pytest.warns(UserWarning, match="without the large sets"):
        assert main(words) == 2
