"""The fair suite: random worlds, pooled by generator, dimension, number of samples and rule."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Ints
from evenroad_studies.problems import PROBLEMS
from evenroad_studies.report.cells import cell_codes, grouping_of
from evenroad_studies.report.comparisons import SIGNIFICANT, also_over_sets, differences_from, holm_of_tested
from evenroad_studies.report.runs import Runs, Setting, combined, first_rows, natural_key, sums_by_unit
from evenroad_studies.statistics.rates import Interval
from evenroad_studies.statistics.resampling import percentile_interval, resampled_ratios
from evenroad_studies.statistics.units import clustered_difference, sign_flip_test

PREFIX = "fair-"
"""Begin of the names of the suite's problems."""
REFERENCE = "uniform"
CONNECT = "connect"
"""The search whose runs are pooled."""
LAZY = "lazy"
"""The search that is compared with it by the motions that it checks."""
BY_RULE = "rule"
"""The grouping that pools every search."""


def is_fair(setting: Setting) -> bool:
    """Say whether a setting belongs to the fair suite."""
    return setting.problem.startswith(PREFIX)


def parts_of(problem: str) -> tuple[str, str, str]:
    """Return generator, dimension and success of uniform points: balls, 5d and 50 % of ``fair-balls-5d-50``.

    Where no dimension is in the name the generator stands for it, and ``-`` for the success.
    """
    found = re.fullmatch(rf"(?:{PREFIX})?(.+?)(?:-(\d+d))?(?:-(\d+))?", problem)
    generator, dimension, success = found.groups() if found else (problem, None, None)
    return generator, dimension or generator, f"{success} %" if success else "-"


GROUPINGS: dict[str, Callable[[Setting, int], str]] = {
    "all": lambda setting, n: "all",
    "generator": lambda setting, n: parts_of(setting.problem)[0],
    "dimension": lambda setting, n: parts_of(setting.problem)[1],
    "difficulty": lambda setting, n: parts_of(setting.problem)[2],
    "samples": lambda setting, n: str(n),
    BY_RULE: lambda setting, n: f"{setting.rule}, {setting.search}",
}
"""What the fair suite is pooled by: name -> group of a setting and a number of samples."""


def pooled_rules(settings: Iterable[Setting]) -> str:
    """Return the connection rules that are pooled, in short: ``k=4, 6, 10, 20 symmetrised``."""
    rules = {each.rule for each in settings if is_fair(each) and each.search == CONNECT}
    names = sorted(rules, key=natural_key)
    parts = [re.fullmatch(r"k=(\d+) (.+)", name) for name in names]
    kinds = {part.group(2) if part else "" for part in parts}
    if len(kinds) != 1 or "" in kinds:
        return ", ".join(names)
    return f"k={', '.join(part.group(1) for part in parts if part)} {kinds.pop()}"


@dataclass(frozen=True)
class Pooled:
    """A sampler against uniform in the same random worlds and runs, over a group of problems.

    `group` is ``all``, ``balls``, ``5d``, ``50 %``, ``256``, ``k=10 symmetrised, connect``, ...  `instances`, `pairs`
    and `sets` count random worlds, runs, and sets of the sampler's pool; no sets if it draws afresh or is the grid.
    `interval`, of the difference of success rates, and `p`, of sign flips, are over worlds; in fewer than 5 dimensions
    a pool's sets are used as they are, and both are Student's over sets where that is wider, or larger.  `p_corrected`
    is by Holm's method over the groups and samplers of a table.
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
    def difference(self) -> float:
        """Success rate of the sampler minus that of uniform."""
        return self.rate - self.reference_rate

    @property
    def significant(self) -> bool:
        """Whether the corrected test tells the two apart."""
        return self.p_corrected < SIGNIFICANT


def pooled(runs: Runs) -> dict[str, tuple[Pooled, ...]]:
    """Pool the fair suite by everything in :data:`GROUPINGS`; groups in natural order, samplers in that of the tables.

    A run counts if uniform has the same run in the same world, so a sampler without sets for hard worlds gains nothing
    by it.  Other searches repeat the outcomes of ``connect``, so they count only where rules are compared.  Empty
    without runs of the suite.
    """
    runs = fair_runs(runs)
    if not len(runs):
        return {}
    paired, difference = differences_from(runs, REFERENCE)
    every = _pairs_of(runs.where(paired), difference[paired])
    connecting = every.where(np.flatnonzero(every.runs.by_setting(lambda each: each.search == CONNECT)))
    chosen = {grouping: every if grouping == BY_RULE else connecting for grouping in GROUPINGS}
    return {grouping: _pooled_by(grouping, pairs) for grouping, pairs in chosen.items() if len(pairs.runs)}


def fair_runs(runs: Runs) -> Runs:
    """Return the runs of the fair suite."""
    return runs.where(np.flatnonzero(runs.by_setting(is_fair)) if len(runs) else np.zeros(0, dtype=np.int64))


def world_codes(runs: Runs) -> Ints:
    """Return a code for every run; runs in the same random world have the same code."""
    return combined(runs.setting_codes(lambda setting: setting.problem), runs.instance)


class _Pairs(NamedTuple):
    """Runs that uniform has, too, and what they have in common with each other; all arrays (rows,).

    `difference` is 1 if only this run is solved, -1 if only uniform's is, else 0; `world` codes the random world,
    `set` the set of a pool (-1 if it is drawn afresh), and `shared` the set if it is used as it is, else the world,
    below 0.
    """

    runs: Runs
    difference: Ints
    world: Ints
    set: Ints
    shared: Ints

    def where(self, rows: Ints) -> _Pairs:
        runs, *columns = self
        return _Pairs(runs.where(rows), *(column[rows] for column in columns))


def _pairs_of(runs: Runs, difference: Ints) -> _Pairs:
    cell, world = cell_codes(runs), world_codes(runs)
    grouping = grouping_of(runs, cell)
    has_set = grouping.pooled[cell] & (runs.set > 0)
    # Problems of one dimension share their sets; a problem that is not known here shares none.
    dims = {
        setting: PROBLEMS[setting.problem].set_dim if setting.problem in PROBLEMS else -1 - place
        for place, setting in enumerate(runs.settings)
    }
    code = combined(runs.sampler, runs.by_setting(dims.__getitem__), runs.n, runs.set)
    as_it_is = has_set & ~grouping.permuted[cell]
    return _Pairs(runs, difference, world, np.where(has_set, code, -1), np.where(as_it_is, code, -1 - world))


def _pooled_by(grouping: str, pairs: _Pairs) -> tuple[Pooled, ...]:
    runs = pairs.runs
    names, group = _groups(grouping, runs)
    place = combined(group, runs.sampler)
    first = first_rows(place)
    by_world = sums_by_unit(place, len(first), pairs.world, pairs.difference)
    by_set = sums_by_unit(place, len(first), pairs.shared, pairs.difference)
    of_pool = pairs.set >= 0
    sets = sums_by_unit(place[of_pool], len(first), pairs.set[of_pool], pairs.difference[of_pool])
    solved = np.bincount(place, weights=runs.solved)
    found = []
    for g, row in enumerate(first):
        _, counts, sums = by_world[g]
        interval, p = clustered_difference(sums, counts, "instances"), sign_flip_test(sums)
        if by_set[g].unit[-1] >= 0:
            interval, p = also_over_sets(interval, p, by_set[g])
        total, rate = int(counts.sum()), float(solved[g] / counts.sum())
        found.append(
            Pooled(
                group=names[group[row]],
                sampler=runs.samplers[runs.sampler[row]],
                instances=len(sums),
                pairs=total,
                sets=len(sets[g].unit),
                rate=rate,
                reference_rate=rate - float(sums.sum()) / total,
                interval=interval,
                p=p,
                p_corrected=p,
            )
        )
    corrected = holm_of_tested([each.p for each in found]).tolist()
    return tuple(replace(each, p_corrected=p) for each, p in zip(found, corrected, strict=True))


def _groups(grouping: str, runs: Runs) -> tuple[list[str], Ints]:
    """Return the names of the groups and every row's number among them."""
    name_of = GROUPINGS[grouping]
    code = combined(runs.setting, runs.n)
    labels = [name_of(runs.settings[runs.setting[row]], int(runs.n[row])) for row in first_rows(code)]
    names = sorted(set(labels), key=natural_key)
    return names, np.array([names.index(label) for label in labels])[code]


class LazyChecks(NamedTuple):
    """Mean numbers of motions that two searches check on the same roadmaps in random worlds, of a rule and a sampler.

    `instances` and `pairs` count worlds and roadmaps; `ratio` is the interval of lazy / connect, by a bootstrap over
    worlds.
    """

    rule: str
    sampler: str
    instances: int
    pairs: int
    connect: float
    lazy: float
    ratio: Interval


def lazy_checks(runs: Runs) -> tuple[LazyChecks, ...]:
    """Compare the two searches on every roadmap of the fair suite that both were run on, by rule and sampler."""
    runs = fair_runs(runs)
    runs = runs.where(~runs.failed)
    if not len(runs):
        return ()
    search = runs.by_setting(lambda setting: setting.search)
    roadmap = runs.setting_codes(lambda setting: (setting.problem, setting.rule))
    pair = combined(roadmap, runs.sampler, runs.n, runs.instance, runs.run, runs.seed)
    connect_row = np.full(int(pair.max()) + 1, -1)
    connects = np.flatnonzero(search == CONNECT)
    connect_row[pair[connects]] = connects
    lazy = np.flatnonzero((search == LAZY) & (connect_row[pair] >= 0))
    connect = connect_row[pair[lazy]]
    place = combined(runs.setting_codes(lambda setting: setting.rule)[lazy], runs.sampler[lazy])
    world = world_codes(runs)[lazy]
    found = []
    for code, first in enumerate(lazy[first_rows(place)]):
        rows = np.flatnonzero(place == code)
        unit = combined(world[rows])
        of_lazy, of_connect = runs.edges_checked[lazy[rows]], runs.edges_checked[connect[rows]]
        sums = [np.bincount(unit, weights=asked) for asked in (of_lazy, of_connect)]
        if sums[1].any():
            found.append(
                LazyChecks(
                    runs.settings[runs.setting[first]].rule,
                    runs.samplers[runs.sampler[first]],
                    len(sums[0]),
                    len(rows),
                    float(of_connect.mean()),
                    float(of_lazy.mean()),
                    Interval(*percentile_interval(resampled_ratios(*sums)), "bootstrap over instances"),
                )
            )
    return tuple(found)
