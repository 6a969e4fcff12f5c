"""The fair suite: random worlds, pooled by generator, dimension, number of samples and rule."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from evenroad.bench.problems import PROBLEMS
from evenroad.bench.statistics import (
    Interval,
    clustered_difference,
    holm,
    sign_flip_test,
    student_interval,
    student_test,
)
from evenroad.report.cells import cell_codes
from evenroad.report.comparisons import SIGNIFICANT, differences_from, pair_codes
from evenroad.report.fair_names import BY_RULE, CONNECT, GROUPINGS, is_fair
from evenroad.report.groups import Ints, combined, first_rows, sums_by_unit
from evenroad.report.runs import Runs, natural_key
from evenroad.report.units import Mask, grouping_of

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
    runs, difference = runs.where(paired), difference[paired]
    connects = np.array([question.search == CONNECT for question in runs.questions])[runs.question]
    found = {}
    for grouping in GROUPINGS:
        chosen = np.ones(len(runs), dtype=bool) if grouping == BY_RULE else connects
        if chosen.any():
            found[grouping] = _pooled_by(grouping, runs.where(chosen), difference[chosen])
    return found


def fair_runs(runs: Runs) -> Runs:
    """Return the runs of the fair suite."""
    fair = np.array([is_fair(question) for question in runs.questions], dtype=bool)
    return runs.where(np.flatnonzero(fair[runs.question]) if fair.any() else np.zeros(0, dtype=np.int64))


def world_codes(runs: Runs) -> Ints:
    """Return one code a run that all runs in the same random world have."""
    problems = sorted({question.problem for question in runs.questions})
    code = np.array([problems.index(question.problem) for question in runs.questions])
    return combined(code[runs.question], runs.instance)


def _pooled_by(grouping: str, runs: Runs, difference: Ints) -> tuple[Pooled, ...]:
    names, group = _groups(grouping, runs)
    place = combined(group, runs.sampler)
    first = first_rows(place)
    world = world_codes(runs)
    by_world = sums_by_unit(place, len(first), world, difference)
    pool_set, has_set, as_it_is = _pool_sets(runs)
    sets = sums_by_unit(place[has_set], len(first), pool_set[has_set], difference[has_set])
    # What has no set of a pool, or a permuted one, stays with its world.
    shared = np.where(as_it_is, pool_set, -1 - world)
    by_set = sums_by_unit(place, len(first), shared, difference)
    shares_sets = np.bincount(place, weights=as_it_is) > 0
    solved = np.bincount(place, weights=runs.solved)
    found = []
    for g, row in enumerate(first):
        entries = by_world.of(g)
        sums, pairs = by_world.sums[entries], by_world.runs[entries]
        interval, p = clustered_difference(sums, pairs, "instances"), sign_flip_test(sums)
        if shares_sets[g]:
            of_sets = by_set.sums[by_set.of(g)], by_set.runs[by_set.of(g)]
            interval = interval.or_wider(student_interval(*of_sets, "sets"))
            p = max(p, student_test(*of_sets))
        total, rate = int(pairs.sum()), float(solved[g] / pairs.sum())
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


def _pool_sets(runs: Runs) -> tuple[Ints, Mask, Mask]:
    """Return codes of the pool's sets, which runs have one, and which of them use it as it is."""
    cell = cell_codes(runs)
    grouping = grouping_of(runs, cell)
    has_set = grouping.pooled[cell] & (runs.set > 0)
    # Problems of one dimension share their sets; those that are not known here share none.
    dims = [
        PROBLEMS[question.problem].set_dim if question.problem in PROBLEMS else -1 - place
        for place, question in enumerate(runs.questions)
    ]
    code = combined(runs.sampler, np.array(dims)[runs.question], runs.n, runs.set)
    return code, has_set, has_set & ~grouping.permuted[cell]


def _groups(grouping: str, runs: Runs) -> tuple[list[str], Ints]:
    """Return the names of the groups and every row's number among them."""
    name_of = GROUPINGS[grouping]
    code = combined(runs.question, runs.n)
    labels = [name_of(runs.questions[runs.question[row]], int(runs.n[row])) for row in first_rows(code)]
    names = sorted(set(labels), key=natural_key)
    number = {name: place for place, name in enumerate(names)}
    return names, np.array([number[label] for label in labels])[code]
