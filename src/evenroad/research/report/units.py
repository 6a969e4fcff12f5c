"""Units: what is independent of what among the runs of a cell.

In random worlds the worlds are.  In a fixed world the runs are, but for these: runs of one set that a pool has given
more than once; a block of a sequence, which is the same under every seed; the only grid there is.  From
:data:`PERMUTED_FROM` dimensions on every run of a pool permutes the coordinates of its set anew, so that runs are
independent given the pool; and where a set leaves coordinates of the problem to chance, as the translations of a
rigid body leave its turns, runs of the only grid are independent given the grid.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import numpy.typing as npt

from evenroad.research.bench.samplers import PERMUTED_FROM
from evenroad.research.problems import PROBLEMS
from evenroad.research.report.groups import Ints, UnitSums, combined, first_rows, sums_by_unit
from evenroad.research.report.runs import Question, Runs

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
