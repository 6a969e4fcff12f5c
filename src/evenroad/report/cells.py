"""Cells: all runs of one question, sampler and number of samples, counted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad._rng import generator
from evenroad.bench.statistics import Interval, clustered_rate, resampled_ratios, wilson
from evenroad.bench.statistics.bootstrap import DRAWS
from evenroad.report.groups import Ints, combined, first_rows, sums_by_unit
from evenroad.report.runs import Question, Runs


@dataclass(frozen=True)
class Units:
    """What is independent in a cell.

    Attributes
    ----------
    kind : str
        ``runs``; ``sets`` where sets of a pool were drawn more than once; ``instances`` where random worlds
        were planned in more than once.
    solved, runs : ndarray of int, shape (units,)
        Counts per set or instance; of ``runs``, one entry with all.
    """

    kind: str
    solved: Ints
    runs: Ints


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

    @property
    def rate(self) -> float:
        """Success rate."""
        return self.solved / self.runs

    def resampled_rates(self) -> npt.NDArray[np.float64]:
        """Return bootstrap resamples of the success rate, over what is independent; shape (DRAWS,)."""
        if self.units.kind == "runs":
            # Seeded by the number of samples, so that two cells of one curve are not resampled in step.
            return generator(self.n).binomial(self.runs, self.rate, size=DRAWS) / self.runs
        return resampled_ratios(self.units.solved, self.units.runs)


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
    units = _units_of(runs, cell, cells)
    low, high = wilson(solved, totals)
    return tuple(
        Cell(
            runs.questions[runs.question[row]],
            runs.samplers[runs.sampler[row]],
            int(runs.n[row]),
            int(totals[c]),
            int(solved[c]),
            int(failures[c]),
            Interval(float(low[c]), float(high[c]), "wilson")
            if units[c].kind == "runs"
            else clustered_rate(units[c].solved, units[c].runs, units[c].kind),
            float(mean_valid[c]),
            float(sd_valid[c]),
            float(mean_early[c]),
            float(sd_early[c]),
            float(mean_edges[c]),
            float(mean_seconds[c]),
            units[c],
        )
        for c, row in enumerate(first)
    )


def cell_codes(runs: Runs) -> Ints:
    """Return the place of every run's cell in :func:`cells_of`."""
    return combined(runs.question, runs.sampler, runs.n)


def unit_of(runs: Runs, cell: Ints) -> tuple[Ints, npt.NDArray[np.bool_]]:
    """Return every run's unit (its instance or its set), and for each cell whether the unit is the instance."""
    cells = int(cell.max()) + 1
    smallest = np.full(cells, np.iinfo(np.int64).max)
    largest = np.full(cells, np.iinfo(np.int64).min)
    np.minimum.at(smallest, cell, runs.instance)
    np.maximum.at(largest, cell, runs.instance)
    random_worlds = smallest != largest
    return np.where(random_worlds[cell], runs.instance, runs.set), random_worlds


def _units_of(runs: Runs, cell: Ints, cells: int) -> list[Units]:
    unit, random_worlds = unit_of(runs, cell)
    by_unit = sums_by_unit(cell, cells, unit, runs.solved.astype(np.int64))
    result = []
    for c in range(cells):
        entries = by_unit.of(c)
        solved, total = by_unit.sums[entries], by_unit.runs[entries]
        drawn_afresh = not random_worlds[c] and not by_unit.unit[entries].any()
        if drawn_afresh or total.max() == 1:
            result.append(Units("runs", solved.sum(keepdims=True), total.sum(keepdims=True)))
        else:
            result.append(Units("instances" if random_worlds[c] else "sets", solved, total))
    return result


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
