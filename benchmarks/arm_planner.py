"""The compiled planner of arms on shelves, boxes, cages and tables: scene, path and shortening, and what they cost.

    python -m benchmarks.arm_planner                       # UR5 and the arm of 7 joints, 100 problems a kind
    python -m benchmarks.arm_planner --ompl                # beside OMPL's RRT-Connect with our checker ([peers])

Times are milliseconds of CPU time of one thread, each the best of a few runs of a query, all the same; printed
as median / mean / 95 %.  "checks" is what the checks of path and shortening alone cost: the difference that it makes to
test every batch of configurations twice.  Problems that no planner here solves are left out of the figures; how many,
it says.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
from numba import carray, cfunc

from benchmarks.arm_problems import KINDS, REPORTING, TUNING, Pool, Problem, arm, problems
from evenroad.roadmap.shortcut import path_length, shortcut
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.kernel import lane_check
from evenroad.robot.kernel.contact import blocked_lanes
from evenroad.robot.kernel.forward_kinematics import write_values
from evenroad.robot.trees import connect, shorten
from evenroad.world.protocol import Connection

Path = npt.NDArray[np.float64]

REPEATS = 5
MOST_MOTIONS = 200_000
FIRST_PLAN = """
import time
begin = time.perf_counter()
from benchmarks.arm_planner import first_problem
from evenroad.robot.trees import connect, shorten
world, start, goals = first_problem()
world.valid(goals), world.motion_valid(goals, goals)
before = time.perf_counter()
path = connect(world, start, goals).path
between = time.perf_counter()
shorten(world, path, proved=True)
print(before - begin, between - before, time.perf_counter() - between)
"""


@cfunc(lane_check._SIGNATURE)
def _twice(scratch: Any, states: Any, ints: Any, table: Any, enough: int) -> int:
    """Check sixteen configurations two times."""
    memory, integers = carray(scratch, 1 << 40), carray(ints, 1 << 40)
    floats = carray(table, 1 << 40)
    blocked = 0
    for _ in range(2):
        write_values(memory, carray(states, 1 << 40), integers, floats)
        blocked = blocked_lanes(memory, integers, floats, enough)
    return blocked


def best_time(task: Callable[[], Any]) -> tuple[Any, float]:
    """Return what a task gives, and the shortest of its times [ms]."""
    best = np.inf
    for _ in range(REPEATS):
        begin = time.thread_time()
        result = task()
        best = min(best, time.thread_time() - begin)
    return result, 1e3 * best


def answer(world: ArmWorld, problem: Problem) -> tuple[Connection, Path]:
    """Return the path of the trees, and the shortened one."""
    connection = connect(
        world, problem.start, problem.goal[np.newaxis], most_motions=MOST_MOTIONS, seconds=60
    )
    path = connection.path
    return connection, shorten(world, path, proved=True)[0] if connection.goal >= 0 else path


def measure(problem: Problem) -> dict[str, float] | None:
    """Return the figures of one problem, or None where it is not solved."""
    world, scene_time = best_time(partial(ArmWorld, problem.robot, problem.scene))
    connection = connect(
        world, problem.start, problem.goal[np.newaxis], most_motions=MOST_MOTIONS, seconds=60
    )
    if connection.goal < 0:
        return None
    goals = problem.goal[np.newaxis]
    _, path_time = best_time(
        partial(connect, world, problem.start, goals, most_motions=MOST_MOTIONS, seconds=60)
    )
    (short, _), short_time = best_time(partial(shorten, world, connection.path, proved=True))
    _, once = best_time(partial(answer, world, problem))
    address, lane_check.check_address = lane_check.check_address, lambda: int(_twice.address)
    try:
        _, twice = best_time(partial(answer, world, problem))
    finally:
        lane_check.check_address = address
    theirs, _ = shortcut(connection.path, world)
    return {
        "scene": scene_time,
        "path": path_time,
        "shorten": short_time,
        "path + shorten": path_time + short_time,
        "all": once,
        "checks": twice - once,
        "motions": connection.motions,
        "raw": path_length(connection.path, world.space),
        "short": path_length(short, world.space),
        "all pairs": path_length(theirs, world.space),
    }


def report(title: str, rows: list[dict[str, float]]) -> None:
    """Print a line of figures."""

    def spread(name: str) -> str:
        values = [row[name] for row in rows]
        return f"{np.median(values):.2f}/{np.mean(values):.2f}/{np.quantile(values, 0.95):.2f}"

    total = {name: sum(row[name] for row in rows) for name in rows[0]}
    ratios = [row["all"] / row["checks"] for row in rows]
    print(
        f"{title}: {len(rows)} solved; scene {spread('scene')}, path {spread('path')}, shorten {spread('shorten')},"
        f" path + shorten {spread('path + shorten')} ms; motions {spread('motions')};"
        f" whole / checks {total['all'] / total['checks']:.2f}, median {np.median(ratios):.2f};"
        f" length {total['raw'] / len(rows):.2f} -> {total['short'] / len(rows):.2f}"
        f" (all pairs {total['all pairs'] / len(rows):.2f}: {total['short'] / total['all pairs'] - 1:+.1%})",
        flush=True,
    )


def first_problem() -> tuple[ArmWorld, Path, Path]:
    """Return a world, a start and goals that need more than a straight motion."""
    from benchmarks.arm_speed import ur5_world

    world = ur5_world("box-reach")
    goals = np.array([[-0.1216, -0.6993, 1.2160, -2.1070, 2.3023]])
    return world, np.array([0.0, -0.5 * np.pi, 0.0, -0.5 * np.pi, 0.0]), goals


def measure_compilation() -> None:
    """Print how long it takes to load the world, and until the first path and the first shortened one."""
    with tempfile.TemporaryDirectory() as folder:
        for state in ("empty", "full"):
            run = subprocess.run(
                [sys.executable, "-c", FIRST_PLAN],
                env={**os.environ, "NUMBA_CACHE_DIR": folder},
                capture_output=True,
                text=True,
                check=True,
            )
            load, path, short = map(float, run.stdout.split())
            print(
                f"{state} cache: world with its first checks {load:.2f} s, then first path {path:.2f} s,"
                f" first shortening {short:.2f} s"
            )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=100, help="problems of each kind, at most 100")
    parser.add_argument("--arms", nargs="*", default=["ur5", "arm7"])
    parser.add_argument("--tuning", action="store_true", help="the problems that constants are chosen on")
    parser.add_argument("--ompl", action="store_true", help="OMPL's RRT-Connect beside it")
    options = parser.parse_args()
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    measure_compilation()
    for name in options.arms:
        pool = Pool(arm(name))
        rows: dict[str, list[dict[str, float]]] = defaultdict(list)
        unsolved: list[Problem] = []
        peer: list[float] = []
        for problem in problems(pool, (TUNING if options.tuning else REPORTING)[: options.count]):
            if options.ompl:
                from benchmarks.arm_ompl import rrt_connect

                solved, seconds = rrt_connect(
                    ArmWorld(problem.robot, problem.scene), problem.start, problem.goal
                )
                peer += [1e3 * seconds] if solved else []
            row = measure(problem)
            if row is None:
                unsolved.append(problem)
            else:
                rows[problem.kind].append(row)
        for kind in KINDS:
            if rows[kind]:
                report(f"{name}, {kind}", rows[kind])
        report(f"{name}, all", [row for of_kind in rows.values() for row in of_kind])
        print(f"{name}: not solved within {MOST_MOTIONS} motions: {[(p.kind, p.seed) for p in unsolved]}")
        if peer:
            spread = f"{np.median(peer):.2f}/{np.mean(peer):.2f}/{np.quantile(peer, 0.95):.2f}"
            print(f"{name}: OMPL's RRT-Connect with our checker: {len(peer)} solved in {spread} ms")
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
