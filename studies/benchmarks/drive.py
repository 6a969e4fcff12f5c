"""Cars on maps: how many queries are solved or proved, how fast, how long the paths are, and whether any pose touches.

Random queries of three turning radii on one map, and parking cases, all with processor times.  ``depot.yaml`` is the
map of nav2_bringup, ``tpcap_case1.csv`` a case of TPCAP; neither is in the repository::

    python -m studies.benchmarks.drive --map depot.yaml -n 200
    python -m studies.benchmarks.drive --map depot.yaml --forward-only --seconds 2
    python -m studies.benchmarks.drive --map depot.yaml -n 12 --best 30
    python -m studies.benchmarks.drive --cases tpcap_case*.csv

With `--best`, each query is planned again with other seeds for that many seconds of processor time, and lengths are
compared with that of the shortest path.  Cusps are compared with those of paths that the lattice finds without trees.

Polygons of a case are tested as they are.
"""

from __future__ import annotations

import argparse
import math
import time
from pathlib import Path

import numpy as np

import evenroad as er
from evenroad._native.drive import CarQuery, Steering
from evenroad.driving import CarWorld, load_parking_case
from evenroad.driving.car_space import CarSpace, as_pieces, cusps_of
from evenroad.planning import PlanResult
from evenroad.planning.planners.car import SHORTCUTS

ROBOT = [(-0.45, -0.31), (0.45, -0.31), (0.45, 0.31), (-0.45, 0.31)]
RADII = 0.4, 1.5, 4.0
CAR = [(-0.929, -0.971), (3.76, -0.971), (3.76, 0.971), (-0.929, 0.971)]
"""The car of TPCAP around the middle of its rear axle."""
TURNING = 2.8 / math.tan(0.75)
LATTICE_ROUNDS = 250
"""Rounds of a lattice of 400 poses each: some tenths of a second."""
STEP = 0.002
"""Distance of poses along a path of a case that are looked at once more [m]."""


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


def cusps_of_lattice(world: CarWorld, start: np.ndarray, goal: np.ndarray) -> int | None:
    """Return the number of cusps of a path without trees, after the same shortcuts; None where there is none soon."""
    space = world.space
    assert isinstance(space, CarSpace), "the world is of a car"
    steering = Steering(space.turning_radius, space.spot, space.reverse, space.turning_radius)
    query = CarQuery(world.vehicle, steering, start, goal, 0)
    if not query.search(LATTICE_ROUNDS, has_trees=False):
        return None
    return cusps_of(as_pieces(query.path(SHORTCUTS)[0], space))


def lengths(path: Path, count: int, seconds: float) -> None:
    """Compare the length of each path with the best one of a long run."""
    grid = er.load_map(path)
    for radius in RADII:
        world = grid.world(footprint=ROBOT, turning_radius=radius)
        q = world.space.from_cube(np.random.default_rng(2).random((40 * count + 400, 3)))
        q = q[world.valid(q)][: 2 * count]
        ratios, cusps = [], []
        for start, goal in zip(q[:count], q[count:], strict=True):
            first = er.plan(world, start, goal)
            others = cusps_of_lattice(world, start, goal)
            cusps += [(first.cusps, others)] if first.solved and others is not None else []
            best, seed, began = first.cost, 0, time.thread_time()
            while first.solved and time.thread_time() - began < seconds:
                seed += 1
                other = er.plan(world, start, goal, rng=seed)
                best = min(best, other.cost) if other.solved else best
            ratios += [first.cost / best] if first.solved else []
        median, p95, most = np.percentile(ratios, (50, 95, 100))
        own, others = np.mean(cusps, axis=0)
        print(
            f"{path.stem}, radius {radius:g}: {len(ratios)} lengths by the best of {seconds:g} s: {median:.3f},"
            f" p95 {p95:.3f}, max {most:.3f}; {own:.2f} cusps, of the lattice alone {others:.2f} ({len(cusps)} paths)",
            flush=True,
        )


def on_cases(paths: list[Path], seconds: float) -> None:
    """Plan each parking case with eight seeds."""
    for path in paths:
        case = load_parking_case(path)
        world = case.map.world(footprint=CAR, turning_radius=TURNING)
        results, times, bad = [], [], 0
        for seed in range(8):
            result, spent = timed(world, case.start, case.goal, seconds, seed)
            results.append(result)
            times.append(spent)
            bad += touches(world, result, STEP) if result.solved else 0
        report(path.stem, results, times, bad)


def main() -> None:
    """Run what the options name."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--map", type=Path, help="a map, for random queries")
    parser.add_argument("-n", type=int, default=200, help="queries for each turning radius")
    parser.add_argument("--forward-only", action="store_true")
    parser.add_argument("--best", type=float, default=0.0, help="compare lengths with those of a run of these seconds")
    parser.add_argument("--cases", type=Path, nargs="*", default=[], help="parking cases")
    parser.add_argument("--seconds", type=float, default=5.0)
    given = parser.parse_args()
    if given.map is not None and given.best:
        lengths(given.map, given.n, given.best)
    elif given.map is not None:
        on_map(given.map, given.n, given.seconds, reverse=not given.forward_only)
    on_cases(given.cases, given.seconds)


if __name__ == "__main__":
    main()
