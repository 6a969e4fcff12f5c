"""With fewer neighbours than dimensions, how far should points of a box be drawn in to its middle?

    python -m benchmarks.drawn_in --worlds 200 -d 5 6 7 10 --csv docs/data/drawn_in.csv
    python -m benchmarks.drawn_in --plan --worlds 200 -d 5 7 10 --csv docs/data/drawn_in_plan.csv
    python -m benchmarks.drawn_in --beside-uniform --worlds 300 -d 10
    python -m benchmarks.drawn_in --corners --worlds 120

Success in balls and boxes of the tuning stream, numbers that chose nothing else, in the cells of the fair suite
(difficulty 50 with N = 128 to 1024, 25 and 75 with the N of the calibration), k nearest as in the suite, every k below
d of 3, 4, 6 and 8.  A set is `even`, times a factor about the middle.  Differences are from the factor 1, in points,
with the standard error of their mean over worlds; "sobol" are scrambled Sobol points as they are.

`--plan` asks :func:`evenroad.roadmap.plan` instead, which links start and goal to 100 milestones, whatever k is: in
worlds of difficulty 50, N = 512, k = 4 and 6, the factor that is used beside 1.  `--beside-uniform` asks what uniform
points gain by that factor, in such worlds, by the rule alone; `--corners` what so many sets lose in a passage along
corners of the cube.
"""

from __future__ import annotations

import argparse
import csv
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.nested_k import smallest_k
from evenroad.points import draw
from evenroad.points.samplers.even import DRAWN_IN, drawn_in
from evenroad.roadmap import KNearest, plan
from evenroad_studies.problems import source_named
from evenroad_studies.problems.fair import (
    CALIBRATED_AT,
    DIFFICULTIES,
    SIZES,
    Family,
    Stream,
    make_instance,
)
from evenroad_studies.suites import COUNTS

FACTORS = (1.0, 0.95, 0.9, 0.85, 0.8)
RULES = (3, 4, 6, 8)
LINKED_RULES = (4, 6)
FIRST = 200_000
"""Number of the first world: lower ones were looked at before."""
FIRST_BESIDE_UNIFORM = 300_000


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--worlds", type=int, default=200, help="of each kind, difficulty and N")
    parser.add_argument("--first", type=int, default=FIRST)
    parser.add_argument("-d", type=int, nargs="*", default=[5, 6, 7, 10])
    parser.add_argument("--plan", action="store_true")
    parser.add_argument("--beside-uniform", action="store_true")
    parser.add_argument("--corners", action="store_true")
    parser.add_argument("--csv", type=Path)
    options = parser.parse_args()
    if options.corners:
        corners(options.worlds)
        return
    if options.beside_uniform:
        for d in options.d:
            beside_uniform(d, options.worlds)
        return
    rows = [
        row
        for d in options.d
        for family in (Family.BALLS, Family.BOXES)
        for row in compared(family, d, options.first, options.worlds, options.plan)
    ]
    if options.csv:
        with open(options.csv, "w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["kind", "d", "k", "points", "worlds", "success", "difference", "error"])
            writer.writerows(rows)


def compared(family: Family, d: int, first: int, worlds: int, linked: bool) -> list[tuple[object, ...]]:
    """Print and return success and differences in one kind of world."""
    rules = [k for k in RULES if k < d and not (linked and k not in LINKED_RULES)]
    factors = (1.0, DRAWN_IN) if linked else FACTORS
    names = [f"{factor:g}" for factor in factors] + ["sobol"]
    calibrated = CALIBRATED_AT[family, d]
    cells = sorted({(50, n) for n in (*COUNTS, calibrated)} | {(25, calibrated), (75, calibrated)})
    cells = [(50, 512)] if linked else cells
    # Another N is another world, too: so all differences are independent.
    solved = np.concatenate(
        [
            [
                in_one_world(family, d, *cell, first + worlds * i + j, factors, rules, linked)
                for j in range(worlds)
            ]
            for i, cell in enumerate(cells)
        ]
    ).astype(float)
    rows: list[tuple[object, ...]] = []
    for j, k in enumerate(rules):
        for i, name in enumerate(names):
            gain = solved[:, i, j] - solved[:, 0, j]
            error = gain.std(ddof=1) / np.sqrt(len(gain))
            text = f"{100 * solved[:, i, j].mean():5.1f} %, {100 * gain.mean():+5.1f} +- {100 * error:.1f}"
            print(f"{family.name.lower()} d={d} k={k} {name:5} {text}", flush=True)
            rows.append(
                (
                    family.name.lower(),
                    d,
                    k,
                    name,
                    len(gain),
                    f"{solved[:, i, j].mean():.4f}",
                    f"{gain.mean():.4f}",
                    f"{error:.4f}",
                )
            )
    return rows


def in_one_world(
    family: Family,
    d: int,
    difficulty: int,
    n: int,
    number: int,
    factors: tuple[float, ...],
    rules: list[int],
    linked: bool,
) -> list[list[bool]]:
    """Return what is solved in one world by k, a row for each factor and one for scrambled Sobol."""
    size = SIZES[family, d][DIFFICULTIES.index(difficulty)]
    problem = make_instance(Stream.TUNING, family, d, difficulty, size, number)
    even, sobol = (draw(name, n, d, rng=number) for name in ("even", "sobol"))
    solved = []
    for points in (*(drawn_in(even, factor) for factor in factors), sobol):
        if linked:
            ends = problem.world, problem.start, problem.goal
            ask = partial(plan, *ends, points, success_only=True, shorten=False)
            solved.append([ask(rule=KNearest(k)).solved for k in rules])
        else:
            least = smallest_k(problem, points.points, rules[-1])
            solved.append([least <= k for k in rules])
    return solved


def beside_uniform(d: int, worlds: int) -> None:
    """Print what drawing in gains for uniform points, and what Sobol's gain on these then."""
    for family in (Family.BALLS, Family.BOXES):
        solved = np.zeros((3, worlds, len(LINKED_RULES)))
        for i in range(worlds):
            size = SIZES[family, d][DIFFICULTIES.index(50)]
            problem = make_instance(Stream.TUNING, family, d, 50, size, FIRST_BESIDE_UNIFORM + i)
            uniform, sobol = (draw(name, 512, d, rng=i) for name in ("uniform", "sobol"))
            for j, points in enumerate((uniform, drawn_in(uniform), drawn_in(sobol))):
                least = smallest_k(problem, points.points, max(LINKED_RULES))
                solved[j, i] = [least <= k for k in LINKED_RULES]
        for text, gain in zip(
            ("uniform, drawn in", "sobol on uniform, both drawn in"), np.diff(solved, axis=0), strict=True
        ):
            means, errors = 100 * gain.mean(0), 100 * gain.std(0, ddof=1) / np.sqrt(worlds)
            shown = ", ".join(
                f"k={k} {m:+.1f} +- {e:.1f}" for k, m, e in zip(LINKED_RULES, means, errors, strict=True)
            )
            print(f"{family.name.lower()} d={d} {text}: {shown}", flush=True)


def corners(sets: int) -> None:
    """Print the success on `hypercube-legacy6` with N = 512, of `even` as it is and drawn in."""
    problem, rules = source_named("hypercube-legacy6").make(0), (4, 6, 8)
    drawn = [draw("even", 512, problem.set_dim, rng=i) for i in range(sets)]
    for text, share in (("even", 1.0), ("drawn in", DRAWN_IN)):
        least = np.array(
            [smallest_k(problem, drawn_in(points, share).points, max(rules)) for points in drawn]
        )
        print(text, ", ".join(f"k={k} {100 * (least <= k).mean():.1f} %" for k in rules), flush=True)


if __name__ == "__main__":
    main()
