"""Cars on maps: how many queries are solved or proved, how fast, how long the paths are, and whether any pose touches.

Random queries of three turning radii on one map, and parking cases, all with processor times.  ``depot.yaml`` is the
map of nav2_bringup, ``tpcap_case1.csv`` a case of TPCAP; neither is in the repository::

    python -m studies.benchmarks.drive --map depot.yaml -n 200
    python -m studies.benchmarks.drive --cases tpcap_case*.csv

A case is one line: start x, y, angle, goal x, y, angle, the number of polygons, their numbers of corners, and all
corners.  Its polygons are drawn on cells of 2 cm, each cell occupied that one of them touches.
"""

from __future__ import annotations

import argparse
import math
import time
from pathlib import Path

import numpy as np

import evenroad as er
from evenroad.driving import CarWorld
from evenroad.planning import PlanResult
from evenroad.world import MapFrame

ROBOT = [(-0.45, -0.31), (0.45, -0.31), (0.45, 0.31), (-0.45, 0.31)]
RADII = 0.4, 1.5, 4.0
CAR = [(-0.929, -0.971), (3.76, -0.971), (3.76, 0.971), (-0.929, 0.971)]
"""The car of TPCAP around the middle of its rear axle."""
TURNING = 2.8 / math.tan(0.75)
CELL = 0.02
MARGIN = 8.0
"""Free space around start, goal and polygons of a case [m]."""


def touches(world: CarWorld, result: PlanResult, step: float) -> int:
    """Return how many poses along the pieces of a path are not free."""
    assert result.pieces is not None, "only of a path"
    side = np.sign(result.pieces[:, 0])
    rows = np.column_stack([side, result.pieces[:, 1]])
    poses = world.space.steering.poses_along(result.start, rows, step)
    return int(np.count_nonzero(~world.valid(poses)))


def timed(
    world: CarWorld, start: np.ndarray, goal: np.ndarray, seconds: float, seed: int = 0
) -> tuple[PlanResult, float]:
    """Return a plan and its processor time [ms]."""
    began = time.thread_time()
    result = er.plan(world, start, goal, seconds=seconds, rng=seed)
    return result, 1e3 * (time.thread_time() - began)


def report(name: str, results: list[PlanResult], times: list[float], bad: int) -> None:
    """Print one row of a table."""
    solved = [each for each in results if each.solved]
    proved = sum(each.status == "not_connected" for each in results)
    median, p95, most = np.percentile(times, (50, 95, 100))
    cusps = np.mean([each.cusps for each in solved]) if solved else math.nan
    print(
        f"{name:24} {len(solved)} solved + {proved} proved of {len(results)};"
        f" {median:.2f} ms, p95 {p95:.1f}, max {most:.0f}; {cusps:.1f} cusps; {bad} poses touch",
        flush=True,
    )


def on_map(path: Path, count: int, seconds: float, *, reverse: bool) -> None:
    """Plan random queries between free poses of a map."""
    grid = er.load_map(path)
    for radius in RADII:
        world = grid.world(footprint=ROBOT, turning_radius=radius, reverse=reverse)
        q = world.space.from_cube(np.random.default_rng(1).random((40 * count + 400, 3)))
        q = q[world.valid(q)][: 2 * count]
        results, times, bad = [], [], 0
        for start, goal in zip(q[:count], q[count:], strict=True):
            result, spent = timed(world, start, goal, seconds)
            results.append(result)
            times.append(spent)
            bad += touches(world, result, 0.1 * grid.resolution) if result.solved else 0
        report(f"{path.stem}, radius {radius:g}", results, times, bad)


def case_world(path: Path) -> tuple[CarWorld, np.ndarray, np.ndarray]:
    """Return the world of a parking case, its start and its goal."""
    numbers = np.array([float(each) for each in path.read_text().split(",")])
    start, goal, count = numbers[:3], numbers[3:6], int(numbers[6])
    sizes = numbers[7 : 7 + count].astype(int)
    corners = numbers[7 + count :].reshape(-1, 2)
    ends = np.stack([start[:2], goal[:2]])
    near = np.concatenate([ends, corners[(np.abs(corners - ends.mean(axis=0)) < 40.0).all(axis=1)]])
    low, high = near.min(axis=0) - MARGIN, near.max(axis=0) + MARGIN
    cols, rows = np.ceil((high - low) / CELL).astype(int)
    occupied = np.zeros((rows, cols), dtype=bool)
    first = 0
    for size in sizes:
        _draw(occupied, (corners[first : first + size] - low) / CELL)
        first += size
    frame = MapFrame(rows=int(rows), cols=int(cols), resolution=CELL, origin=(float(low[0]), float(low[1])), y_up=True)
    return er.GridMap(occupied[::-1].copy(), frame).world(footprint=CAR, turning_radius=TURNING), start, goal


def _draw(occupied: np.ndarray, polygon: np.ndarray) -> None:
    """Occupy the cells that a polygon touches: those whose rows its sides cross, and what lies between."""
    rows, cols = occupied.shape
    for row in range(max(math.floor(polygon[:, 1].min()), 0), min(math.floor(polygon[:, 1].max()) + 1, rows)):
        met = []
        for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
            low, high = sorted((a, b), key=lambda corner: corner[1])
            if low[1] > row + 1 or high[1] < row:
                continue
            rise = high[1] - low[1]
            for y in (max(low[1], row), min(high[1], row + 1)):
                met.append(low[0] + ((y - low[1]) / rise * (high[0] - low[0]) if rise else 0.0))
            met += [a[0], b[0]] if rise == 0.0 else []
        if met:
            occupied[row, max(math.floor(min(met)), 0) : max(math.floor(max(met)) + 1, 0)] = True
    assert cols > 0


def on_cases(paths: list[Path], seconds: float) -> None:
    """Plan each parking case with eight seeds."""
    for path in paths:
        world, start, goal = case_world(path)
        results, times, bad = [], [], 0
        for seed in range(8):
            result, spent = timed(world, start, goal, seconds, seed)
            results.append(result)
            times.append(spent)
            bad += touches(world, result, 0.1 * CELL) if result.solved else 0
        report(path.stem, results, times, bad)


def main() -> None:
    """Run what the options name."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--map", type=Path, help="a map, for random queries")
    parser.add_argument("-n", type=int, default=200, help="queries for each turning radius")
    parser.add_argument("--forward-only", action="store_true")
    parser.add_argument("--cases", type=Path, nargs="*", default=[], help="parking cases")
    parser.add_argument("--seconds", type=float, default=5.0)
    given = parser.parse_args()
    if given.map is not None:
        on_map(given.map, given.n, given.seconds, reverse=not given.forward_only)
    on_cases(given.cases, given.seconds)


if __name__ == "__main__":
    main()
