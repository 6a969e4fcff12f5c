"""The fair suite: random worlds, pooled by generator, dimension, number of samples and rule."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from evenroad.research.problems import PROBLEMS
from evenroad.research.report.cells import cell_codes
from evenroad.research.report.comparisons import SIGNIFICANT
from evenroad.research.report.fair_names import BY_RULE, CONNECT, GROUPINGS, is_fair
from evenroad.research.report.groups import Ints, combined, first_rows, sums_by_unit
from evenroad.research.report.pairs import differences_from, pair_codes
from evenroad.research.report.runs import Runs, natural_key
from evenroad.research.report.units import grouping_of
from evenroad.research.statistics import (
    Interval,
    clustered_difference,
    holm,
    sign_flip_test,
    student_interval,
    student_test,
)

REFERENCE = "uniform"


@dataclass(frozen=True)
class Pooled:
    """A sampler against uniform over all random worlds of a group, on the same worlds and runs.

    Attributes
    ----------
    group : str
        Value of what is pooled by: ``balls``, ``5d``, ``256``, ``k=10 symmetrised, connect``, ``all``.
    sampler : str
    instances, pairs, sets : int
        Random worlds, runs, and sets of the sampler's pool that they had: 0 for sets drawn afresh, and for the grid.
    rate, reference_rate : float
        Success rates over the pairs.
    interval : Interval
        Of their difference: over worlds; or over sets, where that is wider and a pool's sets are used as they are, in
        fewer than 5 dimensions.
    p, p_corrected : float
        Sign flips over worlds, or Student's test over such sets if its p is larger; with Holm's correction over the
        table.
    """

    group: str
    sampler: str
    instances: int
    pairs: int
    sets: int
    rate: float
    reference_rate: float
    interval: Interval
    p: float
    p_corrected: float

    @property
    def significant(self) -> bool:
        """Whether the corrected test tells the two apart."""
        return self.p_corrected < SIGNIFICANT


def pooled(runs: Runs) -> dict[str, tuple[Pooled, ...]]:
    """Pool the fair suite by everything in :data:`GROUPINGS`; groups in natural order, samplers in ours.

    Only runs with a counterpart of uniform on the same world are counted: a sampler that has no set for the hard
    worlds does not profit from it.  Other searches than ``connect`` repeat outcomes of that one, so they are counted
    among the rules only.  Empty where there are none.
    """
    runs = fair_runs(runs)
    if not len(runs):
        return {}
    paired, difference = differences_from(runs, pair_codes(runs), REFERENCE)
    every = _pairs_of(runs.where(paired), difference[paired])
    connects = np.array([question.search == CONNECT for question in runs.questions])[every.runs.question]
    connecting = every.where(np.flatnonzero(connects))
    chosen = {grouping: every if grouping == BY_RULE else connecting for grouping in GROUPINGS}
    return {grouping: _pooled_by(grouping, pairs) for grouping, pairs in chosen.items() if len(pairs.runs)}


def fair_runs(runs: Runs) -> Runs:
    """Return the runs of the fair suite."""
    fair = np.array([is_fair(question) for question in runs.questions], dtype=bool)
    return runs.where(np.flatnonzero(fair[runs.question]) if fair.any() else np.zeros(0, dtype=np.int64))


def world_codes(runs: Runs) -> Ints:
    """Return one code a run that all runs in the same random world have."""
    problems = sorted({question.problem for question in runs.questions})
    code = np.array([problems.index(question.problem) for question in runs.questions])
    return combined(code[runs.question], runs.instance)


def _pooled_by(grouping: str, pairs: _Pairs) -> tuple[Pooled, ...]:
    runs = pairs.runs
    names, group = _groups(grouping, runs)
    place = combined(group, runs.sampler)
    first = first_rows(place)
    by_world = sums_by_unit(place, len(first), pairs.world, pairs.difference)
    of_pool = np.flatnonzero(pairs.set >= 0)
    sets = sums_by_unit(place[of_pool], len(first), pairs.set[of_pool], pairs.difference[of_pool])
    by_set = sums_by_unit(place, len(first), pairs.shared, pairs.difference)
    shares_sets = np.bincount(place, weights=pairs.shared >= 0) > 0
    solved = np.bincount(place, weights=runs.solved)
    found = []
    for g, row in enumerate(first):
        entries = by_world.of(g)
        sums, counts = by_world.sums[entries], by_world.runs[entries]
        interval, p = clustered_difference(sums, counts, "instances"), sign_flip_test(sums)
        if shares_sets[g]:
            of_sets = by_set.sums[by_set.of(g)], by_set.runs[by_set.of(g)]
            interval = interval.or_wider(student_interval(*of_sets, "sets"))
            p = max(p, student_test(*of_sets))
        total, rate = int(counts.sum()), float(solved[g] / counts.sum())
        found.append(
            Pooled(
                group=names[group[row]],
                sampler=runs.samplers[runs.sampler[row]],
                instances=len(sums),
                pairs=total,
                sets=sets.of(g).stop - sets.of(g).start,
                rate=rate,
                reference_rate=rate - float(sums.sum()) / total,
                interval=interval,
                p=p,
                p_corrected=p,
            )
        )
    corrected = holm([each.p for each in found]).tolist()
    return tuple(replace(each, p_corrected=p) for each, p in zip(found, corrected, strict=True))


@dataclass(frozen=True)
class _Pairs:
    """Runs with a counterpart, solved minus solved there, and what they share.

    `set` is the set of a pool, -1 of sets drawn afresh; `shared` the same where it is used as it is, else a code of the
    world, below 0.
    """

    runs: Runs
    difference: Ints
    world: Ints
    set: Ints
    shared: Ints

    def where(self, rows: Ints) -> _Pairs:
        return _Pairs(
            self.runs.where(rows), self.difference[rows], self.world[rows], self.set[rows], self.shared[rows]
        )


def _pairs_of(runs: Runs, difference: Ints) -> _Pairs:
    cell, world = cell_codes(runs), world_codes(runs)
    grouping = grouping_of(runs, cell)
    has_set = grouping.pooled[cell] & (runs.set > 0)
    # Problems of one dimension share their sets; those that are not known here share none.
    dims = [
        PROBLEMS[question.problem].set_dim if question.problem in PROBLEMS else -1 - place
        for place, question in enumerate(runs.questions)
    ]
    code = combined(runs.sampler, np.array(dims)[runs.question], runs.n, runs.set)
    as_it_is = has_set & ~grouping.permuted[cell]
    return _Pairs(runs, difference, world, np.where(has_set, code, -1), np.where(as_it_is, code, -1 - world))


def _groups(grouping: str, runs: Runs) -> tuple[list[str], Ints]:
    """Return the names of the groups and every row's number among them."""
    name_of = GROUPINGS[grouping]
    code = combined(runs.question, runs.n)
    labels = [name_of(runs.questions[runs.question[row]], int(runs.n[row])) for row in first_rows(code)]
    names = sorted(set(labels), key=natural_key)
    number = {name: place for place, name in enumerate(names)}
    return names, np.array([number[label] for label in labels])[code]
