"""Analysis: everything that a report says, computed once; and verdicts on what was published or measured elsewhere."""

from __future__ import annotations

import math
import tomllib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from evenroad._arrays import Floats
from evenroad._rng import generator
from evenroad_studies.bench.rows import Rows
from evenroad_studies.report.cells import Cell, cells_of
from evenroad_studies.report.comparisons import Comparison, comparisons_of, holm_of_tested
from evenroad_studies.report.fair import LazyChecks, Pooled, lazy_checks, pooled
from evenroad_studies.report.runs import Runs, Setting, runs_of
from evenroad_studies.statistics.rates import fisher_exact
from evenroad_studies.statistics.resampling import DRAWS, SamplesNeeded, resampled_ratios, samples_needed
from evenroad_studies.statistics.units import FEW_UNITS

FOLDER = Path(__file__).parent / "expected"
SOURCES = ("paper", "pinned")
"""Names of the data files."""
SEARCHES = ("lazy", "full", "connect", "stock")
"""Searches of our cells: the last that was run is compared.  All have the same success; ``stock`` stops early, too."""
VERDICT_LEVEL = 0.05
"""Corrected p-value below which two cells differ."""


@dataclass(frozen=True)
class ExpectedCell:
    """One cell of a published or measured table; numbers that the source does not give are NaN, or None for `runs`.

    `success` is in percent; `v` is the mean number of milestones, where `v_counts` says what is counted (``all`` valid
    ones, or ``early``: those added until there was a path) and `v_add` what the source adds for start and goal.  `note`
    is what a reader must know of this cell.
    """

    problem: str
    sampler: str
    rule: str
    n: int
    success: float
    v: float
    v_counts: str
    v_add: int
    runs: int | None = None
    note: str = ""

    @property
    def solved(self) -> int | None:
        """Number of solved runs; None if the source does not give enough to tell it."""
        if self.runs is None or math.isnan(self.success):
            return None
        return round(self.success / 100.0 * self.runs)

    @property
    def v_definition(self) -> str:
        """How `v` is counted, in short: ``all + 2``, ``early + 3``."""
        return f"{self.v_counts} + {self.v_add}"


class ExpectedTable(NamedTuple):
    """All expected cells of one source, in the order of its file."""

    name: str
    title: str
    source: str
    about: str
    cells: tuple[ExpectedCell, ...]


@cache
def load_expected(name: str) -> ExpectedTable:
    """Read one of :data:`SOURCES`."""
    record = tomllib.loads((FOLDER / f"{name}.toml").read_text(encoding="utf-8"))
    cells = tuple(cell for row in record["rows"] for cell in _cells_of(row))
    return ExpectedTable(record["name"], record["title"], record["source"], record["about"], cells)


def _cells_of(row: dict[str, Any]) -> list[ExpectedCell]:
    """Return the cells of a row of a data file, which lists `n` and, in the same order, its numbers."""
    columns = (row["n"], row["success"], row.get("v", [math.nan] * len(row["n"])))
    shared = {key: value for key, value in row.items() if key not in ("n", "success", "v", "v_sd")}
    return [
        ExpectedCell(n=n, success=float(success), v=float(v), **shared) for n, success, v in zip(*columns, strict=True)
    ]


@dataclass(frozen=True)
class Verdict:
    """An expected cell beside ours, None if the store has no such runs.

    `p` is of Fisher's exact test on the counts, `p_corrected` the same after Holm's correction over all tested cells of
    the source; NaN if there is nothing to test.
    """

    expected: ExpectedCell
    ours: Cell | None
    p: float
    p_corrected: float

    @property
    def word(self) -> str:
        """``agrees``, ``differs``, ``not run`` or ``no count``."""
        if self.ours is None:
            return "not run"
        if math.isnan(self.p):
            return "no count"
        return "differs" if self.p_corrected < VERDICT_LEVEL else "agrees"

    @property
    def our_v(self) -> float:
        """Our mean number of milestones, counted as the expected cell counts; NaN without runs."""
        if self.ours is None:
            return math.nan
        mean = self.ours.mean_valid if self.expected.v_counts == "all" else self.ours.mean_early
        return mean + self.expected.v_add


def verdicts_of(table: ExpectedTable, cells: Sequence[Cell]) -> tuple[Verdict, ...]:
    """Compare every expected cell with ours; runs that share sets of a pool are taken for independent, too readily."""
    ours = {
        (cell.setting.problem, cell.sampler, cell.setting.rule, cell.n): cell
        for search in SEARCHES
        for cell in cells
        if cell.setting.search == search
    }
    found = [ours.get((each.problem, each.sampler, each.rule, each.n)) for each in table.cells]
    p_values = [_p_value(expected, cell) for expected, cell in zip(table.cells, found, strict=True)]
    corrected = holm_of_tested(p_values).tolist()
    return tuple(map(Verdict, table.cells, found, p_values, corrected))


def _p_value(expected: ExpectedCell, cell: Cell | None) -> float:
    if cell is None or expected.solved is None or expected.runs is None:
        return math.nan
    return fisher_exact((expected.solved, expected.runs), (cell.solved, cell.runs))


class Failure(NamedTuple):
    """Runs of one problem, sampler and rule that failed alike."""

    problem: str
    sampler: str
    rule: str
    status: str
    message: str
    runs: int


def failures_of(rows: Rows) -> tuple[Failure, ...]:
    """Count the failures by kind; the most frequent kind comes first."""
    counted: Counter[tuple[str, str, str, str, str]] = Counter()
    for row in np.flatnonzero(~rows.answered).tolist():
        last_line = (rows.error[row].strip().splitlines() or [""])[-1].strip()
        counted[rows.problem[row], rows.sampler[row], rows.rule[row], rows.status[row], last_line] += 1
    found = [Failure(*key, runs) for key, runs in counted.items()]
    return tuple(sorted(found, key=lambda each: (-each.runs, each.problem, each.sampler, each.message)))


def needed_of(cells: Sequence[Cell]) -> dict[tuple[Setting, str], SamplesNeeded]:
    """Return for every setting and sampler the number of samples at which 90 % of the runs succeed.

    It has an interval if every cell of the curve has at least 10 units.
    """
    curves: dict[tuple[Setting, str], list[Cell]] = {}
    for cell in cells:
        curves.setdefault((cell.setting, cell.sampler), []).append(cell)
    found = {}
    for key, curve in curves.items():
        resampled = resampled_rates(curve) if min(len(cell.units) for cell in curve) >= FEW_UNITS else None
        rates, runs = [cell.rate for cell in curve], [cell.runs for cell in curve]
        found[key] = samples_needed([cell.n for cell in curve], rates, resampled, runs)
    return found


def resampled_rates(curve: Sequence[Cell]) -> Floats:
    """Return bootstrap resamples of the success rates of a curve's cells, shape (draws, cells).

    A unit is resampled for all numbers of samples together, since its results at different numbers are related: one
    generator draws all sets of a run, and the first points of a larger set may be the smaller set.  If all units of a
    cell have the same result a bootstrap has no width; there, rates are drawn from Jeffreys' posterior, a beta
    distribution, with one run for each unit.
    """
    labels, place = np.unique(np.concatenate([cell.units.unit for cell in curve]), return_inverse=True)
    column = np.repeat(np.arange(len(curve)), [len(cell.units) for cell in curve])
    solved, runs = np.zeros((2, len(labels), len(curve)))
    solved[place, column] = np.concatenate([cell.units.solved for cell in curve])
    runs[place, column] = np.concatenate([cell.units.runs for cell in curve])
    rates = resampled_ratios(solved, runs)
    for number, cell in enumerate(curve):
        shares = cell.units.solved / cell.units.runs
        if np.all(shares == shares[0]):
            units, yes = len(shares), len(shares) * float(shares[0])
            # Seeded by the number of samples, so that two cells of one curve do not go in step.
            rates[:, number] = generator(cell.n).beta(yes + 0.5, units - yes + 0.5, size=DRAWS)
    return rates


@dataclass(frozen=True)
class Analysis:
    """All results of a store; cells in the order of settings, samplers and numbers of samples.

    `verdicts` has, for each source with a cell that the store has runs for, its table and the verdicts; `pooled` is
    empty without a fair suite.
    """

    runs: Runs
    cells: tuple[Cell, ...]
    comparisons: tuple[Comparison, ...]
    needed: dict[tuple[Setting, str], SamplesNeeded]
    verdicts: dict[str, tuple[ExpectedTable, tuple[Verdict, ...]]]
    pooled: dict[str, tuple[Pooled, ...]]
    lazy: tuple[LazyChecks, ...]
    failures: tuple[Failure, ...]

    def cells_of(self, setting: Setting) -> tuple[Cell, ...]:
        """Return the cells of one setting."""
        return tuple(cell for cell in self.cells if cell.setting == setting)


def analyse(rows: Rows) -> Analysis:
    """Count, compare and test everything in a store's rows."""
    runs = runs_of(rows)
    cells = cells_of(runs)
    return Analysis(
        runs=runs,
        cells=cells,
        comparisons=comparisons_of(runs, cells),
        needed=needed_of(cells),
        verdicts=_verdicts(cells),
        pooled=pooled(runs),
        lazy=lazy_checks(runs),
        failures=failures_of(rows),
    )


def _verdicts(cells: tuple[Cell, ...]) -> dict[str, tuple[ExpectedTable, tuple[Verdict, ...]]]:
    tables = {name: load_expected(name) for name in SOURCES}
    found = {name: (table, verdicts_of(table, cells)) for name, table in tables.items()}
    return {name: each for name, each in found.items() if any(verdict.ours for verdict in each[1])}
