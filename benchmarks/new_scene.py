"""What a new scene costs an arm whose robot is known: a world out of a Scene, and tables out of raw arrays.

    python -m benchmarks.new_scene                      # 2000 runs of each, interleaved

Medians and 95 % quantiles in milliseconds; "one check" shows that nothing is put off.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable

import numpy as np

from benchmarks.arm_speed import random_boxes, ur5_world
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.kernel.obstacles import obstacle_rows, tested_contacts
from evenroad.robot.kernel.scene_tables import arm_tables
from evenroad.robot.robot import Robot
from evenroad.robot.scene import Scene


def tasks(robot: Robot, scene: Scene) -> dict[str, Callable[[], object]]:
    """Return what is timed."""
    world = ArmWorld(robot, scene)
    arrays, tested = obstacle_rows(scene), tested_contacts(world.robot_tables.capsules, robot.links, scene)
    home = np.zeros((1, world.space.dim))
    return {
        "world": lambda: ArmWorld(robot, scene),
        "world, one check": lambda: ArmWorld(robot, scene).valid(home),
        "tables from arrays": lambda: arm_tables(world.robot_tables, arrays, tested),
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--runs", type=int, default=2000, help="runs of each")
    options = parser.parse_args()
    robot = ur5_world("box-reach").robot
    for scene in (ur5_world("box-reach").scene, random_boxes(20), random_boxes(100)):
        timed = tasks(robot, scene)
        seconds: dict[str, list[float]] = {name: [] for name in timed}
        for _ in range(options.runs):
            for name, task in timed.items():
                begin = time.perf_counter()
                task()
                seconds[name].append(time.perf_counter() - begin)
        figures = ", ".join(
            f"{name} {1e3 * np.median(each):.3f} / {1e3 * np.quantile(each, 0.95):.3f}"
            for name, each in seconds.items()
        )
        print(f"{len(scene.obstacles)} obstacles: {figures} ms")
    print(f"{options.runs} runs; load average of the last minute: {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
