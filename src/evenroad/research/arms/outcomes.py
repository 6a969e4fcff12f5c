"""What every way of planning solved, problem by problem and draw by draw: the rows of stores, small enough to keep.

A store has a row for each run, gigabytes for the whole suite; what its tables need is a bit for each.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats, Ints
from evenroad._npz import Arrays, Path, digest, read_npz, require_array, write_npz
from evenroad.errors import BrokenFile
from evenroad.research.arms.problems import PREFIXES, robot_and_generator
from evenroad.research.arms.scenes import GENERATORS
from evenroad.research.bench.rows import Rows


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

    `problems` are (m, 2), the place of the generator in ``GENERATORS`` and the number of the problem, in this order;
    `draws` are (d, 2), seed and number of the run, in order.  `ran` and `solved` are (m, d).  `costs` are medians of
    configurations and motions checked and of ms, (generators + 1, 3), the last row of all; NaN where nothing ran.
    """

    problems: Ints
    draws: Ints
    ran: Bools
    solved: Bools
    costs: Floats


class Paired(NamedTuple):
    """Problems that two ways were asked in the same draws: the generator of each, runs that one solved more, pairs."""

    generator: Ints
    more: Ints
    pairs: Ints


def is_of_arms(problem: str) -> bool:
    """Say whether a problem is of this suite."""
    return problem.startswith(tuple(f"{prefix}-" for prefix in PREFIXES.values()))


def outcomes_of(rows: Rows) -> dict[Way, Outcomes]:
    """Return the outcomes of all ways of planning that a store has rows of."""
    of_arms = np.array([is_of_arms(name) for name in rows.problem.names], dtype=np.bool_)
    rows = rows.where(of_arms[rows.problem.codes])
    names = [
        robot_and_generator(name) if of_arms[i] else ("", "") for i, name in enumerate(rows.problem.names)
    ]
    kinds = [*GENERATORS, ""]
    generator = np.array([kinds.index(kind) for _, kind in names], dtype=np.int64)[rows.problem.codes]
    solved, answered = rows.solved, rows.answered
    asked = np.stack([rows.valid, rows.edges_checked, 1e3 * rows.seconds], axis=1)
    asked[~answered] = np.nan
    found = {}
    for way, here in _ways(rows, names).items():
        problems, problem = np.unique(
            np.stack([generator[here], rows.instance[here]], axis=1), axis=0, return_inverse=True
        )
        draws, draw = np.unique(
            np.stack([rows.seed[here], rows.run[here]], axis=1), axis=0, return_inverse=True
        )
        place = problem.ravel(), draw.ravel()
        ran, reached = (np.zeros((len(problems), len(draws)), dtype=np.bool_) for _ in range(2))
        ran[place], reached[place] = True, solved[here]
        costs = [_medians(asked[here[generator[here] == each]]) for each in range(len(GENERATORS))]
        found[way] = Outcomes(problems, draws, ran, reached, np.stack([*costs, _medians(asked[here])]))
    return found


def _ways(rows: Rows, names: list[tuple[str, str]]) -> dict[Way, Ints]:
    """Return the rows of each way of planning."""
    columns = (rows.problem.codes, rows.n, rows.sampler.codes, rows.rule.codes, rows.search.codes)
    kinds, which = np.unique(np.stack(columns, axis=1), axis=0, return_inverse=True)
    order = np.argsort(which, kind="stable")
    groups = np.split(order, np.cumsum(np.bincount(which.ravel()))[:-1]) if len(rows) else []
    ways: dict[Way, list[Ints]] = {}
    for (problem, n, sampler, rule, search), group in zip(kinds.tolist(), groups, strict=True):
        rule_name = rows.rule.names[rule]
        k = rule_name.partition(" ")[0].removeprefix("k=")
        sampled, searched = rows.sampler.names[sampler], rows.search.names[search]
        ways.setdefault(Way(names[problem][0], k, n, sampled, rule_name, searched), []).append(group)
    return {way: np.concatenate(groups) for way, groups in ways.items()}


def _medians(asked: Floats) -> Floats:
    asked = asked[~np.isnan(asked[:, 2])]
    medians: Floats = np.median(asked, axis=0) if len(asked) else np.full(3, np.nan)
    return medians


def paired(one: Outcomes, other: Outcomes) -> Paired:
    """Return what the first solved more than the other, by problem; a run without its like is left out."""
    _, mine, theirs = np.intersect1d(_codes(one.problems), _codes(other.problems), return_indices=True)
    _, my_draws, their_draws = np.intersect1d(_codes(one.draws), _codes(other.draws), return_indices=True)
    here, there = np.ix_(mine, my_draws), np.ix_(theirs, their_draws)
    both = one.ran[here] & other.ran[there]
    more = (one.solved[here] & both).sum(axis=1) - (other.solved[there] & both).sum(axis=1)
    asked = both.any(axis=1)
    return Paired(one.problems[mine[asked], 0], more[asked], both.sum(axis=1)[asked])


def _codes(pairs: Ints) -> Ints:
    """Return a number for each pair of numbers, in their order: seeds are 32 bits."""
    return (pairs[:, 0] << 31) + pairs[:, 1]


_NAMES = ("ways", "sizes", "problems", "draws", "ran", "solved", "costs")


def write_outcomes(path: Path, outcomes: Mapping[Way, Outcomes]) -> None:
    """Write outcomes into a compressed .npz file, a bit for each run, atomically."""
    draws = np.unique(np.concatenate([each.draws for each in outcomes.values()]), axis=0)
    places = [np.searchsorted(_codes(draws), _codes(each.draws)) for each in outcomes.values()]

    def packed(masks: list[Bools]) -> npt.NDArray[np.uint8]:
        wide = [np.zeros((len(mask), len(draws)), dtype=np.bool_) for mask in masks]
        for target, mask, place in zip(wide, masks, places, strict=True):
            target[:, place] = mask
        return np.packbits(np.concatenate(wide), axis=1)

    arrays: Arrays = {
        "ways": np.array([[str(field) for field in way] for way in outcomes]),
        "sizes": np.array([len(each.problems) for each in outcomes.values()], dtype=np.int64),
        "problems": np.concatenate([each.problems for each in outcomes.values()]).astype(np.int32),
        "draws": draws,
        "ran": packed([each.ran for each in outcomes.values()]),
        "solved": packed([each.solved for each in outcomes.values()]),
        "costs": np.stack([each.costs for each in outcomes.values()]),
    }
    write_npz(path, arrays | {"hash": np.array(digest(arrays))}, compressed=True)


def read_outcomes(path: Path) -> dict[Way, Outcomes]:
    """Return the outcomes that :func:`write_outcomes` wrote; BrokenFile if it is no such file, or not as written."""
    arrays = read_npz(path, "file of outcomes", (*_NAMES, "hash"))
    written = str(arrays.pop("hash"))
    if digest(arrays) != written:
        raise BrokenFile(f"{path}: what it holds has another hash than was written")
    ways, sizes, draws = arrays["ways"], arrays["sizes"], arrays["draws"]
    require_array(path, "sizes", sizes, np.int64, (len(ways),))
    total, bits = int(sizes.sum()), -(-len(draws) // 8)
    require_array(path, "problems", arrays["problems"], np.int32, (total, 2))
    require_array(path, "draws", draws, np.int64, (None, 2))
    require_array(path, "costs", arrays["costs"], np.float64, (len(ways), len(GENERATORS) + 1, 3))
    masks = []
    for name in ("ran", "solved"):
        require_array(path, name, arrays[name], np.uint8, (total, bits))
        masks.append(np.unpackbits(arrays[name], axis=1, count=len(draws)).astype(np.bool_))
    found = {}
    ends = np.cumsum(sizes).tolist()
    for fields, costs, end, size in zip(ways.tolist(), arrays["costs"], ends, sizes.tolist(), strict=True):
        robot, k, n, *others = fields
        here = slice(end - size, end)
        problems = arrays["problems"][here].astype(np.int64)
        found[Way(robot, k, int(n), *others)] = Outcomes(
            problems, draws, masks[0][here], masks[1][here], costs
        )
    return found
