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
from evenroad_studies.bench.samplers import PERMUTED_FROM
from evenroad_studies.problems import PROBLEMS
from evenroad_studies.report.runs import Runs, Setting, combined, first_rows, sums_by_unit
from evenroad_studies.statistics.rates import Interval, student_interval, wilson
from evenroad_studies.statistics.units import clustered_rate

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
    runs: Ints
    solved: Ints

    def __len__(self) -> int:
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

    @property
    def also_by_set(self) -> Bools:
        """In which cells runs of different units share sets: so it is with a pool in random worlds."""
        return self.pooled & ~self.permuted & (np.array(self.kinds) != "sets")


def grouping_of(runs: Runs, cell: Ints) -> Grouping:
    """Find the unit of every run; `cell` holds the cells' codes, without gaps."""
    first = first_rows(cell)
    cells = len(first)
    setting = runs.setting[first]
    has_set = _have(cell, cells, runs.set > 0)
    grid = _have(cell, cells, np.array([name == GRID for name in runs.sets])[runs.set])
    permuted = runs.by_setting(_is_permuted)[first] & ~grid
    random_worlds = _have(cell, cells, runs.instance != runs.instance[first][cell])
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
    names = np.select([random_worlds, by_set, by_block], ["instances", "sets", "blocks"], "runs")
    kinds = np.where(_repeat(cell, cells, unit), names, "runs")
    drawn_again = has_set & ~grid & _repeat(cell, cells, runs.set)
    return Grouping(cell, unit, tuple(kinds.tolist()), drawn_again, permuted & drawn_again)


def _have(cell: Ints, cells: int, such: Bools) -> Bools:
    """Return which cells have such a run."""
    return np.bincount(cell[such], minlength=cells) > 0


def _repeat(cell: Ints, cells: int, unit: Ints) -> Bools:
    """Return which cells have a unit with more than one run."""
    place = combined(cell, unit)
    return _have(cell, cells, np.bincount(place)[place] > 1)


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

    A failure (exception, time limit, dead worker) counts as not solved; `interval` is of the success rate.  Means and
    standard deviations are over runs that gave an answer, NaN if none did: of valid milestones among all n points,
    `early` among those that were added until there was a path; of motions checked; of seconds of planning.  `sets` are
    those of the pool, none where sets are drawn afresh.  With `pool_given` the interval holds for the sets of this pool
    only: every run permutes the coordinates of one of them.
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
    first = first_rows(cell)
    cells = len(first)
    grouping = grouping_of(runs, cell)
    by_unit = sums_by_unit(cell, cells, grouping.unit, runs.solved)
    units = [Units(kind, *sums) for kind, sums in zip(grouping.kinds, by_unit, strict=True)]
    of_set = np.flatnonzero(runs.set > 0)
    by_set = sums_by_unit(cell[of_set], cells, runs.set[of_set], runs.solved[of_set])
    sets = [Units("sets", *sums) for sums in by_set]
    moments: dict[str, Floats] = {}
    for name in ("valid", "early"):
        moments[f"mean_{name}"], moments[f"sd_{name}"] = _moments(runs, cell, cells, getattr(runs, name))
    moments["mean_edges"], _ = _moments(runs, cell, cells, runs.edges_checked)
    moments["mean_seconds"], _ = _moments(runs, cell, cells, runs.seconds)
    totals, solved, failures = (
        np.bincount(cell[such], minlength=cells).tolist() for such in (slice(None), runs.solved, runs.failed)
    )
    low, high = wilson(solved, totals)
    also_by_set = grouping.also_by_set
    return tuple(
        Cell(
            setting=runs.settings[runs.setting[row]],
            sampler=runs.samplers[runs.sampler[row]],
            n=int(runs.n[row]),
            runs=totals[c],
            solved=solved[c],
            failures=failures[c],
            interval=_interval(
                Interval(float(low[c]), float(high[c]), "wilson"),
                units[c],
                sets[c] if also_by_set[c] else None,
            ),
            units=units[c],
            sets=sets[c],
            pool_given=bool(grouping.permuted[c]) and units[c].kind == "runs",
            **{name: float(column[c]) for name, column in moments.items()},
        )
        for c, row in enumerate(first)
    )


def _interval(of_runs: Interval, units: Units, sets: Units | None) -> Interval:
    """Return the interval of a success rate over units, or the one over `sets`, where units share them, if wider."""
    is_of_runs = units.kind == "runs"
    interval = of_runs if is_of_runs else clustered_rate(units.solved, units.runs, units.kind)
    if sets is None:
        return interval
    return interval.or_wider(student_interval(sets.solved, sets.runs, "sets", lowest=0.0))


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
