"""With fewer neighbours than dimensions, how far should points of a box be drawn in to its middle?

    python -m benchmarks.drawn_in --worlds 200 -d 5 6 7 10 --csv docs/data/drawn_in.csv

Success in balls and boxes of the tuning stream, numbers that chose nothing else, in the cells of the fair suite
(difficulty 50 with N = 128 to 1024, 25 and 75 with the N of the calibration), k nearest as in the suite, every k below
d of 3, 4, 6 and 8.  A set is `even`, times a factor about the middle.  Differences are from the factor 1, in points,
with the standard error of their mean over worlds; "sobol" are scrambled Sobol points as they are.
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path

import numpy as np

from benchmarks.nested_k import smallest_k
from evenroad._arrays import Floats
from evenroad.points import draw
from evenroad.research.problems.fair import CALIBRATED_AT, SIZES, Family, Stream, make_instance
from evenroad.research.suites import COUNTS

FACTORS = (1.0, 0.95, 0.9, 0.85, 0.8)
NAMES = (*map(str, FACTORS), "sobol")
RULES = (3, 4, 6, 8)
FIRST = 200_000
"""Number of the first world: lower ones were looked at before."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--worlds", type=int, default=200, help="of each kind, difficulty and N")
    parser.add_argument("--first", type=int, default=FIRST)
    parser.add_argument("-d", type=int, nargs="*", default=[5, 6, 7, 10])
    parser.add_argument("--csv", type=Path)
    options = parser.parse_args()
    rows = [
        row
        for d in options.d
        for family in (Family.BALLS, Family.BOXES)
        for row in compared(family, d, options.first, options.worlds)
    ]
    if options.csv:
        with open(options.csv, "w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["kind", "d", "k", "points", "worlds", "success", "difference", "error"])
            writer.writerows(rows)


def compared(family: Family, d: int, first: int, worlds: int) -> list[tuple[object, ...]]:
    """Print and return success and differences in one kind of world."""
    rules = [k for k in RULES if k < d]
    calibrated = CALIBRATED_AT[family, d]
    cells = sorted({(50, n) for n in (*COUNTS, calibrated)} | {(25, calibrated), (75, calibrated)})
    # Another N is another world, too: so all differences are independent.
    solved = np.concatenate(
        [
            [
                least_of(family, d, difficulty, n, first + worlds * cell + i)[:, np.newaxis] <= rules
                for i in range(worlds)
            ]
            for cell, (difficulty, n) in enumerate(cells)
        ]
    ).astype(float)
    rows: list[tuple[object, ...]] = []
    for j, k in enumerate(rules):
        for i, name in enumerate(NAMES):
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


def least_of(family: Family, d: int, difficulty: int, n: int, number: int) -> Floats:
    """Return the smallest k of each of :data:`NAMES` in one world."""
    size = SIZES[family, d][(25, 50, 75).index(difficulty)]
    problem = make_instance(Stream.TUNING, family, d, difficulty, size, number)
    most = max(k for k in RULES if k < d)
    even, sobol = (draw(name, n, d, rng=number).points for name in ("even" if d < 10 else "sobol", "sobol"))
    sets = [0.5 + factor * (even - 0.5) for factor in FACTORS] + [sobol]
    return np.array([smallest_k(problem, cube, most) for cube in sets])


if __name__ == "__main__":
    main()
