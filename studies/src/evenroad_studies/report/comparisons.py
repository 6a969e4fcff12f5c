"""Comparisons: each sampler with uniform and with scrambled Halton, on the same runs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad_studies.report.cells import Cell, cell_codes, grouping_of
from evenroad_studies.report.runs import Runs, Setting, UnitSums, combined, sums_by_unit
from evenroad_studies.statistics.rates import (
    Interval,
    bonett_price,
    holm,
    mcnemar_exact,
    student_interval,
    student_test,
)
from evenroad_studies.statistics.units import (
    clustered_difference,
    clustered_rate,
    sets_difference,
    sets_test,
    sign_flip_test,
)

REFERENCES = ("uniform", "halton scrambled")
SIGNIFICANT = 0.05
"""Corrected p-value below which a difference is marked."""
FEW_TO_TEST = 6
"""Smallest number of units that is tested: with fewer, no choice of signs has a p-value below 0.05."""


def differences_from(runs: Runs, reference: str) -> tuple[Bools, Ints]:
    """Compare every run with the same run of the reference sampler.

    Returns whether there is such a run, (rows,), False for runs of the reference itself; and 1 if only this run is
    solved, -1 if only the reference's is, else 0, (rows,), meaningless where there is none.
    """
    pair = combined(runs.setting, runs.n, runs.instance, runs.run, runs.seed)
    solved = runs.solved.astype(np.int64)
    of_reference = np.array([name == reference for name in runs.samplers])[runs.sampler]
    counterpart = np.full(int(pair.max()) + 1, -1)
    counterpart[pair[of_reference]] = solved[of_reference]
    theirs = counterpart[pair]
    return (theirs >= 0) & ~of_reference, solved - theirs


@dataclass(frozen=True)
class Comparison:
    """A cell against a reference sampler, over the runs (instance, run, seed) that both have.

    `only_cell` and `only_reference` are the pairs that only one of the two solved; `interval` is of the difference of
    success rates, cell minus reference.  `test` is ``McNemar`` where runs are independent, else ``Fisher over sets``,
    ``sign flips over blocks`` or ``sign flips over instances``; ``.., Student over sets`` where both were done, and the
    larger p counts; ``too few sets to test`` (or runs, blocks, instances) where there are fewer than six.  `p` is NaN
    if it was not tested; `p_corrected` is by Holm's method over all tested comparisons of the setting.
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
    also_by_set = grouping.also_by_set
    found = []
    for place, reference in enumerate(REFERENCES):
        # A pair of references is compared once.
        left_out = REFERENCES[: place + 1]
        paired, difference = differences_from(runs, reference)
        rows = np.flatnonzero(paired)
        of_unit = cell[rows], len(cells), grouping.unit[rows]
        sums = sums_by_unit(*of_unit, difference[rows])
        solved = sums_by_unit(*of_unit, runs.solved[rows])
        wins, losses = (
            np.bincount(cell[paired & (difference == who)], minlength=len(cells)).tolist() for who in (1, -1)
        )
        rows = rows[also_by_set[cell[rows]]]
        by_set = sums_by_unit(cell[rows], len(cells), runs.set[rows], difference[rows])
        for c, each in enumerate(cells):
            if each.sampler not in left_out and len(sums[c].unit):
                compared = _compare(each, reference, sums[c], solved[c].sums, wins[c], losses[c])
                found.append(_also_over_sets(compared, by_set[c]) if also_by_set[c] else compared)
    return _corrected(found)


def _compare(cell: Cell, reference: str, units: UnitSums, solved: Ints, wins: int, losses: int) -> Comparison:
    """Compare one cell, from the differences and its solved runs by unit, and the pairs that only one solved."""
    differences, counts = units.sums, units.runs
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


def _also_over_sets(compared: Comparison, by_set: UnitSums) -> Comparison:
    """Test over sets, too; return the comparison with the wider interval and the larger p of both tests."""
    interval, p = also_over_sets(compared.interval, compared.p, by_set)
    test = f"{compared.test}, Student over sets" if compared.is_tested else compared.test
    return replace(compared, interval=interval, test=test, p=p, p_corrected=p)


def also_over_sets(interval: Interval, p: float, by_set: UnitSums) -> tuple[Interval, float]:
    """Return the wider interval and the larger p of those given and of Student's over sets; a p of NaN stays."""
    wider = interval.or_wider(student_interval(by_set.sums, by_set.runs, "sets"))
    return wider, p if math.isnan(p) else max(p, student_test(by_set.sums, by_set.runs))


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
