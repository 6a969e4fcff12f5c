"""What the arms' rows say: success by generator, and what the roadmap gains on every other, paired by problem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass, fields, replace
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad.research.arms.execute import KEPT, TREES
from evenroad.research.arms.problems import PREFIXES, robot_and_generator
from evenroad.research.arms.scenes import GENERATORS
from evenroad.research.arms.suite import METHODS
from evenroad.research.bench.rows import Rows
from evenroad.research.statistics.rates import holm
from evenroad.research.statistics.units import sign_flip_test

REFERENCE = "roadmap"
ALL = "all"


class Way(NamedTuple):
    """Which runs belong together: of a robot, k neighbours, n points of a sampler, by a rule and a search."""

    robot: str
    k: str
    n: int
    sampler: str
    rule: str
    search: str


@dataclass(frozen=True)
class Line:
    """Success of one way of planning on the problems of one generator, or of ``all``.

    `gain` is the success of the roadmap of as many milestones minus this one's, `error` its standard error over
    problems, `p` of sign flips over problems, `p_corrected` by Holm over all lines; NaN where there is nothing to
    compare.  Checks and `ms` are medians, `ms` of processor time from the scene to the path.
    """

    robot: str
    k: str
    n: int
    sampler: str
    rule: str
    search: str
    generator: str
    problems: int
    runs: int
    success: float
    gain: float
    error: float
    p: float
    p_corrected: float
    configurations: float
    motions: float
    ms: float


HEADER = tuple(field.name for field in fields(Line))


def is_of_arms(problem: str) -> bool:
    """Say whether a problem is of this suite."""
    return problem.startswith(tuple(f"{prefix}-" for prefix in PREFIXES.values()))


def arm_lines(rows: Rows) -> tuple[Line, ...]:
    """Return all lines of a store: by robot, k, n and sampler, each generator and then all of them."""
    of_arms = np.array([is_of_arms(name) for name in rows.problem.names], dtype=np.bool_)
    rows = rows.where(of_arms[rows.problem.codes])
    if not len(rows):
        return ()
    runs, generator = _runs(rows)
    ways = _ways(rows)
    references = {(way.robot, way.k, way.n): of for way, of in ways.items() if way.sampler == REFERENCE}
    found: list[Line] = []
    for way, mine in sorted(ways.items(), key=lambda item: _place(item[0])):
        theirs = references.get((way.robot, way.k, way.n), np.empty(0, dtype=np.int64))
        theirs = np.empty(0, dtype=np.int64) if way.sampler == REFERENCE else theirs
        for name in (*GENERATORS, ALL):
            here = mine if name == ALL else mine[generator[mine] == list(GENERATORS).index(name)]
            if len(here):
                found.append(_line(runs, way, name, here, _sums(runs, theirs, here)))
    tested = [i for i, line in enumerate(found) if not np.isnan(line.p)]
    corrected = holm([found[i].p for i in tested]).tolist()
    for i, p in zip(tested, corrected, strict=True):
        found[i] = replace(found[i], p_corrected=p)
    return tuple(found)


class _Runs(NamedTuple):
    """What every line asks of all rows, looked up once: the problem of each as a number, and what makes a pair."""

    rows: Rows
    unit: Ints
    pair: Ints
    solved: Bools
    answered: Bools


def _runs(rows: Rows) -> tuple[_Runs, Ints]:
    """Return the rows, ready for lines, and the number of the generator of each."""
    of_name = np.array([list(GENERATORS).index(robot_and_generator(name)[1]) for name in rows.problem.names])
    unit = rows.problem.codes.astype(np.int64) * (int(rows.instance.max()) + 1) + rows.instance
    _, seeds = np.unique(rows.seed, return_inverse=True)
    pair = (unit * (int(rows.run.max()) + 1) + rows.run) * (int(seeds.max()) + 1) + seeds
    return _Runs(rows, unit, pair, rows.solved, rows.answered), of_name[rows.problem.codes]


def _ways(rows: Rows) -> dict[Way, Ints]:
    """Return the rows of each way of planning."""
    columns = (rows.problem.codes, rows.n, rows.sampler.codes, rows.rule.codes, rows.search.codes)
    kinds, which = np.unique(np.stack(columns, axis=1), axis=0, return_inverse=True)
    order = np.argsort(which, kind="stable")
    groups = np.split(order, np.cumsum(np.bincount(which.ravel()))[:-1])
    ways: dict[Way, list[Ints]] = {}
    for (problem, n, sampler, rule, search), group in zip(kinds.tolist(), groups, strict=True):
        robot = robot_and_generator(rows.problem.names[problem])[0]
        rule_name = rows.rule.names[rule]
        k = rule_name.partition(" ")[0].removeprefix("k=")
        way = Way(robot, k, n, rows.sampler.names[sampler], rule_name, rows.search.names[search])
        ways.setdefault(way, []).append(group)
    return {way: np.concatenate(groups) for way, groups in ways.items()}


def _place(way: Way) -> tuple[object, ...]:
    order = [*METHODS, TREES]
    place = order.index(way.sampler) if way.sampler in order else len(order)
    return way.robot, int(way.k) if way.k.isdigit() else -1, way.n, place, way.search == KEPT


def _sums(runs: _Runs, theirs: Ints, mine: Ints) -> tuple[Ints, Ints]:
    """Return the differences of solved runs by problem, and the pairs; a run without its like is left out."""
    if not len(theirs):
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
    pair, solved = runs.pair, runs.solved
    theirs = theirs[np.argsort(pair[theirs])]
    place = np.minimum(np.searchsorted(pair[theirs], pair[mine]), len(theirs) - 1)
    paired = pair[theirs[place]] == pair[mine]
    apart = solved[theirs[place[paired]]].astype(np.int64) - solved[mine[paired]]
    _, which = np.unique(runs.unit[mine[paired]], return_inverse=True)
    return np.bincount(which, weights=apart).astype(np.int64), np.bincount(which)


def _line(runs: _Runs, way: Way, generator: str, here: Ints, paired: tuple[Ints, Ints]) -> Line:
    sums, counts = paired
    gain, error, p = np.nan, np.nan, np.nan
    if len(sums) > 1:
        shares = sums / counts
        gain, error = float(shares.mean()), float(shares.std(ddof=1) / np.sqrt(len(shares)))
        p = sign_flip_test(sums)
    problems, rows = len(np.unique(runs.unit[here])), runs.rows
    asked: list[Floats | Ints] = [rows.valid[here], rows.edges_checked[here], 1e3 * rows.seconds[here]]
    medians = [float(np.nanmedian(column)) if runs.answered[here].any() else np.nan for column in asked]
    return Line(
        *way, generator, problems, len(here), float(runs.solved[here].mean()), gain, error, p, p, *medians
    )


def csv_of(lines: Sequence[Line]) -> list[tuple[object, ...]]:
    """Return the lines as rows under :data:`HEADER`."""
    return [astuple(line) for line in lines]


TITLES = {"sobol scrambled": "owen", "halton scrambled": "halton"}
"""What tables call samplers, where it is shorter."""


def title_of(line: Line) -> str:
    """Return what a table calls a way of planning."""
    name = TITLES.get(line.sampler, line.sampler)
    return name if line.search in (KEPT, TREES) else f"{name}, ends k"


def table_rows(lines: Sequence[Line]) -> dict[tuple[str, str], list[tuple[str, ...]]]:
    """Return for each robot and k the rows of a table: N, sampler, problems x draws, success by generator, gain, p."""
    tables: dict[tuple[str, str], dict[tuple[object, ...], dict[str, Line]]] = {}
    for line in lines:
        key = (line.n, title_of(line), line.rule)
        tables.setdefault((line.robot, line.k), {}).setdefault(key, {})[line.generator] = line
    return {
        title: [(str(n), str(name), *_texts(by)) for (n, name, _), by in found.items()]
        for title, found in tables.items()
    }


def robots_and_k(lines: Sequence[Line]) -> list[tuple[str, str]]:
    """Return each robot and k that has kept roadmaps: what pictures are drawn for."""
    return list(dict.fromkeys((line.robot, line.k) for line in lines if line.search == KEPT))


TABLE_HEADER = ("N", "points", "runs", *GENERATORS, ALL, "roadmap - this", "p (Holm)")


def _texts(by: dict[str, Line]) -> tuple[str, ...]:
    whole = by[ALL]
    runs = f"{whole.problems} x {whole.runs / whole.problems:.3g}"
    shares = (runs, *(f"{100 * by[name].success:.0f}" if name in by else "–" for name in (*GENERATORS, ALL)))
    if np.isnan(whole.gain):
        return (*shares, "", "")
    p = whole.p_corrected
    return (
        *shares,
        f"{100 * whole.gain:+.1f} ± {100 * whole.error:.1f}",
        f"{p:.3f}" if p >= 0.001 else "<.001",
    )
