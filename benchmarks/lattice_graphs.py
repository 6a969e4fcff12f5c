"""What should the search for a Korobov lattice look at: its energy, its minima, its projections, or its graph?

    python -m benchmarks.lattice_graphs --figures --csv docs/data/lattice_figures.csv
    python -m benchmarks.lattice_graphs --worlds 960 -d 2 3 5 7 --csv docs/data/lattice_graphs.csv
    python -m benchmarks.lattice_graphs --worlds 240 -d 6 10 --csv docs/data/lattice_graphs_6_10.csv
    python -m benchmarks.lattice_graphs --poor --worlds 960 -d 4 5 6 7 --csv docs/data/lattice_poor.csv
    python -m benchmarks.lattice_graphs --paths --worlds 240 -d 2 3 --csv docs/data/lattice_paths.csv
    python -m benchmarks.lattice_graphs --poses --worlds 480 --csv docs/data/lattice_poses.csv

`--figures`: 100 numbers of points from 64 to 1024, logarithmically spread: successive minima, the share of n at which
the k nearest do not span all axes (or span them and fall into sheets), and into how many pieces the k-nearest graph of
the shifted points in the cube really falls.

Without it, success in balls and boxes of the tuning stream, difficulty 50, numbers that chose nothing else, k nearest
as in the suite.  World by world the number of points goes through 24 from 128 to 1024, so that many lattices count, and
the lattices of a world have the same shift.  "graph" and "width" are, for each k, the lattice chosen for that k; "any
vector" is a rank-1 lattice whose generating vector is no power, by descent of the energy along its axes; "moved" the
lattice with Gaussian noise of 5 % of the spacing, so that no two points have the same neighbours.  Differences are in
points, paired by world; the error is that of the mean over worlds or over the means by n, whichever is larger.

`--poor`: the same in other worlds, for those n from 64 to 1024 alone whose best Korobov lattice is poor (last minimum
over first above 1.5): there `even` has "any vector".  Difficulty 75 up to 250 points, 50 above.

`--paths`: how much longer than straight lines ways are along the roadmap of an empty cube, means over pairs of points
at least .3 apart and over six numbers of points; and in those worlds (other numbers) the lengths of the roadmap's paths
and of the shortened ones beside those of "energy", in per cent, where both found one.

`--poses` asks random worlds in SE(3) with the axes of places and of rotations weighed as that space weighs them: the
lattice "even" takes elsewhere, with its axes in random order; "graph, weighed" the one of best graph among the same
finalists and all ways to deal their axes to places and rotations, stretched as the space stretches them.
"""

from __future__ import annotations

import argparse
import csv
import time
from collections.abc import Callable, Sequence
from functools import cache
from itertools import combinations
from pathlib import Path

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from benchmarks.nested_k import smallest_k
from evenroad._arrays import Floats
from evenroad.points import PointSet, draw
from evenroad.points.measures.rank_one import (
    least_neighbours,
    minima_ratio,
    neighbour_directions,
    successive_minima,
)
from evenroad.points.samplers import korobov, rank_one_search
from evenroad.points.samplers.korobov import korobov_generator
from evenroad.points.samplers.poses import Sliced
from evenroad.roadmap import KNearest, plan
from evenroad.roadmap.neighbours import nearest
from evenroad.roadmap.search import components
from evenroad_studies.bench.task import Problem
from evenroad_studies.problems.fair import (
    DIFFICULTIES,
    ROTATION_WEIGHT,
    SIZES,
    Family,
    Stream,
    make_instance,
)

RULES = (4, 6, 10, 20)
COUNTS = tuple(round(128 * 8 ** (i / 23)) for i in range(24))
FIRST = 800_000
"""Number of the first world: lower ones were looked at before."""
NOISE = 0.05
FIRST_POOR = 880_000
FIRST_PATHS = 850_000
PATHS_OF = ("energy", "sobol", "graph", "moved")
Vector = tuple[int, ...]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--figures", action="store_true")
    parser.add_argument("--poor", action="store_true")
    parser.add_argument("--poses", action="store_true")
    parser.add_argument("--paths", action="store_true")
    parser.add_argument("--worlds", type=int, default=240, help="of each kind")
    parser.add_argument("-d", type=int, nargs="*", default=[2, 3, 5, 6, 7, 10])
    parser.add_argument("--csv", type=Path)
    options = parser.parse_args()
    if options.figures:
        header = ["set", "d", "first", "ratio", "worst_ratio", "least", "worst_least", "seconds"]
        header += [
            f"{what}{k}" for k in RULES for what in ("short_of_axes", "sheets", "pieces", "largest_piece")
        ]
        lines = [line for d in options.d if d < 10 for line in figures(d)]
    elif options.paths:
        header = ["where", "d", "set", "k", "worlds", "value", "error", "shortened", "error_shortened"]
        lines = [line for d in options.d for line in (*in_empty_cube(d), *paths(d, options.worlds))]
    else:
        header = [
            "kind",
            "d",
            "set",
            "k",
            "worlds",
            "success",
            "minus_energy",
            "error",
            "minus_sobol",
            "error_sobol",
        ]
        kinds = (
            [(Family.SE3, 6)]
            if options.poses
            else [(kind, d) for d in options.d for kind in (Family.BALLS, Family.BOXES)]
        )
        lines = [line for kind, d in kinds for line in planning(kind, d, options.worlds, options.poor)]
    if options.csv:
        with open(options.csv, "w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(header)
            writer.writerows(lines)


def powers(n: int, d: int, by: str = "energy", k: int | None = None) -> Vector:
    """Return the generating vector of a Korobov lattice."""
    multiplier = korobov_generator(n, d, by, k)
    return tuple(pow(multiplier, i, n) for i in range(d))


@cache
def any_vector(n: int, d: int) -> Vector:
    """Return a generating vector of small energy that need not be one of powers."""
    return rank_one_search._descended(n, powers(n, d)) if d > 2 else powers(n, d)


def figures(d: int) -> list[tuple[object, ...]]:
    """Print and return what the lattices of one dimension are like, a line for each objective."""
    numbers = np.unique(np.rint(np.geomspace(64, 1024, 100)).astype(int)).tolist()
    ways: dict[str, Callable[[int], Vector]] = {
        "energy": lambda n: powers(n, d),
        "even": lambda n: rank_one_search.rank_one_vector(n, d),
        "minima": lambda n: powers(n, d, "minima"),
        "projections": lambda n: powers(n, d, "projections"),
        "graph 6": lambda n: powers(n, d, "graph", 6),
    }
    lines = []
    for name, way in ways.items():
        began = time.process_time()
        vectors = [way(n) for n in numbers]
        seconds = (time.process_time() - began) / len(numbers)
        minima = np.array([successive_minima(n, z) for n, z in zip(numbers, vectors, strict=True)])
        first = float(np.median(minima[:, 0] * np.array(numbers) ** (1 / d)))
        ratios = minima[:, -1] / minima[:, 0]
        least = [least_neighbours(n, z) for n, z in zip(numbers, vectors, strict=True)]
        line: list[object] = [name, d, f"{first:.3f}", f"{np.median(ratios):.3f}", f"{ratios.max():.3f}"]
        line += [int(np.median(least)), max(least), f"{seconds:.4f}"]
        for k in RULES:
            directions = [neighbour_directions(n, z, k) for n, z in zip(numbers, vectors, strict=True)]
            pieces, largest = np.array([in_cube(n, z, k) for n, z in zip(numbers, vectors, strict=True)]).T
            short = np.mean([each.rank < d for each in directions])
            sheets = np.mean([1 < each.sheets < np.inf for each in directions])
            line += [f"{short:.3f}", f"{sheets:.3f}", int(pieces.max()), f"{largest.min():.3f}"]
        print(*line, flush=True)
        lines.append(tuple(line))
    return lines


def in_cube(n: int, z: Vector, k: int) -> tuple[int, float]:
    """Return the pieces of the graph of k nearest of the shifted points in the cube, and the largest's share."""
    neighbours = nearest(shifted(n, z, np.random.default_rng([n, k])), k)
    own = np.repeat(np.arange(n), neighbours.shape[1])
    label = components(n, np.stack([own, neighbours.ravel()], axis=1).astype(np.int32))
    sizes = np.unique(label, return_counts=True)[1]
    return len(sizes), sizes.max() / n


def in_empty_cube(d: int) -> list[tuple[object, ...]]:
    """Print and return how much longer ways along the roadmap are than straight lines."""
    lines: list[tuple[object, ...]] = []
    for k in RULES:
        of: dict[str, list[float]] = {}
        for n in COUNTS[::4]:
            for name, by_k in sets(n, d, n).items():
                of.setdefault(name, []).append(stretch(by_k[RULES.index(k) % len(by_k)], k))
        print(
            f"empty cube d={d} k={k}",
            *(f"{name} {np.mean(each):.2f}" for name, each in of.items()),
            flush=True,
        )
        lines += [
            ("empty cube", d, name, k, "", f"{np.mean(each):.3f}", "", "", "") for name, each in of.items()
        ]
    return lines


def stretch(points: Floats, k: int) -> float:
    """Return the mean of shortest ways over straight lines, from 40 of the points to all that are not near."""
    n = len(points)
    neighbours = nearest(points, k)
    own, other = np.repeat(np.arange(n), neighbours.shape[1]), neighbours.ravel()
    lengths = np.linalg.norm(points[own] - points[other], axis=1)
    starts = np.linspace(0, n - 1, 40).astype(int)
    ways = dijkstra(coo_matrix((lengths, (own, other)), shape=(n, n)).tocsr(), directed=False, indices=starts)
    straight = np.linalg.norm(points[starts, np.newaxis] - points, axis=2)
    return float((ways / np.maximum(straight, 1e-9))[straight >= 0.3].mean())


def paths(d: int, worlds: int) -> list[tuple[object, ...]]:
    """Print and return lengths of paths beside those of "energy" [%], as found and shortened."""
    lines: list[tuple[object, ...]] = []
    for kind in (Family.BALLS, Family.BOXES):
        found = np.full((worlds, len(PATHS_OF), len(RULES), 2), np.nan)
        for i in range(worlds):
            number = FIRST_PATHS + i
            problem = make_instance(Stream.TUNING, kind, d, 50, SIZES[kind, d][1], number)
            made = sets(COUNTS[number % len(COUNTS)], d, number)
            for j, name in enumerate(PATHS_OF):
                for m, k in enumerate(RULES):
                    points = PointSet(made[name][m % len(made[name])])
                    ends = problem.world, problem.start, problem.goal
                    result = plan(*ends, points, rule=KNearest(k), links=None)
                    if result.solved:
                        found[i, j, m] = result.milestone_cost, result.cost
        longer = 100.0 * (np.log(found) - np.log(found[:, :1]))
        for j, name in enumerate(PATHS_OF[1:], 1):
            for m, k in enumerate(RULES):
                both = longer[~np.isnan(longer[:, j, m, 0]), j, m]
                means, errors = both.mean(axis=0), both.std(axis=0, ddof=1) / np.sqrt(len(both))
                line = [f"{x:.2f}" for pair in zip(means, errors, strict=True) for x in pair]
                lines.append((kind.name.lower(), d, name, k, len(both), *line))
                print(*lines[-1], flush=True)
    return lines


def shifted(n: int, z: Sequence[int], random: np.random.Generator, noise: float = 0.0) -> Floats:
    """Return the points of a lattice, shifted, (n, d), with noise in units of the spacing."""
    d = len(z)
    points = np.arange(n)[:, np.newaxis] * np.array(z) % n / n + random.random(d)
    if noise:
        points += noise * n ** (-1 / d) * random.standard_normal((n, d))
    return points % 1.0


def planning(kind: Family, d: int, worlds: int, poor: bool = False) -> list[tuple[object, ...]]:
    """Print and return success and differences in one kind of world."""
    counts, first = (poor_counts(d), FIRST_POOR) if poor else (COUNTS, FIRST)
    made = sets_of_poses if kind is Family.SE3 else sets_where_poor if poor else sets
    names: list[str] = []
    solved = []
    for number in range(first, first + worlds):
        n = counts[number % len(counts)]
        difficulty = 75 if poor and n <= 250 else 50
        size = SIZES[kind, d][DIFFICULTIES.index(difficulty)]
        by_name = in_world(
            make_instance(Stream.TUNING, kind, d, difficulty, size, number), made(n, d, number)
        )
        names = list(by_name)
        solved.append([by_name[name] for name in names])
    success = np.array(solved, dtype=float)
    groups = np.arange(first, first + worlds) % len(counts)
    lines = []
    for i, name in enumerate(names):
        text = []
        for j, k in enumerate((*RULES, "all")):
            own = success[:, i].mean(axis=1) if k == "all" else success[:, i, j]
            line: list[object] = [kind.name.lower(), d, name, k, worlds, f"{100 * own.mean():.2f}"]
            for other in (names.index("energy"), names.index("sobol")):
                beside = success[:, other].mean(axis=1) if k == "all" else success[:, other, j]
                gain, error = difference(own - beside, groups)
                line += [f"{gain:.2f}", f"{error:.2f}"]
                text.append(f"{gain:+.1f} ({error:.1f})")
            text.insert(-2, f"k={k}: {100 * own.mean():.1f}")
            lines.append(tuple(line))
        print(f"{kind.name.lower()} d={d} {name:16}", " ".join(text), flush=True)
    return lines


@cache
def poor_counts(d: int) -> tuple[int, ...]:
    """Return the numbers of points whose best Korobov lattice is poor."""
    return tuple(n for n in range(64, 1025) if minima_ratio(n, powers(n, d)) > rank_one_search.POOR)


def sets_where_poor(n: int, d: int, number: int) -> dict[str, list[Floats]]:
    """Return the sets of one world."""
    vectors = {"energy": powers(n, d), "any vector": rank_one_search.rank_one_vector(n, d)}
    random = [np.random.default_rng([18, d, number]) for _ in vectors]
    made = {name: [shifted(n, z, r)] for (name, z), r in zip(vectors.items(), random, strict=True)}
    return made | {"sobol": [draw("sobol", n, d, rng=number).points]}


def difference(gains: Floats, groups: np.ndarray) -> tuple[float, float]:
    """Return the mean in points, and its standard error over worlds or over numbers of points: the larger."""
    means = np.array([gains[groups == g].mean() for g in np.unique(groups)])
    errors = [each.std(ddof=1) / np.sqrt(len(each)) for each in (gains, means)]
    return 100 * float(gains.mean()), 100 * max(errors)


def in_world(problem: Problem, sets: dict[str, list[Floats]]) -> dict[str, list[bool]]:
    """Return what is solved by k; a set for each k, or one for all."""
    known: dict[int, int] = {}
    solved = {}
    for name, by_k in sets.items():
        for points in by_k:
            if id(points) not in known:
                known[id(points)] = smallest_k(problem, points, RULES[-1])
        solved[name] = [
            known[id(points)] <= k for points, k in zip(by_k * (len(RULES) // len(by_k)), RULES, strict=True)
        ]
    return solved


def sets(n: int, d: int, number: int) -> dict[str, list[Floats]]:
    """Return the sets of one world."""
    made: dict[Vector, Floats] = {}

    def of(z: Vector) -> Floats:
        if z not in made:
            made[z] = shifted(n, z, np.random.default_rng([18, d, number]))
        return made[z]

    return {
        "energy": [of(powers(n, d))],
        "sobol": [draw("sobol", n, d, rng=number).points],
        "minima": [of(powers(n, d, "minima"))],
        "projections": [of(powers(n, d, "projections"))],
        "graph": [of(powers(n, d, "graph", k)) for k in RULES],
        "width": [of(powers(n, d, "width", k)) for k in RULES],
        "any vector": [of(any_vector(n, d))],
        "moved": [shifted(n, powers(n, d), np.random.default_rng([18, d, number]), NOISE)],
    }


def sets_of_poses(n: int, d: int, number: int) -> dict[str, list[Floats]]:
    """Return the sets of one world in SE(3)."""
    random = np.random.default_rng([18, number])
    return {
        "energy": [shifted(n, random.permutation(powers(n, 6)).tolist(), random)],
        "sobol": [draw("sobol", n, 6, rng=number).points],
        "graph, weighed": [shifted(n, weighed(n, k), np.random.default_rng([18, number])) for k in RULES],
        "sliced": [Sliced().draw(n, 6, rng=number).points],
    }


@cache
def weighed(n: int, k: int) -> Vector:
    """Return the lattice and the order of its axes whose k neighbours span most of SE(3), as the space stretches it.

    All rotations have the volume pi^2, weighed: a cube of that volume stands for them.
    """
    side = ROTATION_WEIGHT[3] * np.pi ** (2 / 3)
    scale = (1.0, 1.0, 1.0, side, side, side)
    candidates = korobov._candidates(n, 6)
    energies = korobov._energies(korobov._powers(candidates, n, 6), n)
    best: tuple[tuple[float, ...], Vector] | None = None
    for a in candidates[np.argsort(energies)[:16]].tolist():
        for places in combinations(range(6), 3):
            order = (*places, *(i for i in range(6) if i not in places))
            z = tuple(pow(a, i, n) for i in order)
            found = neighbour_directions(n, z, k, scale)
            minima = successive_minima(n, z, scale)
            score = (-found.rank, found.sheets, -round(found.width, 9), round(minima[-1] / minima[0], 9))
            best = (score, z) if best is None or score < best[0] else best
    assert best is not None
    return best[1]


if __name__ == "__main__":
    main()
