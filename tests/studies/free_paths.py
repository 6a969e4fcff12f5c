"""Every public planner, and by how much its paths stay clear, by oracles that share no code with it."""

import math
from itertools import pairwise

import numpy as np

import evenroad as er
from evenroad.collision.certified import CertifiedWorld
from evenroad.points import draw
from evenroad.points.samplers import make_sampler
from evenroad.roadmap import Budget
from evenroad.roadmap.build import roadmap_of_points
from evenroad.robot import ArmWorld
from evenroad.space import SE2, SE3, BoxSpace
from evenroad.space.path import subdivide
from evenroad.world import FunctionWorld, GridMap
from evenroad.world.gridmap import DiskWorld
from evenroad_studies.worlds.rigid import OrientedBox, SolidWorld
from tests.plan_on import find_path, fmt_on, plan_growing, plan_on
from tests.robots.kernel_arms import random_rotation
from tests.robots.oracle import clearance
from tests.studies.worlds.solids_oracle import gap
from tests.world.gridmap_oracle import distance_to_obstacles

FINER = 20
"""States are looked at this many times as densely as the planner's."""

POINTS = 128
BUDGET = Budget(samples=256, seconds=1.0)


def _points(world):
    return draw("sobol", POINTS, world.space.cube_dim, rng=3)


def _kept(world, start, goal, **options):
    return roadmap_of_points(world.space, _points(world)).within(world).plan(start, goal, **options)


def _several(world, start, goal, **options):
    goals = np.stack([goal, world.space.interpolate(goal[None], start[None], np.array([0.1]))[0]])
    return plan_on(world, start, goals, _points(world), search="lazy", **options)


def _arm(world, start, goal, **options):
    return er.plan(world.scene, start, goal, robot=world.robot, smooth=options.pop("smooth", True), **options)


PLANNERS = {
    "full": lambda world, *ends, **options: plan_on(world, *ends, _points(world), **options),
    "lazy": lambda world, *ends, **options: plan_on(world, *ends, _points(world), search="lazy", **options),
    "success only": lambda world, *ends, **options: plan_on(world, *ends, _points(world), success_only=True, **options),
    "several goals": _several,
    "fmt*": lambda world, *ends, **options: fmt_on(world, *ends, _points(world), **options),
    "anytime": lambda world, *ends, **options: plan_growing(
        world, *ends, make_sampler("sobol"), until="settled", budget=BUDGET, **options
    ),
    "kept": _kept,
    "find_path": lambda world, *ends, **options: find_path(world, *ends, budget=BUDGET, **options),
    "plan_arm": _arm,
}
"""Name -> from a world, start and goal to a result."""


def planners_of(world):
    """Names of the planners that take such a world."""
    return [name for name in PLANNERS if name != "plan_arm" or isinstance(world, ArmWorld)]


def nearest(world, path):
    """Least clearance of a path's states a twentieth of the resolution apart; negative: something touches.

    Of a disk on a map exactly, of the motions.
    """
    if isinstance(world, DiskWorld):
        return (
            min(distance_to_obstacles(tuple(a), tuple(b), world.grid.occupied) for a, b in pairwise(path))
            - world.radius
            + 1e-9
        )
    inner = world.world if isinstance(world, CertifiedWorld) else world
    segments = np.maximum(FINER * _steps(inner, path), 1)
    states, _ = subdivide(path, world.space, segments)
    if isinstance(inner, ArmWorld):
        return float(clearance(inner.robot, inner.scene, states).min())
    return float(gap(inner if isinstance(inner, SolidWorld) else inner.is_valid.__self__, states).min())


def _steps(world, path):
    """Into how many segments the planner divides each motion, (p - 1,)."""
    if isinstance(world, ArmWorld):
        return np.ceil(world.space.distance(path[:-1], path[1:]) / world.resolution).astype(int)
    return FunctionWorld(world.space, world.valid, world.resolution)._segments(path[:-1], path[1:])


def queries(world, count, seed=0):
    """Starts and goals that are free, at random."""
    q = world.space.from_cube(np.random.default_rng(seed).random((60 * count + 200, world.space.cube_dim)))
    q = q[world.valid(q)][: 2 * count]
    return list(zip(q[0::2], q[1::2], strict=False))


def disk_world(seed, size=40):
    """A disk on a map with bars across it."""
    rng = np.random.default_rng(seed)
    occupied = rng.random((size, size)) < 0.02
    for _ in range(8):
        row, column, long = rng.integers(0, size, 3)
        if rng.random() < 0.5:
            occupied[row, column : column + long // 2] = True
        else:
            occupied[row : row + long // 2, column] = True
    return GridMap(occupied).world(rng.uniform(0.3, 1.2))


def solid_world(seed, kind):
    """An L-shaped body among turned boxes, some of them flat: in SE2, SE3, or a box of three axes."""
    rng = np.random.default_rng(seed)
    dim = 2 if kind == "SE(2)" else 3
    body = (
        OrientedBox.spanning((-1, -0.2, -0.2)[:dim], (1, 0.2, 0.2)[:dim]),
        OrientedBox.spanning((0.6, 0, -0.2)[:dim], (1, 1, 0.2)[:dim]),
    )
    obstacles = []
    for _ in range(10 if dim == 2 else 25):
        half = rng.uniform(0.2, 1.2, dim)
        if rng.random() < 0.5:
            half[rng.integers(dim)] = 0.0 if dim == 3 else 0.02
        turn = random_rotation(rng)
        if dim == 2:
            angle = rng.uniform(0.0, 2.0 * math.pi)
            turn = (math.cos(angle), -math.sin(angle), math.sin(angle), math.cos(angle))
        obstacles.append(OrientedBox(rng.uniform(0, 10, dim), half, turn))
    if kind == "boxes":
        return SolidWorld(BoxSpace([0] * 3, [10] * 3), body, obstacles, 0.1)
    space = SE2([0, 0], [10, 10]) if dim == 2 else SE3([0] * 3, [10] * 3)
    return SolidWorld(space, body, obstacles, (0.1, 0.05))


def sampled(world):
    """The same verdicts from a function, as a user's own world would have them: states, and nothing between them."""
    return FunctionWorld(world.space, world.valid, world.resolution)
