"""What one call of `er.plan` costs for an arm: stage by stage, and in new scenes.

    python -m studies.benchmarks.plan_call      # UR5 and the arm of 7 joints among 25 boxes, a free motion from a to b
    python -m studies.benchmarks.plan_call --arms panda.urdf        # a file with meshes: by its shapes, and by capsules

Times are microseconds of CPU time of one thread, medians of many calls in one process.  The stages of a call follow it;
what they leave is the call's own.  `native` is what the kernel takes of the trees, which is all that it takes here.

New scenes are shelves, boxes and cages that the tool goes into, with boxes at random beside and behind the robot, 15 to
25 in all.  A query is everything: the scene from arrays, its world, the path and its smoothing, and the proof of all
motions.  Of each problem the best time of a few counts; medians and 95 % are over those that are solved.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
from studies.benchmarks.arm_problems import REPORTING, TUNING, Pool, problems
from studies.benchmarks.rows import parser_of

import evenroad as er
from evenroad._native import planning
from evenroad.planning import arm_trees
from evenroad.planning.connector import Smooth
from evenroad.planning.connectors import ARM_TREES
from evenroad.planning.drivers import native_points
from evenroad.planning.finish import finished
from evenroad.planning.plan import budget_of, solve
from evenroad.planning.problem import Wanted
from evenroad.planning.read_problem import read_problem
from evenroad.planning.reading import Reading
from evenroad.points.reversed_halton import ball_points, cube_points
from evenroad.scenes.obstacle import Obstacle
from evenroad_studies.arms.robots import ARMS, arm_named

BOXES = 25
REPEATS = 1_000
KINDS = ("shelf", "box", "cage")
LEAST, MOST = 15, 25
"""Numbers of boxes of a new scene."""
BEST_OF = 5
SMOOTHING: tuple[Smooth, ...] = ("quick", True)

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class NewScene:
    """Boxes as arrays: extents, centres, quaternions; the contacts that are allowed, and two free configurations."""

    size: Floats
    xyz: Floats
    xyzw: Floats
    names: tuple[str, ...]
    allowed: frozenset[tuple[str, str]]
    start: Floats
    goal: Floats

    def scene(self) -> er.Scene:
        return er.Scene.of_boxes(self.size, self.xyz, xyzw=self.xyzw, names=self.names, allowed=self.allowed)


def median_time(task: Callable[[], Any]) -> float:
    """Return the median time of a task [us]."""
    times = []
    for _ in range(REPEATS):
        began = time.thread_time_ns()
        task()
        times.append(time.thread_time_ns() - began)
    return float(np.median(times[REPEATS // 10 :])) / 1e3


def boxes_around(count: int) -> tuple[Floats, Floats]:
    """Return extents and centres of boxes of 5 to 20 cm within 1 m of the base along each axis, 50 cm from it."""
    rng = np.random.default_rng(0)
    centres = rng.uniform(-1.0, 1.0, (20 * count, 3))
    return rng.uniform(0.05, 0.2, (count, 3)), centres[np.linalg.norm(centres, axis=1) > 0.5][:count]


def free_motion(world: er.ArmWorld) -> tuple[Floats, Floats]:
    """Return the ends of a free motion of 0.2 times the way between two random free configurations."""
    q = world.space.from_cube(np.random.default_rng(1).random((2_000, world.space.dim)))
    q = q[world.valid(q)]
    ends = q[:-1] + 0.2 * (q[1:] - q[:-1])
    row = np.flatnonzero(world.motion_valid(q[:-1], ends))[0]
    return q[row], ends[row]


def stages(robot: er.Robot) -> dict[str, float]:
    """Return the time of each stage of a call [us]."""
    size, xyz = boxes_around(BOXES)
    objects = [er.Box(each, xyz=centre) for each, centre in zip(size.tolist(), xyz.tolist(), strict=True)]
    scene = er.Scene.of_boxes(size, xyz)
    world = er.ArmWorld(robot, scene)
    start, goal = free_motion(world)
    wanted = Wanted(budget=budget_of(None, None, None))
    problem = read_problem(world, start, goal, Reading(), wanted)
    result = solve(problem)
    dim = world.space.dim
    terminals = np.stack([start, goal])
    samples, steps = native_points(cube_points, dim), native_points(ball_points, dim)

    def native() -> None:
        planning.Trees(arm_trees.checks_of(world), terminals, samples, steps).grow(4_000, 1_000)

    tasks: dict[str, Callable[[], Any]] = {
        "scene of objects": lambda: er.Scene(
            [er.Box(each.size, xyz=each.pose.xyz) for each in objects], name="objects"
        ),
        "scene of arrays": lambda: er.Scene.of_boxes(size, xyz),
        "world": lambda: er.ArmWorld(robot, scene),
        "er.plan": lambda: er.plan(world, start, goal),
        "  read": lambda: read_problem(world, start, goal, Reading(), wanted),
        "  solve": lambda: solve(problem),
        "    validity": lambda: world.valid(terminals),
        "    trees": lambda: ARM_TREES.connect(world, problem.start, problem.goals, variant=0, most_motions=4_000),
        "      native": native,
        "  finish": lambda: finished(problem, result),
        "scene of arrays, world and er.plan": lambda: er.plan(
            er.ArmWorld(robot, er.Scene.of_boxes(size, xyz)), start, goal
        ),
    }
    return {name: median_time(task) for name, task in tasks.items()}


def new_scenes(robot: er.Robot, seeds: range) -> Iterator[NewScene]:
    """Yield three scenes for each seed, with boxes added at random behind and beside the robot."""
    for problem in problems(Pool(robot), seeds, KINDS):
        rng = np.random.default_rng([problem.seed, 34])
        obstacles = list(problem.scene.obstacles)
        ends = np.stack([problem.start, problem.goal])
        for _ in range(rng.integers(max(LEAST - len(obstacles), 0), MOST - len(obstacles) + 1)):
            while True:
                angle, away, high = np.pi + rng.uniform(-2.0, 2.0), rng.uniform(0.4, 1.0), rng.uniform(0.0, 1.0)
                place = away * np.cos(angle), away * np.sin(angle), high
                added = Obstacle.of(f"more {len(obstacles)}", "box", tuple(rng.uniform(0.05, 0.2, 3)), place)
                if er.ArmWorld(robot, er.Scene((added,))).valid(ends).all():
                    break
            obstacles.append(added)
        yield NewScene(
            np.array([each.size for each in obstacles]),
            np.array([each.body.pose.xyz for each in obstacles]),
            np.array([each.body.pose.xyzw for each in obstacles]),
            tuple(each.name for each in obstacles),
            problem.scene.allowed,
            *ends,
        )


def best_time(task: Callable[[], Any]) -> float:
    """Return the shortest of a few times of a task [us]."""
    times = []
    for _ in range(BEST_OF):
        began = time.thread_time_ns()
        task()
        times.append(time.thread_time_ns() - began)
    return min(times) / 1e3


def in_new_scenes(robot: er.Robot, seeds: range) -> dict[str, list[float]]:
    """Return the times of queries in new scenes [us], where a path is found."""
    times: dict[str, list[float]] = {name: [] for name in ("scene and world", "with plan, quick", "with plan")}

    def world_of(new: NewScene) -> er.ArmWorld:
        return er.ArmWorld(robot, new.scene())

    def query(new: NewScene, smooth: Smooth = True) -> er.PlanResult:
        return er.plan(world_of(new), new.start, new.goal, smooth=smooth, seconds=1.0)

    for each in new_scenes(robot, seeds):
        times["scene and world"].append(best_time(partial(world_of, each)))
        if query(each).solved:
            for name, smooth in zip(list(times)[1:], SMOOTHING, strict=True):
                times[name].append(best_time(partial(query, each, smooth)))
    return times


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--arms", nargs="*", default=["ur5", "arm7"], help="names, or files of robots")
    parser.add_argument("--count", type=int, default=10, help="new scenes of each of three kinds, at most 100")
    parser.add_argument("--tuning", action="store_true", help="the scenes that constants are chosen on")
    options = parser.parse_args()
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    seeds = (TUNING if options.tuning else REPORTING)[: options.count]
    for arm in options.arms:
        robots = {arm: arm_named(arm) if arm in ARMS else er.load_robot(arm)}
        if robots[arm].shapes:
            robots = {f"{arm} by shapes": robots[arm], f"{arm} by capsules": er.load_robot(arm, bodies="capsules")}
        for title, robot in robots.items():
            for name, microseconds in stages(robot).items():
                print(f"{title}: {name:36s} {microseconds:7.1f} us")
            for name, times in in_new_scenes(robot, seeds).items():
                middle, high = np.quantile(times, [0.5, 0.95])
                print(f"{title}: new: {name:31s} {middle:7.1f} us, 95 % {high:.0f}, of {len(times)}")


if __name__ == "__main__":
    main()
