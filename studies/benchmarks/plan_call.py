"""What one call of `er.plan` costs for an arm, stage by stage.

    python -m studies.benchmarks.plan_call      # UR5 and the arm of 7 joints among 25 boxes, a free motion from a to b

Times are microseconds of CPU time of one thread, medians of many calls in one process.  The stages of a call follow it;
what they leave is the call's own.  `native` is what the kernel takes of the trees, which is all that it takes here.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
from studies.benchmarks.rows import parser_of

import evenroad as er
from evenroad._native import planning
from evenroad.planning import arm_trees, read_request
from evenroad.planning.connectors import ARM_TREES
from evenroad.planning.plan import Options, budget_of, finished, solve
from evenroad.planning.request import Reading
from evenroad.robot.tree_sequences import ball_points, cube_points, native_points

BOXES = 25
REPEATS = 1_000

Floats = npt.NDArray[np.float64]


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
    request = read_request.read_request(world, start, goal, Reading())
    options = Options(budget_of(None, None, None))
    result = solve(request, None, options)
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
        "  read": lambda: read_request.read_request(world, start, goal, Reading()),
        "  solve": lambda: solve(request, None, options),
        "    validity": lambda: world.valid(terminals),
        "    trees": lambda: ARM_TREES.connect(
            world, request.start, request.goals, variant=0, most_motions=4_000, seconds=5.0
        ),
        "      native": native,
        "  finish": lambda: finished(request, result),
        "scene of arrays, world and er.plan": lambda: er.plan(
            er.ArmWorld(robot, er.Scene.of_boxes(size, xyz)), start, goal
        ),
    }
    return {name: median_time(task) for name, task in tasks.items()}


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--arms", nargs="*", default=["ur5", "arm7"])
    options = parser.parse_args()
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    for arm in options.arms:
        for name, microseconds in stages(er.load_robot(arm)).items():
            print(f"{arm}: {name:36s} {microseconds:7.1f} us")


if __name__ == "__main__":
    main()
