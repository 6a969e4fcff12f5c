"""The paper's problems: mazes, corridors along edges of the hypercube, a chain of ten links, and a UR5 at a box."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from evenroad.collision.arm_world import ArmWorld
from evenroad.loading.load import load_robot
from evenroad.robot import in_scene, with_group
from evenroad.scenes.scene_file import load_scene
from evenroad.world.gridmap.load import LEVELS, load_maze
from evenroad_studies.bench.task import Problem, ProblemSource
from evenroad_studies.worlds.chain import ChainWorld
from evenroad_studies.worlds.corridor import Corridor

WIDTHS: dict[int, tuple[float, ...]] = {2: (0.1, 0.0225), 3: (0.2, 0.1), 10: (0.37, 0.495)}
"""Dimension -> widths lambda: the paper's, then one where samplers can differ.

In tables, "low ones first" says that coordinates before the free one are at most the width, those after it at least one
minus the width, as a comment in OMPL's demo says.  The demo's code has it the other way round.

The second ones were chosen by uniform's success alone, k = 10 earlier, 400 runs of seed 1001 (200 in 3-D), at
N = 256 / 512 / 1024: 13 / 29 / 53 % in 2-D, 6 / 26 / 63 % in 3-D, 1 / 4 / 28 % in 10-D.  In 10-D no width has 10 % at
all three: from one half on the straight way is free, and just below it success rises from 1 to 28 %.
"""


def _published(make: Callable[[], Corridor | ChainWorld], instance: int) -> Problem:
    """Return the problem of a world that comes with its start and goal."""
    world = make()
    return Problem(world, world.start, world.goal, set_dim=world.space.dim)


CORRIDORS = (
    *(
        ProblemSource(
            f"corridor-{d}d-{lam:g}",
            d,
            partial(_published, partial(Corridor, d, lam)),
            about=f"corridor along {d} edges of the cube, width {lam:g}, all coordinates tested, low ones first",
        )
        for d, widths in WIDTHS.items()
        for lam in widths
    ),
    ProblemSource(
        "hypercube-legacy6",
        10,
        partial(_published, partial(Corridor, 10, 0.37, checked=6, side="demo")),
        about="10-D corridor, width 0.37, only 6 coordinates tested, high ones first (OMPL's demo)",
    ),
)

CHAINS = (
    ProblemSource(
        "chain-10d",
        10,
        partial(_published, partial(ChainWorld, 10)),
        about="planar chain of 10 links that folds out of a horn, measured by its joints in the plane (OMPL's demo)",
    ),
)


def _maze(level: int, instance: int) -> Problem:
    maze = load_maze(level)
    return Problem(maze.world(), np.array(maze.start), np.array(maze.goal), set_dim=2)


MAZES = tuple(
    ProblemSource(f"maze-{level}", 2, partial(_maze, level), about=f"2-D maze, level {level}, disk of radius 6")
    for level in LEVELS
)


SCENES = {"ur5-c": "box-reach", "ur5-a": "box-reach-narrow"}
"""Name of the problem -> shipped scene."""
RESOLUTION = 0.05
"""Largest step of a motion check, in the Euclidean metric of the joint angles [rad]."""


def _reach(scene_name: str, instance: int) -> Problem:
    robot = load_robot("ur5")
    group = robot.group[:5]
    scene = load_scene(scene_name)
    # The scene has the protocol's bounds: the lift in [-1.3 pi, 0.3 pi], the others in [-pi, pi].
    robot = in_scene(with_group(robot, group), scene)
    start, goal = (np.array([scene.states[name][joint] for joint in group]) for name in ("home", "inside"))
    return Problem(ArmWorld(robot, scene, resolution=RESOLUTION), start, goal, set_dim=len(group))


UR5 = tuple(
    ProblemSource(
        name,
        5,
        partial(_reach, scene),
        about=f"UR5, 5 joints, out of its home into a box: scene {scene}, capsules",
    )
    for name, scene in SCENES.items()
)
