"""Configurations and motions a second of the disk world, on one core.

Run with ``python benchmarks/gridmap_speed.py``.  The map is 640 x 480 with about twenty walls, drawn from a
seed; the robot is a disk of radius 6.  Motions are the edges of the roadmap that a planner would ask for:
the 10 nearest neighbours of 1024 uniform milestones, blocked ones included, once among the free milestones
and once among all of them.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from evenroad.world import GridMap

COLS, ROWS, RADIUS = 640, 480, 6.0
REPEATS = 11


def maze(rng: np.random.Generator, walls: int = 9, gaps: int = 2) -> npt.NDArray[np.bool_]:
    """Draw walls from top to bottom with a few gaps each, joined here and there by walls across."""
    occupied = np.zeros((ROWS, COLS), dtype=np.bool_)
    spacing = COLS // (walls + 1)
    for wall in range(1, walls + 1):
        left = wall * spacing
        occupied[:, left : left + rng.integers(3, 9)] = True
        for top in rng.integers(0, ROWS - 40, gaps):
            occupied[top : top + rng.integers(20, 36), left : left + 9] = False
    for wall in range(walls + 1):
        top = rng.integers(60, ROWS - 60)
        occupied[top : top + 5, wall * spacing + 22 : (wall + 1) * spacing] = True
    return occupied


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


def main() -> None:
    rng = np.random.default_rng(0)
    grid = GridMap(maze(rng))

    begin = time.perf_counter()
    world = grid.world(RADIUS)
    world.valid(np.zeros((1, 2)))
    world.motion_valid(np.zeros((1, 2)), np.zeros((1, 2)))
    print(f"first build and calls (compiling, or reading compiled code): {time.perf_counter() - begin:.2f} s")

    builds, slowest = rate(lambda: grid.world(RADIUS), 1)
    print(f"build of a 640 x 480 world: {1e3 / builds:.1f} ms (slowest {1e3 / slowest:.1f} ms)")

    q = grid.space.from_cube(rng.random((500_000, 2)))
    free = world.valid(q)
    median, slowest = rate(lambda: world.valid(q), len(q))
    print(f"configurations: {median / 1e6:.1f} M/s (slowest {slowest / 1e6:.1f}), {free.mean():.1%} free")

    for name, candidates in (("free milestones", q[free][:1024]), ("all milestones", q[:1024])):
        edges = neighbour_edges(candidates)
        a, b = (np.tile(candidates[edges[:, end]], (20, 1)) for end in (0, 1))
        verdicts = world.motion_valid(a, b)
        median, slowest = rate(lambda a=a, b=b: world.motion_valid(a, b), len(a))  # type: ignore[misc]
        length = np.hypot(*(a - b).T).mean()
        print(
            f"motions among {name}: {median / 1e6:.2f} M/s (slowest {slowest / 1e6:.2f}),"
            f" {len(edges)} edges of mean length {length:.1f} px, {verdicts.mean():.1%} free"
        )

    a, b = q[free][:2000], q[free][2000:4000]
    median, _ = rate(lambda: world.motion_valid(a, b), len(a))
    print(f"motions across the whole map: {median / 1e6:.2f} M/s")
    a = a[:1]
    median, _ = rate(lambda: world.motion_valid(a, a), 1)
    print(f"one call with one motion: {1e6 / median:.1f} us")


if __name__ == "__main__":
    main()
