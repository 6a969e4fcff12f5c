"""The network's sets in the mazes, by what it starts from: ``python -m benchmarks.network_mazes``.

As in the paper suite: k = 10 symmetrised, the start and the goal by the same rule.  Beside the networks the Kronecker
starts as they are, and the pool that is shipped.  Success in %, with its standard error over the sets.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import numpy as np

from evenroad.points import PointSet, draw
from evenroad.research.mazes import load_maze
from evenroad.research.network import NetworkConfig
from evenroad.research.network.train import kronecker
from evenroad.research.training import train_many
from evenroad.roadmap import KNearest, plan

CELLS = ((64, (1, 2)), (128, (2,)), (256, (3,)))
SEED, STARTS, POOL = 7, 400, 8


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


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--sets", type=int, default=32)
    parser.add_argument("--steps", type=int, default=2000)
    options = parser.parse_args()
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
        pool = [draw("mpmc", n, 2, rng=i) for i in range(POOL)]
        for level in levels:
            cells = (solved(level, sets) for sets in (made, starts, other, pool))
            print(f"| {level} | {n} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
