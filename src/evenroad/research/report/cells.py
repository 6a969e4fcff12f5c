"""Cells: the runs of one setting, sampler and number of samples, counted by what is independent.

Runs of a cell are not always independent of each other, so intervals and tests count units:

* in random worlds a unit is a world;
* in a fixed world it is a run, with three exceptions: a set that a pool gives more than once, a block of a sequence
  (it is the same under every seed), and the grid, of which there is only one;
* from :data:`PERMUTED_FROM` dimensions on every run permutes the coordinates of its set, and a run is a unit again;
  so it is with the grid where chance draws some coordinates, as the turns of a rigid body.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad.research.bench.samplers import PERMUTED_FROM
from evenroad.research.problems import PROBLEMS
from evenroad.research.report.runs import Runs, Setting, UnitSums, combined, first_rows, sums_by_unit
from evenroad.research.statistics import Interval, clustered_rate, student_interval, wilson

GRID = "grid"
"""The `set_id` of the grid."""
BLOCKS = "paper-blocks"
"""End of the names of samplers whose run number decides the set."""


@dataclass(frozen=True)
class Units:
    """Independent units of a cell, each with its runs; all arrays (units,).

    `kind` is ``sets`` of a pool, ``blocks`` of a sequence, ``instances`` of random worlds, or ``runs`` where every
    unit has one run.  The codes in `unit` differ between numbers of points for sets; all others mean the same in every
    cell of a setting.
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
    """The cell and the unit of every run, as codes, (rows,); the others are of each cell, (cells,).

    `kinds` are the kinds of the units; `pooled` says whether a pool gave one of its sets more than once (the grid is no
    pool), and `permuted` whether every run permutes the coordinates of such a set.
    """

    cell: Ints
    unit: Ints
    kinds: tuple[str, ...]
    pooled: Bools
    permuted: Bools

    def also_by_set(self, c: int) -> bool:
        """Say whether runs of different units share sets: so it is with a pool in random worlds."""
        return bool(self.pooled[c] and not self.permuted[c] and self.kinds[c] != "sets")


def grouping_of(runs: Runs, cell: Ints) -> Grouping:
    """Find the unit of every run; `cell` holds the cells' codes, without gaps."""
    first = first_rows(cell)
    cells = len(first)
    setting = runs.setting[first]
    has_set = np.bincount(cell, weights=runs.set > 0, minlength=cells) > 0
    grid = np.bincount(cell, weights=runs.set == _code_of(runs.sets, GRID), minlength=cells) > 0
    permuted = runs.by_setting(_is_permuted)[first] & ~grid
    random_worlds = _varies(runs.instance, cell, cells)
    by_set = has_set & ~random_worlds & ~permuted
    several = np.bincount(cell, minlength=cells) > 1
    for c in np.flatnonzero(by_set & grid & several):
        by_set[c] = not _leaves_to_chance(runs.settings[setting[c]].problem)
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


def _units_of(runs: Runs, grouping: Grouping) -> list[Units]:
    """Return the units of every cell, in order."""
    sums = sums_by_unit(grouping.cell, len(grouping.kinds), grouping.unit, runs.solved.astype(np.int64))
    return [_units(kind, sums, c) for c, kind in enumerate(grouping.kinds)]


def _sets_of(runs: Runs, grouping: Grouping) -> list[Units]:
    """Return the sets of every cell, in order; none where sets are drawn afresh."""
    rows, cells = np.flatnonzero(runs.set > 0), len(grouping.kinds)
    sums = sums_by_unit(grouping.cell[rows], cells, runs.set[rows], runs.solved[rows].astype(np.int64))
    return [_units("sets", sums, c) for c in range(cells)]


def _units(kind: str, sums: UnitSums, c: int) -> Units:
    entries = sums.of(c)
    return Units(kind, sums.unit[entries], sums.sums[entries], sums.runs[entries])


def _repeats(cell: Ints, cells: int, unit: Ints) -> Bools:
    """Return which cells have a unit with more than one run."""
    place = combined(cell, unit)
    several = np.bincount(place)[place] > 1
    return np.bincount(cell[several], minlength=cells) > 0


def _varies(column: Ints, cell: Ints, cells: int) -> Bools:
    """Return in which cells a column has more than one value."""
    first = column[first_rows(cell)]
    return np.bincount(cell, weights=column != first[cell], minlength=cells) > 0


def _code_of(names: tuple[str, ...], name: str) -> int:
    return names.index(name) if name in names else -1


def _is_permuted(setting: Setting) -> bool:
    source = PROBLEMS.get(setting.problem)
    return source is not None and source.set_dim >= PERMUTED_FROM


@cache
def _leaves_to_chance(problem: str) -> bool:
    """Say whether a problem's sets give fewer coordinates than its configurations have; for this it is made."""
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
        A failure (exception, time limit, dead worker) counts as not solved.
    interval : Interval
        Of the success rate, 95 %.
    mean_valid, sd_valid : float
        Number of valid milestones among all n points, without start and goal.  These and the next moments are over
        runs that gave an answer; NaN if none did.
    mean_early, sd_early : float
        The same among the points that were added until there was a path.
    mean_edges, mean_seconds : float
        Number of motions checked; seconds of planning.
    units : Units
        The independent units.
    sets : Units
        The sets of the pool; none where sets are drawn afresh.
    pool_given : bool
        Whether the interval holds for the sets of this pool only: every run permutes the coordinates of one of them.
    """

    setting: Setting
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
    """Count all cells, in the order of settings, samplers and numbers of samples."""
    if not len(runs):
        return ()
    cell = cell_codes(runs)
    cells = int(cell.max()) + 1
    first = first_rows(cell)
    totals = np.bincount(cell, minlength=cells)
    solved = np.bincount(cell, weights=runs.solved, minlength=cells).astype(np.int64)
    failures = np.bincount(cell, weights=runs.failed, minlength=cells).astype(np.int64)
    moments: dict[str, Floats] = {}
    for name in ("valid", "early"):
        moments[f"mean_{name}"], moments[f"sd_{name}"] = _moments(runs, cell, cells, getattr(runs, name))
    moments["mean_edges"], _ = _moments(runs, cell, cells, runs.edges_checked)
    moments["mean_seconds"], _ = _moments(runs, cell, cells, runs.seconds)
    grouping = grouping_of(runs, cell)
    units, sets = _units_of(runs, grouping), _sets_of(runs, grouping)
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
            setting=runs.settings[runs.setting[row]],
            sampler=runs.samplers[runs.sampler[row]],
            n=int(runs.n[row]),
            runs=int(totals[c]),
            solved=int(solved[c]),
            failures=int(failures[c]),
            interval=intervals[c],
            units=units[c],
            sets=sets[c],
            pool_given=bool(grouping.permuted[c]) and units[c].kind == "runs",
            **{name: float(column[c]) for name, column in moments.items()},
        )
        for c, row in enumerate(first)
    )


def cell_codes(runs: Runs) -> Ints:
    """Return for every run the place of its cell in what :func:`cells_of` returns."""
    return combined(runs.setting, runs.sampler, runs.n)


def _moments(runs: Runs, cell: Ints, cells: int, column: Floats) -> tuple[Floats, Floats]:
    """Return mean and standard deviation (n - 1 below) of a column in every cell, over runs with an answer."""
    use = ~runs.failed & np.isfinite(column)
    cell, column = cell[use], column[use]
    count = np.bincount(cell, minlength=cells).astype(np.float64)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.bincount(cell, weights=column, minlength=cells) / count
        squares = np.bincount(cell, weights=(column - mean[cell]) ** 2, minlength=cells)
        deviation = np.sqrt(squares / (count - 1.0))
    return mean, np.where(count > 1, deviation, np.nan)
