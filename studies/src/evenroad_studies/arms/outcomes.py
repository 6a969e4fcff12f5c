"""What every way of planning solved, problem by problem and draw by draw: the rows of stores, small enough to keep.

A store has a row for each run, gigabytes for the whole suite.  Its tables need two bits of each run, whether it ran and
whether it was solved, and medians of costs.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats, Ints
from evenroad._npz import Arrays, Path, digest, read_npz, require_array, write_npz
from evenroad.errors import BrokenFile, InvalidValue
from evenroad_studies.arms.problems import PREFIXES, robot_and_generator, stream_of
from evenroad_studies.arms.scenes import GENERATORS
from evenroad_studies.bench.rows import Rows


class Way(NamedTuple):
    """Which runs belong together: of a robot, k neighbours, n points of a sampler, by a rule and a search."""

    robot: str
    k: str
    n: int
    sampler: str
    rule: str
    search: str


@dataclass(frozen=True, eq=False)
class Outcomes:
    """The runs of one way of planning.

    `problems`, (m, 2): the place of the generator in ``GENERATORS`` and the number of the problem; rows are sorted.
    `draws`, (d, 2): seed and number of the draw; sorted, too.  `ran` and `solved`, (m, d); a failed run ran and did not
    solve.  `costs`, (generators + 1, 3): medians over answers of configurations checked, motions checked and ms, the
    last row of all generators; NaN without an answer.
    """

    problems: Ints
    draws: Ints
    ran: Bools
    solved: Bools
    costs: Floats


class Paired(NamedTuple):
    """By problem that both ways were asked in the same draw: its generator, by how many runs the first solved more, and
    how many pairs of runs there are; (p,) each.
    """

    generator: Ints
    more: Ints
    pairs: Ints


def is_of_arms(problem: str) -> bool:
    """Say whether a problem is of this suite."""
    return problem.startswith(tuple(f"{prefix}-" for prefix in PREFIXES.values()))


def outcomes_of(rows: Rows) -> dict[Way, Outcomes]:
    """Return the outcomes of all ways of planning that there are rows of; rows of other suites are passed over."""
    of_arms = np.array([is_of_arms(name) for name in rows.problem.names], dtype=np.bool_)
    rows = rows.where(of_arms[rows.problem.codes])
    names = [_whose(name) if of_arms[i] else ("", "") for i, name in enumerate(rows.problem.names)]
    kinds = [*GENERATORS, ""]
    generator = np.array([kinds.index(kind) for _, kind in names], dtype=np.int64)[rows.problem.codes]
    solved = rows.solved
    asked = np.stack([rows.valid, rows.edges_checked, 1e3 * rows.seconds], axis=1)
    asked[~rows.answered] = np.nan
    found = {}
    for way, here in _ways(rows, names).items():
        problems, problem = _numbered(np.stack([generator[here], rows.instance[here]], axis=1))
        draws, draw = _numbered(np.stack([rows.seed[here], rows.run[here]], axis=1))
        ran, reached = (np.zeros((len(problems), len(draws)), dtype=np.bool_) for _ in range(2))
        ran[problem, draw], reached[problem, draw] = True, solved[here]
        costs = [_medians(asked[here[generator[here] == each]]) for each in range(len(GENERATORS))]
        found[way] = Outcomes(problems, draws, ran, reached, np.stack([*costs, _medians(asked[here])]))
    return found


def _whose(problem: str) -> tuple[str, str]:
    """Return the robot, with the stream where it is not what is reported, and the generator."""
    robot, generator = robot_and_generator(problem)
    return (robot if stream_of(problem) == "report" else f"{robot} ({stream_of(problem)})"), generator


def _ways(rows: Rows, names: list[tuple[str, str]]) -> dict[Way, Ints]:
    """Return the rows of each way of planning."""
    columns = (rows.problem.codes, rows.n, rows.sampler.codes, rows.rule.codes, rows.search.codes)
    kinds, which = _numbered(np.stack(columns, axis=1))
    order = np.argsort(which, kind="stable")
    groups = np.split(order, np.cumsum(np.bincount(which))[:-1]) if len(rows) else []
    ways: dict[Way, list[Ints]] = {}
    for (problem, n, sampler, rule, search), group in zip(kinds.tolist(), groups, strict=True):
        rule_name = rows.rule.names[rule]
        k = rule_name.partition(" ")[0].removeprefix("k=")
        sampled, searched = rows.sampler.names[sampler], rows.search.names[search]
        ways.setdefault(Way(names[problem][0], k, n, sampled, rule_name, searched), []).append(group)
    return {way: np.concatenate(groups) for way, groups in ways.items()}


def _numbered(pairs: Ints) -> tuple[Ints, Ints]:
    """Return the rows that occur, sorted, and the place of each row among them."""
    rows, places = np.unique(pairs, axis=0, return_inverse=True)
    return rows, places.ravel()


def _medians(asked: Floats) -> Floats:
    medians = np.full(3, np.nan)
    for place, column in enumerate(asked.T):
        known = column[~np.isnan(column)]
        medians[place] = np.median(known) if len(known) else np.nan
    return medians


def paired(one: Outcomes, other: Outcomes) -> Paired:
    """Return what the first solved more than the other, by problem; a run without its like is left out."""
    mine, theirs = _shared(one.problems, other.problems)
    here, there = (np.ix_(*each) for each in zip((mine, theirs), _shared(one.draws, other.draws), strict=True))
    both = one.ran[here] & other.ran[there]
    more = (one.solved[here] & both).sum(axis=1) - (other.solved[there] & both).sum(axis=1)
    asked = both.any(axis=1)
    return Paired(one.problems[mine[asked], 0], more[asked], both.sum(axis=1)[asked])


def _shared(some: Ints, others: Ints) -> tuple[Ints, Ints]:
    """Return where the rows are that both have, in each of them; rows are sorted, and none comes twice."""
    if np.array_equal(some, others):
        # As of nearly all pairs of one file: no search among millions of rows.
        return np.arange(len(some)), np.arange(len(some))
    codes = _numbered(np.concatenate([some, others]))[1]
    _, mine, theirs = np.intersect1d(codes[: len(some)], codes[len(some) :], return_indices=True)
    return mine, theirs


PROTOCOL = 7
"""Counted up when the same draw of the same sampler would plan otherwise.

What is kept is older than today's `even`: its rows are of the set that is called `korobov` now.
"""

_NAMES = ("protocol", "generators", "ways", "sizes", "problems", "draws", "ran", "solved", "costs", "hash")


def write_outcomes(path: Path, outcomes: Mapping[Way, Outcomes]) -> None:
    """Write outcomes into a compressed .npz file, atomically; InvalidValue if there are none."""
    if not outcomes:
        raise InvalidValue("there are no runs of arms to write")
    draws = np.unique(np.concatenate([each.draws for each in outcomes.values()]), axis=0)
    places = [_shared(draws, each.draws)[0] for each in outcomes.values()]

    def packed(masks: list[Bools]) -> npt.NDArray[np.uint8]:
        wide = [np.zeros((len(mask), len(draws)), dtype=np.bool_) for mask in masks]
        for target, mask, place in zip(wide, masks, places, strict=True):
            target[:, place] = mask
        return np.packbits(np.concatenate(wide), axis=1)

    arrays: Arrays = {
        "protocol": np.array(PROTOCOL),
        "generators": np.array(list(GENERATORS)),
        "ways": np.array([[str(field) for field in way] for way in outcomes]),
        "sizes": np.array([len(each.problems) for each in outcomes.values()], dtype=np.int64),
        "problems": np.concatenate([each.problems for each in outcomes.values()]),
        "draws": draws,
        "ran": packed([each.ran for each in outcomes.values()]),
        "solved": packed([each.solved for each in outcomes.values()]),
        "costs": np.stack([each.costs for each in outcomes.values()]),
    }
    write_npz(path, arrays | {"hash": np.array(digest(arrays))}, compressed=True)


def read_outcomes(path: Path) -> dict[Way, Outcomes]:
    """Return the outcomes that :func:`write_outcomes` wrote, each with the draws of all.

    BrokenFile if it is no such file, not as it was written, or of another protocol or other generators.
    """
    arrays = read_npz(path, "file of outcomes", _NAMES)
    written = str(arrays.pop("hash"))
    if digest(arrays) != written:
        raise BrokenFile(f"{path}: what it holds has another hash than was written")
    protocol, names = arrays["protocol"].tolist(), arrays["generators"].tolist()
    if protocol != PROTOCOL:
        raise BrokenFile(f"{path} is of protocol {protocol!r}, this is {PROTOCOL}: run the suite again")
    if names != list(GENERATORS):
        raise BrokenFile(f"{path} is of the generators {names}, these are {list(GENERATORS)}")
    ways, ran, solved = _checked(path, arrays)
    found, ends = {}, np.cumsum(arrays["sizes"]).tolist()
    for way, costs, end, size in zip(ways, arrays["costs"], ends, arrays["sizes"].tolist(), strict=True):
        here = slice(end - size, end)
        found[way] = Outcomes(arrays["problems"][here], arrays["draws"], ran[here], solved[here], costs)
    return found


def _checked(path: Path, arrays: Arrays) -> tuple[list[Way], Bools, Bools]:
    """Return the ways of a file, and which runs ran and were solved, or raise BrokenFile."""
    require_array(path, "ways", arrays["ways"], arrays["ways"].dtype, (None, len(Way._fields)))
    require_array(path, "sizes", arrays["sizes"], np.int64, (len(arrays["ways"]),))
    require_array(path, "draws", arrays["draws"], np.int64, (None, 2))
    total, draws = int(arrays["sizes"].sum()), len(arrays["draws"])
    require_array(path, "problems", arrays["problems"], np.int64, (total, 2))
    require_array(path, "costs", arrays["costs"], np.float64, (len(arrays["ways"]), len(GENERATORS) + 1, 3))
    for name in ("ran", "solved"):
        require_array(path, name, arrays[name], np.uint8, (total, -(-draws // 8)))
    ran, solved = (np.unpackbits(arrays[name], axis=1, count=draws).astype(np.bool_) for name in ("ran", "solved"))
    fields = arrays["ways"].tolist()
    if not all(isinstance(each[2], str) and each[2].isdecimal() for each in fields):
        raise BrokenFile(f"{path}: ways must be texts, the third one a number of points")
    ways = [Way(robot, k, int(n), *others) for robot, k, n, *others in fields]
    problems = arrays["problems"]
    first = np.cumsum(arrays["sizes"]) - arrays["sizes"]
    wrong = {
        "a way twice": len(set(ways)) < len(ways),
        "a negative size": bool((arrays["sizes"] < 0).any()),
        "draws out of order": not _rises(arrays["draws"], np.zeros(1, dtype=np.int64)),
        "problems out of order": not _rises(problems, first),
        "a generator that is none": not np.isin(problems[:, 0], range(len(GENERATORS))).all(),
        "a run that is solved and did not run": bool((solved & ~ran).any()),
        "negative costs": bool((arrays["costs"] < 0.0).any()),
    }
    if any(wrong.values()):
        raise BrokenFile(f"{path} holds {', '.join(name for name, here in wrong.items() if here)}")
    return ways, ran, solved


def _rises(pairs: Ints, first: Ints) -> bool:
    """Say whether each row is greater than the one before it, but for those where another list begins."""
    (a, b), (c, d) = pairs[:-1].T, pairs[1:].T
    rises = (a < c) | ((a == c) & (b < d))
    return bool(rises[~np.isin(np.arange(1, len(pairs)), first)].all())
