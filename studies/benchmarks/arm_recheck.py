"""What the strict check says of shortcut paths in random scenes, beside the double-precision oracle of the tests.

    python -m studies.benchmarks.arm_recheck                    # 300 paths of each of three arms

Each motion of a path is put to `ArmWorld.recheck` and, at a twentieth of the resolution, to the oracle.  "missed"
counts motions that the check calls free and the oracle does not: it must be 0.  "refused" are motions that the check
does not call free although the oracle finds nothing.
"""

from __future__ import annotations

import argparse
import time
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from tests.robot.kernel_arms import random_scene, random_tree, seven_joint_arm, ur5
from tests.robot.oracle import clearance

from evenroad.points import draw
from evenroad.roadmap import plan
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.robot import Robot

FINER = 20
"""The oracle's states are this many times as dense as the planner's."""

POINTS = 256


def deepest(world: ArmWorld, path: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return by how much the nearest bodies stay apart on each motion of a path, negative in contact: (p - 1,) [m]."""
    least = []
    for a, b in pairwise(path):
        count = 1 + FINER * int(
            np.ceil(world.space.distance(a[np.newaxis], b[np.newaxis])[0] / world.resolution)
        )
        share = np.linspace(0.0, 1.0, count)
        states = world.space.interpolate(np.tile(a, (count, 1)), np.tile(b, (count, 1)), share)
        least.append(clearance(world.robot, world.scene, states).min())
    return np.array(least)


def compare(name: str, robot: Robot, wanted: int, shorten: bool) -> int:
    """Print how check and oracle agree on `wanted` paths; return how many motions the check missed."""
    paths = motions = free = missed = refused = touching = 0
    seconds, depth = 0.0, 0.0
    for seed in range(wanted):
        world = ArmWorld(robot, random_scene(1000 + seed, count=10, spread=1.0, clear=0.35))
        q = world.space.from_cube(np.random.default_rng(seed).random((200, world.space.dim)))
        q = q[world.valid(q)]
        points = draw("sobol", POINTS, world.space.cube_dim, rng=0)
        for start, goal in zip(q[0:8:2], q[1:8:2], strict=False):
            result = plan(world, start, goal, points, search="lazy", shorten=shorten)
            if result.path is None or paths == wanted:
                continue
            world.recheck(result.path)
            begin = time.perf_counter()
            passed = world.recheck(result.path)
            seconds += time.perf_counter() - begin
            apart = deepest(world, result.path)
            depth = max(depth, -float(apart.min()))
            paths, motions, free = paths + 1, motions + len(passed), free + int(passed.all())
            missed += int((passed & (apart <= 0.0)).sum())
            refused += int((~passed & (apart > 0.0)).sum())
            touching += int((apart <= 0.0).any())
        if paths == wanted:
            break
    print(
        f"{name}, {'shortcut' if shorten else 'as found'}: {paths} paths, {motions} motions; {touching} paths touch,"
        f" up to {1e3 * depth:.2f} mm deep; {free} paths pass, missed {missed}, refused {refused} motions;"
        f" {1e3 * seconds / paths:.2f} ms a path",
        flush=True,
    )
    return missed


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--paths", type=int, default=300, help="paths of each kind")
    options = parser.parse_args()
    missed = 0
    for shorten in (True, False):
        for name, robot in (("UR5", ur5(3.2)), ("seven joints", seven_joint_arm()), ("tree", random_tree(8))):
            missed += compare(name, robot, options.paths, shorten)
    if missed:
        raise SystemExit(f"{missed} motions in collision were called free")


if __name__ == "__main__":
    main()
