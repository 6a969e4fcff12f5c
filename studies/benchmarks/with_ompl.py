"""OMPL's RRT-Connect with its path simplifier beside `er.plan`, on arms among shelves, boxes, cages and tables.

    python -m studies.benchmarks.with_ompl --count 10       # needs the extra [ompl]

Both ask the same world, evenroad's, so that every motion of either path is proved; OMPL asks it through Python, one
motion at a time, as it does for anybody who uses OMPL from Python.  Each query is planned once by each, with a limit
of `SECONDS`.  Times are processor time of one thread, from a robot and a scene to the smoothed path, median / mean;
lengths are of the problems that both solve.
"""

from __future__ import annotations

import time

import numpy as np
from ompl import geometric as og
from ompl import util as ou
from studies.benchmarks.arm_problems import REPORTING, Pool, Problem, arm_named, problems
from studies.benchmarks.rows import parser_of

import evenroad as er
from evenroad.adapters.ompl import ompl_path, path_of, solve, space_information
from evenroad.robot.arm_world import ArmWorld
from evenroad.space.path import path_length

SECONDS = 2.0
Row = tuple[float, float | None]
"""Time [ms] and length of a plan, None where there is none."""


def ours(problem: Problem) -> Row:
    """Plan with `er.plan`."""
    begin = time.thread_time()
    result = er.plan(ArmWorld(problem.robot, problem.scene), problem.start, problem.goal, seconds=SECONDS)
    return 1e3 * (time.thread_time() - begin), result.length


def theirs(problem: Problem) -> Row:
    """Plan with OMPL's RRT-Connect, and simplify its path."""
    begin = time.thread_time()
    world = ArmWorld(problem.robot, problem.scene)
    information = space_information(world)
    path = solve(og.RRTConnect(information), problem.start, problem.goal, seconds=SECONDS)
    if path is not None:
        states = ompl_path(information, path)
        og.PathSimplifier(information).simplifyMax(states)
        path = path_of(information, states)
    return 1e3 * (time.thread_time() - begin), None if path is None else path_length(path, world.space)


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--count", type=int, default=10, help="problems of each kind, at most 100")
    parser.add_argument("--arms", nargs="*", default=["ur5", "arm7"])
    options = parser.parse_args()
    ou.setLogLevel(ou.LogLevel.LOG_NONE)
    ou.RNG.setSeed(1)
    for name in options.arms:
        every = list(problems(Pool(arm_named(name)), REPORTING[: options.count]))
        # The first plan of a process loads what all others use.
        ours(every[0]), theirs(every[0])
        rows = [(ours(problem), theirs(problem)) for problem in every]
        both = [row for row in rows if row[0][1] is not None and row[1][1] is not None]
        for i, who in enumerate(("er.plan", "OMPL's RRT-Connect, simplified")):
            times = [row[i][0] for row in rows if row[i][1] is not None]
            lengths = [row[i][1] for row in both]
            print(
                f"{name}, {who}: {len(times)} of {len(rows)} solved; {np.median(times):.2f} / {np.mean(times):.2f} ms;"
                f" length {np.mean(lengths):.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
