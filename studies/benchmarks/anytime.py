"""How soon the paths of arms become short: their length over the best known, after milliseconds of processor time.

    python -m studies.benchmarks.anytime --count 8                   # 8 problems a kind, the UR5 and seven joints
    python -m studies.benchmarks.anytime --count 3 --ompl            # planners of OMPL beside it, 3 s each
    python -m studies.benchmarks.anytime --count 3 --ompl --roboplan --picture FILE   # RoboPlan, too, and the curves

Time counts from the query of a known world on: first path, smoothing and improvement.  The best known is the shortest
that this run or others find, which are driven by other sequences and take far longer; what runs beside counts, too.
A path that comes later counts as it is when it comes; problems with straight paths are in.

OMPL (extra [ompl], 2.0 for AORRTC; its wheel has no AIT*) asks the same proofs through Python, one motion at a time.
Its RRT-Connect plans again and again, each path is simplified, and the shortest is kept.  So does RoboPlan (wheels
roboplan-core and roboplan-rrt), which asks coal at states 0.02 rad apart: its paths count unless they touch.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np
from studies.benchmarks.arm_problems import REPORTING, TUNING, Pool, Problem, Vector, arm_named, problems
from studies.benchmarks.rows import parser_of

from evenroad.collision.arm_world import ArmWorld
from evenroad.collision.certified import CertifiedWorld
from evenroad.planning.arm_trees import connect
from evenroad.planning.attempt import NO_LIMIT
from evenroad.planning.connectors import ArmTrees
from evenroad.points.reversed_halton import shifted_cube_points
from evenroad.space.path import path_length

TREES = ArmTrees(shortest=True)

MOST_MOTIONS = 200_000
TIMES = (1.0, 3.0, 10.0, 30.0, 100.0, 300.0)
LATER = (1000.0, 3000.0)
"""Times of what runs beside alone [ms]."""
OF_OMPL = {"AORRTC": "AORRTC", "BITstar": "BIT*"}
"""Planners of OMPL that go on after the first path, and how they are named."""
SPENT = 0.98
"""Share of a time after which OMPL is told to stop: it takes a little longer."""
OTHERS = 3
SLICE = 100
Beside = dict[str, Callable[[Problem, float], Iterator[tuple[float, float]]]]
"""What runs beside: a problem and milliseconds to times [ms] and lengths, as `lengths` yields them."""


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


def lengths_of(name: str, problem: Problem, most: float) -> Iterator[tuple[float, float]]:
    """Yield as `lengths` of a planner of OMPL, which begins anew for each of the times.

    AORRTC of 2.0.1 cannot go on: its path then has length 0, or the process ends.  It has length 0 also where it is
    straight, so it counts as long as that.
    """
    from ompl import base as ob
    from ompl import geometric as og

    from evenroad.adapters.ompl import format_of, space_information

    world = ArmWorld(problem.robot, problem.scene)
    straight = path_length(np.stack([problem.start, problem.goal]), world.space)
    for until in (each for each in (*TIMES, *LATER) if each <= most):
        begin = time.thread_time()
        information = space_information(CertifiedWorld(world))
        definition = ob.ProblemDefinition(information)
        ends = [information.allocState() for _ in range(2)]
        for state, q in zip(ends, (problem.start, problem.goal), strict=True):
            format_of(information.getStateSpace()).write(state, q.tolist())
        definition.setStartAndGoalStates(*ends)
        definition.setOptimizationObjective(ob.PathLengthOptimizationObjective(information))
        planner = getattr(og, name)(information)
        planner.setProblemDefinition(definition)
        planner.setup()
        planner.solve(ob.PlannerTerminationCondition(partial(_is_over, begin + SPENT * 1e-3 * until)))
        if definition.hasExactSolution():
            yield 1e3 * (time.thread_time() - begin), max(definition.getSolutionPath().length(), straight)


def _is_over(deadline: float) -> bool:
    return time.thread_time() > deadline


def simplified(problem: Problem, most: float) -> Iterator[tuple[float, float]]:
    """Yield as `lengths` of OMPL's RRT-Connect, planning again and again."""
    from ompl import geometric as og

    from evenroad.adapters.ompl import ompl_path, path_of, solve, space_information

    world = ArmWorld(problem.robot, problem.scene)
    begin = time.thread_time()
    information = space_information(CertifiedWorld(world))
    while (left := 1e-3 * most - (time.thread_time() - begin)) > 0.0:
        path = solve(og.RRTConnect(information), problem.start, problem.goal, seconds=left)
        if path is not None:
            states = ompl_path(information, path)
            og.PathSimplifier(information).simplifyMax(states)
            yield 1e3 * (time.thread_time() - begin), path_length(path_of(information, states), world.space)


def by_roboplan(problem: Problem, most: float) -> Iterator[tuple[float, float]]:
    """Yield as `lengths` of RoboPlan's RRT-Connect, planning again and again; what touches does not count."""
    from studies.benchmarks.roboplan_arm import plans
    from studies.benchmarks.with_ompl import file_of, touches

    world = ArmWorld(problem.robot, problem.scene)
    begin, apart = time.thread_time(), 0.0
    for path in plans(problem, file_of(problem.robot), 1e-3 * most):
        spent = 1e3 * (time.thread_time() - begin - apart)
        if path is not None and spent <= most and not touches(problem, path):
            yield spent, path_length(path, world.space)
        if spent > most:
            return
        apart = time.thread_time() - begin - 1e-3 * spent


def times_of(seconds: float) -> tuple[float, ...]:
    """Return the times that are looked at [ms], of what runs so long."""
    return (*TIMES, *(each for each in LATER if each <= 1e3 * seconds))


def measured(problem: Problem, best: float, beside: Beside, seconds: float) -> list[list[float]] | None:
    """Return of each planner when its first path comes [ms], and lengths after each time over the best known.

    None where there is no path.
    """
    world = ArmWorld(problem.robot, problem.scene)
    runs = [list(lengths(world, problem, 0, TIMES[-1]))]
    if not runs[0]:
        return None
    others = [list(lengths(world, problem, 1 + i, 1e3 * best)) for i in range(OTHERS)]
    runs += [list(planner(problem, 1e3 * seconds)) for planner in beside.values()]
    shortest = min(length for each in (*runs, *others) for _, length in each)
    firsts = [run[0] if run else (np.nan, np.nan) for run in runs]
    return [
        [first[0], *(min([c for t, c in run if t <= most] or [first[1]]) / shortest for most in times_of(seconds))]
        for run, first in zip(runs, firsts, strict=True)
    ]


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--count", type=int, default=10, help="problems of each kind, at most 100")
    parser.add_argument("--arms", nargs="*", default=["arm7", "ur5"])
    parser.add_argument("--tuning", action="store_true", help="the problems that constants are chosen on")
    parser.add_argument("--best", type=float, default=1.0, help="seconds of each of three other runs [s]")
    parser.add_argument("--ompl", action="store_true", help="planners of OMPL beside it")
    parser.add_argument("--roboplan", action="store_true", help="RoboPlan beside it")
    parser.add_argument("--seconds", type=float, default=3.0, help="seconds of each planner beside it [s]")
    parser.add_argument("--picture", type=Path, help="file of a picture of the curves")
    options = parser.parse_args()
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    beside: Beside = {}
    if options.ompl:
        from ompl import util as ou

        ou.setLogLevel(ou.LogLevel.LOG_NONE)
        beside |= {f"OMPL's {called}": partial(lengths_of, name) for name, called in OF_OMPL.items()}
        beside["OMPL's RRT-Connect, simplified, again and again"] = simplified
    if options.roboplan:
        beside["RoboPlan's RRT-Connect, shortcuts, again and again"] = by_roboplan
    curves: dict[str, Vector] = {}
    for name in options.arms:
        every = list(problems(Pool(arm_named(name)), (TUNING if options.tuning else REPORTING)[: options.count]))
        # The first query of a process loads what all others use.
        list(lengths(ArmWorld(every[0].robot, every[0].scene), every[0], 0, 10.0))
        rows = (measured(each, options.best, beside, options.seconds) for each in every)
        ratios = np.array([row for row in rows if row])
        for i, who in enumerate(("evenroad", *beside)):
            own = ratios[:, i]
            found = ~np.isnan(own[:, 0])
            curves[f"{who}; {name}"] = own[found]
            print(
                f"{name}, {who}: {found.sum()} of {len(own)} problems; mean ± standard error / median / 95 % / largest"
            )
            for most, column in zip(times_of(options.seconds if i else 0.0), own[found].T[1:], strict=False):
                error = np.std(column) / np.sqrt(len(column))
                spread = np.median(column), np.quantile(column, 0.95), column.max()
                shown = " / ".join(f"{each:.4f}" for each in spread)
                print(f"  {most:5g} ms: {np.mean(column):.4f} ± {error:.4f} / {shown}", flush=True)
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    if options.picture:
        draw(curves, options.seconds, options.picture)


def draw(curves: dict[str, Vector], seconds: float, file: Path) -> None:
    """Draw the mean ratios against the time, from that on by which half of the paths are there."""
    import matplotlib.pyplot as plt

    arms = list(dict.fromkeys(name.split("; ")[1] for name in curves))
    planners = list(dict.fromkeys(name.split("; ")[0] for name in curves))
    figure, axes = plt.subplots(1, len(arms), figsize=(5.5 * len(arms), 4.6), layout="constrained", squeeze=False)
    for name, ratios in curves.items():
        who, arm = name.split("; ")
        axis = axes[0][arms.index(arm)]
        times = np.array(times_of(0.0 if who == "evenroad" else seconds))
        begun = times >= np.median(ratios[:, 0])
        excess = 100.0 * (ratios[:, 1 : 1 + len(times)].mean(axis=0) - 1.0)
        axis.loglog(times[begun], excess[begun], color=f"C{planners.index(who)}", marker="o", label=who)
        axis.set(xlabel="processor time from the query on [ms]", title=arm)
        axis.grid(alpha=0.3, which="both")
    axes[0][0].set(ylabel="mean length above the best known [%]")
    figure.legend(*axes[0][0].get_legend_handles_labels(), loc="outside lower center", ncols=2, fontsize=8)
    figure.savefig(file)


if __name__ == "__main__":
    main()
