"""Why the lattice loses on Cubicles: by its places, or by what it makes of places and rotations together?

    python -m benchmarks.cubicles_places --draws 220 -n 1024 --csv docs/data/cubicles_places.csv

Success with k nearest, symmetrised, of four kinds of set: scrambled Sobol; the lattice, another shift and order of axes
in each set; the same with the rotations dealt anew among its places; a lattice of places in three dimensions, shifted,
with the rotations of the Sobol set.  "hole" is the largest distance of 20 000 random places from the nearest of the
set, in the scene's units, "valid" how many of the poses are.  The lattice's sets are also told apart by thirds of that
distance, smallest first.
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from benchmarks.nested_k import smallest_k
from evenroad._arrays import Floats
from evenroad.points import draw
from evenroad_studies.problems import source_named

RULES = (4, 6, 10, 20)
NAMES = ("sobol", "lattice", "lattice, rotations dealt anew", "lattice of places")
FIRST = 1000
PROBES = 20_000


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--draws", type=int, default=220)
    parser.add_argument("-n", type=int, default=1024)
    parser.add_argument("--csv", type=Path)
    options = parser.parse_args()
    problem = source_named("cubicles-6d").make(0)
    box = problem.world.space.parts[0]
    sides = np.array(box.high) - np.array(box.low)
    probes = np.random.default_rng(0).random((PROBES, 3)) * sides
    least, holes, valid = (np.zeros((options.draws, len(NAMES))) for _ in range(3))
    for i in range(options.draws):
        for j, cube in enumerate(sets(options.n, FIRST + i)):
            least[i, j] = smallest_k(problem, cube, RULES[-1])
            holes[i, j] = cKDTree(cube[:, :3] * sides).query(probes)[0].max()
            valid[i, j] = problem.world.valid(problem.world.space.from_cube(cube)).sum()
    rows = table(least, holes, valid)
    if options.csv:
        with open(options.csv, "w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["points", "sets", *(f"k{k}" for k in RULES), *(f"error{k}" for k in RULES)])
            writer.writerows(rows)


def sets(n: int, number: int) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the four sets of one number, (n, 6) each."""
    random = np.random.default_rng([6, number])
    sobol, lattice = (draw(name, n, 6, rng=number).points for name in ("sobol", "even"))
    dealt = np.hstack([lattice[:, :3], lattice[random.permutation(n), 3:]])
    places = random.permutation(draw("korobov", n, 3, rng=number).points)
    return sobol, lattice, dealt, np.hstack([places, sobol[:, 3:]])


def table(least: Floats, holes: Floats, valid: Floats) -> list[tuple[object, ...]]:
    """Print and return success with its error of all sets of a kind, and of thirds of the lattice's."""
    groups = {name: (j, np.arange(len(least))) for j, name in enumerate(NAMES)}
    for third, rows in enumerate(np.array_split(np.argsort(holes[:, 1], kind="stable"), 3), 1):
        groups[f"lattice, third {third} by hole"] = 1, rows
    lines: list[tuple[object, ...]] = []
    for name, (j, rows) in groups.items():
        share = np.array([(least[rows, j] <= k).mean() for k in RULES])
        error = np.sqrt(share * (1.0 - share) / len(rows))
        text = ", ".join(
            f"k={k} {100 * s:.1f} ({100 * e:.1f})" for k, s, e in zip(RULES, share, error, strict=True)
        )
        print(f"{name:30} {text}; hole {holes[rows, j].mean():.1f}, valid {valid[rows, j].mean():.0f}")
        lines.append((name, len(rows), *(f"{s:.4f}" for s in share), *(f"{e:.4f}" for e in error)))
    return lines


if __name__ == "__main__":
    main()
