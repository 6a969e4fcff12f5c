"""The paper's experiment carried to cars: which share of worlds a roadmap of N milestones solves, by its points.

Each world is a square of 12 m with random boxes.  A car of 0.9 m by 0.62 m crosses it from corner to corner, along the
curves of Reeds and Shepp.  Only worlds count in which `CarSearch` finds a path.  All samplers get the same worlds, and
in each world every sampler draws with the seed of the world::

    python -m studies.benchmarks.car_roadmaps --worlds 300 -n 64 128 256 512

A row is a number of milestones and a sampler: the share of worlds that are solved with its standard error, and how much
that is more than with uniform points, in the same worlds.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator

import numpy as np

import evenroad as er
from evenroad.driving import CarWorld

SAMPLERS = "even", "halton", "sobol", "uniform"
CAR = [(-0.45, -0.31), (0.45, -0.31), (0.45, 0.31), (-0.45, 0.31)]
TURNING = 0.8
CELL, SIDE = 0.1, 120
START, GOAL = (1.2, 1.2, 0.8), (10.8, 10.8, 0.8)
CLEAR = 24
"""Number of cells along the sides of two corners that stay free."""
BOXES = 26
NEIGHBOURS = 10


def random_world(seed: int) -> CarWorld:
    """Return a square with random boxes, 0.4 m to 2 m along a side; they may overlap."""
    rng = np.random.default_rng(seed)
    cells = np.zeros((SIDE, SIDE), dtype=bool)
    for _ in range(BOXES):
        row, column = rng.integers(0, SIDE, 2)
        height, width = rng.integers(4, 21, 2)
        cells[row : row + height, column : column + width] = True
    cells[:CLEAR, :CLEAR] = cells[-CLEAR:, -CLEAR:] = False
    return er.GridMap(cells, resolution=CELL).world(footprint=CAR, turning_radius=TURNING)


def worlds_with_a_path(count: int) -> Iterator[tuple[int, CarWorld]]:
    """Yield that many worlds in which there is a path, with their seeds."""
    seed = 0
    while count > 0:
        world = random_world(seed)
        if er.plan(world, START, GOAL, smooth=False, seconds=5).solved:
            count -= 1
            yield seed, world
        seed += 1


def is_solved(world: CarWorld, sampler: str, n: int, seed: int) -> bool:
    """Say whether a roadmap on points of a sampler has a path."""
    planner = er.PRM(er.draw(sampler, n, 3, rng=seed), k=NEIGHBOURS, success_only=True)
    return bool(er.plan(world, START, GOAL, planner, smooth=False, seconds=60).solved)


def main() -> None:
    """Print a row for each number of milestones and sampler."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--worlds", type=int, default=300)
    parser.add_argument("-n", type=int, nargs="*", default=[64, 128, 256, 512])
    given = parser.parse_args()
    solved = np.zeros((len(given.n), len(SAMPLERS), given.worlds))
    for row, (seed, world) in enumerate(worlds_with_a_path(given.worlds)):
        for i, n in enumerate(given.n):
            for j, sampler in enumerate(SAMPLERS):
                solved[i, j, row] = is_solved(world, sampler, n, seed)
    for n, of_n in zip(given.n, solved, strict=True):
        for sampler, own in zip(SAMPLERS, of_n, strict=True):
            more = own - of_n[-1]
            print(
                f"N {n:4} {sampler:8} {100 * own.mean():5.1f} ± {100 * own.std() / len(own) ** 0.5:.1f} %,"
                f" more than uniform by {100 * more.mean():+5.1f} ± {100 * more.std() / len(more) ** 0.5:.1f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
