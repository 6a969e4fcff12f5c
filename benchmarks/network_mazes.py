"""The network's sets in the mazes, by what it starts from: ``python -m benchmarks.network_mazes``.

As in the paper suite: k = 10 symmetrised, the start and the goal by the same rule.  Beside the networks the Kronecker
starts as they are, and the pool that is shipped.  Success in %, with its standard error over the sets.  ``--random``:
in the fair suite's random mazes, N = 256, paired by world.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import numpy as np

from benchmarks.nested_k import smallest_k
from evenroad.points import PointSet, draw
from evenroad.points.bank import Bank
from evenroad.roadmap import KNearest, plan
from evenroad.world.gridmap.shipped import load_maze
from evenroad_studies.network import NetworkConfig
from evenroad_studies.network.train import kronecker
from evenroad_studies.problems.fair import DIFFICULTIES, SIZES, Family, Stream, make_instance
from evenroad_studies.training import train_many

CELLS = ((64, (1, 2)), (128, (2,)), (256, (3,)))
SEED, STARTS = 7, 400
NEIGHBOURS = (4, 6, 10, 20)


def solved(level: int, sets: Sequence[PointSet]) -> str:
    """Return how many of the sets solve a maze."""
    maze = load_maze(level)
    world = maze.world()
    asked = (
        plan(world, maze.start, maze.goal, each, rule=KNearest(10), links=None, shorten=False).solved
        for each in sets
    )
    share = 100.0 * np.array(list(asked), dtype=float)
    return f"{share.mean():.0f} ± {share.std(ddof=1) / np.sqrt(len(share)):.0f}"


def in_random_mazes(worlds: int, n: int = 256) -> None:
    """Print success, over three difficulties and by k, and what each is ahead of the pool's sets."""
    ways = {
        "the pool": lambda rng: draw("mpmc", n, 2, rng=rng).points,
        "Kronecker points": lambda rng: kronecker(n, rng.random(2)),
        "`even`": lambda rng: draw("even", n, 2, rng=rng).points,
        "Sobol, scrambled": lambda rng: draw("sobol", n, 2, rng=rng).points,
    }
    least = np.zeros((len(ways), worlds, len(DIFFICULTIES)), int)
    for world, hard in np.ndindex(least.shape[1:]):
        size = SIZES[Family.MAZE, 2][hard]
        problem = make_instance(Stream.REPORTING, Family.MAZE, 2, DIFFICULTIES[hard], size, world)
        for way, points in enumerate(ways.values()):
            least[way, world, hard] = smallest_k(
                problem, points(np.random.default_rng([SEED, world, hard])), max(NEIGHBOURS)
            )
    solved = 100.0 * np.stack([least <= k for k in NEIGHBOURS], axis=-1)
    print("| points | " + " | ".join(f"k = {k}" for k in NEIGHBOURS) + " | all | minus the pool |")
    print("|---|" + "---|" * (len(NEIGHBOURS) + 2))
    for name, of in zip(ways, solved, strict=True):
        ahead = (of - solved[0]).mean(axis=-1).ravel()
        cells = (*of.mean(axis=(0, 1)), of.mean())
        error = ahead.std(ddof=1) / np.sqrt(ahead.size)
        print(
            f"| {name} | " + " | ".join(f"{c:.1f}" for c in cells) + f" | {ahead.mean():+.1f} ± {error:.1f} |"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--sets", type=int, default=32)
    parser.add_argument("--steps", type=int, default=2000)
    parser.add_argument(
        "--random", type=int, metavar="WORLDS", help="so many random mazes a difficulty instead"
    )
    options = parser.parse_args()
    if options.random:
        in_random_mazes(options.random)
        return
    print(
        "| level | n | network from Kronecker points | these points | network from Sobol points | the pool |"
    )
    print("|---|---|---|---|---|---|")
    for n, levels in CELLS:
        made, other = (
            train_many(
                NetworkConfig(n, 2, start=start, steps=options.steps), options.sets, rng=SEED, workers=1
            )
            for start in ("kronecker", "sobol")
        )
        shifts = np.random.default_rng(SEED).random((STARTS, 2))
        starts = [PointSet(kronecker(n, shift)) for shift in shifts]
        pool = [PointSet(points) for points in Bank().cell("mpmc", n, 2).load()]
        for level in levels:
            cells = (solved(level, sets) for sets in (made, starts, other, pool))
            print(f"| {level} | {n} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
