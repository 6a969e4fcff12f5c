"""The compiled planner of arms on shelves, boxes, cages and tables: scene, path and smoothing, and what they cost.

    python -m studies.benchmarks.arm_planner      # UR5 and the arm of 7 joints, 100 problems a kind

Times are milliseconds of CPU time of one thread, each the best of a few runs of a query, which are all the same;
printed as median / mean / 95 %.  "query" is everything, from a robot and a Scene to the smoothed path; "again" is a
second query in the same world: path and smoothing; "quick" is smoothing by straight shortcuts alone, and "beside
quick" are the lengths of smoothed paths as shares of its, and how much longer smoothing takes in the median.  Problems
that are not solved are left out of the figures and named.
"""

from __future__ import annotations

import os
import time
from collections import defaultdict
from collections.abc import Callable
from functools import partial
from itertools import chain
from typing import Any

import numpy as np
import numpy.typing as npt
from studies.benchmarks.arm_problems import KINDS, REPORTING, TUNING, Pool, Problem, arm_named, problems
from studies.benchmarks.rows import parser_of

from evenroad.collision.arm_world import ArmWorld
from evenroad.planning.arm_trees import connect, shorten
from evenroad.planning.connector import Connection
from evenroad.planning.connectors import ARM_TREES
from evenroad.planning.shortcut import shortcut
from evenroad.space.path import path_length

Path = npt.NDArray[np.float64]

REPEATS = 5
MOST_MOTIONS = 200_000


def best_time(task: Callable[[], Any]) -> tuple[Any, float]:
    """Return what a task gives, and the shortest of its times [ms]."""
    best = np.inf
    for _ in range(REPEATS):
        begin = time.thread_time()
        result = task()
        best = min(best, time.thread_time() - begin)
    return result, 1e3 * best


def answer(world: ArmWorld, problem: Problem) -> tuple[Connection, Path]:
    """Return the path of the trees, and the smoothed one."""
    connection = connect(world, problem.start, problem.goal[np.newaxis], most_motions=MOST_MOTIONS, seconds=60)
    path = connection.path
    return connection, ARM_TREES.smooth(world, path)[0] if connection.goal >= 0 else path


def measure(problem: Problem) -> dict[str, float] | None:
    """Return the figures of one problem, or None where it is not solved."""
    world, scene_time = best_time(partial(ArmWorld, problem.robot, problem.scene))
    connection = connect(world, problem.start, problem.goal[np.newaxis], most_motions=MOST_MOTIONS, seconds=60)
    if connection.goal < 0:
        return None
    goals = problem.goal[np.newaxis]
    _, path_time = best_time(partial(connect, world, problem.start, goals, most_motions=MOST_MOTIONS, seconds=60))
    (short, _), short_time = best_time(partial(ARM_TREES.smooth, world, connection.path))
    (quick, _), quick_time = best_time(partial(shorten, world, connection.path))
    _, again = best_time(partial(answer, world, problem))
    _, query = best_time(lambda: answer(ArmWorld(problem.robot, problem.scene), problem))
    theirs, _ = shortcut(world, connection.path)
    return {
        "scene": scene_time,
        "path": path_time,
        "smooth": short_time,
        "quick": quick_time,
        "again": again,
        "query": query,
        "motions": connection.motions,
        "raw": path_length(connection.path, world.space),
        "short": path_length(short, world.space),
        "quickly": path_length(quick, world.space),
        "all pairs": path_length(theirs, world.space),
    }


def report(title: str, rows: list[dict[str, float]]) -> None:
    """Print a line of figures."""

    def spread(name: str) -> str:
        values = [row[name] for row in rows]
        return f"{np.median(values):.2f}/{np.mean(values):.2f}/{np.quantile(values, 0.95):.2f}"

    ratio = np.array([row["short"] / row["quickly"] for row in rows])
    more = np.median([row["smooth"] - row["quick"] for row in rows])
    total = {name: sum(row[name] for row in rows) for name in rows[0]}
    print(
        f"{title}: {len(rows)} solved; scene {spread('scene')}, path {spread('path')}, smooth {spread('smooth')},"
        f" quick {spread('quick')},"
        f" query {spread('query')}, again {spread('again')} ms; motions {spread('motions')};"
        f" length {total['raw'] / len(rows):.2f} -> {total['short'] / len(rows):.2f}"
        f" (quick {total['quickly'] / len(rows):.2f}, all pairs {total['all pairs'] / len(rows):.2f});"
        f" beside quick {ratio.mean():.3f} in the mean, 95 % {np.quantile(ratio, 0.95):.3f}, {more:.2f} ms more",
        flush=True,
    )


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--count", type=int, default=100, help="problems of each kind, at most 100")
    parser.add_argument("--arms", nargs="*", default=["ur5", "arm7"])
    parser.add_argument("--tuning", action="store_true", help="the problems that constants are chosen on")
    options = parser.parse_args()
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    for name in options.arms:
        pool = Pool(arm_named(name))
        rows: dict[str, list[dict[str, float]]] = defaultdict(list)
        unsolved: list[Problem] = []
        for problem in problems(pool, (TUNING if options.tuning else REPORTING)[: options.count]):
            row = measure(problem)
            if row is None:
                unsolved.append(problem)
            else:
                rows[problem.kind].append(row)
        for kind in KINDS:
            if rows[kind]:
                report(f"{name}, {kind}", rows[kind])
        report(f"{name}, all", list(chain(*rows.values())))
        print(f"{name}: not solved within {MOST_MOTIONS} motions: {[(p.kind, p.seed) for p in unsolved]}")
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
