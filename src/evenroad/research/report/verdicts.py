"""Verdicts: does a published or independently measured cell agree with ours?"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from evenroad.research.report.cells import Cell
from evenroad.research.report.expected import ExpectedCell, ExpectedTable
from evenroad.research.statistics import fisher_exact, holm

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
