"""From rows to cells, comparisons, verdicts and the pooled fair suite, against slow counting."""

import math

import numpy as np
import pytest

from evenroad_studies.bench.store import read_rows
from evenroad_studies.bench.task import Outcome
from evenroad_studies.report import runs as module
from evenroad_studies.report.analysis import analyse, load_expected, needed_of, verdicts_of
from evenroad_studies.report.cells import cells_of
from evenroad_studies.report.comparisons import comparisons_of
from evenroad_studies.report.fair import pooled
from evenroad_studies.report.runs import combined, first_rows, natural_key
from evenroad_studies.statistics.rates import bonett_price, fisher_exact, holm, mcnemar_exact, wilson
from tests.studies.report.stores import made_up, runs_from, solved, task, write_store

LEGACY = {"rule": "k=10 earlier", "search": "stock"}


@pytest.fixture(scope="module")
def rows():
    return made_up(runs=30)


@pytest.fixture(scope="module")
def runs(rows, tmp_path_factory):
    return runs_from(tmp_path_factory.mktemp("store") / "a.db", rows)


@pytest.fixture(scope="module")
def cells(runs):
    return cells_of(runs)


def test_a_cell_counts_what_a_loop_counts(rows, cells):
    assert len(cells) == 12
    for cell in cells:
        mine = [outcome for each, outcome in rows if (each.sampler, each.n) == (cell.sampler, cell.n)]
        assert (cell.runs, cell.solved) == (len(mine), sum(each.solved for each in mine))
        assert cell.mean_valid == pytest.approx(np.mean([each.valid for each in mine]))
        assert cell.sd_valid == pytest.approx(np.std([each.valid for each in mine], ddof=1))
        assert cell.mean_edges == pytest.approx(np.mean([each.edges_checked for each in mine]))
        assert cell.mean_seconds == pytest.approx(np.mean([each.seconds for each in mine]))


def test_samplers_drawn_afresh_get_wilsons_interval_and_pools_one_over_sets(cells):
    for cell in cells:
        if cell.sampler == "hickernell":
            assert cell.interval.kind == "wilson over sets"
            assert cell.units.runs.sum() == cell.runs
            assert cell.units.solved.sum() == cell.solved
        else:
            low, high = wilson(cell.solved, cell.runs)
            assert (cell.interval.low, cell.interval.high, cell.interval.kind) == (low, high, "wilson")


def test_sets_that_were_drawn_once_each_are_independent_runs(tmp_path):
    rows = [(task(sampler="hickernell", run=run), solved(run % 3 > 0, set_id=str(run))) for run in range(12)]
    (cell,) = cells_of(runs_from(tmp_path / "a.db", rows))
    assert cell.interval.kind == "wilson"


def test_failures_are_runs_that_were_not_solved_and_have_no_means(tmp_path):
    rows = [
        (task(run=0), solved(valid=40)),
        (task(run=1), Outcome("failed", error="boom")),
        (task(run=2), Outcome("lost")),
    ]
    (cell,) = cells_of(runs_from(tmp_path / "a.db", rows))
    assert (cell.runs, cell.solved, cell.failures) == (3, 1, 2)
    assert cell.mean_valid == 40
    assert math.isnan(cell.sd_valid)


def test_early_milestones_are_those_at_the_solution_where_there_was_one(tmp_path):
    rows = [
        (task(run=0, **LEGACY), solved(valid=100, valid_at_solution=0)),
        (task(run=1, **LEGACY), solved(False, valid=80)),
    ]
    (cell,) = cells_of(runs_from(tmp_path / "a.db", rows))
    assert (cell.mean_valid, cell.mean_early) == (90, 40)


def test_mcnemars_test_is_over_the_same_runs(rows, runs, cells):
    found = comparisons_of(runs, cells)
    of = {(each.sampler, each.n, each.run): outcome.solved for each, outcome in rows}
    for each in found:
        sampler, n = each.cell.sampler, each.cell.n
        pairs = [(of[sampler, n, run], of[each.reference, n, run]) for run in range(30)]
        assert each.pairs == 30
        assert each.only_cell == sum(a and not b for a, b in pairs)
        assert each.only_reference == sum(b and not a for a, b in pairs)
        if each.test == "McNemar":
            assert each.p == mcnemar_exact(each.only_cell, each.only_reference)
            assert each.interval == bonett_price(each.only_cell, each.only_reference, 30)
        assert each.interval.low <= each.difference <= each.interval.high
    assert [each.p_corrected for each in found] == pytest.approx(holm([each.p for each in found]).tolist())


def test_each_pair_of_samplers_is_tested_once(runs, cells):
    pairs = [
        frozenset((each.cell.sampler, each.reference)) for each in comparisons_of(runs, cells) if each.cell.n == 128
    ]
    assert len(pairs) == len(set(pairs)) == 3 + 2


def test_runs_without_a_counterpart_are_left_out(tmp_path):
    rows = [(task(sampler="uniform", run=run), solved(False)) for run in range(5)]
    rows += [(task(sampler="lattice", run=run), solved()) for run in range(3, 20)]
    rows += [(task(sampler="lattice", run=run, seed=1), solved()) for run in range(3)]
    runs = runs_from(tmp_path / "a.db", rows)
    (only,) = comparisons_of(runs, cells_of(runs))
    assert (only.pairs, only.only_cell) == (2, 2)


def test_holms_family_is_one_setting(tmp_path):
    rows = made_up("maze-1", runs=10) + made_up("maze-2", runs=10)
    runs = runs_from(tmp_path / "a.db", rows)
    found = comparisons_of(runs, cells_of(runs))
    mine = [each for each in found if each.cell.setting.problem == "maze-2"]
    assert [each.p_corrected for each in mine] == pytest.approx(holm([each.p for each in mine]).tolist())


def test_samples_needed_are_found_for_every_curve(cells):
    needed = needed_of(cells)
    assert {sampler for _, sampler in needed} == {"uniform", "halton scrambled", "halton paper-blocks", "hickernell"}
    for each in needed.values():
        assert each.low <= each.estimate <= each.high
        assert (each.smallest, each.largest) == (128, 512)


def test_the_papers_table_has_all_its_cells_as_counts():
    cells = load_expected("paper").cells
    assert len(cells) == 7 * 3 * 4
    assert all(each.solved is not None for each in cells)
    percent = [100 * each.solved / each.runs for each in cells]
    # Printed without digits: of 16 runs the whole percentages are rounded, of 50 they are exact.
    assert percent == pytest.approx([each.success for each in cells], abs=0.5)
    mpmc = [each.solved for each in cells if (each.problem, each.sampler) == ("ur5-c", "mpmc")]
    assert mpmc == [1, 5, 12, 13]


def test_the_papers_own_counts_tell_two_comparisons_apart():
    """But for two corridors and the arm, at p < .05: R^10, 512 samples against Halton, 1024 against uniform."""
    table = {(each.problem, each.sampler, each.n): (each.solved, each.runs) for each in load_expected("paper").cells}
    told_apart = {
        (problem, n, other)
        for (problem, sampler, n), ours in table.items()
        for other in ("uniform", "halton paper-blocks")
        if sampler == "mpmc" and not problem.startswith(("corridor", "ur5"))
        if fisher_exact(ours, table[problem, other, n]) < 0.05
    }
    assert told_apart == {("hypercube-legacy6", 512, "halton paper-blocks"), ("hypercube-legacy6", 1024, "uniform")}


def test_verdicts_agree_where_counts_agree_and_differ_where_they_cannot(tmp_path):
    rows = []
    for n, of_200 in ((128, 2), (256, 23), (512, 10)):
        for run in range(200):
            rows.append((task("hypercube-legacy6", "uniform", n, run, **LEGACY), solved(run < of_200, valid=15)))
    cells = cells_of(runs_from(tmp_path / "a.db", rows))
    verdicts = {
        (each.expected.sampler, each.expected.n): each
        for each in verdicts_of(load_expected("pinned"), cells)
        if each.expected.problem == "hypercube-legacy6"
    }
    words = [verdicts["uniform", n].word for n in (128, 256, 512, 1024)]
    assert words == ["agrees", "agrees", "differs", "not run"]
    tested = [
        fisher_exact((24, 2000), (2, 200)),
        fisher_exact((228, 2000), (23, 200)),
        fisher_exact((1056, 2000), (10, 200)),
    ]
    assert [verdicts["uniform", n].p_corrected for n in (128, 256, 512)] == pytest.approx(holm(tested).tolist())
    assert verdicts["uniform", 128].our_v == 17
    assert math.isnan(verdicts["uniform", 1024].our_v)


def test_a_row_without_a_number_of_runs_is_not_tested_nor_one_of_another_rule(tmp_path):
    cells = cells_of(runs_from(tmp_path / "a.db", [(task("corridor-2d-0.1", **LEGACY), solved())]))
    words = {
        each.expected.n: each.word
        for each in verdicts_of(load_expected("pinned"), cells)
        if each.expected.problem == "corridor-2d-0.1"
    }
    assert words == {128: "no count", 256: "not run", 512: "not run", 1024: "not run"}
    cells = cells_of(runs_from(tmp_path / "b.db", [(task("chain-10d", rule="k=10 symmetrised"), solved())]))
    assert {each.word for each in verdicts_of(load_expected("paper"), cells)} == {"not run"}


def test_the_search_that_stops_early_speaks_for_a_cell(tmp_path):
    rows = [
        (task("chain-10d", rule="k=10 earlier", search=search), solved(valid=30, valid_at_solution=at))
        for search, at in (("connect", None), ("stock", 7))
    ]
    cells = cells_of(runs_from(tmp_path / "a.db", rows))
    (mine,) = [each for each in verdicts_of(load_expected("paper"), cells) if each.ours is not None]
    assert mine.our_v == 10


def _fair_rows():
    rng = np.random.default_rng(4)
    rows = []
    for problem, worlds in (("fair-balls-2d-50", 12), ("fair-boxes-10d-25", 15), ("fair-maze-75", 11)):
        for rule in ("k=4 symmetrised", "k=10 symmetrised"):
            for run in range(3 * worlds):
                where = {"run": run, "instance": run // 3, "rule": rule, "n": 256}
                rows.append((task(problem, "uniform", **where), solved(rng.random() < 0.4)))
                rows.append((task(problem, "lattice", **where), solved(rng.random() < 0.7)))
                if problem != "fair-boxes-10d-25":
                    rows.append((task(problem, "mpmc", **where), solved(rng.random() < 0.5, set_id=str(run % 7))))
    return rows


def test_the_fair_suite_is_pooled_over_the_same_worlds(tmp_path):
    rows = _fair_rows()
    runs = runs_from(tmp_path / "a.db", rows)
    of = {(each.problem, each.sampler, each.rule, each.run): outcome.solved for each, outcome in rows}
    found = {(each.group, each.sampler): each for each in pooled(runs)["rule"]}
    assert set(found) == {(f"k={k} symmetrised, connect", sampler) for k in (4, 10) for sampler in ("lattice", "mpmc")}
    for (group, sampler), each in found.items():
        mine = [key for key in of if key[1] == sampler and group.startswith(key[2])]
        theirs = [of[problem, "uniform", rule, run] for problem, _, rule, run in mine]
        assert each.pairs == len(mine)
        assert each.instances == len({(problem, run // 3) for problem, _, _, run in mine})
        assert each.rate == pytest.approx(np.mean([of[key] for key in mine]))
        assert each.reference_rate == pytest.approx(np.mean(theirs))
        assert each.sets == (7 if sampler == "mpmc" else 0)
        assert sampler == "mpmc" or each.interval.kind == "paired bootstrap over instances"
    assert found["k=4 symmetrised, connect", "mpmc"].instances == 12 + 11


def test_pools_are_by_generator_dimension_and_difficulty_of_the_name(tmp_path):
    runs = runs_from(tmp_path / "a.db", _fair_rows())
    groups = {
        by: list(dict.fromkeys(each.group for each in pooled(runs)[by]))
        for by in ("generator", "dimension", "difficulty")
    }
    assert groups == {
        "generator": ["balls", "boxes", "maze"],
        "dimension": ["2d", "10d", "maze"],
        "difficulty": ["25 %", "50 %", "75 %"],
    }


def test_a_store_without_a_fair_suite_has_none(runs):
    assert pooled(runs) == {}


def test_numbers_in_names_sort_as_numbers():
    assert sorted(["10d", "2d", "k=10 x", "k=4 x"], key=natural_key) == ["2d", "10d", "k=4 x", "k=10 x"]


def test_codes_are_equal_where_all_columns_are_by_table_and_by_sorting(monkeypatch):
    a, b = np.array([2, 2, 1, 2, 1]), np.array([9, 7, 9, 9, 7])
    assert combined(a, b).tolist() == [3, 2, 1, 3, 0]
    large = np.array([2**62, 3, 3])
    assert combined(np.array([5, 7, 5]), large, large).tolist() == [1, 2, 0]
    columns = np.random.default_rng(0).integers(-5, 40, size=(3, 500))
    by_table = combined(*columns)
    monkeypatch.setattr(module, "TABLE_LIMIT", 0)
    assert np.array_equal(combined(*columns), by_table)
    assert np.array_equal(first_rows(by_table), np.unique(by_table, return_index=True)[1])


def test_an_empty_store_is_analysed_to_nothing(tmp_path):
    analysis = analyse(read_rows(write_store(tmp_path / "a.db", [])))
    assert (analysis.cells, analysis.comparisons, analysis.failures, analysis.pooled) == ((), (), (), {})
