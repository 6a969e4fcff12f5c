"""How many paths `er.plan_many` makes in a second of one processor, proved and smoothed.

    python -m studies.benchmarks.plan_many      # UR5 and the arm of 7 joints

Among 25 boxes: motions of 0.2 times the way between random free configurations, which are mostly straight, and the
whole ways.  In scenes of ``evenroad bench arms``, where no straight motion leads to the goal: 200 problems of each
generator.  All are asked with three seeds.  A few hard queries can take most of the time, so the median of a query
stands beside, and how many are answered in a second without the slowest hundredth.  Time is that of the processor, in
one thread; that of single queries is by the clock.
"""

from __future__ import annotations

import os
import time
from typing import Any

import numpy as np
from studies.benchmarks.plan_call import BOXES, boxes_around
from studies.benchmarks.rows import parser_of

import evenroad as er
from evenroad.datasets.random_scenes import GENERATORS
from evenroad.planning.connector import Smooth
from evenroad_studies.arms.problems import draw_problem
from evenroad_studies.arms.robots import arm_named

SEEDS = 3
WAYS: tuple[Smooth, ...] = ("quick", True)


def rates(worlds: Any, starts: Any, goals: Any) -> str:
    """Return, in words, how many queries were solved, and how many are in a second, by each way to smooth."""
    texts, solved = [], 0
    for smooth in WAYS:
        began, seconds = time.process_time(), []
        for seed in range(SEEDS):
            results = er.plan_many(worlds, starts, goals, smooth=smooth, threads=1, rng=seed)
            seconds.append(results.seconds)
            solved += results.solved.sum()
        each = np.sort(np.concatenate(seconds))
        most = each[: len(each) - len(each) // 100]
        texts.append(
            f"{'quick' if smooth == 'quick' else 'default'}: {len(each) / (time.process_time() - began):6.0f} a second,"
            f" median {1e3 * np.median(each):.2f} ms, {len(most) / most.sum():6.0f} without the slowest hundredth"
        )
    return f"{solved / len(WAYS) / SEEDS:6.1f} of {len(starts)} solved; {'; '.join(texts)}"


def among_boxes(robot: er.Robot) -> None:
    """Print the rates in one world of boxes."""
    world = er.ArmWorld(robot, er.Scene.of_boxes(*boxes_around(BOXES)))
    q = world.space.from_cube(np.random.default_rng(3).random((12_000, world.dim)))
    starts, goals = (q := q[world.valid(q)][:4000])[:2000], q[2000:]
    near = starts + 0.2 * (goals - starts)
    free = world.valid(near)
    print(f"{robot.name}, boxes, short motions: {rates(world, starts[free], near[free])}")
    print(f"{robot.name}, boxes, whole ways:    {rates(world, starts, goals)}")


def in_scenes(name: str, count: int) -> None:
    """Print the rates in scenes of the suite."""
    for generator in GENERATORS:
        problems = [draw_problem(name, generator, "report", i) for i in range(count)]
        worlds: list[Any] = [each.world for each in problems]
        starts, goals = np.array([each.start for each in problems]), np.array([each.goal for each in problems])
        # What a world makes once, when it is first asked, is not timed.
        er.plan_many(worlds, starts, goals, threads=1, limits={"motions": 100})
        print(f"{name}, {generator}: {rates(worlds, starts, goals)}", flush=True)


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--arms", nargs="*", default=["ur5", "arm7"])
    parser.add_argument("--count", type=int, default=200, help="problems of each generator")
    options = parser.parse_args()
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    for name in options.arms:
        among_boxes(arm_named(name))
        in_scenes(name, options.count)


if __name__ == "__main__":
    main()
