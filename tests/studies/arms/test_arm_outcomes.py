"""What ways of planning solved, kept in one small file, and the tables of the pages that are made of it."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from studies.benchmarks.arm_tables import PAGES, all_tables, with_tables

from evenroad._npz import digest
from evenroad.errors import BrokenFile, InvalidValue
from evenroad_studies.arms.outcomes import Way, outcomes_of, paired, read_outcomes, write_outcomes
from evenroad_studies.arms.results import HEADER, csv_of, lines_of
from evenroad_studies.bench.store import open_store, read_rows
from evenroad_studies.bench.task import Outcome, Task
from tests.refused import refused

DOCS = Path(__file__).parents[3] / "studies" / "docs"
TASK = Task("arm-scara-shelf", 0, "uniform", 64, "k=10 ends=64", "kept", 0, 1)
UNIFORM = Way("scara", "10", 64, "uniform", "k=10 ends=64", "kept")


def _outcomes(path, runs):
    """Return the outcomes of (task, outcome)."""
    with open_store(path) as store:
        for task, outcome in runs:
            store.add("arms", task, outcome, "here")
    return outcomes_of(read_rows(path))


def _answer(solved, valid=0):
    return Outcome("solved" if solved else "not_connected", valid=valid, edges_checked=2 * valid, seconds=0.5)


def _random_runs(seed=0):
    """Return made-up runs of two samplers, of which a third is missing."""
    rng = np.random.default_rng(seed)
    return [
        (replace(TASK, problem=f"arm-scara-{kind}", instance=i, sampler=sampler, run=run, seed=s), solved)
        for sampler in ("uniform", "roadmap")
        for kind in ("cage", "shelf")
        for i in range(7)
        for run in range(3)
        for s in (1, 5)
        for solved in [bool(rng.random() < 0.5)]
        if rng.random() < 0.67
    ]


def test_every_run_has_its_place_by_problem_and_draw(tmp_path):
    other = replace(TASK, problem="arm-scara-cage", instance=5, run=2)
    runs = [(TASK, _answer(True)), (replace(TASK, run=2), _answer(False)), (other, _answer(True))]
    outcomes = _outcomes(tmp_path / "a.db", runs)
    assert list(outcomes) == [UNIFORM]
    found = outcomes[UNIFORM]
    assert found.problems.tolist() == [[0, 0], [4, 5]]
    assert found.draws.tolist() == [[1, 0], [1, 2]]
    assert found.ran.tolist() == [[True, True], [False, True]]
    assert found.solved.tolist() == [[True, False], [False, True]]


def test_costs_are_medians_over_answers_by_generator_and_over_all(tmp_path):
    runs = [(replace(TASK, run=run), _answer(False, valid)) for run, valid in enumerate((1, 2, 9))]
    runs += [(replace(TASK, problem="arm-scara-cage"), _answer(True, 30))]
    runs += [(replace(TASK, problem="arm-scara-cage", run=1), Outcome("timeout", error="too long"))]
    costs = _outcomes(tmp_path / "a.db", runs)[UNIFORM].costs
    assert costs[0].tolist() == [2.0, 4.0, 500.0]
    assert costs[4].tolist() == [30.0, 60.0, 500.0]
    assert costs[5].tolist() == [5.5, 11.0, 500.0]
    assert np.isnan(costs[1:4]).all()


def test_pairs_are_the_runs_that_both_ways_have(tmp_path):
    runs = _random_runs()
    outcomes = _outcomes(tmp_path / "a.db", [(task, _answer(solved)) for task, solved in runs])
    solved = {(t.sampler, t.problem, t.instance, t.run, t.seed): yes for t, yes in runs}
    more, pairs = {}, {}
    for (sampler, *rest), yes in solved.items():
        if sampler == "roadmap" and ("uniform", *rest) in solved:
            unit = tuple(rest[:2])
            more[unit] = more.get(unit, 0) + yes - solved["uniform", *rest]
            pairs[unit] = pairs.get(unit, 0) + 1
    found = paired(outcomes[UNIFORM._replace(sampler="roadmap")], outcomes[UNIFORM])
    units = sorted(more, key=lambda unit: (unit[0] == "arm-scara-cage", unit[1]))
    assert found.generator.tolist() == [4 * (problem == "arm-scara-cage") for problem, _ in units]
    assert found.more.tolist() == [more[unit] for unit in units]
    assert found.pairs.tolist() == [pairs[unit] for unit in units]


def test_rows_of_other_suites_are_passed_over(tmp_path):
    maze = replace(TASK, problem="maze-1")
    assert list(_outcomes(tmp_path / "a.db", [(maze, _answer(True)), (TASK, _answer(True))])) == [UNIFORM]
    assert _outcomes(tmp_path / "b.db", [(maze, _answer(True))]) == {}
    assert lines_of({}) == ()
    refused(InvalidValue, "no runs", write_outcomes, tmp_path / "o.npz", {})


def test_outcomes_come_back_as_they_were_written(tmp_path):
    runs = _random_runs()
    outcomes = _outcomes(tmp_path / "a.db", [(task, _answer(solved)) for task, solved in runs])
    # Other draws, more than eight of them, and the largest seed.
    more = [(replace(TASK, sampler="even", run=run, seed=2**32 - 1), _answer(run % 2 == 0)) for run in range(20)]
    outcomes |= _outcomes(tmp_path / "b.db", more)
    write_outcomes(tmp_path / "o.npz", outcomes)
    again = read_outcomes(tmp_path / "o.npz")
    assert list(again) == list(outcomes)
    for way, each in outcomes.items():
        back = again[way]
        np.testing.assert_array_equal(back.problems, each.problems)
        np.testing.assert_array_equal(back.costs, each.costs)
        # Draws that only others have did not run.
        at = [back.draws.tolist().index(draw) for draw in each.draws.tolist()]
        np.testing.assert_array_equal(back.ran[:, at], each.ran)
        np.testing.assert_array_equal(back.solved[:, at], each.solved)
        assert back.ran.sum() == each.ran.sum()
    assert str(lines_of(again)) == str(lines_of(outcomes))


def test_the_two_streams_of_problems_are_kept_apart(tmp_path):
    tuning = replace(TASK, problem="tune-arm-scara-shelf")
    outcomes = _outcomes(tmp_path / "a.db", [(TASK, _answer(True)), (tuning, _answer(False))])
    assert [way.robot for way in outcomes] == ["scara", "scara (tune)"]
    assert [each.solved.tolist() for each in outcomes.values()] == [[[True]], [[False]]]


def _written(tmp_path, **changed):
    """Write a file of two ways, with arrays that are something else, and the hash that fits them."""
    path = tmp_path / "o.npz"
    runs = [(replace(TASK, sampler=s, instance=i), _answer(i > 0)) for s in ("even", "uniform") for i in range(2)]
    write_outcomes(path, _outcomes(tmp_path / "a.db", runs))
    with np.load(path) as archive:
        arrays = dict(archive)
    del arrays["hash"]
    for name, change in changed.items():
        arrays[name] = np.asarray(change(arrays[name]))
    np.savez(path, **arrays, hash=np.array(digest(arrays)))
    return path


WRONG = [
    ("protocol", lambda a: a + 1, ""),
    ("generators", lambda a: a[::-1], ""),
    ("ways", lambda a: np.array([a[0], a[0]]), ""),
    ("ways", lambda ways: ways[:, :5], "ways"),
    ("ways", lambda ways: np.array("ways"), "ways"),
    ("ways", lambda ways: np.char.replace(ways, "64", "many"), "ways"),
    ("ways", lambda ways: np.zeros((2, 6), dtype=np.int64), "ways"),
    ("sizes", lambda a: np.array([-1, 5]), ""),
    ("problems", lambda a: a[::-1], ""),
    ("problems", lambda a: a + np.array([9, 0]), "a generator that is none"),
    ("draws", lambda a: np.array(1), ""),
    ("draws", lambda a: np.repeat(a, 2, axis=0), "draws out of order"),
    ("solved", lambda a: a.astype(np.int64), ""),
    ("ran", np.zeros_like, ""),
    ("costs", lambda a: -a, ""),
]


@pytest.mark.parametrize(("name", "change", "says"), WRONG)
def test_a_file_of_outcomes_that_cannot_be_is_refused(tmp_path, name, change, says):
    refused(BrokenFile, rf"o\.npz.*{says}", read_outcomes, _written(tmp_path, **{name: change}))


@pytest.mark.parametrize("harm", ["cut", "flipped", "other"])
def test_a_damaged_file_of_outcomes_is_refused(tmp_path, harm):
    path = _written(tmp_path)
    if harm == "cut":
        path.write_bytes(path.read_bytes()[:-40])
    elif harm == "other":
        np.savez(path, points=np.zeros((2, 2)))
    else:
        with np.load(path) as archive:
            arrays = dict(archive)
        np.savez(path, **(arrays | {"solved": ~arrays["solved"]}))
    refused(BrokenFile, r"o\.npz", read_outcomes, path)


def test_the_tables_of_the_pages_are_those_of_the_kept_outcomes():
    outcomes = read_outcomes(DOCS / "data" / "arms_solved.npz")
    assert {len(each.problems) for each in outcomes.values()} == {1500}
    lines = lines_of(outcomes)
    tables = all_tables(outcomes, lines)
    for name in PAGES:
        page = (DOCS / name).read_text()
        assert page.count("<!-- table") > 1
        assert with_tables(page, tables) == page
    with (DOCS / "data" / "arms.csv").open(newline="") as file:
        header, *kept = csv.reader(file)
    assert header == list(HEADER)
    for texts, values in zip(kept, csv_of(lines), strict=True):
        assert texts[:9] == [str(value) for value in values[:9]]
        # Last bits are another processor's.
        numbers = [float(text or "nan") for text in texts[9:]]
        np.testing.assert_allclose(numbers, values[9:], rtol=1e-9, atol=1e-12)
