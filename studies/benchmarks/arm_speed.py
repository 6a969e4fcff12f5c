"""Configurations and motions a second of arms, on one core.

    python -m studies.benchmarks.arm_speed

Rates are the best of several repeats: what else runs on the machine only ever takes away.  Motions are between
random free configurations, blocked ones included, at 0.05 rad.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from functools import partial

import numpy as np
import numpy.typing as npt
from tests.robots.kernel_arms import as_balls

from evenroad.collision.arm_world import ArmWorld
from evenroad.collision.certified import CertifiedWorld
from evenroad.loading.load import load_robot
from evenroad.robot import Robot, in_scene, with_group
from evenroad.scenes.scene import Obstacle, Scene
from evenroad.scenes.scene_file import load_scene
from evenroad.world import World

REPEATS = 11


def ur5_world(scene_name: str) -> ArmWorld:
    """Return the UR5 with 5 planned joints in a shipped scene."""
    scene = load_scene(scene_name)
    robot = load_robot("ur5")
    return ArmWorld(in_scene(with_group(robot, robot.group[:5]), scene), scene)


def box_for(robot: Robot, scene: Scene) -> Scene:
    """Return the obstacles of `scene`, with the table allowed to touch the first two links of `robot`."""
    return Scene(scene.obstacles, name=scene.name, allowed=frozenset((link, "table") for link in robot.links[:2]))


def random_boxes(count: int = 100) -> Scene:
    """Return boxes of 5 to 20 cm at random places within 1 m of the base along each axis, 35 cm from it."""
    rng = np.random.default_rng(0)
    boxes: list[Obstacle] = []
    while len(boxes) < count:
        place, size = rng.uniform(-1.0, 1.0, 3), rng.uniform(0.05, 0.2, 3)
        if np.linalg.norm(place) > 0.35:
            boxes.append(Obstacle.of(f"box {len(boxes)}", "box", tuple(size), tuple(place)))
    return Scene(tuple(boxes), name=f"{count} boxes")


def seconds(task: Callable[[], object], repeats: int = REPEATS) -> float:
    """Return the shortest time of a task, after one run that is not counted."""
    task()
    best = np.inf
    for _ in range(repeats):
        begin = time.perf_counter()
        task()
        best = min(best, time.perf_counter() - begin)
    return best


def motions(world: World, count: int) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return the ends of motions between random free configurations."""
    q = world.space.from_cube(np.random.default_rng(1).random((20 * count, world.space.dim)))
    q = q[world.valid(q)]
    return q[:count], q[count : 2 * count]


def measure(name: str, world: ArmWorld) -> None:
    """Print configurations and motions a second."""
    q = world.space.from_cube(np.random.default_rng(0).random((60_000, world.space.dim)))
    free = world.valid(q)
    clear = q[free]
    a, b = motions(world, 4_000)
    passed = world.motion_valid(a, b)
    rate = len(q) / seconds(partial(world.valid, q))
    of_free = len(clear) / seconds(partial(world.valid, clear))
    motion_rate = len(a) / seconds(partial(world.motion_valid, a, b))
    free_rate = passed.sum() / seconds(partial(world.motion_valid, a[passed], b[passed]))
    print(
        f"{name}: {rate / 1e6:.2f} M configurations/s ({free.mean():.1%} free; {of_free / 1e6:.2f} M/s of free ones),"
        f" {motion_rate / 1e3:.0f} k motions/s ({passed.mean():.1%} free, mean length"
        f" {world.space.distance(a, b).mean():.2f} rad; {free_rate / 1e3:.0f} k/s of free ones)"
    )


def measure_certified(world: ArmWorld) -> None:
    """Print what a proof costs and how many motions it leaves open."""
    a, b = motions(world, 1_000)
    proof = CertifiedWorld(world)
    sampled, proved = world.motion_valid(a, b), proof.motion_valid(a, b)
    each = seconds(partial(proof.motion_valid, a[proved], b[proved]), 3) / proved.sum()
    print(f"certified: {proved.sum()} of {sampled.sum()} motions that states call free, {1e6 * each:.0f} us each")


def main() -> None:
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    wide, narrow = ur5_world("box-reach"), ur5_world("box-reach-narrow")
    print(f"{wide.spheres} spheres that exceed their capsules by {1e3 * wide.excess:.1f} mm at most")
    measure("UR5, scene c", wide)
    measure("UR5, scene a", narrow)
    seven = load_robot("arm7")
    measure("arm of 7 joints, boxes of scene a", ArmWorld(seven, box_for(seven, narrow.scene)))
    measure("UR5, 100 random boxes", ArmWorld(wide.robot, random_boxes()))
    measure("UR5 of 42 balls, scene c", ArmWorld(as_balls(wide.robot), wide.scene))
    measure_certified(wide)
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
