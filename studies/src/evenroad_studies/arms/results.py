"""What the arms' rows say: success by generator, and what the roadmap gains on every other, paired by problem."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, fields, replace

import numpy as np

from evenroad._arrays import Bools, Ints
from evenroad_studies.arms.execute import KEPT, TREES
from evenroad_studies.arms.outcomes import Outcomes, Paired, Way, outcomes_of, paired
from evenroad_studies.arms.scenes import GENERATORS
from evenroad_studies.arms.suite import METHODS
from evenroad_studies.bench.rows import Rows
from evenroad_studies.statistics.rates import holm
from evenroad_studies.statistics.units import sign_flip_test

REFERENCE = "roadmap"
ALL = "all"


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


def arm_lines(rows: Rows) -> tuple[Line, ...]:
    """Return all lines of a store: by robot, k, n and sampler, each generator and then all of them."""
    return lines_of(outcomes_of(rows))


def lines_of(outcomes: Mapping[Way, Outcomes]) -> tuple[Line, ...]:
    """Return all lines of what ways of planning solved, in the order of :func:`arm_lines`."""
    references = {(way.robot, way.k, way.n): of for way, of in outcomes.items() if way.sampler == REFERENCE}
    found: list[Line] = []
    for way in sorted(outcomes, key=_place):
        mine = outcomes[way]
        roadmap = None if way.sampler == REFERENCE else references.get((way.robot, way.k, way.n))
        pairs = None if roadmap is None else paired(roadmap, mine)
        found += [_line(way, name, mine, pairs) for name in (*GENERATORS, ALL)]
    found = [line for line in found if line.runs]
    tested = [i for i, line in enumerate(found) if not np.isnan(line.p)]
    corrected = holm([found[i].p for i in tested]).tolist()
    for i, p in zip(tested, corrected, strict=True):
        found[i] = replace(found[i], p_corrected=p)
    return tuple(found)


def _place(way: Way) -> tuple[object, ...]:
    order = [*METHODS, TREES]
    place = order.index(way.sampler) if way.sampler in order else len(order)
    return way.robot, int(way.k) if way.k.isdigit() else -1, way.n, place, way.search == KEPT


def _line(way: Way, generator: str, mine: Outcomes, pairs: Paired | None) -> Line:
    which = [*GENERATORS, ALL].index(generator)
    here = _of(mine.problems[:, 0], which)
    ran, solved = mine.ran[here], mine.solved[here]
    gain, error, p = np.nan, np.nan, np.nan
    if pairs is not None and (these := _of(pairs.generator, which)).sum() > 1:
        shares = pairs.more[these] / pairs.pairs[these]
        gain, error = float(shares.mean()), float(shares.std(ddof=1) / np.sqrt(len(shares)))
        p = sign_flip_test(pairs.more[these])
    runs = int(ran.sum())
    success = float(solved.sum() / max(runs, 1))
    problems = int(ran.any(axis=1).sum())
    return Line(*way, generator, problems, runs, success, gain, error, p, p, *mine.costs[which].tolist())


def _of(generator: Ints, which: int) -> Bools:
    """Return what is of a generator; all of it for the number after theirs."""
    return (generator == which) | (which == len(GENERATORS))


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
        f"{p:.3f}" if p >= 0.001 else "<0.001",
    )
