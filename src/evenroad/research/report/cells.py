"""Cells: all runs of one question, sampler and number of samples, counted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad.research.report.groups import Ints, combined, first_rows
from evenroad.research.report.runs import Question, Runs
from evenroad.research.report.units import Units, grouping_of, sets_of, units_of
from evenroad.research.statistics import Interval, clustered_rate, student_interval, wilson


@dataclass(frozen=True)
class Cell:
    """One cell of a success table.

    Attributes
    ----------
    runs, solved, failures : int
        A failure (exception, time limit, dead worker) counts as a run that was not solved.
    interval : Interval
        Of the success rate, 95 %.
    mean_valid, sd_valid, mean_early, sd_early : float
        Valid milestones, start and goal not counted: among all n points, and those added until there was a path.
        Over the runs that gave an answer, as the next two; NaN if none did.
    mean_edges, mean_seconds : float
        Motions checked; seconds of planning.
    units : Units
        The runs by what is independent.
    sets : Units
        The runs by the set of the pool that they had; empty for sets drawn afresh.
    pool_given : bool
        Whether the runs are independent given the pool's sets only: coordinates are permuted anew in every run.
    """

    question: Question
    sampler: str
    n: int
    runs: int
    solved: int
    failures: int
    interval: Interval
    mean_valid: float
    sd_valid: float
    mean_early: float
    sd_early: float
    mean_edges: float
    mean_seconds: float
    units: Units
    sets: Units
    pool_given: bool

    @property
    def rate(self) -> float:
        """Success rate."""
        return self.solved / self.runs


def cells_of(runs: Runs) -> tuple[Cell, ...]:
    """Count all cells, in the order of questions, samplers and numbers of samples."""
    if not len(runs):
        return ()
    cell = cell_codes(runs)
    cells = int(cell.max()) + 1
    first = first_rows(cell)
    totals = np.bincount(cell, minlength=cells)
    solved = np.bincount(cell, weights=runs.solved, minlength=cells).astype(np.int64)
    failures = np.bincount(cell, weights=runs.failed, minlength=cells).astype(np.int64)
    answered = ~runs.failed
    mean_valid, sd_valid = _moments(cell, cells, runs.valid, answered)
    mean_early, sd_early = _moments(cell, cells, runs.early, answered)
    mean_edges, _ = _moments(cell, cells, runs.edges_checked, answered)
    mean_seconds, _ = _moments(cell, cells, runs.seconds, answered)
    grouping = grouping_of(runs, cell)
    units, sets = units_of(runs, grouping), sets_of(runs, grouping)
    low, high = wilson(solved, totals)
    intervals = [
        Interval(float(low[c]), float(high[c]), "wilson")
        if units[c].kind == "runs"
        else clustered_rate(units[c].solved, units[c].runs, units[c].kind)
        for c in range(cells)
    ]
    for c in range(cells):
        if grouping.also_by_set(c):
            over_sets = student_interval(sets[c].solved, sets[c].runs, "sets", lowest=0.0)
            intervals[c] = intervals[c].or_wider(over_sets)
    return tuple(
        Cell(
            runs.questions[runs.question[row]],
            runs.samplers[runs.sampler[row]],
            int(runs.n[row]),
            int(totals[c]),
            int(solved[c]),
            int(failures[c]),
            intervals[c],
            float(mean_valid[c]),
            float(sd_valid[c]),
            float(mean_early[c]),
            float(sd_early[c]),
            float(mean_edges[c]),
            float(mean_seconds[c]),
            units[c],
            sets[c],
            bool(grouping.permuted[c]) and units[c].kind == "runs",
        )
        for c, row in enumerate(first)
    )


def cell_codes(runs: Runs) -> Ints:
    """Return the place of every run's cell in :func:`cells_of`."""
    return combined(runs.question, runs.sampler, runs.n)


def _moments(
    cell: Ints, cells: int, column: npt.NDArray[np.float64], use: npt.NDArray[np.bool_]
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return mean and standard deviation (n - 1 below) of a column by cell, over the runs to use."""
    use = use & np.isfinite(column)
    cell, column = cell[use], column[use]
    count = np.bincount(cell, minlength=cells).astype(np.float64)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.bincount(cell, weights=column, minlength=cells) / count
        squares = np.bincount(cell, weights=(column - mean[cell]) ** 2, minlength=cells)
        deviation = np.sqrt(squares / (count - 1.0))
    return mean, np.where(count > 1, deviation, np.nan)
