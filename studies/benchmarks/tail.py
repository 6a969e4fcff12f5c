"""Random queries among boxes: how many are answered within a second, by a path or by a proof that there is none.

    python -m studies.benchmarks.tail --count 10                 # 200 queries of a UR5 with a gripper: extra [robots]
    python -m studies.benchmarks.tail --count 25 --first 3000    # 500 others

Each scene has boxes of random places, sizes and turns within reach; starts and goals are any free configurations.
Times are processor time of one thread, from a robot and a scene to the answer.  What comes later, or stays open, is
listed with what the plan says of it.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator

import numpy as np
from studies.benchmarks.arm_problems import Problem
from studies.benchmarks.rows import parser_of

import evenroad as er
from evenroad.collision.arm_world import ArmWorld
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Obstacle

TUNING, REPORTING = range(1_000, 1_100), range(2_000, 2_100)
"""Seeds, one a scene: constants were chosen on the one, figures come from the other."""
QUERIES = 20
"""Queries of a scene."""
BOXES = 12, 30
"""Least and largest number of boxes of a scene."""
SECONDS, LIMIT = 1.0, 5.0
"""An answer counts within the first; a plan may take the second, of wall time [s]."""


def problems(robot: Robot, seeds: range) -> Iterator[Problem]:
    """Yield the queries of each seed's scene."""
    for seed in seeds:
        rng = np.random.default_rng([seed, 5])
        scene = er.Scene(tuple(_boxes(rng)), name=f"boxes{seed}")
        world = ArmWorld(robot, scene)
        ends = np.empty((0, world.space.dim))
        while len(ends) < 2 * QUERIES:
            q = world.space.from_cube(rng.random((256, world.space.dim)))
            ends = np.concatenate([ends, q[world.valid(q)]])
        for i in range(QUERIES):
            yield Problem("boxes", seed * QUERIES + i, robot, scene, *ends[2 * i : 2 * i + 2])


def _boxes(rng: np.random.Generator) -> Iterator[Obstacle]:
    """Yield boxes around the robot, none over its base."""
    for i in range(rng.integers(*BOXES)):
        angle, away = rng.uniform(-np.pi, np.pi), rng.uniform(0.35, 1.0)
        place = away * np.cos(angle), away * np.sin(angle), rng.uniform(0.0, 1.1)
        turn = rng.uniform(-np.pi, np.pi)
        cosine, sine = np.cos(turn), np.sin(turn)
        about_z = (cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0)
        yield Obstacle.of(f"box {i}", "box", tuple(rng.uniform(0.05, 0.4, 3)), place, about_z)


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--count", type=int, default=10, help="scenes, at most 100")
    parser.add_argument("--robot", default="ur5_gripper", help="a robot's name or file")
    parser.add_argument("--tuning", action="store_true", help="the scenes that constants are chosen on")
    parser.add_argument("--first", type=int, default=REPORTING[0], help="seed of the first scene; not with --tuning")
    options = parser.parse_args()
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    robot = er.load_robot(options.robot)
    times, paths, proofs, late = [], 0, 0, []
    seeds = TUNING if options.tuning else range(options.first, options.first + len(REPORTING))
    for problem in problems(robot, seeds[: options.count]):
        begin = time.thread_time()
        result = er.plan(ArmWorld(robot, problem.scene), problem.start, problem.goal, seconds=LIMIT)
        spent = time.thread_time() - begin
        is_proved = result.message.startswith("proved")
        paths, proofs = paths + result.solved, proofs + is_proved
        times.append(spent if result.solved or is_proved else np.inf)
        if not times[-1] <= SECONDS:
            late.append(f"{problem.seed}: {spent:.2f} s, {result.message}")
    soon = 100.0 * np.mean(np.array(times) <= SECONDS)
    print(f"{len(times)} queries, {paths} paths, {proofs} proofs; answered within {SECONDS:g} s: {soon:.1f} %")
    answered = 1e3 * np.array(times)[np.isfinite(times)]
    spread = np.median(answered), answered.mean(), np.quantile(answered, 0.95), answered.max()
    print("ms, median / mean / 95 % / longest:", " / ".join(f"{each:.1f}" for each in spread))
    print(*late, sep="\n")


if __name__ == "__main__":
    main()
