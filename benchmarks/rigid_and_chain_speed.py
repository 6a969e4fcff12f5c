"""Configurations and motions a second of the chain, of bodies of boxes, and of the same bodies as meshes in coal.

    python -m benchmarks.rigid_and_chain_speed

One core; median of several repeats.  Configurations are uniform in the space, motions are the edges that a planner
asks for: the 10 nearest neighbours, symmetrised, among the free ones of 1024 uniform configurations.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from functools import partial

import numpy as np

from evenroad.errors import NotAvailable
from evenroad.geometry.mesh import merged
from evenroad.roadmap import KNearest
from evenroad.world import World
from evenroad_studies.problems import source_named
from evenroad_studies.worlds.rigid import MeshWorld, SolidWorld, surface_of

REPEATS = 7


def rate(task: Callable[[], object], items: int) -> float:
    """Return items a second, the median over the repeats."""
    task()
    seconds = []
    for _ in range(REPEATS):
        begin = time.perf_counter()
        task()
        seconds.append(time.perf_counter() - begin)
    return items / statistics.median(seconds)


def as_meshes(world: SolidWorld) -> MeshWorld:
    """Return the same scene as surfaces of triangles."""
    body = merged(tuple(surface_of(box) for box in world.body))
    return MeshWorld(world.space, body, [surface_of(box) for box in world.obstacles], world.resolution)


def measure(name: str, world: World, configurations: int) -> tuple[float, float]:
    """Print and return configurations and motions a second."""
    q = world.space.from_cube(np.random.default_rng(0).random((configurations, world.space.cube_dim)))
    free = world.valid(q)
    checks = rate(partial(world.valid, q), len(q))
    milestones = q[:1024][free[:1024]]
    edges = KNearest(10).edges(milestones, world.space)
    a, b = milestones[edges[:, 0]], milestones[edges[:, 1]]
    verdicts = world.motion_valid(a, b)
    motions = rate(partial(world.motion_valid, a, b), len(edges))
    print(
        f"{name:20} {checks:12,.0f} configurations/s ({free.mean():.1%} free)"
        f" {motions:12,.0f} motions/s ({len(edges)}, {verdicts.mean():.1%} free)",
        flush=True,
    )
    return checks, motions


def main() -> None:
    measure("chain-10d", source_named("chain-10d").make(0).world, 200_000)
    for name in ("cubicles", "twistycool"):
        world = source_named(name).make(0).world
        assert isinstance(world, SolidWorld)
        ours = measure(f"{name}, boxes", world, 200_000)
        try:
            theirs = measure(f"{name}, coal", as_meshes(world), 5_000)
        except NotAvailable as error:
            print(error)
            continue
        print(
            f"{'':20} boxes over coal: {ours[0] / theirs[0]:.0f}x configurations, {ours[1] / theirs[1]:.0f}x motions"
        )


if __name__ == "__main__":
    main()
