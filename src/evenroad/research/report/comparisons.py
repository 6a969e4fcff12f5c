"""Comparisons: each sampler with uniform and with scrambled Halton, on the same runs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from evenroad.research.report.cells import Cell, cell_codes, grouping_of
from evenroad.research.report.runs import Ints, Question, Runs, UnitSums, combined, sums_by_unit
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


def pair_codes(runs: Runs) -> Ints:
    """Return one code a run that the same run of another sampler has, too."""
    return combined(runs.question, runs.n, runs.instance, runs.run, runs.seed)


def differences_from(runs: Runs, pair: Ints, reference: str) -> tuple[npt.NDArray[np.bool_], Ints]:
    """Return which runs of others have a counterpart of the reference sampler, and solved minus solved there."""
    solved = runs.solved.astype(np.int64)
    if reference not in runs.samplers:
        return np.zeros(len(runs), dtype=bool), np.zeros(len(runs), dtype=np.int64)
    of_reference = runs.sampler == runs.samplers.index(reference)
    counterpart = np.full(int(pair.max()) + 1, -1)
    counterpart[pair[of_reference]] = solved[of_reference]
    theirs = counterpart[pair]
    return (theirs >= 0) & ~of_reference, solved - theirs


REFERENCES = ("uniform", "halton scrambled")
SIGNIFICANT = 0.05
"""Corrected p-value below which a difference is marked."""
FEW_TO_TEST = 6
"""With fewer units than this no choice of signs has a p-value below .05, and a pool of so few sets says as little."""


@dataclass(frozen=True)
class Comparison:
    """A cell against a reference sampler, over the runs (instance, run, seed) that both have.

    Attributes
    ----------
    cell : Cell
    reference : str
    pairs : int
    only_cell, only_reference : int
        Pairs that only one of the two solved.
    interval : Interval
        Of the difference of success rates, cell minus reference.
    test : str
        ``McNemar``; where pairs are not independent ``Fisher over sets`` or ``sign flips over instances`` (or blocks),
        the latter followed by ``Student over sets`` where both were done and the larger p counts; ``too few sets to
        test`` (or runs, ..) where there are fewer than six.
    p : float
        NaN where nothing was tested.
    p_corrected : float
        By Holm's method over all comparisons of the question that were tested.
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
        """Whether there were enough units for a test."""
        return not math.isnan(self.p)


def comparisons_of(runs: Runs, cells: Sequence[Cell]) -> tuple[Comparison, ...]:
    """Compare every cell with every reference that has runs in common; Holm's correction question by question."""
    if not len(runs):
        return ()
    cell = cell_codes(runs)
    grouping = grouping_of(runs, cell)
    also_by_set = np.array([grouping.also_by_set(c) for c in range(len(cells))])
    pair = pair_codes(runs)
    found = []
    for place, reference in enumerate(REFERENCES):
        # A reference against an earlier one has been said already, the other way round.
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
    """Compare by the units of a cell: their differences, and the runs that were `solved` in each."""
    differences, counts = sums.sums[sums.of(c)], sums.runs[sums.of(c)]
    pairs = int(counts.sum())
    kind = cell.units.kind
    match kind:
        case "runs":
            interval = bonett_price(wins, losses, pairs)
            test, p = "McNemar", float(mcnemar_exact(wins, losses))
        case "sets":
            # A pool draws its sets by other numbers than the reference its points: nothing is paired.
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
    """Return the comparison with the wider interval and the larger p of it and of Student's over sets."""
    entries = by_set.of(c)
    sums, pairs = by_set.sums[entries], by_set.runs[entries]
    p = max(compared.p, student_test(sums, pairs)) if compared.is_tested else math.nan
    return replace(
        compared,
        interval=compared.interval.or_wider(student_interval(sums, pairs, "sets")),
        test=f"{compared.test}, Student over sets" if compared.is_tested else compared.test,
        p=p,
        p_corrected=p,
    )


def _corrected(found: list[Comparison]) -> tuple[Comparison, ...]:
    families: dict[Question, list[int]] = {}
    for place, each in enumerate(found):
        if each.is_tested:
            families.setdefault(each.cell.question, []).append(place)
    corrected: dict[int, float] = {}
    for family in families.values():
        values = holm([found[place].p for place in family])
        corrected.update(zip(family, values.tolist(), strict=True))
    return tuple(
        replace(each, p_corrected=corrected.get(place, math.nan)) for place, each in enumerate(found)
    )
