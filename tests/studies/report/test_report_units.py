"""What is independent of what: small pools, grids, blocks under two seeds, sets in random worlds."""

import math

import numpy as np
import pytest

from evenroad_studies.report.cells import cells_of
from evenroad_studies.report.comparisons import comparisons_of
from evenroad_studies.report.fair import pooled
from evenroad_studies.report.sections import expected_table, paired_tables, spread_table, success_table
from evenroad_studies.statistics.rates import mcnemar_exact, student_interval, student_test, wilson
from evenroad_studies.statistics.units import sign_flip_test
from tests.studies.report.stores import analysis_from, from_pool, runs_from, solved, task

HARD, EASY = (0.1,), (0.1, 0.9, 0.9, 0.9)
FRESH = ("",)
STOCK = {"rule": "k=10 earlier", "search": "stock"}


def _found(tmp_path, *rows):
    """Return (cell, comparison with uniform) of the sampler that is not uniform."""
    runs = runs_from(tmp_path / "a.db", [row for part in rows for row in part])
    cells = cells_of(runs)
    (cell,) = [cell for cell in cells if cell.sampler != "uniform"]
    (comparison,) = comparisons_of(runs, cells)
    return cell, comparison


def _uniform(problem, n=128, runs=80, **others):
    return from_pool(problem, "uniform", n, HARD, runs, FRESH, **others)


def test_runs_of_four_permuted_sets_are_independent_given_the_pool(tmp_path):
    problem = "hypercube-legacy6"
    cell, compared = _found(tmp_path, _uniform(problem), from_pool(problem, "mpmc", 128, EASY))
    assert (cell.units.kind, len(cell.units), len(cell.sets), cell.pool_given) == ("runs", 80, 4, True)
    assert (cell.interval.low, cell.interval.high) == wilson(cell.solved, 80)
    assert compared.test == "McNemar"
    assert compared.p == mcnemar_exact(compared.only_cell, compared.only_reference)
    assert compared.significant


@pytest.mark.parametrize(("sets", "test"), [(4, "too few sets to test"), (6, "Fisher over sets")])
def test_runs_of_sets_in_few_dimensions_are_tested_set_by_set_if_there_are_six(tmp_path, sets, test):
    cell, compared = _found(tmp_path, _uniform("maze-1"), from_pool("maze-1", "mpmc", 128, (0.9,) * sets))
    assert (cell.units.kind, len(cell.units), cell.pool_given) == ("sets", sets, False)
    assert compared.test == test
    assert math.isnan(compared.p) == math.isnan(compared.p_corrected) == (sets == 4)
    assert compared.significant == (sets == 6)


def test_what_could_not_be_tested_is_named_and_not_among_what_is_corrected_for(tmp_path):
    analysis = analysis_from(
        tmp_path / "a.db",
        _uniform("maze-1")
        + from_pool("maze-1", "mpmc", 128, EASY)
        + from_pool("maze-1", "korobov", 128, (0.9,), ids=FRESH),
    )
    (table,) = paired_tables(analysis, analysis.runs.settings[0], "name")
    assert "over the 1 comparisons of this setting that were tested; McNemar." in table.notes[0]
    assert table.notes[1] == "mpmc, N = 128: too few sets to test."
    assert [row[1].mark for row in table.rows] == ["", "better"]


def test_the_page_says_which_runs_are_independent_given_the_pool_only(tmp_path):
    problem = "hypercube-legacy6"
    analysis = analysis_from(tmp_path / "a.db", _uniform(problem) + from_pool(problem, "mpmc", 128, EASY))
    setting = analysis.runs.settings[0]
    said = "mpmc: the intervals hold for the sets of the pool; every run permutes the coordinates of one of them."
    assert said in success_table(analysis, setting, "name").notes
    assert said in paired_tables(analysis, setting, "name")[0].notes
    (row,) = spread_table(analysis, setting, "name").rows
    assert [entry.text for entry in row[:4]] == ["mpmc", "128", "4", "80"]


@pytest.mark.parametrize(
    ("problem", "kind"), [("cubicles", "runs"), ("maze-1", "sets"), ("of another version", "sets")]
)
def test_runs_of_the_only_grid_are_independent_where_it_gives_translations_only(tmp_path, problem, kind):
    rows = from_pool(problem, "sukharev", 512, (0.5,), ids=("grid",), **STOCK)
    cell, _ = _found(tmp_path, _uniform(problem, 512, **STOCK), rows)
    assert (cell.units.kind, len(cell.units)) == (kind, 80 if kind == "runs" else 1)
    wide = cell.interval.high - cell.interval.low
    assert wide < 0.25 if kind == "runs" else wide == 1.0


def test_one_block_under_two_seeds_counts_once(tmp_path):
    both = [
        row
        for seed in (1, 2)
        for row in (
            *from_pool("maze-1", "halton paper-blocks", 128, (0.5,), 40, FRESH, rng=7, seed=seed),
            *from_pool("maze-1", "uniform", 128, (0.5,), 40, FRESH, rng=seed, seed=seed),
        )
    ]
    cell, compared = _found(tmp_path, both)
    assert cell.runs == 80
    assert (cell.units.kind, len(cell.units), cell.interval.kind) == ("blocks", 40, "wilson over blocks")
    assert compared.test == "sign flips over blocks"
    (uniform,) = [each for each in cells_of(runs_from(tmp_path / "b.db", both)) if each.sampler == "uniform"]
    assert (uniform.units.kind, len(uniform.units)) == ("runs", 80)


def _in_random_worlds(problem, chances, worlds=30, **others):
    """Return rows of uniform and of a pool, three sets a world: as good as the worlds' average, set by set."""
    rng = np.random.default_rng(3)
    rows = []
    for run in range(3 * worlds):
        where = {"n": 128, "run": run, "instance": run // 3} | others
        which = int(rng.integers(len(chances)))
        rows.append((task(problem, "uniform", **where), solved(bool(rng.random() < 0.5))))
        rows.append((task(problem, "mpmc", **where), solved(bool(rng.random() < chances[which]), set_id=str(which))))
    return rows


def _sums(rows, key_of):
    """Return wins minus losses against uniform, and pairs, by a key of (instance, set)."""
    of_uniform = {each.run: outcome.solved for each, outcome in rows if each.sampler == "uniform"}
    found = {}
    for each, outcome in rows:
        if each.sampler == "mpmc":
            sums = found.setdefault(key_of(each.instance, outcome.set_id), [0, 0])
            sums[0] += int(outcome.solved) - int(of_uniform[each.run])
            sums[1] += 1
    return np.array(list(found.values())).T


def test_random_worlds_take_the_wider_interval_of_worlds_and_sets(tmp_path):
    rows = _in_random_worlds("fair-balls-2d-50", (0.1, 0.9, 0.2, 0.95))
    cell, compared = _found(tmp_path, rows)
    assert (cell.units.kind, len(cell.units), len(cell.sets)) == ("instances", 30, 4)
    by_set = _sums(rows, lambda instance, which: which)
    assert cell.interval.kind == "student over sets"
    assert compared.interval == student_interval(*by_set, "sets")
    assert compared.test == "sign flips over instances, Student over sets"
    assert compared.p == student_test(*by_set) > sign_flip_test(_sums(rows, lambda world, _: world)[0])
    (all_pooled,) = pooled(runs_from(tmp_path / "b.db", rows))["all"]
    assert (all_pooled.interval, all_pooled.p) == (compared.interval, compared.p)
    assert (all_pooled.instances, all_pooled.sets) == (30, 4)


def test_permuted_sets_in_random_worlds_are_as_many_as_the_worlds(tmp_path):
    rows = _in_random_worlds("fair-balls-10d-50", (0.1, 0.9, 0.2, 0.95))
    cell, compared = _found(tmp_path, rows)
    assert cell.interval.kind == "wilson over instances"
    assert compared.test == "sign flips over instances"
    (all_pooled,) = pooled(runs_from(tmp_path / "b.db", rows))["all"]
    assert (all_pooled.interval, all_pooled.sets) == (compared.interval, 4)


def test_sets_are_those_of_their_dimension_and_number_of_points(tmp_path):
    pool = (0.5, 0.4, 0.3, 0.2)
    rows = _in_random_worlds("fair-balls-2d-50", pool) + _in_random_worlds("fair-maze-50", pool)
    rows += _in_random_worlds("fair-balls-3d-50", pool) + _in_random_worlds("fair-balls-2d-50", pool, n=256)
    found = pooled(runs_from(tmp_path / "a.db", rows))
    assert [each.sets for each in found["all"]] == [12]
    assert {each.group: each.sets for each in found["dimension"]} == {"2d": 8, "3d": 4, "maze": 4}


def test_the_only_grid_is_no_pool_in_random_worlds(tmp_path):
    where = "fair-balls-2d-50"
    rows = [
        (task(where, sampler, 256, run, instance=run), solved(run % 3 > 0, set_id=which))
        for run in range(20)
        for sampler, which in (("uniform", ""), ("sukharev", "grid"))
    ]
    cell, compared = _found(tmp_path, rows)
    assert (cell.interval.kind, compared.test) == ("wilson", "McNemar")
    assert [each.sets for each in pooled(runs_from(tmp_path / "b.db", rows))["all"]] == [0]


def test_a_verdict_on_a_few_sets_says_so(tmp_path):
    rows = from_pool("cubicles", "mpmc", 1024, (0.0,) * 4, **STOCK)
    rows += from_pool("hypercube-legacy6", "mpmc", 1024, (0.0,) * 4, **STOCK)
    table, verdicts = analysis_from(tmp_path / "a.db", rows).verdicts["paper"]
    assert [each.expected.problem for each in verdicts if each.word == "differs"] == ["cubicles", "hypercube-legacy6"]
    assert expected_table(table, verdicts).notes[-1].startswith("cubicles mpmc (4 sets at N = 1024): our runs")


def test_a_single_run_is_not_tested(tmp_path):
    rows = from_pool("maze-1", "sukharev", 256, (1.0,), runs=1, ids=("grid",))
    _, compared = _found(tmp_path, _uniform("maze-1", 256), rows)
    assert (compared.test, compared.is_tested, compared.significant) == ("too few runs to test", False, False)
