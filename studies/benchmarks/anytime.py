"""How soon the paths of arms become short: their length over the best known, after milliseconds of processor time.

    python -m studies.benchmarks.anytime --count 8                     # 8 problems a kind, the UR5 and seven joints
    python -m studies.benchmarks.anytime --count 3 --ompl 3            # AORRTC and BIT* of OMPL beside it, 3 s each
    python -m studies.benchmarks.anytime --picture FILE                # and a picture of the curves

Time counts from the query of a known world on: first path, smoothing and improvement.  The best known is the shortest
that this run or others find, which are driven by other sequences and take far longer; where OMPL runs, its paths
count, too.  A path that comes later counts as it is when it comes; problems with straight paths are in.  OMPL (extra
[ompl], 2.0 for AORRTC; its wheel has no AIT*) asks the same proofs through Python, one motion at a time.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from studies.benchmarks.arm_problems import REPORTING, TUNING, Pool, Problem, Vector, arm_named, problems
from studies.benchmarks.rows import parser_of

from evenroad.planning.arm_trees import connect
from evenroad.planning.connectors import ArmTrees
from evenroad.roadmap.attempt import NO_LIMIT
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.certified import CertifiedWorld
from evenroad.robot.tree_sequences import shifted_cube_points

TREES = ArmTrees(shortest=True)

MOST_MOTIONS = 200_000
TIMES = (1.0, 3.0, 10.0, 30.0, 100.0, 300.0)
LATER = (1000.0, 3000.0)
"""Times of OMPL alone [ms]."""
OF_OMPL = ("AORRTC", "BITstar")
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


def lengths_of(name: str, world: ArmWorld, problem: Problem, most: float) -> Iterator[tuple[float, float]]:
    """Yield as `lengths` of a planner of OMPL, looked at after each of the times."""
    from ompl import base as ob
    from ompl import geometric as og
    from ompl import util as ou

    from evenroad.adapters.ompl import format_of, space_information

    ou.setLogLevel(ou.LogLevel.LOG_NONE)
    begin = time.thread_time()
    information = space_information(CertifiedWorld(world))
    definition = ob.ProblemDefinition(information)
    ends = []
    for q in (problem.start, problem.goal):
        state = information.allocState()
        format_of(information.getStateSpace()).write(state, q.tolist())
        ends.append(state)
    definition.setStartAndGoalStates(*ends)
    definition.setOptimizationObjective(ob.PathLengthOptimizationObjective(information))
    planner = getattr(og, name)(information)
    planner.setProblemDefinition(definition)
    planner.setup()
    for until in (each for each in (*TIMES, *LATER) if each <= most):
        left = 1e-3 * until - (time.thread_time() - begin)
        if left > 0.0:
            planner.solve(left)
        if definition.hasExactSolution():
            yield 1e3 * (time.thread_time() - begin), definition.getSolutionPath().length()


def measured(problem: Problem, best: float, ompl: float) -> list[list[float]] | None:
    """Return the lengths after each time over the best known of each planner; None where there is no path."""
    world = ArmWorld(problem.robot, problem.scene)
    runs = [list(lengths(world, problem, 0, TIMES[-1]))]
    if not runs[0]:
        return None
    others = [list(lengths(world, problem, 1 + i, 1e3 * best)) for i in range(OTHERS)]
    if ompl:
        runs += [list(lengths_of(name, world, problem, 1e3 * ompl)) for name in OF_OMPL]
    shortest = min(length for each in (*runs, *others) for _, length in each)
    first = [run[0][1] if run else np.nan for run in runs]
    return [
        [min([c for t, c in run if t <= most] or [late]) / shortest for most in (*TIMES, *LATER)]
        for run, late in zip(runs, first, strict=True)
    ]


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--count", type=int, default=10, help="problems of each kind, at most 100")
    parser.add_argument("--arms", nargs="*", default=["arm7", "ur5"])
    parser.add_argument("--tuning", action="store_true", help="the problems that constants are chosen on")
    parser.add_argument("--best", type=float, default=1.0, help="seconds of each of three other runs [s]")
    parser.add_argument("--ompl", type=float, default=0.0, help="seconds of each planner of OMPL, 0 for none [s]")
    parser.add_argument("--picture", type=Path, help="file of a picture of the curves")
    options = parser.parse_args()
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    curves: dict[str, Vector] = {}
    for name in options.arms:
        every = list(problems(Pool(arm_named(name)), (TUNING if options.tuning else REPORTING)[: options.count]))
        # The first query of a process loads what all others use.
        list(lengths(ArmWorld(every[0].robot, every[0].scene), every[0], 0, 10.0))
        ratios = np.array([row for row in (measured(each, options.best, options.ompl) for each in every) if row])
        for i, who in enumerate(("evenroad", *OF_OMPL)[: ratios.shape[1]]):
            own = ratios[:, i]
            found = ~np.isnan(own[:, 0])
            curves[f"{who}, {name}"] = own[found]
            print(f"{name}, {who}: {found.sum()} of {len(own)} problems; mean / median / 95 % / largest")
            for most, column in zip((*TIMES, *LATER)[: None if i else len(TIMES)], own[found].T, strict=False):
                spread = np.mean(column), np.median(column), np.quantile(column, 0.95), column.max()
                print(f"  {most:5g} ms: {' / '.join(f'{each:.4f}' for each in spread)}", flush=True)
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    if options.picture:
        draw(curves, options.picture)


def draw(curves: dict[str, Vector], file: Path) -> None:
    """Draw the mean ratios against the time."""
    import matplotlib.pyplot as plt

    figure, axis = plt.subplots(figsize=(7, 4), constrained_layout=True)
    arms = list(dict.fromkeys(name.split(", ")[1] for name in curves))
    planners = list(dict.fromkeys(name.split(", ")[0] for name in curves))
    for name, ratios in curves.items():
        who, arm = name.split(", ")
        look = dict(color=f"C{planners.index(who)}", linestyle=("-", "--", ":")[arms.index(arm) % 3], marker="o")
        shown = len(TIMES) if who == "evenroad" else len(TIMES) + len(LATER)
        axis.loglog((*TIMES, *LATER)[:shown], ratios.mean(axis=0)[:shown] - 1.0, label=name, **look)
    axis.set(xlabel="processor time from the query on [ms]", ylabel="mean length above the best known, as a share")
    axis.grid(alpha=0.3, which="both")
    axis.legend()
    figure.savefig(file)


if __name__ == "__main__":
    main()
