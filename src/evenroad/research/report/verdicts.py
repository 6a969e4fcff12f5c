"""Verdicts: do our results agree with what was published or measured elsewhere?"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from evenroad.errors import UnknownName
from evenroad.research.report.cells import Cell
from evenroad.research.statistics import fisher_exact, holm

FOLDER = Path(__file__).parent / "expected"
SOURCES = ("paper", "pinned")
"""Names of the data files."""


@dataclass(frozen=True)
class ExpectedCell:
    """One cell of a published or measured table.

    Attributes
    ----------
    problem, sampler, rule, n
        Which of our cells it is held against.
    success : float
        Success rate as given, in percent; NaN where none is given.
    runs : int or None
        Runs behind it; None where the source does not say, and then there is nothing to test.
    v, v_sd : float
        Mean number of milestones and its standard deviation over runs; NaN where not given.
    v_counts : str
        ``all`` valid ones among the n points, or ``early``: those added until there was a path.
    v_add : int
        What the source adds for start and goal.
    note : str
        What a reader must know of this row.
    """

    problem: str
    sampler: str
    rule: str
    n: int
    success: float
    runs: int | None
    v: float
    v_sd: float
    v_counts: str
    v_add: int
    note: str

    @property
    def solved(self) -> int | None:
        """Number of solved runs, where the source lets one tell it."""
        if self.runs is None or math.isnan(self.success):
            return None
        return round(self.success / 100.0 * self.runs)

    @property
    def v_definition(self) -> str:
        """How `v` is counted, in a few characters: ``all + 2``, ``early + 3``."""
        return f"{self.v_counts} + {self.v_add}"


@dataclass(frozen=True)
class ExpectedTable:
    """All expected cells of one source, in the order of its file."""

    name: str
    title: str
    source: str
    about: str
    cells: tuple[ExpectedCell, ...]


@cache
def load_expected(name: str) -> ExpectedTable:
    """Read one of :data:`SOURCES`.

    Raises
    ------
    UnknownName
        If there is no such source.
    """
    if name not in SOURCES:
        raise UnknownName.among("source of expected results", name, SOURCES)
    record = tomllib.loads((FOLDER / f"{name}.toml").read_text(encoding="utf-8"))
    cells = tuple(cell for row in record["rows"] for cell in _cells_of(row))
    return ExpectedTable(record["name"], record["title"], record["source"], record["about"], cells)


def _cells_of(row: dict[str, Any]) -> list[ExpectedCell]:
    unknown = [math.nan] * len(row["n"])
    columns = (row["n"], row["success"], row.get("v", unknown), row.get("v_sd", unknown))
    return [
        ExpectedCell(
            row["problem"],
            row["sampler"],
            row["rule"],
            n,
            float(success),
            row.get("runs"),
            float(v),
            float(v_sd),
            row["v_counts"],
            row["v_add"],
            row.get("note", ""),
        )
        for n, success, v, v_sd in zip(*columns, strict=True)
    ]


SEARCHES = ("stock", "connect", "full", "lazy")
"""Which of our cells speaks where there are several: all have the same success, the first also stops early."""
LEVEL = 0.05


@dataclass(frozen=True)
class Verdict:
    """An expected cell beside ours.

    Attributes
    ----------
    expected : ExpectedCell
    ours : Cell or None
        None where the store has no such runs.
    p, p_corrected : float
        Fisher's exact test on the counts, and with Holm's correction over all cells of the source that can be
        tested; NaN where there is nothing to test.
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
    """Hold every expected cell against ours.

    A cell whose runs come from sets of a pool is tested by its counts as well: its runs are not independent, so
    "differs" is there said too readily rather than too late.
    """
    ours = {(c.question.problem, c.sampler, c.question.rule, c.n, c.question.search): c for c in cells}
    found = [_ours_for(expected, ours) for expected in table.cells]
    p_values = [_p_value(expected, cell) for expected, cell in zip(table.cells, found, strict=True)]
    tested = [place for place, p in enumerate(p_values) if not math.isnan(p)]
    corrected = dict(zip(tested, holm([p_values[place] for place in tested]).tolist(), strict=True))
    return tuple(
        Verdict(expected, cell, p_values[place], corrected.get(place, math.nan))
        for place, (expected, cell) in enumerate(zip(table.cells, found, strict=True))
    )


def _ours_for(expected: ExpectedCell, ours: dict[tuple[str, str, str, int, str], Cell]) -> Cell | None:
    for search in SEARCHES:
        cell = ours.get((expected.problem, expected.sampler, expected.rule, expected.n, search))
        if cell is not None:
            return cell
    return None


def _p_value(expected: ExpectedCell, cell: Cell | None) -> float:
    if cell is None or expected.solved is None or expected.runs is None:
        return math.nan
    return fisher_exact((expected.solved, expected.runs), (cell.solved, cell.runs))
