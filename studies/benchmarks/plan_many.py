"""How many paths `er.plan_many` makes in a second of one processor, proved and smoothed.

    python -m studies.benchmarks.plan_many      # UR5 and the arm of 7 joints

Among 25 boxes: motions of 0.2 times the way between random free configurations, which are mostly straight, and the
whole ways.  In scenes of ``evenroad bench arms``, where no straight motion leads to the goal: 20 problems of each
generator, each asked several times.  The same problems that need no second call of compiled code stand beside them:
what few hard ones take is nearly all of the time.  Time is that of the processor, in one thread.
"""

from __future__ import annotations

import os
import time
from typing import Any

import numpy as np
from studies.benchmarks.plan_call import BOXES, boxes_around
from studies.benchmarks.rows import parser_of

import evenroad as er
from evenroad.planning.connectors import RESTART
from evenroad.roadmap.connector import Smooth
from evenroad_studies.arms.problems import draw_problem
from evenroad_studies.arms.robots import arm_named
from evenroad_studies.arms.scenes import GENERATORS

REPEATS = 10
WAYS: tuple[Smooth, ...] = ("quick", True)


def rates(worlds: Any, starts: Any, goals: Any, repeats: int = 1) -> str:
    """Return, in words, how many queries were solved, and how many are in a second, by each way to smooth."""
    worlds = [*worlds] * repeats if isinstance(worlds, list) else worlds
    starts, goals = np.tile(starts, (repeats, 1)), np.tile(goals, (repeats, 1))
    texts = []
    for smooth in WAYS:
        began = time.process_time()
        results = er.plan_many(worlds, starts, goals, smooth=smooth, threads=1)
        rate = len(results) / (time.process_time() - began)
        texts.append(f"{rate:7.0f} a second ({'quick' if smooth == 'quick' else 'default'})")
    return f"{results.solved.sum() // repeats:5d} of {len(results) // repeats:5d} solved, {', '.join(texts)}"


def among_boxes(robot: er.Robot) -> None:
    """Print the rates in one world of boxes."""
    world = er.ArmWorld(robot, er.Scene.of_boxes(*boxes_around(BOXES)))
    q = world.space.from_cube(np.random.default_rng(3).random((12_000, world.dim)))
    starts, goals = (q := q[world.valid(q)][:4000])[:2000], q[2000:]
    near = starts + 0.2 * (goals - starts)
    free = world.valid(near)
    print(f"{robot.name}, boxes, short motions: {rates(world, starts[free], near[free], REPEATS)}")
    print(f"{robot.name}, boxes, whole ways:    {rates(world, starts, goals)}")


def in_scenes(name: str, count: int) -> None:
    """Print the rates in scenes of the suite."""
    for generator in GENERATORS:
        problems = [draw_problem(name, generator, "report", i) for i in range(count)]
        worlds: list[Any] = [each.world for each in problems]
        starts, goals = np.array([each.start for each in problems]), np.array([each.goal for each in problems])
        print(f"{name}, {generator}: {rates(worlds, starts, goals, REPEATS)}")
        soon = er.plan_many(worlds, starts, goals, limits={"motions": RESTART}).solved
        kept = [world for world, is_soon in zip(worlds, soon, strict=True) if is_soon]
        print(f"{name}, {generator}, one call: {rates(kept, starts[soon], goals[soon], REPEATS)}", flush=True)


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--arms", nargs="*", default=["ur5", "arm7"])
    parser.add_argument("--count", type=int, default=20, help="problems of each generator")
    options = parser.parse_args()
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    for name in options.arms:
        among_boxes(arm_named(name))
        in_scenes(name, options.count)


if __name__ == "__main__":
    main()
