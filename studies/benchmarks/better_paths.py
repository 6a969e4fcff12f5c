"""How soon the paths of arms become short: their length over the best known, after milliseconds of processor time.

    python -m studies.benchmarks.better_paths --count 10      # 10 problems a kind for the UR5 and the arm of 7 joints

Time counts from the query of a known world on: first path, smoothing and improvement.  The best known is the shortest
that this run or others find, which are driven by other sequences and take far longer.  A path that comes later counts
as it is when it comes; problems with straight paths are in.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator

import numpy as np
from studies.benchmarks.arm_problems import REPORTING, TUNING, Pool, Problem, arm_named, problems
from studies.benchmarks.rows import parser_of

from evenroad.planning.arm_trees import connect
from evenroad.planning.connectors import ArmTrees
from evenroad.roadmap.attempt import NO_LIMIT
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.tree_sequences import shifted_cube_points

TREES = ArmTrees(shortest=True)

MOST_MOTIONS = 200_000
TIMES = (1.0, 3.0, 10.0, 30.0, 100.0, 300.0)
OTHERS = 3
SLICE = 100


def lengths(world: ArmWorld, problem: Problem, variant: int, most: float) -> Iterator[tuple[float, float]]:
    """Yield the processor time [ms] and the length of each better path; nothing where none is found."""
    begin = time.thread_time()
    goals, dim = problem.goal[np.newaxis], world.space.dim
    sequence = shifted_cube_points(dim, variant) if variant else None
    found = connect(world, problem.start, goals, most_motions=MOST_MOTIONS, seconds=60, sequence=sequence)
    if found.goal < 0:
        return
    path, _ = TREES.smooth(world, found.path)
    terminals = np.concatenate([problem.start[np.newaxis], goals])
    first = path, 0, found.motions
    improver = TREES.improver(world, terminals, first, variant=variant, is_smoothing=True)
    length, state = np.inf, "paused"
    while True:
        if improver.length < length:
            length = improver.length
            yield 1e3 * (time.thread_time() - begin), length
        if state != "paused" or 1e3 * (time.thread_time() - begin) > most:
            return
        state = improver.improve(NO_LIMIT, NO_LIMIT, SLICE)


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--count", type=int, default=10, help="problems of each kind, at most 100")
    parser.add_argument("--arms", nargs="*", default=["arm7", "ur5"])
    parser.add_argument("--tuning", action="store_true", help="the problems that constants are chosen on")
    parser.add_argument("--best", type=float, default=1.0, help="seconds of each of three other runs [s]")
    options = parser.parse_args()
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    for name in options.arms:
        ratios = []
        for problem in problems(Pool(arm_named(name)), (TUNING if options.tuning else REPORTING)[: options.count]):
            world = ArmWorld(problem.robot, problem.scene)
            if not (run := list(lengths(world, problem, 0, TIMES[-1]))):
                continue
            others = [list(lengths(world, problem, 1 + i, 1e3 * options.best)) for i in range(OTHERS)]
            best = min(length for each in (run, *others) for _, length in each)
            ratios.append([min([c for t, c in run if t <= most] or [run[0][1]]) / best for most in TIMES])
        print(f"{name}: {len(ratios)} problems; mean / median / 95 % / largest")
        for most, column in zip(TIMES, np.array(ratios).T, strict=True):
            spread = np.mean(column), np.median(column), np.quantile(column, 0.95), column.max()
            print(f"  {most:5g} ms: {' / '.join(f'{each:.4f}' for each in spread)}", flush=True)
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
