"""Verdicts of the arms' kernels beside a slow double-precision oracle of the same model, on many configurations.

    python -m studies.benchmarks.arm_oracle                    # the tests' arms and oracle, 10^5 configurations a kind

"differ" counts verdicts that are not the oracle's outside of 1e-5 m of contact, "optimistic" those of the lanes that
are free although the oracle says contact, at any distance.
"""

from __future__ import annotations

import numpy as np
from studies.benchmarks.rows import parser_of
from tests.robots.kernel_arms import as_balls, random_scene, random_tree, seven_joint_arm, ur5
from tests.robots.oracle import clearance

from evenroad.collision.arm_world import ArmWorld
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Scene

BAND = 1e-5
BLOCK = 10_000
TREES = 20


def compare(name: str, robots: list[tuple[Robot, Scene]], count: int) -> None:
    """Print how the verdicts on `count` configurations, shared out among the robots, agree."""
    differ = {"lanes": 0, "scalar": 0}
    optimistic = free = total = 0
    rng = np.random.default_rng(20_261_121)
    for robot, scene in robots:
        worlds = {backend: ArmWorld(robot, scene, backend=backend) for backend in differ}
        left = count // len(robots)
        while left > 0:
            q = worlds["lanes"].space.from_cube(rng.random((min(left, BLOCK), worlds["lanes"].space.dim)))
            left -= len(q)
            apart = clearance(robot, scene, q)
            clear = np.abs(apart) > BAND
            verdicts = {backend: world.valid(q) for backend, world in worlds.items()}
            for backend, verdict in verdicts.items():
                differ[backend] += int((verdict[clear] != (apart[clear] > 0.0)).sum())
            optimistic += int((verdicts["lanes"] & (apart < 0.0)).sum())
            free += int((apart > 0.0).sum())
            total += len(q)
    print(
        f"{name}: {total} configurations, {free / total:.0%} free; differ: lanes {differ['lanes']},"
        f" scalar {differ['scalar']}; optimistic: {optimistic}",
        flush=True,
    )


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--count", type=int, default=100_000, help="configurations of each kind")
    options = parser.parse_args()
    compare("UR5 among every shape", [(ur5(), random_scene(5))], options.count)
    compare("seven joints among every shape", [(seven_joint_arm(), random_scene(3))], options.count)
    compare("UR5 of 42 balls among every shape", [(as_balls(ur5()), random_scene(5))], options.count)
    trees = [(random_tree(seed), random_scene(100 + seed, spread=0.7, clear=0.45)) for seed in range(TREES)]
    compare(f"{TREES} random trees", trees, options.count)


if __name__ == "__main__":
    main()
