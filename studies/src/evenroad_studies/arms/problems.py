"""Problems for arms: a scene at random, and two configurations in it that are worth a roadmap.

A problem counts where neither the straight motion nor 48 uniform points lead to the goal, and 5000 do.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache, partial

import numpy as np

from evenroad._arrays import Floats
from evenroad.collision.arm_world import VALIDATION_TOLERANCE
from evenroad.datasets.queries import free_configurations
from evenroad.datasets.random_scenes import GENERATORS, REPORT, Ranges, cell_of, draw_scene, inside_of
from evenroad.errors import NotAvailable
from evenroad.points import PointSet
from evenroad.roadmap import KNearest, Roadmap, build_roadmap
from evenroad.robot import ArmWorld, Scene
from evenroad_studies.arms.robots import arm_named, tool_of
from evenroad_studies.bench.task import Problem, ProblemSource

POOL = 300_000
"""From so many configurations those with the tool in a region are taken."""

CHOICE = 8
"""Postures that the second end is chosen from: the one that is nearest to the first end."""

EASY, ENOUGH = 48, 5000
"""Uniform points that must not, and that must do."""

EASY_K, ENOUGH_K = 10, 20
"""Neighbours that each of them is joined to; ends are linked to all of the first, and to 500."""

TRIES = 2000
"""Scenes that are drawn for one problem at most."""

TUNE = Ranges(
    shelf_angle=(-0.6, 0.6),
    shelf_away=(0.62, 0.72),
    shelf_width=(0.32, 0.40),
    shelf_height=(0.28, 0.32),
    shelf_columns=(2, 3),
    things=(6, 11),
    thing_height=(0.15, 0.4),
    window=(0.22, 0.30),
    wall_away=(0.5, 0.58),
    boxes=(6, 13),
    box_half=(0.04, 0.15),
    cage_width=(0.5, 0.56),
    cage_bars=(1, 2),
)
"""Ranges of problems by which constants are chosen."""

RANGES = {"report": REPORT, "tune": TUNE}
"""Stream -> ranges of its random scenes."""

PREFIXES = {"report": "arm", "tune": "tune-arm"}
"""Stream -> how the names of its problems begin."""


def problem_name(robot: str, generator: str, stream: str = "report") -> str:
    """Return the name of a stream of problems, such as ``arm-ur5-shelf``."""
    return f"{PREFIXES[stream]}-{robot}-{generator}"


def robot_and_generator(problem: str) -> tuple[str, str]:
    """Return whose problem it is, and by which generator, from its name."""
    robot, _, generator = problem.partition("arm-")[2].rpartition("-")
    return robot, generator


def stream_of(problem: str) -> str:
    """Return the stream of a problem's name."""
    return next(stream for stream, prefix in PREFIXES.items() if problem.startswith(prefix))


@lru_cache(maxsize=4096)
def draw_problem(robot: str, generator: str, stream: str, instance: int) -> Problem:
    """Return the problem of a number >= 0; NotAvailable where none counts of the scenes that are drawn for it."""
    kinds = list(GENERATORS), list(PREFIXES)
    of_problem = np.random.SeedSequence(
        [20261122, kinds[0].index(generator), kinds[1].index(stream), sum(map(ord, robot)), instance]
    )
    rng = np.random.default_rng(of_problem)
    for _ in range(TRIES):
        found = _drawn(robot, generator, stream, rng)
        if found is not None and is_worth(robot, found, rng):
            return found
    raise NotAvailable(f"of {TRIES} {generator} scenes none gives {robot} a problem that counts")


def _drawn(robot: str, generator: str, stream: str, rng: np.random.Generator) -> Problem | None:
    """Return a scene with two free configurations, or None where it cannot be reached into."""
    arm = arm_named(robot)
    cell = cell_of(arm)
    obstacles, regions = draw_scene(generator, rng, RANGES[stream])
    named = tuple(replace(each, name=f"{generator} {i}") for i, each in enumerate(obstacles))
    scene = Scene((*cell.obstacles, *named), name=f"{robot} {generator}", allowed=cell.allowed)
    world = ArmWorld(arm, scene)
    pool, tools = _pool(robot)
    ends: list[Floats] = []
    for region in rng.permutation(len(regions))[:2] if regions else (-1, -1):
        here = pool[rng.integers(len(pool), size=200)] if region < 0 else pool[inside_of(tools, regions[region])]
        free = here[world.valid(here)]
        if not len(free):
            return None
        some = free[rng.integers(len(free), size=CHOICE)]
        nearest = np.argmin(world.space.distance(some, np.broadcast_to(ends[0], some.shape))) if ends else 0
        ends.append(some[nearest if region >= 0 else 0])
    return Problem(world, ends[0], ends[1], set_dim=world.space.dim)


def is_worth(robot: str, problem: Problem, rng: np.random.Generator) -> bool:
    """Say whether a problem is neither easy nor beyond 5000 uniform points."""
    world, start, goal = problem.world, problem.start, problem.goal
    assert isinstance(world, ArmWorld)
    if world.motion_certified(start[np.newaxis], goal[np.newaxis], VALIDATION_TOLERANCE)[0]:
        return False
    few = _roadmap(world, rng.random((EASY, world.space.dim)), EASY_K)
    if joins(few, problem, EASY):
        return False
    return joins(_many(robot), problem, 500)


def joins(roadmap: Roadmap, problem: Problem, links: int) -> bool:
    """Say whether a roadmap leads from start to goal."""
    return roadmap.within(problem.world).plan(problem.start, problem.goal, smooth=False, links=links).solved


@lru_cache(maxsize=2)
def _many(robot: str) -> Roadmap:
    world = ArmWorld(arm_named(robot), cell_of(arm_named(robot)))
    return _roadmap(world, np.random.default_rng(5000).random((ENOUGH, world.space.dim)), ENOUGH_K)


def _roadmap(world: ArmWorld, points: Floats, k: int) -> Roadmap:
    """Return a roadmap of points of the cube, (n, dim), each joined to its k nearest."""
    return build_roadmap(world, PointSet(points), rule=KNearest(k))


@lru_cache(maxsize=2)
def _pool(robot: str) -> tuple[Floats, Floats]:
    """Return configurations that are free of robot and cell, (n, dim), and where the tool is, (n, 3)."""
    arm = arm_named(robot)
    return free_configurations(arm, cell_of(arm), POOL, tool_of(arm))


ARM_ROBOTS = {"ur5-5": 5, "ur5": 6, "arm7": 7, "scara": 4, "twoarm": 8}
"""Name -> joints: lists of problems load no robot."""

ABOUT = {
    "shelf": "compartments of a shelf",
    "clutter": "low between things on a table",
    "tight": "windows of a wall",
    "boxes": "boxes anywhere",
    "cage": "a cage of bars",
}

ARM_PROBLEMS = tuple(
    ProblemSource(
        problem_name(robot, generator, stream),
        dim,
        partial(draw_problem, robot, generator, stream),
        random=True,
        about=f"{robot}, {dim} joints: {ABOUT[generator]}",
    )
    for stream in PREFIXES
    for robot, dim in ARM_ROBOTS.items()
    for generator in GENERATORS
)
"""``arm-..`` for what is reported, ``tune-arm-..`` for what chooses."""
