"""Comparisons: each sampler with uniform and with scrambled Halton, on the same runs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad.research.report.cells import Cell, cell_codes, grouping_of
from evenroad.research.report.runs import Runs, Setting, UnitSums, combined, sums_by_unit
from evenroad.research.statistics import (
    Interval,
    bonett_price,
    clustered_difference,
    clustered_rate,
    holm,
    mcnemar_exact,
    sets_difference,
    sets_test,
    sign_flip_test,
    student_interval,
    student_test,
)

REFERENCES = ("uniform", "halton scrambled")
SIGNIFICANT = 0.05
"""Corrected p-value below which a difference is marked."""
FEW_TO_TEST = 6
"""Smallest number of units that is tested: with fewer, no choice of signs has a p-value below .05."""


def pair_codes(runs: Runs) -> Ints:
    """Return a code for every run; the same run of another sampler has the same code."""
    return combined(runs.setting, runs.n, runs.instance, runs.run, runs.seed)


def differences_from(runs: Runs, pair: Ints, reference: str) -> tuple[Bools, Ints]:
    """Compare every run with the same run of the reference sampler.

    Returns whether there is such a run, (rows,), False for runs of the reference itself; and 1 if only this run is
    solved, -1 if only the reference's is, else 0, (rows,), meaningless where there is none.
    """
    solved = runs.solved.astype(np.int64)
    if reference not in runs.samplers:
        return np.zeros(len(runs), dtype=bool), np.zeros(len(runs), dtype=np.int64)
    of_reference = runs.sampler == runs.samplers.index(reference)
    counterpart = np.full(int(pair.max()) + 1, -1)
    counterpart[pair[of_reference]] = solved[of_reference]
    theirs = counterpart[pair]
    return (theirs >= 0) & ~of_reference, solved - theirs


@dataclass(frozen=True)
class Comparison:
    """A cell against a reference sampler, over the runs (instance, run, seed) that both have.

    Attributes
    ----------
    only_cell, only_reference : int
        Pairs that only one of the two solved.
    interval : Interval
        Of the difference of success rates, cell minus reference.
    test : str
        ``McNemar`` where runs are independent, else ``Fisher over sets``, ``sign flips over blocks`` or ``sign flips
        over instances``; ``.., Student over sets`` where both were done, and the larger p counts; ``too few sets to
        test`` (or runs, blocks, instances) where there are fewer than six.
    p, p_corrected : float
        NaN if it was not tested; by Holm's method over all tested comparisons of the setting.
    """

    cell: Cell
    reference: str
    pairs: int
    only_cell: int
    only_reference: int
    interval: Interval
    test: str
    p: float
    p_corrected: float

    @property
    def difference(self) -> float:
        """Success rate of the cell minus that of the reference, over the pairs."""
        return (self.only_cell - self.only_reference) / self.pairs

    @property
    def significant(self) -> bool:
        """Whether the corrected test tells the two apart."""
        return self.p_corrected < SIGNIFICANT

    @property
    def is_tested(self) -> bool:
        """Whether there are enough units for a test."""
        return not math.isnan(self.p)


def comparisons_of(runs: Runs, cells: Sequence[Cell]) -> tuple[Comparison, ...]:
    """Compare every cell with every reference that has the same runs; p-values are corrected within a setting."""
    if not len(runs):
        return ()
    cell = cell_codes(runs)
    grouping = grouping_of(runs, cell)
    also_by_set = np.array([grouping.also_by_set(c) for c in range(len(cells))])
    pair = pair_codes(runs)
    found = []
    for place, reference in enumerate(REFERENCES):
        # A pair of references is compared once.
        left_out = REFERENCES[: place + 1]
        paired, difference = differences_from(runs, pair, reference)
        rows = np.flatnonzero(paired)
        sums = sums_by_unit(cell[rows], len(cells), grouping.unit[rows], difference[rows])
        solved = sums_by_unit(cell[rows], len(cells), grouping.unit[rows], runs.solved[rows].astype(np.int64))
        wins = np.bincount(cell[rows], weights=difference[rows] > 0, minlength=len(cells)).astype(int)
        losses = np.bincount(cell[rows], weights=difference[rows] < 0, minlength=len(cells)).astype(int)
        rows = rows[also_by_set[cell[rows]]]
        by_set = sums_by_unit(cell[rows], len(cells), runs.set[rows], difference[rows])
        for c, each in enumerate(cells):
            if each.sampler not in left_out and sums.of(c).stop > sums.of(c).start:
                counts = solved.sums[solved.of(c)], int(wins[c]), int(losses[c])
                compared = _compare(each, reference, sums, c, *counts)
                found.append(_also_over_sets(compared, by_set, c) if also_by_set[c] else compared)
    return _corrected(found)


def _compare(
    cell: Cell, reference: str, sums: UnitSums, c: int, solved: Ints, wins: int, losses: int
) -> Comparison:
    """Compare one cell.

    `sums` has the differences by unit, those of `cell` in group `c`; `solved`, (units,), its solved runs; `wins` and
    `losses` count the pairs that only the cell, and only the reference, solved.
    """
    differences, counts = sums.sums[sums.of(c)], sums.runs[sums.of(c)]
    pairs = int(counts.sum())
    kind = cell.units.kind
    match kind:
        case "runs":
            interval = bonett_price(wins, losses, pairs)
            test, p = "McNemar", float(mcnemar_exact(wins, losses))
        case "sets":
            # The draw of a set has nothing to do with the reference's draw of points: runs are no pairs.
            of_pool = int(solved.sum())
            of_reference = of_pool - (wins - losses)
            over_sets = clustered_rate(solved, counts, kind)
            interval = sets_difference(over_sets, of_pool / pairs, of_reference, pairs)
            test, p = "Fisher over sets", sets_test(solved, counts, of_reference, pairs)
        case _:
            interval = clustered_difference(differences, counts, kind)
            test, p = f"sign flips over {kind}", sign_flip_test(differences)
    if len(counts) < FEW_TO_TEST:
        test, p = f"too few {kind} to test", math.nan
    return Comparison(cell, reference, pairs, wins, losses, interval, test, p, p)


def _also_over_sets(compared: Comparison, by_set: UnitSums, c: int) -> Comparison:
    """Test over sets, too; return the comparison with the wider interval and the larger p of both tests."""
    interval, p = also_over_sets(compared.interval, compared.p, by_set, c)
    test = f"{compared.test}, Student over sets" if compared.is_tested else compared.test
    return replace(compared, interval=interval, test=test, p=p, p_corrected=p)


def also_over_sets(interval: Interval, p: float, by_set: UnitSums, group: int) -> tuple[Interval, float]:
    """Return the wider interval and the larger p of those given and of Student's over the sets of a group.

    A p of NaN, "not tested", stays.
    """
    sums, runs = by_set.sums[by_set.of(group)], by_set.runs[by_set.of(group)]
    wider = interval.or_wider(student_interval(sums, runs, "sets"))
    return wider, p if math.isnan(p) else max(p, student_test(sums, runs))


def _corrected(found: list[Comparison]) -> tuple[Comparison, ...]:
    families: dict[Setting, list[int]] = {}
    for place, each in enumerate(found):
        families.setdefault(each.cell.setting, []).append(place)
    values = np.empty(len(found))
    for family in families.values():
        values[family] = holm_of_tested([found[place].p for place in family])
    return tuple(replace(each, p_corrected=p) for each, p in zip(found, values.tolist(), strict=True))


def holm_of_tested(p_values: Sequence[float]) -> Floats:
    """Correct p-values by Holm's method; NaN means "not tested", does not count and stays."""
    values = np.array(p_values, dtype=np.float64)
    tested = ~np.isnan(values)
    values[tested] = holm(values[tested])
    return values
