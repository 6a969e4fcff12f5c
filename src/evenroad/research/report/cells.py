"""Cells: all runs of one question, sampler and number of samples, counted."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import numpy.typing as npt

from evenroad.research.bench.samplers import PERMUTED_FROM
from evenroad.research.problems import PROBLEMS
from evenroad.research.report.runs import Ints, Question, Runs, UnitSums, combined, first_rows, sums_by_unit
from evenroad.research.statistics import Interval, clustered_rate, student_interval, wilson

Mask = npt.NDArray[np.bool_]

GRID = "grid"
"""The `set_id` of the only set that there is."""
BLOCKS = "paper-blocks"
"""Protocol in a sampler's name: a run's number decides its set."""


@dataclass(frozen=True)
class Units:
    """Runs counted by what is independent.

    Attributes
    ----------
    kind : str
        ``runs``; ``sets`` of a pool, ``blocks`` of a sequence or ``instances`` of random worlds where some of them
        have several runs.
    unit : ndarray of int, shape (units,)
        Codes that mean the same in the cells of one question with other numbers of points, but for sets.
    solved, runs : ndarray of int, shape (units,)
    """

    kind: str
    unit: Ints
    solved: Ints
    runs: Ints

    def __len__(self) -> int:
        """Return the number of units."""
        return len(self.unit)


@dataclass(frozen=True)
class Grouping:
    """What the runs of a store belong to.

    Attributes
    ----------
    cell, unit : ndarray of int, shape (rows,)
        Cell and unit of every run.
    kinds : tuple of str
        Of each cell's units.
    pooled : ndarray of bool, shape (cells,)
        Whether the sets come from a pool that gave one of them more than once; never the grid.
    permuted : ndarray of bool, shape (cells,)
        Whether such a set's coordinates are permuted anew in every run.
    """

    cell: Ints
    unit: Ints
    kinds: tuple[str, ...]
    pooled: Mask
    permuted: Mask

    def also_by_set(self, c: int) -> bool:
        """Say whether a cell's runs in different units still share sets: pools in random worlds."""
        return bool(self.pooled[c] and not self.permuted[c] and self.kinds[c] != "sets")


def grouping_of(runs: Runs, cell: Ints) -> Grouping:
    """Return what the runs belong to, by their cells (codes without gaps)."""
    first = first_rows(cell)
    cells = len(first)
    question = runs.question[first]
    has_set = np.bincount(cell, weights=runs.set > 0, minlength=cells) > 0
    grid = np.bincount(cell, weights=runs.set == _code_of(runs.sets, GRID), minlength=cells) > 0
    permuted = np.array([_is_permuted(each) for each in runs.questions])[question] & ~grid
    random_worlds = _varies(runs.instance, cell, cells)
    by_set = has_set & ~random_worlds & ~permuted
    several = np.bincount(cell, minlength=cells) > 1
    for c in np.flatnonzero(by_set & grid & several):
        by_set[c] = not _leaves_to_chance(runs.questions[question[c]].problem)
    in_blocks = np.array([name.endswith(BLOCKS) for name in runs.samplers])[runs.sampler[first]]
    by_block = in_blocks & ~random_worlds
    unit = np.select(
        [random_worlds[cell], by_set[cell], by_block[cell]],
        [runs.instance, runs.set, runs.run],
        combined(runs.instance, runs.run, runs.seed),
    )
    repeated = _repeats(cell, cells, unit)
    names = np.select([random_worlds, by_set, by_block], ["instances", "sets", "blocks"], "runs")
    drawn_again = has_set & ~grid & _repeats(cell, cells, runs.set)
    return Grouping(
        cell, unit, tuple(np.where(repeated, names, "runs").tolist()), drawn_again, permuted & drawn_again
    )


def units_of(runs: Runs, grouping: Grouping) -> list[Units]:
    """Return the units of every cell, in order."""
    cells = len(grouping.kinds)
    sums = sums_by_unit(grouping.cell, cells, grouping.unit, runs.solved.astype(np.int64))
    return [_units(grouping.kinds[c], sums, c) for c in range(cells)]


def sets_of(runs: Runs, grouping: Grouping) -> list[Units]:
    """Return the counts of every cell by the sets of its pool, empty for sets drawn afresh."""
    rows = np.flatnonzero(runs.set > 0)
    cells = len(grouping.kinds)
    sums = sums_by_unit(grouping.cell[rows], cells, runs.set[rows], runs.solved[rows].astype(np.int64))
    return [_units("sets", sums, c) for c in range(cells)]


def _units(kind: str, sums: UnitSums, c: int) -> Units:
    entries = sums.of(c)
    return Units(kind, sums.unit[entries], sums.sums[entries], sums.runs[entries])


def _repeats(cell: Ints, cells: int, unit: Ints) -> Mask:
    """Return which cells have a unit with more than one run."""
    place = combined(cell, unit)
    several = np.bincount(place)[place] > 1
    return np.bincount(cell[several], minlength=cells) > 0


def _varies(column: Ints, cell: Ints, cells: int) -> Mask:
    first = column[first_rows(cell)]
    return np.bincount(cell, weights=column != first[cell], minlength=cells) > 0


def _code_of(names: tuple[str, ...], name: str) -> int:
    return names.index(name) if name in names else -1


def _is_permuted(question: Question) -> bool:
    source = PROBLEMS.get(question.problem)
    return source is not None and source.set_dim >= PERMUTED_FROM


@cache
def _leaves_to_chance(problem: str) -> bool:
    """Say whether a problem's sets give fewer coordinates than its configurations have; this makes the problem."""
    if problem not in PROBLEMS:
        return False
    made = PROBLEMS[problem].make(0)
    return made.set_dim < made.world.space.cube_dim


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
