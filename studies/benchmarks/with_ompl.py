"""OMPL's and RoboPlan's RRT-Connect beside `er.plan`, on arms among shelves, boxes, cages and tables, in one process.

    python -m studies.benchmarks.with_ompl --count 10              # needs the extra [ompl]
    python -m studies.benchmarks.with_ompl --count 10 --roboplan   # and the wheels roboplan-core and roboplan-rrt
    python -m studies.benchmarks.with_ompl --picture FILE          # and a picture of times and lengths

OMPL asks evenroad's `CertifiedWorld`, so that every motion of its path is proved, too.  It asks through Python, one
motion at a time, as it does for anybody who uses OMPL from Python.  RoboPlan asks coal, at states at most 0.02 rad
apart, about the same bodies: a cylinder with a ball at each end for a capsule.  It also plans as its users do: in a
scene that it has read before, with its own step of 0.05 rad.  Each query is planned once by each, with a limit of
`SECONDS`.  Times are processor time of one thread, from a robot and a scene to the smoothed path, as
median / mean / 95 %.  Lengths are shares of those of `er.plan`, of the problems that both solve.  A path touches
if `ArmWorld` says that one of its states, 0.001 rad apart, is not free.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
from ompl import geometric as og
from ompl import util as ou
from studies.benchmarks.arm_problems import REPORTING, Pool, Problem, Vector, arm_named, problems
from studies.benchmarks.frozen import processor
from studies.benchmarks.rows import parser_of

import evenroad as er
from evenroad.adapters.ompl import ompl_path, path_of, solve, space_information
from evenroad.collision.arm_world import ArmWorld
from evenroad.collision.certified import CertifiedWorld
from evenroad.robots.robot import Robot

SECONDS = 2.0
APART = 1e-3
DATA = Path(er.__file__).parent / "loading" / "data"
Row = tuple[float, Vector | None]
"""Time [ms] and path of a plan, None where there is none."""


def ours(problem: Problem) -> Row:
    """Plan with `er.plan`."""
    begin = time.thread_time()
    result = er.plan(ArmWorld(problem.robot, problem.scene), problem.start, problem.goal, seconds=SECONDS)
    return 1e3 * (time.thread_time() - begin), result.path


def theirs(problem: Problem) -> Row:
    """Plan with OMPL's RRT-Connect, and simplify its path."""
    begin = time.thread_time()
    information = space_information(CertifiedWorld(ArmWorld(problem.robot, problem.scene)))
    path = solve(og.RRTConnect(information), problem.start, problem.goal, seconds=SECONDS)
    if path is not None:
        states = ompl_path(information, path)
        og.PathSimplifier(information).simplifyMax(states)
        path = path_of(information, states)
    return 1e3 * (time.thread_time() - begin), path


def file_of(robot: Robot) -> Path:
    """Return the URDF of a robot that ships."""
    return DATA / f"{'ur5' if robot.name.startswith('ur5') else robot.name}.urdf"


def by_roboplan(problem: Problem) -> Row:
    """Plan with RoboPlan's RRT-Connect, and its shortcuts."""
    from studies.benchmarks.roboplan_arm import plan

    begin = time.thread_time()
    path = plan(problem, file_of(problem.robot), SECONDS)
    return 1e3 * (time.thread_time() - begin), path


def by_roboplan_in_its_scene(problem: Problem) -> Row:
    """Plan with RoboPlan in a scene that is there, with its own step; the time begins with the query."""
    from studies.benchmarks.roboplan_arm import OWN_STEP, plans_in, scene_of

    scene = scene_of(problem, file_of(problem.robot))
    begin = time.thread_time()
    path = next(plans_in(scene, problem, SECONDS, OWN_STEP))
    return 1e3 * (time.thread_time() - begin), path


def touches(problem: Problem, path: Vector) -> bool:
    """Return whether a state of a path is not free."""
    world = ArmWorld(problem.robot, problem.scene)
    for a, b in pairwise(path):
        shares = np.linspace(0.0, 1.0, 2 + int(np.linalg.norm(b - a) / APART))[:, np.newaxis]
        if not world.valid(a + shares * (b - a)).all():
            return True
    return False


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--count", type=int, default=10, help="problems of each kind, at most 100")
    parser.add_argument("--arms", nargs="*", default=["ur5", "arm7"])
    parser.add_argument("--roboplan", action="store_true", help="RoboPlan, too")
    parser.add_argument("--picture", type=Path, help="file of a picture of times and lengths")
    options = parser.parse_args()
    ou.setLogLevel(ou.LogLevel.LOG_NONE)
    ou.RNG.setSeed(1)
    planners: dict[str, Callable[[Problem], Row]] = {"er.plan": ours, "OMPL's RRT-Connect, simplified": theirs}
    if options.roboplan:
        planners["RoboPlan's RRT-Connect, shortcuts"] = by_roboplan
        planners["the same, scene known, its own step"] = by_roboplan_in_its_scene
    print(f"{processor()}; load average of the last minute: {os.getloadavg()[0]:.1f}")
    drawn = []
    for name in options.arms:
        every = list(problems(Pool(arm_named(name)), REPORTING[: options.count]))
        # The first plan of a process loads what all others use.
        for planner in planners.values():
            planner(every[0])
        rows = [[planner(problem) for planner in planners.values()] for problem in every]
        for i, who in enumerate(planners):
            solved = [(problem, row) for problem, row in zip(every, rows, strict=True) if row[i][1] is not None]
            times = [row[i][0] for _, row in solved]
            shares = [length(row[i][1]) / length(row[0][1]) for _, row in solved if row[0][1] is not None]
            touching = sum(touches(problem, row[i][1]) for problem, row in solved)
            spread = f"{np.median(times):.2f} / {np.mean(times):.2f} / {np.quantile(times, 0.95):.2f} ms"
            lengths = f"length {np.mean(shares):.3f}, median {np.median(shares):.3f}"
            print(
                f"{name}, {who}: {len(times)} of {len(rows)} solved, {touching} touch; {spread}; {lengths}", flush=True
            )
            drawn.append((name, who, times, shares))
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    if options.picture:
        draw(drawn, options.picture)


def length(path: Vector) -> float:
    """Return the length of a path of joints that do not wrap."""
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


def draw(rows: list[tuple[str, str, list[float], list[float]]], file: Path) -> None:
    """Draw how many problems are solved by when, and how long the paths are beside ours."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(11, 4.8), constrained_layout=True)
    arms = list(dict.fromkeys(name for name, *_ in rows))
    who = list(dict.fromkeys(planner for _, planner, *_ in rows))
    for name, planner, times, shares in rows:
        look = dict(color=f"C{who.index(planner)}", linestyle=("-", "--", ":")[arms.index(name) % 3])
        axes[0].step(np.sort(times), np.arange(1, len(times) + 1), label=f"{planner}, {name}", **look)
        axes[1].step(np.sort(shares), np.arange(1, len(shares) + 1), **look)
    axes[0].set(xscale="log", xlabel="processor time to the smoothed path [ms]", ylabel="problems solved")
    axes[1].set(xscale="log", xlabel="length of the path, as a share of er.plan's", ylabel="problems that both solve")
    figure.legend(loc="outside lower center", ncols=2, fontsize=8)
    for axis in axes:
        axis.grid(alpha=0.3)
    figure.savefig(file)


if __name__ == "__main__":
    main()
