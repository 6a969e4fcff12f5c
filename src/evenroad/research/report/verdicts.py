"""Verdicts: do our results agree with what was published or measured elsewhere?"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from evenroad.research.report.cells import Cell
from evenroad.research.report.comparisons import holm_of_tested
from evenroad.research.statistics.rates import fisher_exact

FOLDER = Path(__file__).parent / "expected"
SOURCES = ("paper", "pinned")
"""Names of the data files."""
SEARCHES = ("lazy", "full", "connect", "stock")
"""Searches of our cells: the last that was run is compared.  All have the same success; ``stock`` stops early, too."""
LEVEL = 0.05
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
        ExpectedCell(n=n, success=float(success), v=float(v), **shared)
        for n, success, v in zip(*columns, strict=True)
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
        return "differs" if self.p_corrected < LEVEL else "agrees"

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
