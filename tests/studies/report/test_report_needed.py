"""Samples for 90 %: how sure, and who is named."""

import math

import numpy as np
import pytest

from evenroad_studies.commands.report import _fewest
from evenroad_studies.report.analysis import needed_of, resampled_rates
from evenroad_studies.report.cells import cells_of
from evenroad_studies.report.sections import success_table
from tests.studies.report.stores import analysis_from, from_pool, runs_from, solved, task

FRESH = ("",)


def _curve(sampler, chances, counts=(128, 256, 512), runs=60, ids=FRESH):
    return [
        row
        for n, chance in zip(counts, chances, strict=True)
        for row in from_pool("maze-1", sampler, n, (chance,) * len(ids), runs, ids, rng=n)
    ]


def test_a_grid_of_one_run_for_each_number_of_samples_has_no_interval_and_does_not_win(tmp_path):
    rows = _curve("sukharev", (0, 0, 1), counts=(64, 256, 1024), runs=1, ids=("grid",))
    rows += _curve("uniform", (0.1, 0.5, 1.0), counts=(64, 256, 1024))
    analysis = analysis_from(tmp_path / "a.db", rows)
    (setting,) = analysis.runs.settings
    alone = analysis.needed[setting, "sukharev"]
    assert not alone.has_interval
    assert str(alone) == "891 [–]"
    assert _fewest(analysis, setting).endswith(": uniform")
    table = success_table(analysis, setting, "name")
    assert table.rows[-1][-1].text == "891 [–]"
    assert any(note.startswith("[–]: fewer than 10 runs") for note in table.notes)


def test_pools_of_few_sets_have_no_interval_and_sixteen_that_all_solve_leave_some_doubt(tmp_path):
    rows = _curve("mpmc", (0, 0, 1), ids=("0", "1", "2", "3"))
    (needed,) = needed_of(cells_of(runs_from(tmp_path / "a.db", rows))).values()
    assert math.isnan(needed.low)
    assert math.isnan(needed.high)
    ids = tuple(str(each) for each in range(16))
    rows = _curve("mpmc", (0, 1, 1), runs=160, ids=ids)
    (needed,) = needed_of(cells_of(runs_from(tmp_path / "b.db", rows))).values()
    assert needed.low < needed.estimate < needed.high
    assert needed.high > 256


def test_only_samplers_with_all_cells_and_an_interval_are_compared(tmp_path):
    rows = _curve("uniform", (0.1, 0.5, 0.95)) + _curve("lattice", (1.0, 1.0), counts=(256, 512))
    analysis = analysis_from(tmp_path / "a.db", rows)
    assert _fewest(analysis, analysis.runs.settings[0]).endswith(": uniform")
    analysis = analysis_from(tmp_path / "b.db", _curve("uniform", (1, 1, 1), runs=9))
    assert _fewest(analysis, analysis.runs.settings[0]) == "–"


def test_runs_are_resampled_together_for_all_numbers_of_samples(tmp_path):
    """The second cell fails where the first does, and once more: so in every resample."""
    rows = []
    for run in range(50):
        rows.append((task(n=128, run=run), solved(run % 2 == 0)))
        rows.append((task(n=256, run=run), solved(run % 2 == 0 and run > 0)))
        rows.append((task(n=512, run=run), solved(run % 2 == 1)))
    curve = cells_of(runs_from(tmp_path / "a.db", rows))
    rates = resampled_rates(curve)
    assert np.all(rates[:, 1] <= rates[:, 0])
    assert rates[:, 0] + rates[:, 2] == pytest.approx(1.0)
    assert rates[:, 0].std() == pytest.approx(0.5 / np.sqrt(50), rel=0.06)


def test_cells_may_have_other_numbers_of_runs(tmp_path):
    rows = _curve("uniform", (0.3,), counts=(128,), runs=200) + _curve("uniform", (0.8,), counts=(256,), runs=12)
    curve = cells_of(runs_from(tmp_path / "a.db", rows))
    rates = resampled_rates(curve)
    assert np.isfinite(rates).all()
    for column, cell in zip(rates.T, curve, strict=True):
        assert column.mean() == pytest.approx(cell.rate, abs=0.02)
        assert column.std() == pytest.approx(np.sqrt(cell.rate * (1 - cell.rate) / cell.runs), rel=0.15)
