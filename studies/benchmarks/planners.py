"""Planners by the points that they plan with: FMT, roadmaps that grow, and the trees of an arm.

    python -m studies.benchmarks.planners --csv studies/docs/data/planners.csv
    python -m studies.benchmarks.planners --table studies/docs/data/planners.csv

The worlds are reported ones of ``points_apart``: forests, caves and bars in two, three, four and six dimensions, and a
UR5 among boxes.  World after world takes the next of eight numbers of points for FMT.  A roadmap that grows draws a
sequence until there is a path, at most four times as many points.  Trees grow towards a sequence, with at most 20 000
motions.

Nothing is smoothed.  All points see the same worlds.  Success is in percent, and beside it how much more a sampler
solves than scrambled Sobol points, paired by world, with the standard error.  Motions that are checked and lengths (in
the CSV alone) are over those of Sobol's points, as geometric means over the worlds that both solve.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
from studies.benchmarks.points_apart import TIMES, Make, number_of_points, problems
from studies.benchmarks.rows import parser_of, write_rows

import evenroad as er
from evenroad._arrays import Floats
from evenroad.planning import GrowingPRM
from evenroad.planning.arm_trees import connect
from evenroad.points.reversed_halton import shifted_cube_points
from evenroad.points.samplers import make_sampler
from evenroad.space.path import path_length
from evenroad_studies.bench.task import Problem
from evenroad_studies.problems.apart import Use

CELLS = (("apart", 2), ("apart", 3), ("apart", 4), ("apart", 6), ("arms", 6))
"""Family and dimension of the worlds."""
KINDS = ("forest", "cave", "bars", "ur5")
OF_ARMS = "arms"
"""The family in which trees are compiled, and take a sequence."""
GROWN = 4
"""Most points of a roadmap that grows, over the number of the family."""
MOST_MOTIONS, SECONDS, SEQUENCE = 20_000, 60.0, 2048
BESIDE, OTHERS = "sobol", ("lattice", "Halton", "uniform")
"""What the others are compared with, and these: the lattice is `even`, or of sequences `growing`."""
COLUMNS = ("worlds", "d", "planner", "points", "of", "solved", "more", "error", "motions", "length")
Answer = tuple[float, float, float]
"""Whether a path was found, motions that were checked, length of the path."""
Ask = Callable[[Problem, int, int], Answer]
"""From a problem, a number of points and the number of its world."""


def planned(problem: Problem, planner: er.FMT | GrowingPRM, most: int, world: int) -> Answer:
    """Plan without smoothing."""
    result = er.plan(
        problem.world, problem.start, problem.goal, planner, smooth=False, rng=world, limits={"samples": most}
    )
    length = path_length(result.path, problem.world.space) if result.solved else math.nan
    return float(result.solved), float(result.counts.get("edges_checked", 0)), length


def fmt(name: str) -> Ask:
    """Return a tree on a set of points."""
    return lambda problem, n, world: planned(problem, er.FMT(er.draw(name, n, problem.set_dim, rng=world)), n, world)


def growing(name: str) -> Ask:
    """Return a roadmap that grows along a sequence."""
    return lambda problem, n, world: planned(problem, GrowingPRM(make_sampler(name)), GROWN * n, world)


def trees(name: str) -> Ask:
    """Return the two trees of an arm that grow towards a sequence."""

    def ask(problem: Problem, n: int, world: int) -> Answer:
        d = problem.set_dim
        sequence = (
            shifted_cube_points(d, 1 + world)
            if name == "reversed halton"
            else er.draw(name, SEQUENCE, d, rng=world).points
        )
        assert isinstance(problem.world, er.ArmWorld)
        found = connect(
            problem.world,
            problem.start,
            problem.goal[np.newaxis],
            most_motions=MOST_MOTIONS,
            seconds=SECONDS,
            sequence=sequence,
        )
        length = path_length(found.path, problem.world.space) if found.goal >= 0 else math.nan
        return float(found.goal >= 0), float(found.motions), length

    return ask


def asked(family: str) -> Mapping[tuple[str, str], Ask]:
    """Return what is asked in a family: planner and points -> how."""
    found = {("FMT", name): fmt(name) for name in ("sobol", "even", "halton", "uniform")}
    found |= {("GrowingPRM", name): growing(name) for name in ("sobol", "growing", "halton", "uniform")}
    if family == OF_ARMS:
        found |= {("trees", name): trees(name) for name in ("sobol", "growing", "reversed halton", "uniform")}
    return found


def answers(family: str, d: int, worlds: range) -> tuple[list[tuple[str, str]], Floats]:
    """Return what was asked, and the answers, (worlds, asked, 3)."""
    every, n = asked(family), number_of_points(family, d)
    makers: list[tuple[Make, int]] = [
        (make, number) for kind, make in problems(Use.REPORTING, d, family) if kind in KINDS for number in worlds
    ]
    found = np.empty((len(makers), len(every), 3))
    for row, (make, number) in enumerate(makers):
        problem, count = make(number), round(TIMES[number % len(TIMES)] * n)
        for column, ask in enumerate(every.values()):
            found[row, column] = ask(problem, count, number)
    return list(every), found


def rows_of(family: str, d: int, names: Sequence[tuple[str, str]], found: Floats) -> Iterator[dict[str, str]]:
    """Yield a row for each planner and sampler."""
    for column, (planner, name) in enumerate(names):
        here, base = found[:, column], found[:, names.index((planner, BESIDE))]
        more = 100.0 * (here[:, 0] - base[:, 0])
        both = (here[:, 0] > 0.0) & (base[:, 0] > 0.0)
        row = {"worlds": family, "d": str(d), "planner": planner, "points": name, "of": str(len(found))}
        row |= {"solved": f"{100.0 * here[:, 0].mean():.1f}", "more": f"{more.mean():+.1f}"}
        row["error"] = f"{more.std(ddof=1) / math.sqrt(len(more)):.1f}"
        for at, what in ((1, "motions"), (2, "length")):
            # A motion more: a straight path may need none.
            logs = np.log((here[both, at] + (at == 1)) / (base[both, at] + (at == 1)))
            row[what] = f"{math.exp(logs.mean()):.3f} ({logs.std(ddof=1) / math.sqrt(len(logs)):.3f})"
        yield row


def print_table(rows: Sequence[Mapping[str, str]]) -> None:
    """Print a line for each planner in each family: how much more others solve than Sobol's points, and motions."""
    print("| worlds | d | planner | Sobol, % |", " | ".join(f"{each} | motions" for each in OTHERS), "|")
    print("| :-- | --: | :-- |", " | ".join(["--:"] * 7), "|")
    lines: dict[tuple[str, str, str], list[Mapping[str, str]]] = {}
    for row in rows:
        lines.setdefault((row["worlds"], row["d"], row["planner"]), []).append(row)
    for at, (base, *others) in lines.items():
        cells = (f"{row['more']} ({row['error']}) | {row['motions']}" for row in others)
        print("|", " | ".join([*at, base["solved"], *cells]), "|")
    for planner in dict.fromkeys(at[2] for at in lines):
        each = [others for at, (_, *others) in lines.items() if at[2] == planner and at[0] != OF_ARMS]
        if len(each) > 1:
            columns = (mean_text([others[column] for others in each]) for column in range(len(OTHERS)))
            print("|", " | ".join([CELLS[0][0], "mean", planner, "", *columns]), "|")


def mean_text(rows: Sequence[Mapping[str, str]]) -> str:
    """Return the means over dimensions with their errors, of what is solved and of motions; as two cells."""
    more, error = (np.array([float(row[name]) for row in rows]) for name in ("more", "error"))
    motions = np.array([list(map(float, row["motions"].rstrip(")").split(" ("))) for row in rows])
    ratio, spread = math.exp(np.log(motions[:, 0]).mean()), np.linalg.norm(motions[:, 1]) / len(rows)
    return f"{more.mean():+.1f} ({np.linalg.norm(error) / len(rows):.1f}) | {ratio:.3f} ({spread:.3f})"


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("-d", type=int, nargs="*", help="dimensions; default: all")
    parser.add_argument("--worlds", type=int, default=80, help="of each kind; five times as many of the arm")
    parser.add_argument("--first", type=int, default=800_000, help="number of the first world")
    parser.add_argument("--csv", type=Path)
    parser.add_argument("--table", type=Path, nargs="*", help="print the table of such CSVs, and plan nothing")
    options = parser.parse_args()
    if options.table:
        print_table([row for path in options.table for row in csv.DictReader(path.read_text().splitlines())])
        return
    rows: list[dict[str, str]] = []
    for family, d in CELLS:
        if options.d and d not in options.d:
            continue
        count = options.worlds * (5 if family == OF_ARMS else 1)
        rows += rows_of(family, d, *answers(family, d, range(options.first, options.first + count)))
        print(f"{family} {d}: {rows[-1]['of']} worlds", flush=True)
        # After each dimension, so that a long run leaves what it has.
        write_rows(options.csv, COLUMNS, rows)
    print_table(rows)


if __name__ == "__main__":
    main()
