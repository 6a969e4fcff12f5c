"""The fair suite: random worlds, pooled by generator, dimension, number of samples and rule."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from evenroad.bench.statistics import Interval, clustered_difference, holm, sign_flip_test
from evenroad.report.comparisons import SIGNIFICANT, differences_from, pair_codes
from evenroad.report.groups import Ints, combined, first_rows, sums_by_unit
from evenroad.report.runs import Question, Runs, natural_key

PREFIX = "fair-"
REFERENCE = "uniform"


@dataclass(frozen=True)
class Pooled:
    """A sampler against uniform over all random worlds of a group, on the same worlds and runs.

    Attributes
    ----------
    group : str
        Value of what is pooled by: ``balls``, ``5d``, ``256``, ``k=10 symmetrised``, ``all``.
    sampler : str
    instances, pairs : int
        Random worlds, which are what is independent, and runs.
    rate, reference_rate : float
        Success rates over the pairs.
    interval : Interval
        Of their difference, by a paired bootstrap over worlds.
    p, p_corrected : float
        Sign flips over worlds; with Holm's correction over the table.
    """

    group: str
    sampler: str
    instances: int
    pairs: int
    rate: float
    reference_rate: float
    interval: Interval
    p: float
    p_corrected: float

    @property
    def significant(self) -> bool:
        """Whether the corrected test tells the two apart."""
        return self.p_corrected < SIGNIFICANT


def is_fair(question: Question) -> bool:
    """Say whether a question belongs to the fair suite."""
    return question.problem.startswith(PREFIX)


def generator_of(problem: str) -> str:
    """Return the generator's name: ``balls`` of ``fair-balls-5d-50``."""
    parts = problem.removeprefix(PREFIX).split("-")
    return "-".join(part for part in parts if not re.fullmatch(r"\d+d?", part)) or problem


def dimension_of(problem: str) -> str:
    """Return the dimension as the name has it, ``5d``; where it has none, the generator."""
    found = re.search(r"-(\d+d)(?=-|$)", problem)
    return found.group(1) if found else generator_of(problem)


def difficulty_of(problem: str) -> str:
    """Return uniform's intended success in percent, the number at the end of the name; ``-`` without."""
    found = re.search(r"-(\d+)$", problem)
    return f"{found.group(1)} %" if found else "-"


GROUPINGS: dict[str, Callable[[Question, int], str]] = {
    "all": lambda question, n: "all",
    "generator": lambda question, n: generator_of(question.problem),
    "dimension": lambda question, n: dimension_of(question.problem),
    "difficulty": lambda question, n: difficulty_of(question.problem),
    "samples": lambda question, n: str(n),
    "rule": lambda question, n: f"{question.rule}, {question.search}",
}
"""What the fair suite is pooled by."""


def pooled(runs: Runs) -> dict[str, tuple[Pooled, ...]]:
    """Pool the fair suite by everything in :data:`GROUPINGS`; groups in natural order, samplers in ours.

    Only runs with a counterpart of uniform on the same world are counted: a sampler that has no set for the hard
    worlds does not profit from it.  Empty where there are none.
    """
    fair_questions = np.array([is_fair(question) for question in runs.questions], dtype=bool)
    fair = (
        np.flatnonzero(fair_questions[runs.question]) if fair_questions.any() else np.zeros(0, dtype=np.int64)
    )
    if not len(fair):
        return {}
    runs = runs.where(fair)
    paired, difference = differences_from(runs, pair_codes(runs), REFERENCE)
    if not paired.any():
        return {}
    runs, difference = runs.where(paired), difference[paired]
    world = combined(_problem_codes(runs), runs.instance)
    return {grouping: _pooled_by(grouping, runs, world, difference) for grouping in GROUPINGS}


def _pooled_by(grouping: str, runs: Runs, world: Ints, difference: Ints) -> tuple[Pooled, ...]:
    names, group = _groups(grouping, runs)
    place = combined(group, runs.sampler)
    first = first_rows(place)
    sums = sums_by_unit(place, len(first), world, difference)
    solved = np.bincount(place, weights=runs.solved)
    found = []
    for g, row in enumerate(first):
        entries = sums.of(g)
        pairs = int(sums.runs[entries].sum())
        rate = float(solved[g] / pairs)
        interval = clustered_difference(sums.sums[entries], sums.runs[entries], "instances")
        p = sign_flip_test(sums.sums[entries])
        reference_rate = rate - float(sums.sums[entries].sum()) / pairs
        sampler = runs.samplers[runs.sampler[row]]
        worlds = entries.stop - entries.start
        found.append(Pooled(names[group[row]], sampler, worlds, pairs, rate, reference_rate, interval, p, p))
    corrected = holm([each.p for each in found]).tolist()
    return tuple(replace(each, p_corrected=p) for each, p in zip(found, corrected, strict=True))


def _groups(grouping: str, runs: Runs) -> tuple[list[str], Ints]:
    """Return the names of the groups and every row's number among them."""
    name_of = GROUPINGS[grouping]
    code = combined(runs.question, runs.n)
    labels = [name_of(runs.questions[runs.question[row]], int(runs.n[row])) for row in first_rows(code)]
    names = sorted(set(labels), key=natural_key)
    number = {name: place for place, name in enumerate(names)}
    return names, np.array([number[label] for label in labels])[code]


def _problem_codes(runs: Runs) -> Ints:
    problems = sorted({question.problem for question in runs.questions})
    code = np.array([problems.index(question.problem) for question in runs.questions])
    result: Ints = code[runs.question]
    return result
