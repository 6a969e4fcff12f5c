"""Lazy search: the motions it checks, against those of the search that only connects."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad.research.report.fair import fair_runs, world_codes
from evenroad.research.report.fair_names import CONNECT
from evenroad.research.report.groups import combined
from evenroad.research.report.runs import Runs
from evenroad.research.statistics import Interval, percentile_interval, resampled_ratios

LAZY = "lazy"


@dataclass(frozen=True)
class LazyChecks:
    """Motions checked by both searches of a sampler, on the same roadmaps in random worlds.

    Attributes
    ----------
    rule, sampler : str
    instances, pairs : int
        Random worlds and roadmaps.
    connect, lazy : float
        Mean motions checked.
    ratio : Interval
        Of lazy / connect, by a bootstrap over worlds; not a share.
    """

    rule: str
    sampler: str
    instances: int
    pairs: int
    connect: float
    lazy: float
    ratio: Interval


def lazy_checks(runs: Runs) -> tuple[LazyChecks, ...]:
    """Compare the two searches wherever the fair suite has both; by rule and sampler."""
    runs = fair_runs(runs)
    runs = runs.where(~runs.failed)
    if not len(runs):
        return ()
    search = np.array([question.search for question in runs.questions])[runs.question]
    roadmaps = sorted({(question.problem, question.rule) for question in runs.questions})
    codes = np.array([roadmaps.index((each.problem, each.rule)) for each in runs.questions])
    pair = combined(codes[runs.question], runs.sampler, runs.n, runs.instance, runs.run, runs.seed)
    connect_row = np.full(int(pair.max()) + 1, -1)
    connects = np.flatnonzero(search == CONNECT)
    connect_row[pair[connects]] = connects
    lazy = np.flatnonzero((search == LAZY) & (connect_row[pair] >= 0))
    connect = connect_row[pair[lazy]]
    rules = sorted({question.rule for question in runs.questions})
    rule = np.array([rules.index(question.rule) for question in runs.questions])[runs.question[lazy]]
    world = world_codes(runs)[lazy]
    place = combined(rule, runs.sampler[lazy])
    found = []
    for code in range(int(place.max()) + 1 if len(place) else 0):
        rows = np.flatnonzero(place == code)
        unit = combined(world[rows])
        asked = runs.edges_checked[lazy[rows]], runs.edges_checked[connect[rows]]
        sums = [np.bincount(unit, weights=column) for column in asked]
        if sums[1].any():
            found.append(
                LazyChecks(
                    rules[rule[rows[0]]],
                    runs.samplers[runs.sampler[lazy[rows[0]]]],
                    len(sums[0]),
                    len(rows),
                    float(asked[1].mean()),
                    float(asked[0].mean()),
                    Interval(*percentile_interval(resampled_ratios(*sums)), "bootstrap over instances"),
                )
            )
    return tuple(found)
