"""Paths of the arms' planner beside a slow double-precision oracle of the same model, at a twentieth of the resolution.

    python -m studies.benchmarks.arm_paths_oracle               # 1100 shortened paths of each of three kinds of robots

Shortened paths are looked at state by state; so are, of a part of the queries, raw ones as the trees found them, and
"sampled" ones, which the batch shortcut of ``evenroad.roadmap`` made of them with the sampled check.  "touch" counts
paths of which some state touches; "nearest" is the least clearance of any [mm], below 0 where bodies overlap.
"""

from __future__ import annotations

import argparse
import time
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from tests.robot.kernel_arms import random_scene, random_tree, seven_joint_arm, ur5
from tests.robot.oracle import clearance

from evenroad.roadmap.shortcut import shortcut
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.robot import Robot
from evenroad.robot.scene import Scene
from evenroad.robot.trees import connect, shorten

SHARE = 20
TREES = (0, 3, 4, 5, 6, 8, 9, 10, 12, 13)
OTHERS_SHARE = 5
"""Of one query in so many the raw path is looked at, and the one that the batch shortcut makes of it."""

Path = npt.NDArray[np.float64]


def dense_states(world: ArmWorld, path: Path) -> Path:
    """Return the states of a path at a share of the world's resolution, (n, dim)."""
    pieces = []
    for a, b in pairwise(path):
        length = world.space.distance(a[np.newaxis], b[np.newaxis])[0]
        count = int(np.ceil(length / (world.resolution / SHARE))) + 1
        ends = (np.broadcast_to(end, (count, len(end))) for end in (a, b))
        pieces.append(world.space.interpolate(*ends, np.linspace(0.0, 1.0, count)))
    return np.concatenate(pieces)


def nearest(world: ArmWorld, path: Path) -> float:
    """Return the least clearance of a path [m]."""
    return float(clearance(world.robot, world.scene, dense_states(world, path)).min())


def compare(name: str, robots: list[tuple[Robot, list[Scene]]], wanted: int) -> None:
    """Print what the oracle says of `wanted` shortened paths that were not straight, shared out among the worlds."""
    begin = time.perf_counter()
    least: dict[str, list[float]] = {"raw": [], "shortened": [], "sampled": []}
    worlds = [ArmWorld(robot, scene) for robot, scenes in robots for scene in scenes]
    unsolved = 0
    for number, world in enumerate(worlds):
        q = world.space.from_cube(np.random.default_rng(number).random((4_000, world.space.dim)))
        q = q[world.valid(q)]
        share, found = -(-(wanted - len(least["shortened"])) // (len(worlds) - number)), 0
        for start, goal in zip(q[0::2], q[1::2], strict=False):
            if found == share:
                break
            connection = connect(world, start, [goal], most_motions=3_000, seconds=60)
            if connection.goal < 0:
                unsolved += 1
            if len(connection.path) < 3:
                # Straight, or none.
                continue
            found += 1
            least["shortened"].append(nearest(world, shorten(world, connection.path)[0]))
            if found % OTHERS_SHARE == 1:
                least["raw"].append(nearest(world, connection.path))
                least["sampled"].append(nearest(world, shortcut(connection.path, world)[0]))
    cells = [
        f"{kind}: {sum(value <= 0.0 for value in values)} of {len(values)} touch, nearest {1e3 * min(values):+.4f}"
        for kind, values in least.items()
    ]
    print(
        f"{name}, {len(worlds)} scenes, {unsolved} queries unsolved | {' | '.join(cells)} |"
        f" {time.perf_counter() - begin:.0f} s",
        flush=True,
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=1_100, help="shortened paths of each kind")
    options = parser.parse_args()
    scenes = [random_scene(seed) for seed in range(5, 16)]
    trees = [(random_tree(s), [random_scene(100 + s, spread=0.7, clear=0.45)]) for s in TREES]
    compare("random trees", trees, options.count)
    compare("seven joints", [(seven_joint_arm(), scenes)], options.count)
    compare("UR5", [(ur5(np.pi), scenes)], options.count)


if __name__ == "__main__":
    main()
