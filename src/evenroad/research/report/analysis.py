"""Analysis: everything that a report says, computed once."""

from __future__ import annotations

from dataclasses import dataclass

from evenroad.research.bench.rows import Rows
from evenroad.research.report.cells import Cell, cells_of
from evenroad.research.report.comparisons import Comparison, comparisons_of
from evenroad.research.report.expected import SOURCES, ExpectedTable, load_expected
from evenroad.research.report.failures import Failure, failures_of
from evenroad.research.report.fair import Pooled, pooled
from evenroad.research.report.lazy import LazyChecks, lazy_checks
from evenroad.research.report.needed import needed_of
from evenroad.research.report.runs import Question, Runs, runs_of
from evenroad.research.report.verdicts import Verdict, verdicts_of
from evenroad.research.statistics import SamplesNeeded


@dataclass(frozen=True)
class Analysis:
    """What was found in a store.

    Attributes
    ----------
    runs : Runs
    cells : tuple of Cell
        In the order of questions, samplers and numbers of samples.
    comparisons : tuple of Comparison
    needed : dict of (Question, sampler) to SamplesNeeded
    verdicts : dict of source name to (ExpectedTable, tuple of Verdict)
        Of the sources that have at least one problem in common with the store.
    pooled : dict of grouping to tuple of Pooled
        Empty without a fair suite.
    lazy : tuple of LazyChecks
    failures : tuple of Failure
    """

    runs: Runs
    cells: tuple[Cell, ...]
    comparisons: tuple[Comparison, ...]
    needed: dict[tuple[Question, str], SamplesNeeded]
    verdicts: dict[str, tuple[ExpectedTable, tuple[Verdict, ...]]]
    pooled: dict[str, tuple[Pooled, ...]]
    lazy: tuple[LazyChecks, ...]
    failures: tuple[Failure, ...]

    def cells_of(self, question: Question) -> tuple[Cell, ...]:
        """Return the cells of one question."""
        return tuple(cell for cell in self.cells if cell.question == question)


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
    found = {}
    for name in SOURCES:
        table = load_expected(name)
        verdicts = verdicts_of(table, cells)
        if any(each.ours is not None for each in verdicts):
            found[name] = (table, verdicts)
    return found
