"""Roadmaps before any scene is known, by the sampler of their milestones: what each may know of the robot."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from evenroad._arrays import Floats
from evenroad.points import draw
from evenroad.roadmap.neighbours import nearest
from evenroad.robot import ArmWorld, Obstacle, Robot, Scene
from evenroad.robot.kinematics import link_poses
from evenroad.robot_roadmap.arm_roadmap import ArmRoadmap
from evenroad.robot_roadmap.build import arm_roadmap, joined
from evenroad.robot_roadmap.turns import one_turn, shifts, winding_motions_free
from evenroad_studies.arms.robots import arm_named
from evenroad_studies.bench.samplers import SAMPLERS, draw_set, why_not

BOX_SAMPLERS = ("uniform", "sobol scrambled", "halton scrambled", "even", "hickernell", "mpmc")
"""Of the joint box: they know nothing of the robot."""

KNOWING = {
    "rejection": "the first scrambled Sobol points that are free of robot and cell",
    "control": "the same, in the roadmap's metric, motions proved free of robot and cell beforehand",
    "roadmap": "as evenroad.build_roadmap builds it",
}
"""Name -> what its milestones are."""

CANDIDATES = 4
"""Sobol points that are drawn for each that is to be free; doubled where they are too few."""


def cell_of(robot: Robot) -> Scene:
    """Return the cell that all problems share: the table that the robot stands on."""
    table = Obstacle.of("table", "box", (1.6, 1.6, 0.05), (0.3, 0.0, -0.03))
    bodied = [link for link in robot.links if any(capsule.link == link for capsule in robot.capsules)]
    return Scene((table,), name="table", allowed=frozenset((link, "table") for link in bodied[:2]))


def free_configurations(arm: Robot, cell: Scene, count: int, link: int) -> tuple[Floats, Floats]:
    """Return those of uniform configurations that are free of robot and cell, (n, dim), and where a link is, (n, 3)."""
    world = ArmWorld(arm, cell)
    q = world.space.from_cube(np.random.default_rng(0).random((count, world.space.dim)))
    q = q[world.valid(q)]
    # Some at a time: the poses of all links are much larger than those of one.
    return q, np.concatenate([link_poses(arm, part)[:, link, :3, 3] for part in np.array_split(q, 40)])


def why_no_roadmap(sampler: str, n: int, dim: int) -> str:
    """Return why there is no roadmap of a sampler's points, or "" if there is one."""
    return "" if sampler in KNOWING else why_not(sampler, n, dim)


@lru_cache(maxsize=16)
def roadmap_of(robot: str, sampler: str, n: int, k: int, run: int, seed: int) -> tuple[ArmRoadmap, str]:
    """Return a roadmap of n milestones, each joined to k, and which set of a pool they are."""
    arm = arm_named(robot)
    of_set, of_free = np.random.SeedSequence(seed, spawn_key=(run,)).spawn(2)
    if sampler in SAMPLERS:
        points, set_id = draw_set(sampler, n, len(arm.group), run, np.random.default_rng(of_set))
        return box_roadmap(arm, points.points, k), set_id
    made = made_roadmap(robot, n, run, seed)
    if sampler == "roadmap":
        return joined(made, made.milestones, k), ""
    free = first_free(made.world, n, np.random.default_rng(of_free))
    return joined(made, free, k) if sampler == "control" else _joined_in_box(made.world, free, k), ""


@lru_cache(maxsize=4)
def made_roadmap(robot: str, n: int, run: int, seed: int) -> ArmRoadmap:
    """Return the roadmap that evenroad makes, for all numbers of neighbours."""
    arm = arm_named(robot)
    return arm_roadmap(ArmWorld(arm, cell_of(arm)), n, rng=np.random.SeedSequence(seed, spawn_key=(run, n)))


def box_roadmap(robot: Robot, points: Floats, k: int) -> ArmRoadmap:
    """Return a roadmap of points of the cube, each joined to its k nearest, whatever is in between."""
    world = ArmWorld(robot, cell_of(robot))
    return _joined_in_box(world, world.space.from_cube(points), k)


def first_free(world: ArmWorld, n: int, rng: np.random.Generator) -> Floats:
    """Return the first n scrambled Sobol points that are free of robot and cell, (n, dim)."""
    drawn = CANDIDATES * n
    while True:
        q = world.space.from_cube(draw("sobol", drawn, world.space.dim, rng=rng.spawn(1)[0]).points)
        free = q[world.valid(q)]
        if len(free) >= n:
            return free[:n]
        drawn *= 2


def _joined_in_box(world: ArmWorld, milestones: Floats, k: int) -> ArmRoadmap:
    """Return a roadmap in the metric of the joints; edges that no scene leaves free are left out of it."""
    near = nearest(milestones, min(k, len(milestones) - 1), world.space)
    own = np.repeat(np.arange(len(milestones)), near.shape[1])
    pairs = np.unique(np.sort(np.stack([own, near.ravel()], axis=1)), axis=0)
    one = one_turn(world.space, np.zeros(world.space.dim, dtype=np.bool_))
    a, b = milestones[pairs[:, 0]], milestones[pairs[:, 1]]
    turns = shifts(one, a, b)
    free = winding_motions_free(world, one, a, b, turns)
    return ArmRoadmap(
        robot=world.robot,
        scene=world.scene,
        resolution=world.resolution,
        milestones=milestones,
        edges=pairs[free].astype(np.int32),
        turns=turns[free].astype(np.int8),
        weights=np.ones(world.space.dim),
    )
