"""Configurations and motions a second of the disk world on the shipped mazes, on one core.

    python -m studies.benchmarks.gridmap_speed

The mazes are 640 x 480, the robot is a disk of radius 6.  Motions are the edges of the roadmap that a planner
asks for: the 10 nearest neighbours, symmetrised, of 1024 uniform milestones, blocked ones included; once
among free milestones and once among all of them.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from functools import partial

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from evenroad.world.gridmap.shipped import LEVELS, load_maze

REPEATS = 11


def neighbour_edges(q: npt.NDArray[np.float64], k: int = 10) -> npt.NDArray[np.intp]:
    """Return the edges, (m, 2) with i < j, of the symmetrised k-nearest-neighbour graph."""
    _, neighbours = cKDTree(q).query(q, k + 1)
    pairs = np.stack([np.repeat(np.arange(len(q)), k), neighbours[:, 1:].ravel()], axis=1)
    return np.unique(np.sort(pairs, axis=1), axis=0)


def rate(task: Callable[[], object], items: int) -> tuple[float, float]:
    """Return items a second: the median over the repeats, and the slowest."""
    task()
    seconds = []
    for _ in range(REPEATS):
        begin = time.perf_counter()
        task()
        seconds.append(time.perf_counter() - begin)
    return items / statistics.median(seconds), items / max(seconds)


def measure(level: int) -> None:
    maze = load_maze(level)
    grid, world = maze.map(), maze.world()
    builds, slowest = rate(lambda: grid.world(maze.robot_radius), 1)
    print(f"maze {level}: build {1e3 / builds:.1f} ms (slowest {1e3 / slowest:.1f} ms)")

    q = world.space.from_cube(np.random.default_rng(0).random((500_000, 2)))
    free = world.valid(q)
    median, slowest = rate(lambda: world.valid(q), len(q))
    print(f"  configurations: {median / 1e6:.1f} M/s (slowest {slowest / 1e6:.1f}), {free.mean():.1%} free")

    for name, candidates in (("free milestones", q[free][:1024]), ("all milestones", q[:1024])):
        edges = neighbour_edges(candidates)
        a, b = (np.tile(candidates[edges[:, end]], (20, 1)) for end in (0, 1))
        verdicts = world.motion_valid(a, b)
        median, slowest = rate(partial(world.motion_valid, a, b), len(a))
        length = world.space.distance(a, b).mean()
        print(
            f"  motions among {name}: {median / 1e6:.2f} M/s (slowest {slowest / 1e6:.2f}),"
            f" {len(edges)} edges of mean length {length:.1f} px, {verdicts.mean():.1%} free"
        )

    a, b = q[free][:2000], q[free][2000:4000]
    median, _ = rate(lambda: world.motion_valid(a, b), len(a))
    print(f"  motions across the whole map: {median / 1e6:.2f} M/s")
    median, _ = rate(lambda: world.motion_valid(a[:1], b[:1]), 1)
    print(f"  one call with one motion: {1e6 / median:.1f} us")


def main() -> None:
    begin = time.perf_counter()
    world = load_maze(1).world()
    world.valid(np.zeros((1, 2)))
    world.motion_valid(np.zeros((1, 2)), np.zeros((1, 2)))
    print(f"first build and calls (compiling, or reading compiled code): {time.perf_counter() - begin:.2f} s")
    for level in LEVELS:
        measure(level)


if __name__ == "__main__":
    main()
